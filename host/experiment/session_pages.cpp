#include "host/experiment/session_pages.h"

#include <cmath>

#include "experiment_pages.h"
#include "host/experiment/page_text.h"
#include "host/output/json.h"

namespace forceshade::experiment {
namespace {

// The section of a bump of these facets, as a picture.
Json section_of_bump(unsigned facets) {
    constexpr double kRadius = 0.65, kHalf = 0.5; // of the width
    constexpr int kRound = 48;
    const double opening = std::asin(kHalf / kRadius), low = std::sqrt(kRadius * kRadius - kHalf * kHalf);
    const int pieces = facets == 0 ? kRound : int(facets);
    Json points = Json::array({Json::array({-1.0, 0.0})});
    for (int i = 0; i <= pieces; ++i) {
        const double angle = opening * (2.0 * i / pieces - 1);
        points.push_back({kRadius * std::sin(angle), low - kRadius * std::cos(angle)});
    }
    points.push_back({1.0, 0.0});
    return points;
}

// With the experiment's own words in it.
std::string participants_page(const ExperimentSpec& spec) {
    constexpr std::string_view kPlace = "{/* words */}";
    std::string words = page_message({{"text", texts_with(spec.text)},
                                      {"title", spec.title},
                                      {"consent", spec.consent.bytes},
                                      {"instructions", spec.instructions.bytes}});
    for (std::size_t at = words.find('<'); at != words.npos; at = words.find('<', at))
        words.replace(at, 1, "\\u003c"); // or "</script>" would end the script
    std::string page(pages::participant_html);
    return page.replace(page.find(kPlace), kPlace.size(), words);
}

} // namespace

std::vector<ServedPage> session_pages(const ExperimentSpec& spec) {
    std::vector<ServedPage> pages{{kParticipant, participants_page(spec), true},
                                  {kOperator, std::string(pages::operator_html), false}};
    for (const Answer& answer : spec.answers)
        if (const std::string name = answer.picture_file(); !name.empty())
            pages.push_back({name, answer.picture.bytes, false,
                             answer.picture.extension == ".png" ? "image/png" : "image/svg+xml"});
    return pages;
}

Json answers_on_page(const ExperimentSpec& spec, const std::vector<unsigned>& buttons) {
    Json json{{"question", spec.question},
              {"compare", spec.task == Task::compare},
              {"by_key", spec.interval == 0},
              {"buttons", !buttons.empty()},
              {"answers", Json::array()}};
    for (const Answer& answer : spec.answers) {
        Json one{{"label", answer.label}};
        if (const std::string name = answer.picture_file(); !name.empty()) {
            one["picture"] = name;
        } else if (answer.facets) {
            one["points"] = section_of_bump(*answer.facets);
            one["box"] = {-1.05, -0.3, 2.1, 0.35};
        }
        if (!buttons.empty())
            one["button"] = buttons[json["answers"].size()];
        json["answers"].push_back(std::move(one));
    }
    return json;
}

std::string page_message(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace forceshade::experiment

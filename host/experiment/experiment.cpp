#include "host/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include "host/error.h"
#include "host/experiment/conditions.h"
#include "host/experiment/trials.h"
#include "host/output/reading.h"
#include "host/scene/document.h"
#include "host/scene/quantity.h"
#include "host/scene/schema.h"

namespace forceshade::experiment {
namespace {

constexpr std::uint64_t kMostTrials = 10000, kMostBlocks = 1000;
constexpr std::size_t kMostAnswers = 9; // keys 1 to 9
constexpr std::size_t kLongestText = 500;
constexpr std::uint64_t kLargestPicture = 1u << 20;    // bytes
constexpr std::uint64_t kMostPicturePixels = 1u << 22; // of a PNG
constexpr const char* kSource = "the paper's experiment";

// A value of a key, where it stands, and the folder that files are relative to.
struct Given {
    const std::string& source;
    const std::filesystem::path& folder;
    const TomlNode& member;

    template <typename... Parts>
    [[noreturn]] void refuse(fmt::format_string<Parts...> message, Parts&&... parts) const {
        forceshade::fail(source, member.where.line > 0 ? member.where : member.key_where,
                         fmt::format(message, std::forward<Parts>(parts)...));
    }
    std::string text() const {
        if (member.type != TomlNode::Type::string || member.text.empty())
            refuse("{} is a text in quotes, got {}", member.key, describe(member));
        if (member.text.size() > kLongestText)
            refuse("{} is longer than {} characters", member.key, kLongestText);
        return member.text;
    }
    std::uint64_t integer(std::uint64_t least, std::uint64_t most) const {
        const std::int64_t value = member.integer;
        if (member.type != TomlNode::Type::integer || value < 0 || std::uint64_t(value) < least ||
            std::uint64_t(value) > most)
            refuse("{} is an integer from {} to {}, got {}", member.key, least, most, describe(member));
        return std::uint64_t(value);
    }
    bool boolean() const {
        if (member.type != TomlNode::Type::boolean)
            refuse("{} is true or false, got {}", member.key, describe(member));
        return member.truth;
    }
    double number(double least) const {
        const bool whole = member.type == TomlNode::Type::integer;
        const double value = whole ? double(member.integer) : member.real;
        if ((!whole && member.type != TomlNode::Type::real) || !(value >= least) || std::isinf(value))
            refuse("{} is a number, {} or more, got {}", member.key, least, describe(member));
        return value;
    }
    double seconds(bool positive) const {
        double value = 0;
        try {
            value = parse_quantity(text(), Dimension::time);
        } catch (const UsageError& error) {
            refuse("{}", error.what());
        }
        if (positive ? !(value > 0) : !(value >= 0))
            refuse("{} must {}, got {}", member.key, positive ? "be positive" : "not be negative", text());
        return value;
    }
};

struct SpecKey {
    const char* name;
    const char* type;
    const char* meaning;
    std::function<void(ExperimentSpec&, const Given&)> set;
    std::function<std::string(const ExperimentSpec&)> literal; // as TOML; empty: not given
    std::vector<const char*> choices = {};
    std::uint64_t least = 0, most = 0; // of an integer
    bool of_compare = false;           // of the task compare alone
};

template <typename T> SpecKey text_key(const char* name, const char* meaning, T ExperimentSpec::*part) {
    return {name, "text", meaning, [part](ExperimentSpec& s, const Given& g) { s.*part = g.text(); },
            [part](const ExperimentSpec& s) { return (s.*part).empty() ? "" : toml_string(s.*part); }};
}

SpecKey integer_key(const char* name, const char* meaning, std::uint64_t ExperimentSpec::*part, std::uint64_t least,
                    std::uint64_t most) {
    SpecKey key{name, "integer", meaning, [=](ExperimentSpec& s, const Given& g) { s.*part = g.integer(least, most); },
                [=](const ExperimentSpec& s) { return std::to_string(s.*part); }};
    key.least = least;
    key.most = most;
    return key;
}

SpecKey time_key(const char* name, const char* meaning, double ExperimentSpec::*part, bool positive) {
    return {name, "time", meaning, [=](ExperimentSpec& s, const Given& g) { s.*part = g.seconds(positive); },
            [=](const ExperimentSpec& s) { return toml_string(fmt::format("{} s", s.*part)); }};
}

template <typename Choice>
SpecKey choice_key(const char* name, const char* meaning, Choice ExperimentSpec::*part,
                   const std::vector<const char*>& choices) {
    SpecKey key{name, "choice", meaning,
                [=](ExperimentSpec& s, const Given& g) {
                    const std::string word = g.text();
                    const auto found = std::ranges::find(choices, word);
                    if (found == choices.end())
                        g.refuse("{} is \"{}\", got \"{}\"", name, fmt::join(choices, "\" or \""), word);
                    s.*part = static_cast<Choice>(found - choices.begin());
                },
                [=](const ExperimentSpec& s) { return toml_string(choices[static_cast<std::size_t>(s.*part)]); }};
    key.choices = choices;
    return key;
}

const std::vector<SpecKey>& spec_keys() {
    using S = ExperimentSpec;
    static const std::vector<SpecKey> keys = [] {
        std::vector<SpecKey> all{
            choice_key("task", "name what one stimulus is, or compare two that are felt one after the other", &S::task,
                       {"name", "compare"}),
            text_key("title", "of the data", &S::title),
            text_key("question", "what a participant is asked after each stimulus", &S::question),
            integer_key("trials", "of each condition; of each track the most", &S::trials, 1, kMostTrials),
            integer_key("practice", "trials before, which do not count", &S::practice, 0, kMostTrials),
            integer_key("blocks", "with a break between", &S::blocks, 1, kMostBlocks),
            choice_key("order", "of trials: over the session, or so that each block has every condition equally often",
                       &S::order, {"random", "balanced"}),
            {"feedback", "boolean", "whether a participant is told if the answer was right",
             [](S& s, const Given& g) { s.feedback = g.boolean(); },
             [](const S& s) { return std::string(s.feedback ? "true" : "false"); }},
            time_key("longest_trial", "after which a trial ends without an answer and is repeated at the end",
                     &S::longest_trial, true),
            integer_key("seed", "of the order; each subject and session has one of its own", &S::seed, 0,
                        std::numeric_limits<std::int64_t>::max())};
        const std::size_t of_both = all.size();
        all.insert(
            all.end(),
            {text_key("standard",
                      "shell pattern of the cases that the others are compared with, each with the standard "
                      "that has most of its settings",
                      &S::standard),
             text_key("correct",
                      "smoother: right is the stimulus of more facets, the smooth shape before all; or a shell "
                      "pattern of the cases that are right",
                      &S::correct),
             time_key("interval", "that each stimulus is felt; 0 s: until a key is pressed", &S::interval, false),
             text_key("track",
                      "axis of the study over which a threshold is looked for: the level of each trial is the "
                      "one that tells most (QUEST+), a track for each combination of the other settings",
                      &S::track),
             {"track_ratio", "number",
              "a track ends before its trials do once the ends of the threshold's 95 % interval have a smaller "
              "ratio; 1: never",
              [](S& s, const Given& g) { s.track_ratio = g.number(1); },
              [](const S& s) { return fmt::format("{}", s.track_ratio); }}});
        for (std::size_t i = of_both; i < all.size(); ++i)
            all[i].of_compare = true;
        return all;
    }();
    return keys;
}

bool is_name(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

// Nothing: it is one; else what is wrong with it.
std::string complaint_of_png(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    std::string complaint;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) != 0) {
        image.format = PNG_FORMAT_RGBA;
        if (std::uint64_t{image.width} * image.height > kMostPicturePixels) {
            complaint = fmt::format("it has {} x {} pixels, and {} are the most", image.width, image.height,
                                    kMostPicturePixels);
        } else {
            std::vector<std::byte> pixels(PNG_IMAGE_SIZE(image));
            png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr);
        }
    }
    if (complaint.empty() && PNG_IMAGE_FAILED(image))
        complaint = fmt::format("it is damaged ({})", image.message);
    png_image_free(&image);
    return complaint;
}

bool is_svg(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n", kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark))
        text.remove_prefix(kMark.size());
    text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
    text = text.substr(0, text.find_last_not_of(kSpace) + 1);
    return text.starts_with("<") && text.find("<svg") != text.npos &&
           (text.ends_with("</svg>") || text.ends_with("/>"));
}

AnswerPicture read_picture(const Given& given) {
    const std::filesystem::path file = given.folder / given.text();
    std::error_code error;
    if (const auto size = std::filesystem::file_size(file, error); !error && size > kLargestPicture)
        given.refuse("the picture {} has {} bytes, and {} are the most", file.string(), size, kLargestPicture);
    AnswerPicture picture;
    try {
        picture.bytes = read_file(file);
    } catch (const Error& failure) {
        given.refuse("{}; a picture is a PNG or SVG file beside the experiment's", failure.what());
    }
    constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
    if (picture.bytes.starts_with(kPng)) {
        picture.extension = ".png";
        if (const std::string complaint = complaint_of_png(picture.bytes); !complaint.empty())
            given.refuse("the picture {} cannot be shown: {}", file.string(), complaint);
    } else if (is_svg(picture.bytes)) {
        picture.extension = ".svg";
    } else {
        given.refuse("{} is no picture: neither a PNG nor an SVG file", file.string());
    }
    return picture;
}

struct AnswerKey {
    const char* name;
    const char* type;
    const char* meaning;
    void (*set)(Answer&, const Given&);
};

constexpr AnswerKey kAnswerKeys[] = {
    {"name", "text", "as data has it",
     [](Answer& a, const Given& g) {
         a.name = g.text();
         if (!is_name(a.name))
             g.refuse("an answer's name, which stands in the data, has a to z, 0 to 9 and _ only; got \"{}\"; its "
                      "label may be any text",
                      a.name);
     }},
    {"label", "text", "as a participant reads it", [](Answer& a, const Given& g) { a.label = g.text(); }},
    {"facets", "integer", "of the shape that it names and its picture shows; 0: the smooth one; none: words alone",
     [](Answer& a, const Given& g) { a.facets = unsigned(g.integer(0, 1000)); }},
    {"correct_for", "text", "a pattern of case names; without it bumps of these facets",
     [](Answer& a, const Given& g) { a.correct_for = g.text(); }},
    {"picture", "file", "PNG or SVG of up to 1 MiB, relative to the experiment file, in place of the drawn shape",
     [](Answer& a, const Given& g) { a.picture = read_picture(g); }}};

Answer read_answer(const std::string& source, const std::filesystem::path& folder, const TomlNode& node) {
    Answer answer;
    Errors errors;
    const auto read_key = [&](const TomlNode& member) {
        const auto key = std::ranges::find(kAnswerKeys, member.key, &AnswerKey::name);
        if (key == std::end(kAnswerKeys)) {
            std::vector<std::string> known;
            for (const AnswerKey& one : kAnswerKeys)
                known.emplace_back(one.name);
            const std::string near = did_you_mean(member.key, known);
            fail(source, member.key_where, "unknown key \"{}\" of an answer{}", member.key,
                 near.empty() ? fmt::format("; it has {}", fmt::join(known, ", ")) : near);
        }
        key->set(answer, {source, folder, member});
    };
    for (const TomlNode& member : node.items)
        errors.attempt([&] { read_key(member); });
    errors.report();
    if (answer.name.empty())
        fail(source, node.where, "an answer needs a name");
    if (answer.label.empty())
        answer.label = answer.name;
    return answer;
}

void read_answers(const std::string& source, const std::filesystem::path& folder, const TomlNode& member,
                  ExperimentSpec& spec) {
    const auto is_table = [](const TomlNode& item) { return item.type == TomlNode::Type::table; };
    if (member.type != TomlNode::Type::array || !std::ranges::all_of(member.items, is_table))
        fail(source, member.key_where, "answers are tables, each written as [[experiment.answer]], with two brackets");
    spec.answers.clear();
    Errors errors;
    for (const TomlNode& item : member.items)
        errors.attempt([&] {
            spec.answers.push_back(read_answer(source, folder, item));
            const auto same = std::ranges::count(spec.answers, spec.answers.back().name, &Answer::name);
            if (same > 1)
                fail(source, item.where, "two answers are named \"{}\"", spec.answers.back().name);
        });
    errors.report();
    if (spec.answers.size() < 2 || spec.answers.size() > kMostAnswers)
        fail(source, member.key_where, "there are 2 to {} answers, one for each key; got {}", kMostAnswers,
             spec.answers.size());
}

std::vector<Answer> paper_answers() {
    return {{"flat", "flat", 1, {}, {}},
            {"two_poly", "two facets", 2, {}, {}},
            {"three_poly", "three facets", 3, {}, {}},
            {"cylinder", "round", 0, {}, {}}};
}

// What the keys of the task compare want of each other, and that the task name has none of them.
void settle_task(const std::string& source, const TomlNode& table, ExperimentSpec& spec) {
    const auto given = [&](std::string_view key) { return table.find(key); };
    if (spec.task == Task::name) {
        for (const SpecKey& key : spec_keys())
            if (const TomlNode* member = key.of_compare ? given(key.name) : nullptr)
                fail(source, member->key_where,
                     "\"{}\" is of the task \"compare\": say task = \"compare\" or leave it out", key.name);
        return;
    }
    if (!given("standard"))
        fail(source, table.where,
             "task = \"compare\" needs a standard, which the other stimuli are compared with: standard = "
             "\"cylinder_bump*\"");
    if (!given("question")) {
        if (spec.correct != kSmoother)
            fail(source, given("correct")->key_where, "say what is asked: question = \"Which one is ...?\"");
        spec.question = "Which one is smoother?";
    }
    if (spec.track_ratio > 1 && spec.track.empty())
        fail(source, given("track_ratio")->key_where,
             "track_ratio ends a track, and there is no track: say which axis");
    if (spec.interval >= spec.longest_trial)
        fail(source, given("interval")->key_where, "an interval of {} s is not shorter than longest_trial, {} s",
             spec.interval, spec.longest_trial);
    const TomlNode* answers = given("answer");
    if (!answers) {
        spec.answers = {{"first", "the first", {}, {}, {}}, {"second", "the second", {}, {}, {}}};
        return;
    }
    if (spec.answers.size() != 2)
        fail(source, answers->key_where, "task = \"compare\" has two answers, for the first and the second; got {}",
             spec.answers.size());
    for (const Answer& answer : spec.answers)
        if (answer.facets || !answer.correct_for.empty())
            fail(source, answers->key_where,
                 "the answer \"{}\" is of an interval: facets and correct_for are of task = \"name\"; what is right is "
                 "said by correct = ...",
                 answer.name);
}

ExperimentSpec read_spec(const Document& document, const std::filesystem::path& folder) {
    ExperimentSpec spec;
    spec.answers = paper_answers();
    if (!document.experiment)
        return spec;
    if (document.experiment->type != TomlNode::Type::table)
        fail(document.source, document.experiment->where, "[experiment] is a table of keys");
    const auto read_key = [&](const TomlNode& member) {
        if (member.key == "answer")
            return read_answers(document.source, folder, member, spec);
        const auto key = std::ranges::find(spec_keys(), member.key, &SpecKey::name);
        if (key != spec_keys().end())
            return key->set(spec, {document.source, folder, member});
        std::vector<std::string> names{"answer"};
        for (const SpecKey& one : spec_keys())
            names.emplace_back(one.name);
        const std::string near = did_you_mean(member.key, names);
        fail(document.source, member.key_where, "unknown key \"{}\" in [experiment]{}", member.key,
             near.empty() ? fmt::format("; it has {}", fmt::join(names, ", ")) : near);
    };
    Errors errors;
    for (const TomlNode& member : document.experiment->items)
        errors.attempt([&] { read_key(member); });
    errors.report();
    settle_task(document.source, *document.experiment, spec);
    return spec;
}

Experiment checked(ExperimentSpec given, Study study) {
    Experiment experiment{std::move(given), std::move(study), {}, {}, {}, {}};
    const std::string& source = experiment.study.document->source;
    const ExperimentSpec& spec = experiment.spec;
    const auto at = [&](std::string_view key, void (*arrange)(Experiment&)) {
        try {
            arrange(experiment);
        } catch (const UsageError& error) {
            const TomlNode* member = experiment.study.document->experiment->find(key); // the paper's is arranged
            fail(source, member ? member->where : Location{}, "{}", error.what());
        }
    };
    at("standard", find_conditions);
    at("track", find_tracks);
    const char* const what = experiment.tracks.empty() ? "condition" : "track";
    const std::size_t units = experiment.size() / spec.trials;
    if (experiment.size() > kMostTrials * 10)
        fail(source, {}, "{} {}s of {} trials each are more than a session can have", units, what, spec.trials);
    if (spec.order == Order::balanced && spec.trials % spec.blocks != 0)
        fail(source, {},
             "{} trials of each {} do not share out to {} blocks; balanced blocks want a multiple, or order = "
             "\"random\"",
             spec.trials, what, spec.blocks);
    if (spec.blocks > experiment.size())
        fail(source, {}, "{} blocks are more than there are trials ({})", spec.blocks, experiment.size());
    for (const Answer& answer : spec.answers)
        if (!answer.correct_for.empty() && std::ranges::none_of(experiment.study.cases, [&](const Case& one) {
                return fnmatch(answer.correct_for.c_str(), one.name.c_str(), 0) == 0;
            }))
            fail(source, {}, "the answer \"{}\" is correct for \"{}\", which no case is named; the first is {}",
                 answer.name, answer.correct_for, experiment.study.cases.front().name);
    const auto has_right_answer = [&](std::size_t condition) {
        return experiment.correct_answer(Trial{1, 1, condition, 0}).has_value();
    };
    for (std::size_t i = 0; i < experiment.conditions.size() && (spec.feedback || !experiment.tracks.empty()); ++i)
        if (!has_right_answer(i))
            fail(source, {}, "{} needs a correct answer to every stimulus, and {} has none: {}",
                 spec.feedback ? "feedback" : "a track", experiment.stimulus(experiment.conditions[i]).name,
                 spec.task == Task::name ? "give answers facets or correct_for"
                                         : "it is as smooth as its standard, or correct names both or neither");
    return experiment;
}

} // namespace

namespace {

using Read = std::function<Study(std::span<const Override>, const ReadBeside&)>;

// Laws go in double precision, as the live loop's, unless somebody says otherwise.
Experiment in_double(std::span<const Override> overrides, const std::filesystem::path& folder, const Read& read) {
    const auto key = key_index("run.precision");
    ExperimentSpec spec;
    Study study = read(overrides, [&](const Document& document) { spec = read_spec(document, folder); });
    if (study.document->base.find(key) || study.document->overrides.find(key))
        return checked(std::move(spec), std::move(study));
    std::vector<Override> all(overrides.begin(), overrides.end());
    all.emplace_back("run.precision", "f64");
    return checked(std::move(spec), read(all, {}));
}

} // namespace

Experiment parse_experiment(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                            std::span<const Override> overrides) {
    return in_double(overrides, folder, [&](std::span<const Override> some, const ReadBeside& beside) {
        return parse_study(text, source, folder, some, beside);
    });
}

Experiment read_experiment(const std::filesystem::path& file, std::span<const Override> overrides) {
    if (file.empty())
        return parse_experiment(paper_experiment(), kSource, {}, overrides);
    return in_double(overrides, file.parent_path(), [&](std::span<const Override> some, const ReadBeside& beside) {
        return read_study(file, some, beside);
    });
}

std::string_view paper_experiment() {
    return R"toml(# Morgenbesser & Srinivasan 1996: seven bumps at three radii, 24 trials of each, answers by four pictures.
[experiment]
title = "Force shading for haptic shape perception (1996)"
trials = 24

[surface]
width = "1000 mil"
radius = ["600 mil", "1000 mil", "1400 mil"]

[force]
stiffness = "1 N/mm"

[[variant]]
surface.kind = "cylinder_bump"

[[variant]]
surface.kind = "bump"
surface.facets = [1, 2, 3]
force.shading = ["none", "reference"]
)toml";
}

std::string resolved_toml(const Experiment& experiment) {
    std::string text = "[experiment]\n";
    const ExperimentSpec& spec = experiment.spec;
    for (const SpecKey& key : spec_keys()) {
        const bool kept = spec.task == Task::compare || (!key.of_compare && key.name != std::string_view("task"));
        if (const std::string literal = kept ? key.literal(spec) : ""; !literal.empty())
            text += fmt::format("{} = {}\n", key.name, literal);
    }
    for (const Answer& answer : spec.answers) {
        text += fmt::format("\n[[experiment.answer]]\nname = {}\nlabel = {}\n", toml_string(answer.name),
                            toml_string(answer.label));
        if (answer.facets)
            text += fmt::format("facets = {}\n", *answer.facets);
        if (!answer.correct_for.empty())
            text += fmt::format("correct_for = {}\n", toml_string(answer.correct_for));
        if (!answer.picture.bytes.empty())
            text += fmt::format("picture = {}\n", toml_string(answer.picture_file()));
    }
    return text + "\n" + forceshade::resolved_toml(experiment.study);
}

namespace {

// The defaults, and of the keys that have none an example.
ExperimentSpec shown_spec() {
    ExperimentSpec spec;
    spec.standard = "cylinder_bump*";
    spec.track = "surface.facets";
    return spec;
}

} // namespace

std::string experiment_schema() {
    std::string text = "# Of forceshade experiment. Stimuli are the cases of the other tables.\n[experiment]\n";
    for (const SpecKey& key : spec_keys())
        text += fmt::format("{}{} = {} # {}: {}{}\n", key.of_compare ? "# " : "", key.name, key.literal(shown_spec()),
                            key.choices.empty() ? key.type : fmt::format("{}", fmt::join(key.choices, " | ")),
                            key.meaning, key.of_compare ? "; task compare" : "");
    text +=
        fmt::format("# Tables [[experiment.answer]], 2 to {}, in the order of their keys. Default: the paper's four "
                    "pictures; of the task compare \"the first\" and \"the second\". Their keys:\n",
                    kMostAnswers);
    for (const AnswerKey& key : kAnswerKeys)
        text += fmt::format("# {}: {}: {}\n", key.name, key.type, key.meaning);
    return text;
}

nlohmann::ordered_json experiment_schema_json() {
    nlohmann::ordered_json keys = nlohmann::ordered_json::array();
    const auto add = [&](const std::string& name, const char* type, const char* meaning) -> nlohmann::ordered_json& {
        keys.push_back({{"key", "experiment." + name}, {"type", type}, {"default", nullptr}});
        keys.back().update(
            {{"count", 1}, {"one_for_all", false}, {"axis", false}, {"applies_to", ""}, {"doc", meaning}});
        return keys.back();
    };
    for (const SpecKey& key : spec_keys()) {
        nlohmann::ordered_json& row = add(key.name, key.type, key.meaning);
        if (const std::string literal = key.literal(ExperimentSpec{}); !literal.empty())
            row["default"] = literal;
        if (key.most > 0)
            row.update({{"minimum", key.least}, {"maximum", key.most}});
        if (!key.choices.empty())
            row["choices"] = key.choices;
        if (key.of_compare)
            row["applies_to"] = "task compare";
    }
    for (const AnswerKey& key : kAnswerKeys)
        add(std::string("answer.") + key.name, key.type, key.meaning);
    return keys;
}

} // namespace forceshade::experiment

#include "host/experiment/experiment.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"
#include "host/scene/document.h"
#include "host/scene/quantity.h"
#include "host/scene/schema.h"

namespace forceshade::experiment {
namespace {

constexpr std::uint64_t kMostTrials = 10000, kMostBlocks = 1000;
constexpr std::size_t kMostAnswers = 9; // keys 1 to 9
constexpr std::size_t kLongestText = 500;
constexpr const char* kSource = "the paper's experiment";

// A value of a key, and where it stands.
struct Given {
    const std::string& source;
    const TomlMember& member;

    template <typename... Parts>
    [[noreturn]] void refuse(fmt::format_string<Parts...> message, Parts&&... parts) const {
        forceshade::fail(source, member.value.where.line > 0 ? member.value.where : member.where,
                         fmt::format(message, std::forward<Parts>(parts)...));
    }
    std::string text() const {
        if (member.value.type != TomlNode::Type::string || member.value.text.empty())
            refuse("{} is a text in quotes, got {}", member.key, describe(member.value));
        if (member.value.text.size() > kLongestText)
            refuse("{} is longer than {} characters", member.key, kLongestText);
        return member.value.text;
    }
    std::uint64_t integer(std::uint64_t least, std::uint64_t most) const {
        const std::int64_t value = member.value.integer;
        if (member.value.type != TomlNode::Type::integer || value < 0 || std::uint64_t(value) < least ||
            std::uint64_t(value) > most)
            refuse("{} is an integer from {} to {}, got {}", member.key, least, most, describe(member.value));
        return std::uint64_t(value);
    }
    bool boolean() const {
        if (member.value.type != TomlNode::Type::boolean)
            refuse("{} is true or false, got {}", member.key, describe(member.value));
        return member.value.truth;
    }
    double seconds() const {
        double value = 0;
        try {
            value = parse_quantity(text(), Dimension::time);
        } catch (const UsageError& error) {
            refuse("{}", error.what());
        }
        if (!(value > 0))
            refuse("{} must be positive, got {}", member.key, text());
        return value;
    }
};

struct SpecKey {
    const char* name;
    const char* values;
    const char* meaning;
    std::function<void(ExperimentSpec&, const Given&)> set;
    std::function<std::string(const ExperimentSpec&)> literal; // as TOML
};

const std::vector<SpecKey>& spec_keys() {
    using S = ExperimentSpec;
    static const std::vector<SpecKey> keys{
        {"title", "text", "of the data", [](S& s, const Given& g) { s.title = g.text(); },
         [](const S& s) { return toml_string(s.title); }},
        {"question", "text", "what a participant is asked after each stimulus",
         [](S& s, const Given& g) { s.question = g.text(); }, [](const S& s) { return toml_string(s.question); }},
        {"trials", "integer", "of each condition", [](S& s, const Given& g) { s.trials = g.integer(1, kMostTrials); },
         [](const S& s) { return std::to_string(s.trials); }},
        {"practice", "integer", "trials before, which do not count",
         [](S& s, const Given& g) { s.practice = g.integer(0, kMostTrials); },
         [](const S& s) { return std::to_string(s.practice); }},
        {"blocks", "integer", "with a break between",
         [](S& s, const Given& g) { s.blocks = g.integer(1, kMostBlocks); },
         [](const S& s) { return std::to_string(s.blocks); }},
        {"order", "random | balanced",
         "of trials: over the session, or so that each block has every condition equally often",
         [](S& s, const Given& g) {
             const std::string word = g.text();
             if (word != "random" && word != "balanced")
                 g.refuse("order is \"random\" or \"balanced\", got \"{}\"", word);
             s.order = word == "random" ? Order::random : Order::balanced;
         },
         [](const S& s) { return toml_string(s.order == Order::random ? "random" : "balanced"); }},
        {"feedback", "true | false", "whether a participant is told if the answer was right",
         [](S& s, const Given& g) { s.feedback = g.boolean(); },
         [](const S& s) { return std::string(s.feedback ? "true" : "false"); }},
        {"longest_trial", "time", "after which a trial ends without an answer and is repeated at the end",
         [](S& s, const Given& g) { s.longest_trial = g.seconds(); },
         [](const S& s) { return toml_string(fmt::format("{} s", s.longest_trial)); }},
        {"seed", "integer", "of the order; each subject and session has one of its own",
         [](S& s, const Given& g) { s.seed = g.integer(0, std::numeric_limits<std::int64_t>::max()); },
         [](const S& s) { return std::to_string(s.seed); }}};
    return keys;
}

bool is_name(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

Answer read_answer(const std::string& source, const TomlNode& node) {
    Answer answer;
    for (const TomlMember& member : node.members) {
        const Given given{source, member};
        if (member.key == "name") {
            answer.name = given.text();
            if (!is_name(answer.name))
                given.refuse(
                    "an answer's name, which stands in the data, has a to z, 0 to 9 and _ only; got \"{}\"; its "
                    "label may be any text",
                    answer.name);
        } else if (member.key == "label") {
            answer.label = given.text();
        } else if (member.key == "facets") {
            answer.facets = unsigned(given.integer(0, 1000));
        } else if (member.key == "correct_for") {
            answer.correct_for = given.text();
        } else {
            const std::vector<std::string> known{"name", "label", "facets", "correct_for"};
            const std::string near = did_you_mean(member.key, known);
            fail(source, member.where, "unknown key \"{}\" of an answer{}", member.key,
                 near.empty() ? "; it has name, label, facets and correct_for" : near);
        }
    }
    if (answer.name.empty())
        fail(source, node.where, "an answer needs a name");
    if (answer.label.empty())
        answer.label = answer.name;
    return answer;
}

void read_answers(const std::string& source, const TomlMember& member, ExperimentSpec& spec) {
    const auto is_table = [](const TomlNode& item) { return item.type == TomlNode::Type::table; };
    if (member.value.type != TomlNode::Type::array || !std::ranges::all_of(member.value.items, is_table))
        fail(source, member.where, "answers are tables, each written as [[experiment.answer]], with two brackets");
    spec.answers.clear();
    for (const TomlNode& item : member.value.items) {
        spec.answers.push_back(read_answer(source, item));
        const auto same = std::ranges::count(spec.answers, spec.answers.back().name, &Answer::name);
        if (same > 1)
            fail(source, item.where, "two answers are named \"{}\"", spec.answers.back().name);
    }
    if (spec.answers.size() < 2 || spec.answers.size() > kMostAnswers)
        fail(source, member.where, "there are 2 to {} answers, one for each key; got {}", kMostAnswers,
             spec.answers.size());
}

std::vector<Answer> paper_answers() {
    return {{"flat", "flat", 1, {}},
            {"two_poly", "two facets", 2, {}},
            {"three_poly", "three facets", 3, {}},
            {"cylinder", "round", 0, {}}};
}

ExperimentSpec read_spec(const Document& document) {
    ExperimentSpec spec;
    spec.answers = paper_answers();
    if (!document.experiment)
        return spec;
    if (document.experiment->type != TomlNode::Type::table)
        fail(document.source, document.experiment->where, "[experiment] is a table of keys");
    for (const TomlMember& member : document.experiment->members) {
        if (member.key == "answer") {
            read_answers(document.source, member, spec);
            continue;
        }
        const auto key = std::ranges::find(spec_keys(), member.key, &SpecKey::name);
        if (key != spec_keys().end()) {
            key->set(spec, {document.source, member});
            continue;
        }
        std::vector<std::string> names{"answer"};
        for (const SpecKey& one : spec_keys())
            names.emplace_back(one.name);
        const std::string near = did_you_mean(member.key, names);
        fail(document.source, member.where, "unknown key \"{}\" in [experiment]{}", member.key,
             near.empty() ? fmt::format("; it has {}", fmt::join(names, ", ")) : near);
    }
    return spec;
}

Experiment checked(Study study) {
    Experiment experiment{read_spec(*study.document), std::move(study)};
    const std::string& source = experiment.study.document->source;
    const ExperimentSpec& spec = experiment.spec;
    const std::size_t conditions = experiment.study.cases.size();
    if (conditions * spec.trials > kMostTrials * 10)
        fail(source, {}, "{} conditions of {} trials each are more than a session can have", conditions, spec.trials);
    if (spec.order == Order::balanced && spec.trials % spec.blocks != 0)
        fail(source, {},
             "{} trials of each condition do not share out to {} blocks; balanced blocks want a multiple, or order = "
             "\"random\"",
             spec.trials, spec.blocks);
    if (spec.blocks > experiment.size())
        fail(source, {}, "{} blocks are more than there are trials ({})", spec.blocks, experiment.size());
    for (const Answer& answer : spec.answers)
        if (!answer.correct_for.empty() && std::ranges::none_of(experiment.study.cases, [&](const Case& one) {
                return fnmatch(answer.correct_for.c_str(), one.name.c_str(), 0) == 0;
            }))
            fail(source, {}, "the answer \"{}\" is correct for \"{}\", which no case is named; the first is {}",
                 answer.name, answer.correct_for, experiment.study.cases.front().name);
    if (spec.feedback &&
        std::ranges::any_of(experiment.study.cases, [&](const Case& one) { return !experiment.correct_answer(one); }))
        fail(source, {}, "feedback needs a correct answer to every stimulus: give answers facets or correct_for");
    return experiment;
}

} // namespace

std::optional<std::size_t> Experiment::correct_answer(const Case& stimulus) const {
    const SurfaceSpec& surface = stimulus.scene.surface;
    std::optional<unsigned> facets;
    if (surface.kind == SurfaceKind::bump)
        facets = surface.facets;
    else if (surface.kind == SurfaceKind::cylinder_bump)
        facets = 0;
    for (std::size_t i = 0; i < spec.answers.size(); ++i) {
        const Answer& answer = spec.answers[i];
        if (answer.correct_for.empty() ? facets && answer.facets == facets
                                       : fnmatch(answer.correct_for.c_str(), stimulus.name.c_str(), 0) == 0)
            return i;
    }
    return std::nullopt;
}

namespace {

// Laws go in double precision, as the live loop's, unless somebody says otherwise.
Experiment in_double(std::span<const Override> overrides, const std::function<Study(std::span<const Override>)>& read) {
    const auto key = key_index("run.precision");
    Study study = read(overrides);
    if (study.document->base.find(key) || study.document->overrides.find(key))
        return checked(std::move(study));
    std::vector<Override> all(overrides.begin(), overrides.end());
    all.emplace_back("run.precision", "f64");
    return checked(read(all));
}

} // namespace

Experiment parse_experiment(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                            std::span<const Override> overrides) {
    return in_double(overrides,
                     [&](std::span<const Override> some) { return parse_study(text, source, folder, some); });
}

Experiment read_experiment(const std::filesystem::path& file, std::span<const Override> overrides) {
    if (file.empty())
        return parse_experiment(paper_experiment(), kSource, {}, overrides);
    return in_double(overrides, [&](std::span<const Override> some) { return read_study(file, some); });
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
    for (const SpecKey& key : spec_keys())
        text += fmt::format("{} = {}\n", key.name, key.literal(experiment.spec));
    for (const Answer& answer : experiment.spec.answers) {
        text += fmt::format("\n[[experiment.answer]]\nname = {}\nlabel = {}\n", toml_string(answer.name),
                            toml_string(answer.label));
        if (answer.facets)
            text += fmt::format("facets = {}\n", *answer.facets);
        if (!answer.correct_for.empty())
            text += fmt::format("correct_for = {}\n", toml_string(answer.correct_for));
    }
    return text + "\n" + forceshade::resolved_toml(experiment.study);
}

std::string experiment_schema() {
    std::string text = "# Of forceshade experiment. Stimuli are the cases of the other tables.\n[experiment]\n";
    for (const SpecKey& key : spec_keys())
        text += fmt::format("{} = {} # {}: {}\n", key.name, key.literal(ExperimentSpec{}), key.values, key.meaning);
    text +=
        "# answer: tables [[experiment.answer]], 2 to 9, in the order of their keys: name, label, facets of the shape "
        "that the picture shows (0: the smooth one; none: words alone), correct_for (a pattern of case names; "
        "without it bumps of these facets). Default: the paper's four pictures\n";
    return text;
}

} // namespace forceshade::experiment

#include "host/experiment/experiment.h"

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include "host/error.h"
#include "host/experiment/page_text.h"
#include "host/output/files.h"
#include "host/scene/document.h"
#include "host/scene/schema.h"
#include "host/scene/schema_json.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade::experiment {
namespace {

constexpr std::uint64_t kMostTrials = 10000, kMostBlocks = 1000;
constexpr std::size_t kMostAnswers = 9; // keys 1 to 9
constexpr std::uint64_t kMostAnswerFacets = 1000;
constexpr std::uint64_t kLargestPicture = 1u << 20;    // bytes
constexpr std::uint64_t kLargestText = 1u << 16;       // bytes
constexpr std::uint64_t kMostPicturePixels = 1u << 22; // of a PNG
constexpr const char* kSource = "the paper's experiment";

/// A key of [experiment] or of an answer, read as a scene's keys are, and the member of `Spec` that it sets.
template <typename Spec> struct Row : Key {
    std::function<void(Spec&, const Value&, const std::string& source)> store;
    std::function<std::string(const Key&, const Spec&)> literal; // as TOML; empty: not given
};
using SpecKey = Row<ExperimentSpec>;
using AnswerKey = Row<Answer>;

template <typename T>
constexpr ValueKind kKindOf = std::is_same_v<T, std::string>     ? ValueKind::text
                              : std::is_same_v<T, bool>          ? ValueKind::boolean
                              : std::is_enum_v<T>                ? ValueKind::choice
                              : std::is_floating_point_v<T>      ? ValueKind::quantity
                              : std::is_same_v<T, AnswerPicture> ? ValueKind::file
                              : std::is_same_v<T, GivenFile>     ? ValueKind::file
                                                                 : ValueKind::integer;

bool is_name(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

// Empty: it is one; else what is wrong with it.
std::string error_of_png(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    std::string error_text;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) != 0) {
        image.format = PNG_FORMAT_RGBA;
        if (std::uint64_t{image.width} * image.height > kMostPicturePixels) {
            error_text = fmt::format("it has {} x {} pixels, and {} are the most", image.width, image.height,
                                     kMostPicturePixels);
        } else {
            std::vector<std::byte> pixels(PNG_IMAGE_SIZE(image));
            png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr);
        }
    }
    if (error_text.empty() && PNG_IMAGE_FAILED(image))
        error_text = fmt::format("it is damaged ({})", image.message);
    png_image_free(&image);
    return error_text;
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

// Of at most `most` bytes; `what` it is, and where it belongs.
std::string read_given(const Value& given, const std::string& source, std::uint64_t most, const char* what) {
    std::error_code error;
    if (const auto size = std::filesystem::file_size(given.path, error); !error && size > most)
        fail(source, given.where, "the {} {} has {} bytes, and {} are the most", what, given.path, size, most);
    try {
        return read_file(given.path);
    } catch (const Error& failure) {
        fail(source, given.where, "{}; a {} file stands in the experiment's folder", failure.what(), what);
    }
}

AnswerPicture read_picture(const Value& given, const std::string& source) {
    const std::filesystem::path file = given.path;
    AnswerPicture picture;
    picture.bytes = read_given(given, source, kLargestPicture, "picture");
    constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
    if (picture.bytes.starts_with(kPng)) {
        picture.extension = ".png";
        if (const std::string error_text = error_of_png(picture.bytes); !error_text.empty())
            fail(source, given.where, "the picture {} cannot be shown: {}", file.string(), error_text);
    } else if (is_svg(picture.bytes)) {
        picture.extension = ".svg";
    } else {
        fail(source, given.where, "{} is no picture: neither a PNG nor an SVG file", file.string());
    }
    return picture;
}

void assign(std::string& to, const Value& value, const std::string&) {
    to = value.texts.front();
}
void assign(double& to, const Value& value, const std::string&) {
    to = value.numbers.front();
}
void assign(std::optional<unsigned>& to, const Value& value, const std::string&) {
    to = static_cast<unsigned>(value.integers.front());
}
void assign(AnswerPicture& to, const Value& value, const std::string& source) {
    to = read_picture(value, source);
}
void assign(GivenFile& to, const Value& value, const std::string& source) {
    to = {value.path, read_given(value, source, kLargestText, "text")};
    if (to.bytes.empty())
        fail(source, value.where, "the text {} is empty", value.path);
}
template <typename T> void assign(T& to, const Value& value, const std::string&) {
    to = static_cast<T>(value.integers.front());
}

std::string literal_of(const Key&, const std::string& value) {
    return value.empty() ? "" : toml_string(value);
}
std::string literal_of(const Key&, const std::optional<unsigned>& value) {
    return value ? fmt::format("{}", *value) : "";
}
std::string literal_of(const Key&, const AnswerPicture&) {
    return ""; // the answer's name has a part in it
}
std::string literal_of(const Key& key, const GivenFile& value) {
    return value.bytes.empty() ? "" : toml_string(text_file_name(key.name));
}
template <typename T> std::string literal_of(const Key& key, const T& value) {
    if constexpr (std::is_enum_v<T>)
        return toml_string(key.choices[static_cast<std::size_t>(value)]);
    else
        return key.kind == ValueKind::quantity ? fmt::format("\"{} s\"", value) : fmt::format("{}", value);
}

} // namespace

std::string text_file_name(std::string_view key) {
    return std::string(key) + (key == "conditions" ? ".csv" : ".md");
}

std::vector<std::pair<std::string, std::string>> given_files(const ExperimentSpec& spec) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const Answer& answer : spec.answers)
        if (!answer.picture.bytes.empty())
            files.emplace_back(answer.picture_file(), answer.picture.bytes);
    for (const auto& [key, file] :
         {std::pair("consent", &spec.consent), {"instructions", &spec.instructions}, {"conditions", &spec.conditions}})
        if (!file->bytes.empty())
            files.emplace_back(text_file_name(key), file->bytes);
    return files;
}

namespace {

template <typename Spec, typename T>
Row<Spec>& add(std::vector<Row<Spec>>& keys, T Spec::*member, std::string_view name, std::string_view doc,
               const KeyTraits& traits = {}) {
    Row<Spec>& key = keys.emplace_back(Row<Spec>{
        Key{traits,
            std::is_same_v<Spec, Answer> ? "experiment.answer" : "experiment",
            name,
            kKindOf<T>,
            {},
            doc,
            nullptr},
        [member](Spec& spec, const Value& value, const std::string& source) { assign(spec.*member, value, source); },
        [member](const Key& of, const Spec& spec) { return literal_of(of, spec.*member); }});
    key.dimension = Dimension::time;
    key.axis = false;
    return key;
}

std::vector<SpecKey> make_spec_keys() {
    using S = ExperimentSpec;
    static constexpr std::array<std::string_view, 2> kTasks{"name", "compare"};
    static constexpr std::array<std::string_view, 4> kOrders{"random", "balanced", "latin", "sequential"};
    std::vector<SpecKey> keys;
    add(keys, &S::task, "task", "name what one stimulus is, or compare two that are felt one after the other").choices =
        kTasks;
    add(keys, &S::title, "title", "of the data");
    add(keys, &S::question, "question", "what a participant is asked after each stimulus");
    add(keys, &S::trials, "trials", "of each condition; of each track the most").largest = kMostTrials;
    add(keys, &S::practice, "practice", "trials before, which do not count", {.smallest = 0}).largest = kMostTrials;
    add(keys, &S::blocks, "blocks", "with a break between").largest = kMostBlocks;
    add(keys, &S::order, "order",
        "of trials: random, over the session; balanced: each block has every condition equally often; latin: each "
        "repetition is a row of a balanced Latin square, whose rows go round the subjects by their numbers; "
        "sequential: as conditions are listed")
        .choices = kOrders;
    add(keys, &S::conditions, "conditions",
        "CSV of up to 64 KiB: a header of \"case\" or of keys in which the stimuli differ, as PsychoPy's, and a row a "
        "condition, which is asked about as often as it stands there; without it each stimulus is one",
        {.example = "\"conditions.csv\""});
    add(keys, &S::block_by, "block_by", "key of the study: a block for each of its values, in place of blocks",
        {.example = "\"force.shading\""});
    add(keys, &S::break_every, "break_every", "trials between breaks, besides those between blocks; 0: none",
        {.smallest = 0})
        .largest = kMostTrials;
    add(keys, &S::break_after, "break_after", "time since the last break; 0 s: none", {.sign = Sign::not_negative});
    add(keys, &S::break_least, "break_least", "the shortest break", {.sign = Sign::not_negative});
    add(keys, &S::consent, "consent",
        "Markdown of up to 64 KiB (headings, paragraphs, lists, *emphasis*, **strong**): what a participant agrees to "
        "before the first trial",
        {.example = "\"consent.md\""});
    add(keys, &S::instructions, "instructions", "the same, to read at each start", {.example = "\"instructions.md\""});
    add(keys, &S::familiarise, "familiarise",
        "whether each answer's stimulus is displayed before the first trial, with its name");
    add(keys, &S::catch_trials, "catch", "shell pattern of the cases whose answer is beyond doubt",
        {.example = "\"*facets-2*\""});
    add(keys, &S::catch_least, "catch_least",
        "share of these that a subject has to answer right; who has less is left out of the analysis",
        {.sign = Sign::not_negative})
        .kind = ValueKind::number;
    add(keys, &S::feedback, "feedback", "whether a participant is told if the answer was right");
    add(keys, &S::longest_trial, "longest_trial",
        "after which a trial ends without an answer and is repeated at the end", {.sign = Sign::positive});
    add(keys, &S::least_contact, "least_contact",
        "time in contact with each stimulus before an answer counts; after less the trial is repeated at the end",
        {.sign = Sign::not_negative});
    add(keys, &S::max_repeats, "max_repeats", "of a trial that does not count; then it is left out", {.smallest = 0})
        .largest = 1000;
    add(keys, &S::seed, "seed", "of the order; each subject and session has one of its own", {.smallest = 0}).largest =
        std::numeric_limits<std::int64_t>::max();
    const std::size_t of_both = keys.size();
    add(keys, &S::standard, "standard",
        "shell pattern of the cases that the others are compared with, each with the standard that has most of its "
        "settings",
        {.example = "\"cylinder_bump*\""});
    add(keys, &S::correct, "correct",
        "smoother: right is the stimulus of more facets, the smooth shape before all; or a shell pattern of the cases "
        "that are right");
    add(keys, &S::interval, "interval", "that each stimulus is felt; 0 s: until a key is pressed",
        {.sign = Sign::not_negative});
    add(keys, &S::track, "track",
        "axis of the study over which a threshold is looked for: the level of each trial is the one whose answer is "
        "expected to say most (QUEST+), a track for each combination of the other settings",
        {.example = "\"surface.facets\""});
    add(keys, &S::track_ratio, "track_ratio",
        "1 or more: a track ends before its trials do once the ends of the threshold's 95 % interval have a smaller "
        "ratio; 1: never",
        {.sign = Sign::positive})
        .kind = ValueKind::number;
    for (std::size_t i = of_both; i < keys.size(); ++i)
        keys[i].subject = Subject::task;
    static std::deque<std::string> defaults; // keys refer to them
    for (SpecKey& key : keys)
        key.default_text = defaults.emplace_back(key.literal(key, ExperimentSpec{}));
    return keys;
}

const std::vector<SpecKey>& spec_keys() {
    static const std::vector<SpecKey> keys = make_spec_keys();
    return keys;
}

std::vector<AnswerKey> make_answer_keys() {
    using A = Answer;
    std::vector<AnswerKey> keys;
    add(keys, &A::name, "name", "as data has it").store = [](A& answer, const Value& value, const std::string& source) {
        assign(answer.name, value, source);
        if (!is_name(answer.name))
            fail(source, value.where,
                 "an answer's name, which stands in the data, has a to z, 0 to 9 and _ only; got \"{}\"; its label may "
                 "be any text",
                 answer.name);
    };
    add(keys, &A::label, "label", "as a participant reads it");
    add(keys, &A::facets, "facets",
        "of the shape that it names and its picture shows; 0: the smooth one; none: words alone", {.smallest = 0})
        .largest = kMostAnswerFacets;
    add(keys, &A::correct_for, "correct_for", "a pattern of case names; without it bumps of these facets");
    add(keys, &A::picture, "picture",
        "PNG or SVG of up to 1 MiB, relative to the experiment file, in place of the drawn shape")
        .literal = [](const Key& key, const A& answer) { return literal_of(key, answer.picture_file()); };
    return keys;
}

const std::vector<AnswerKey>& answer_keys() {
    static const std::vector<AnswerKey> keys = make_answer_keys();
    return keys;
}

// A member of [experiment] or of an answer; `other` keys are read elsewhere.
template <typename Spec>
void read_key(const std::vector<Row<Spec>>& keys, const TomlNode& member, const std::string& source,
              const std::filesystem::path& folder, Spec& spec, std::vector<std::string> other = {}) {
    if (const auto key = std::ranges::find(keys, member.key, &Key::name); key != keys.end())
        return key->store(spec, read_values(*key, member, source, folder.string()).front(), source);
    std::vector<std::string> names = std::move(other);
    for (const Key& one : keys)
        names.emplace_back(one.name);
    const std::string near = did_you_mean(member.key, names);
    fail(source, member.key_where, "unknown key \"{}\" in [{}]{}", member.key, keys.front().table,
         near.empty() ? fmt::format("; it has {}", fmt::join(names, ", ")) : near);
}

Answer read_answer(const std::string& source, const std::filesystem::path& folder, const TomlNode& node) {
    Answer answer;
    Errors errors;
    for (const TomlNode& member : node.items)
        errors.attempt([&] { read_key(answer_keys(), member, source, folder, answer); });
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
            if (const TomlNode* member = key.subject == Subject::task ? given(key.name) : nullptr)
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
    if (spec.track_ratio < 1)
        fail(source, given("track_ratio")->where, "track_ratio must be 1 or more, got {}", spec.track_ratio);
    if (spec.track_ratio > 1 && spec.track.empty())
        fail(source, given("track_ratio")->key_where,
             "track_ratio ends a track, and there is no track: say which axis");
    if (spec.least_contact >= spec.longest_trial)
        fail(source, given("least_contact") ? given("least_contact")->key_where : given("longest_trial")->key_where,
             "least_contact, {} s, is not shorter than longest_trial, {} s", spec.least_contact, spec.longest_trial);
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

void read_texts(const std::string& source, const TomlNode& table, ExperimentSpec& spec) {
    if (table.type != TomlNode::Type::table)
        fail(source, table.key_where, "[experiment.text] is a table of sentences");
    Errors errors;
    for (const TomlNode& member : table.items)
        errors.attempt([&] {
            const PageText* const sentence = page_text(member.key);
            if (!sentence) {
                std::vector<std::string> names;
                for (const PageText& one : page_texts())
                    names.emplace_back(one.key);
                const std::string near = did_you_mean(member.key, names);
                fail(source, member.key_where, "unknown sentence \"{}\"{}", member.key,
                     near.empty() ? fmt::format("; there are {}", fmt::join(names, ", ")) : near);
            }
            const Key key{{}, "experiment.text", sentence->key, ValueKind::text, {}, sentence->place, nullptr};
            const std::string& text = spec.text[member.key] =
                read_values(key, member, source, "").front().texts.front();
            if (const std::string word = unknown_word(*sentence, text); !word.empty())
                fail(source, member.where, "nothing stands for {} here; the English is \"{}\"", word,
                     sentence->english);
        });
    errors.report();
}

ExperimentSpec read_spec(const Document& document, const std::filesystem::path& folder) {
    ExperimentSpec spec;
    spec.answers = paper_answers();
    if (!document.experiment)
        return spec;
    if (document.experiment->type != TomlNode::Type::table)
        fail(document.source, document.experiment->where, "[experiment] is a table of keys");
    Errors errors;
    for (const TomlNode& member : document.experiment->items)
        errors.attempt([&] {
            if (member.key == "answer")
                read_answers(document.source, folder, member, spec);
            else if (member.key == "text")
                read_texts(document.source, member, spec);
            else
                read_key(spec_keys(), member, document.source, folder, spec, {"answer", "text"});
        });
    errors.report();
    settle_task(document.source, *document.experiment, spec);
    return spec;
}

Experiment checked(ExperimentSpec given, Study study) {
    Experiment experiment{std::move(given), std::move(study), {}, {}, {}, {}, {}};
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
    list_conditions(experiment);
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
    const auto needs = [&](bool used, std::string_view key, bool met, std::string_view what_is_wrong) {
        const TomlNode* member =
            experiment.study.document->experiment ? experiment.study.document->experiment->find(key) : nullptr;
        if (used && !met)
            fail(source, member ? member->key_where : Location{}, "{}", what_is_wrong);
    };
    const bool tracked = !experiment.tracks.empty();
    needs(spec.order >= Order::latin, "order", !tracked, "a track chooses its levels itself: order = \"random\"");
    needs(!spec.conditions.bytes.empty(), "conditions", !tracked,
          "a track chooses its levels itself, without a list of conditions");
    needs(!spec.block_by.empty(), "block_by", !tracked && spec.blocks == 1 && spec.order != Order::balanced,
          "block_by makes the blocks: without a track, blocks and order = \"balanced\"");
    if (!spec.block_by.empty())
        at("block_by", [](Experiment& of) { trials_of(of, "1", 1); });
    needs(spec.break_least > 0, "break_least",
          spec.blocks > 1 || spec.break_every > 0 || spec.break_after > 0 || !spec.block_by.empty(),
          "there is no break: say break_every, break_after or blocks, too");
    needs(spec.familiarise, "familiarise",
          spec.task == Task::name &&
              std::ranges::any_of(experiment.study.cases,
                                  [&](const Case& one) { return experiment.correct_answer(one).has_value(); }),
          "no answer names a stimulus that could be made known: give answers facets or correct_for, with task = "
          "\"name\"");
    needs(true, "catch_least", spec.catch_least <= 1, "catch_least is a share, at most 1");
    bool any_catch = false;
    for (const std::size_t i : experiment.asked()) {
        const std::string& name = experiment.stimulus(experiment.conditions[i]).name;
        any_catch = any_catch || experiment.is_catch(name);
        needs(experiment.is_catch(name), "catch", experiment.correct_answer(Trial{1, 1, i, 0}).has_value(),
              fmt::format("{} has no right answer: give answers facets or correct_for", name));
    }
    needs(!spec.catch_trials.empty(), "catch", any_catch,
          fmt::format("\"{}\" names no stimulus that is asked about; one is {}", spec.catch_trials,
                      experiment.stimulus(experiment.conditions[experiment.listed.front()]).name));
    for (const Answer& answer : spec.answers)
        if (!answer.correct_for.empty() && std::ranges::none_of(experiment.study.cases, [&](const Case& one) {
                return fnmatch(answer.correct_for.c_str(), one.name.c_str(), 0) == 0;
            }))
            fail(source, {}, "the answer \"{}\" is correct for \"{}\", which no case is named; the first is {}",
                 answer.name, answer.correct_for, experiment.study.cases.front().name);
    const auto has_right_answer = [&](std::size_t condition) {
        return experiment.correct_answer(Trial{1, 1, condition, 0}).has_value();
    };
    for (const std::size_t i : experiment.asked())
        if ((spec.feedback || tracked) && !has_right_answer(i))
            fail(source, {}, "{} needs a correct answer to every stimulus, and {} has none: {}",
                 spec.feedback ? "feedback" : "a track", experiment.stimulus(experiment.conditions[i]).name,
                 spec.task == Task::name ? "give answers facets or correct_for"
                                         : "it is as smooth as its standard, or correct names both or neither");
    return experiment;
}

} // namespace

// Laws go in double precision, as the live loop's, unless the file says otherwise.
Experiment parse_experiment(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                            std::span<const Override> overrides) {
    const auto key = key_index("run.precision");
    ExperimentSpec spec;
    Study study = parse_study(text, source, folder, overrides,
                              [&](const Document& document) { spec = read_spec(document, folder); });
    if (!study.document->base.find(key) && !study.document->overrides.find(key)) {
        std::vector<Override> all(overrides.begin(), overrides.end());
        all.emplace_back("run.precision", "f64");
        study = parse_study(text, source, folder, all);
    }
    return checked(std::move(spec), std::move(study));
}

Experiment read_experiment(const std::filesystem::path& file, std::span<const Override> overrides) {
    if (file.empty())
        return parse_experiment(paper_experiment(), kSource, {}, overrides);
    const SceneText read = read_scene_text(file);
    return parse_experiment(read.text, read.source, read.folder, overrides);
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
        const bool kept = spec.task == Task::compare || (key.subject != Subject::task && key.name != "task");
        if (const std::string literal = kept ? key.literal(key, spec) : ""; !literal.empty())
            text += fmt::format("{} = {}\n", key.name, literal);
    }
    if (!spec.text.empty())
        text += "\n[experiment.text]\n";
    for (const auto& [key, sentence] : spec.text)
        text += fmt::format("{} = {}\n", key, toml_string(sentence));
    for (const Answer& answer : spec.answers) {
        text += "\n[[experiment.answer]]\n";
        for (const AnswerKey& key : answer_keys())
            if (const std::string literal = key.literal(key, answer); !literal.empty())
                text += fmt::format("{} = {}\n", key.name, literal);
    }
    return text + "\n" + forceshade::resolved_toml(experiment.study);
}

std::string experiment_schema() {
    std::string text = "# Of forceshade experiment. Stimuli are the cases of the other tables.\n[experiment]\n";
    for (const SpecKey& key : spec_keys())
        text += key_text(key, key.example.empty() ? key.default_text : key.example,
                         key.subject != Subject::task && !key.default_text.empty());
    text += comment_text(
        fmt::format("Tables [[experiment.answer]], 2 to {}, in the order of their keys. Default: the paper's four "
                    "pictures; of the task compare \"the first\" and \"the second\". Their keys:",
                    kMostAnswers));
    for (const AnswerKey& key : answer_keys())
        text += comment_text(fmt::format("{}: {}: {}", key.name, describe_values(key), key.doc));
    text += comment_text("Table [experiment.text]: the sentences of the participant's page, in any language. What it "
                         "does not have is English:");
    for (const PageText& one : page_texts())
        text += comment_text(fmt::format("{} = {}   {}", one.key, toml_string(std::string(one.english)), one.place));
    return text;
}

nlohmann::ordered_json experiment_schema_json() {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const SpecKey& key : spec_keys())
        rows.push_back(schema_row(key));
    for (const AnswerKey& key : answer_keys())
        rows.push_back(schema_row(key));
    return rows;
}

} // namespace forceshade::experiment

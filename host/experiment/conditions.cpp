#include "host/experiment/experiment.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fnmatch.h>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/paths/path_reader.h"
#include "host/random.h"
#include "host/scene/schema.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade::experiment {

namespace {

constexpr const char* kFacets = "surface.facets";

bool matches(const std::string& pattern, const Case& one) {
    return fnmatch(pattern.c_str(), one.name.c_str(), 0) == 0;
}

// Of a bump; 0: of the smooth shape; nothing: it is none.
std::optional<unsigned> facets_of(const Case& one) {
    const SurfaceSpec& surface = one.scene.surface;
    if (surface.kind == SurfaceKind::bump)
        return surface.facets;
    return surface.kind == SurfaceKind::cylinder_bump ? std::optional(0u) : std::nullopt;
}

std::string path_of(const Setting& setting) {
    return fmt::format("{}.{}", setting.table, setting.name);
}

// As in TOML; empty: the case has no such key.
std::string literal_of(const Case& one, const std::string& path) {
    const auto found = std::ranges::find(one.settings, path, path_of);
    return found == one.settings.end() ? "" : found->literal;
}

std::string unquoted(std::string text) {
    std::erase(text, '"');
    return text;
}

// In SI; infinite: the facets of the smooth shape; nothing: it has no such key.
std::optional<double> axis_level(const Case& one, const std::string& path) {
    if (path == kFacets && facets_of(one) == 0u)
        return std::numeric_limits<double>::infinity();
    const std::string text = unquoted(literal_of(one, path));
    if (text.empty())
        return std::nullopt;
    const Key& key = schema_keys()[key_index(path)];
    if (key.kind == ValueKind::quantity)
        return parse_quantity(text, key.dimension);
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

// The standard with most settings of the stimulus.
std::size_t standard_for(const Study& study, const std::vector<std::size_t>& standards, std::size_t stimulus) {
    const auto in_common = [&](std::size_t standard) {
        return std::ranges::count_if(study.cases[stimulus].settings, [&](const Setting& one) {
            return literal_of(study.cases[standard], path_of(one)) == one.literal;
        });
    };
    std::size_t best = standards.front();
    bool tie = false;
    for (std::size_t i = 1; i < standards.size(); ++i) {
        const auto difference = in_common(standards[i]) - in_common(best);
        tie = difference == 0 || (tie && difference < 0);
        best = difference > 0 ? standards[i] : best;
    }
    if (tie)
        throw UsageError("{} has as much in common with the standard {} as with another; name fewer standards",
                         study.cases[stimulus].name, study.cases[best].name);
    return best;
}

} // namespace

std::string value_text(const Case& one, const std::string& path) {
    return unquoted(literal_of(one, path));
}

std::vector<std::string> varying_keys_of(const Experiment& experiment) {
    std::map<std::string, std::set<std::string>> values;
    for (const Condition& condition : experiment.conditions)
        for (const Setting& setting : experiment.stimulus(condition).settings)
            values[path_of(setting)].insert(setting.literal);
    std::vector<std::string> varying;
    for (const auto& [path, literals] : values)
        if (literals.size() > 1)
            varying.push_back(path);
    return varying;
}

namespace {

// `key_name`: of the experiment's key that names it.
std::string axis_of(const std::string& word, const std::vector<std::string>& varying, const char* key_name,
                    bool numbers) {
    std::vector<std::string> found;
    for (const std::string& path : varying)
        if (path == word || path.substr(path.find('.') + 1) == word)
            found.push_back(path);
    if (found.size() > 1)
        throw UsageError("{} = \"{}\" may be {}; say which", key_name, word, fmt::join(found, " or "));
    if (found.empty()) {
        std::vector<std::string> names = varying;
        for (const std::string& path : varying)
            names.push_back(path.substr(path.find('.') + 1));
        const std::string near = did_you_mean(word, names);
        throw UsageError("{} = \"{}\": the stimuli do not differ in it{}", key_name, word,
                         !near.empty()     ? near
                         : varying.empty() ? std::string("; give a key of the study several values")
                                           : fmt::format("; they differ in {}", fmt::join(varying, ", ")));
    }
    if (!numbers)
        return found.front();
    const Key& key = schema_keys()[key_index(found.front())];
    const bool numeric =
        key.kind == ValueKind::quantity || key.kind == ValueKind::number || key.kind == ValueKind::integer;
    if (!numeric || key.count > 1)
        throw UsageError("track = \"{}\": its values are no single numbers, which levels are", word);
    return found.front();
}

std::vector<Track> tracks_of(const Experiment& experiment, const std::vector<std::string>& varying) {
    constexpr std::size_t kLeastLevels = 3;
    const std::string& axis = experiment.track_key;
    std::vector<Track> tracks;
    for (std::size_t i = 0; i < experiment.conditions.size(); ++i) {
        const Case& stimulus = experiment.stimulus(experiment.conditions[i]);
        const auto level = axis_level(stimulus, axis);
        if (!level || !(*level > 0) || std::isinf(*level))
            throw UsageError(
                "{} has no level of the track over {}, a positive number; leave it out or make it a standard",
                stimulus.name, axis);
        const Case& standard = experiment.study.cases[*experiment.conditions[i].standard];
        const auto reference = axis_level(standard, axis);
        if (!reference || *reference == *level)
            throw UsageError("the standard {} {} in {}, so that it is open which levels are easy", standard.name,
                             reference ? "equals " + stimulus.name : "has nothing", axis);
        std::string name;
        for (const std::string& path : varying)
            if (const std::string text = unquoted(literal_of(stimulus, path)); path != axis && !text.empty())
                name += fmt::format("{}{} {}", name.empty() ? "" : ", ", path.substr(path.find('.') + 1), text);
        if (name.empty())
            name = "all";
        auto track = std::ranges::find(tracks, name, &Track::name);
        if (track == tracks.end())
            track = tracks.insert(track, {name, {}, {}, *level > *reference});
        if (track->rises != (*level > *reference))
            throw UsageError("levels of {} lie on both sides of the standard's; a track wants them on one", axis);
        const auto place = std::ranges::lower_bound(track->levels, *level) - track->levels.begin();
        track->levels.insert(track->levels.begin() + place, *level);
        track->conditions.insert(track->conditions.begin() + place, i);
    }
    for (const Track& track : tracks) {
        if (const double ratio = track.levels.back() / track.levels.front(); experiment.spec.track_ratio >= ratio)
            throw UsageError("track_ratio = {} is no less than the ratio {:.3g} of the levels' ends, so that the track "
                             "\"{}\" would end at once",
                             experiment.spec.track_ratio, ratio, track.name);
        if (track.levels.size() < kLeastLevels)
            throw UsageError("the track \"{}\" over {} has {} levels, and {} are the fewest", track.name, axis,
                             track.levels.size(), kLeastLevels);
    }
    return tracks;
}

// Whether the stimulus is right, and not its standard; nothing: neither is.
std::optional<bool> is_right(const Experiment& experiment, const Condition& condition) {
    const Case &stimulus = experiment.stimulus(condition), &standard = experiment.study.cases[*condition.standard];
    if (experiment.spec.correct != kSmoother) {
        const bool one = matches(experiment.spec.correct, stimulus), other = matches(experiment.spec.correct, standard);
        return one == other ? std::nullopt : std::optional(one);
    }
    const auto one = axis_level(stimulus, kFacets), other = axis_level(standard, kFacets);
    return one && other && *one != *other ? std::optional(*one > *other) : std::nullopt;
}

template <typename T> void shuffle(std::vector<T>& all, Random& random) {
    for (std::size_t i = all.size(); i > 1; --i)
        std::swap(all[i - 1], all[random.below(i)]);
}

// Each of these `times`, shuffled.
std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t times, Random& random) {
    std::vector<std::size_t> order;
    for (std::uint64_t i = 0; i < times; ++i)
        for (std::size_t one = 0; one < count; ++one)
            order.push_back(one);
    shuffle(order, random);
    return order;
}

// The standard comes first in half of the trials of each condition or track, in an order by chance; of an odd number
// chance says which half is the larger.
void place_standards(const Experiment& experiment, std::vector<Trial>& trials, Random& random) {
    std::map<std::size_t, std::vector<Trial*>> units;
    for (Trial& trial : trials)
        units[trial.track.value_or(experiment.tracks.size() + trial.condition)].push_back(&trial);
    for (auto& [unit, of_unit] : units) {
        const std::uint64_t offset = random.below(2);
        shuffle(of_unit, random);
        for (std::size_t i = 0; i < of_unit.size(); ++i)
            of_unit[i]->standard_first = (i + offset) % 2 == 0;
    }
}

// Subjects are rows of a Latin square by their number; without one by chance.
std::uint64_t ordinal_of(const std::string& subject, std::uint64_t session) {
    std::uint64_t number = 0;
    const auto digits = subject.find_last_not_of("0123456789") + 1; // npos + 1: all are
    const char* const end = subject.data() + subject.size();
    const auto [last, error] = std::from_chars(subject.data() + digits, end, number);
    if (error != std::errc() || number == 0)
        number = Random(0, subject).word() >> 1;
    return number + session - 2;
}

// Indices below `count`, each `times`, in the order that is asked for; balanced is that of a block.
std::vector<std::size_t> arranged(Order order, std::size_t count, std::uint64_t times, std::uint64_t ordinal,
                                  Random& random) {
    if (order == Order::random || order == Order::balanced)
        return shuffled(count, times, random);
    std::vector<std::size_t> all;
    for (std::uint64_t i = 0; i < times; ++i)
        if (order == Order::latin)
            std::ranges::copy(latin_row(count, ordinal + i), std::back_inserter(all));
        else
            for (std::size_t place = 0; place < count; ++place)
                all.push_back(place);
    return all;
}

// Of listed conditions: those that share a value of block_by, in the order of the values' first condition.
std::vector<std::vector<std::size_t>> blocks_of(const Experiment& experiment) {
    std::vector<std::string> values;
    std::vector<std::vector<std::size_t>> blocks;
    const std::string axis = axis_of(experiment.spec.block_by, varying_keys_of(experiment), "block_by", false);
    for (std::size_t i = 0; i < experiment.listed.size(); ++i) {
        const Condition& condition = experiment.conditions[experiment.listed[i]];
        const std::string value = literal_of(experiment.stimulus(condition), axis);
        auto place = std::ranges::find(values, value);
        if (place == values.end()) {
            place = values.insert(place, value);
            blocks.emplace_back();
        }
        blocks[static_cast<std::size_t>(place - values.begin())].push_back(i);
    }
    return blocks;
}

// Of a conditions file: the key that a column names; empty: it is "case".
std::string key_of_column(const CsvReader& csv, std::size_t cell, const std::vector<std::string>& varying) {
    const std::string name(csv.text(cell));
    if (name == "case")
        return "";
    std::vector<std::string> found;
    for (const std::string& path : varying)
        if (path == name || path.substr(path.find('.') + 1) == name)
            found.push_back(path);
    if (found.size() == 1)
        return found.front();
    if (found.size() > 1)
        fail(csv.source(), csv.where(cell), "the column \"{}\" may be {}; say which", name, fmt::join(found, " or "));
    std::vector<std::string> names = varying;
    names.emplace_back("case");
    fail(csv.source(), csv.where(cell), "the column \"{}\" is nothing in which the stimuli differ; columns are {}",
         name, fmt::join(names, ", "));
}

bool is_value(const Case& one, const std::string& path, std::string_view cell) {
    return path.empty() ? one.name == cell : unquoted(literal_of(one, path)) == cell;
}

} // namespace

std::vector<std::size_t> latin_row(std::size_t n, std::uint64_t row) {
    // 0, 1, n - 1, 2, n - 2, ...: neighbours differ by another number each time. Of an odd n every second square is
    // read from its end.
    const std::size_t turn = static_cast<std::size_t>(row % n);
    std::vector<std::size_t> places(n);
    for (std::size_t i = 0; i < n; ++i)
        places[i] = ((i % 2 == 1 ? (i + 1) / 2 : n - i / 2) + turn) % n;
    if (n % 2 == 1 && row / n % 2 == 1)
        std::ranges::reverse(places);
    return places;
}

std::vector<std::size_t> Experiment::asked() const {
    std::vector<std::size_t> once = listed;
    std::ranges::sort(once);
    once.erase(std::unique(once.begin(), once.end()), once.end());
    return once;
}

bool Experiment::is_catch(const std::string& name) const {
    return !spec.catch_trials.empty() && fnmatch(spec.catch_trials.c_str(), name.c_str(), 0) == 0;
}

void list_conditions(Experiment& experiment) {
    for (std::size_t i = 0; i < experiment.conditions.size(); ++i)
        experiment.listed.push_back(i);
    if (experiment.spec.conditions.bytes.empty())
        return;
    experiment.listed.clear();
    CsvReader csv(experiment.spec.conditions.path, experiment.spec.conditions.bytes);
    const std::vector<std::string> varying = varying_keys_of(experiment);
    std::vector<std::string> columns;
    csv.next();
    for (std::size_t cell = 0; cell < csv.size(); ++cell)
        columns.push_back(key_of_column(csv, cell, varying));
    while (csv.next()) {
        if (csv.size() != columns.size())
            fail(csv.source(), csv.end(), "the row has {} cells, and the header names {} columns", csv.size(),
                 columns.size());
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < experiment.conditions.size(); ++i) {
            std::size_t cell = 0;
            while (cell < columns.size() &&
                   is_value(experiment.stimulus(experiment.conditions[i]), columns[cell], csv.text(cell)))
                ++cell;
            if (cell == columns.size())
                found.push_back(i);
        }
        if (found.size() != 1)
            fail(csv.source(), csv.where(0),
                 "the row is of {} of the {} stimuli; a row names one, as \"{}\" in a column \"case\"",
                 found.empty() ? "none" : std::to_string(found.size()), experiment.conditions.size(),
                 experiment.stimulus(experiment.conditions.front()).name);
        experiment.listed.push_back(found.front());
    }
    if (experiment.listed.empty())
        fail(csv.source(), csv.end(), "there is no row below the header");
}

std::optional<std::size_t> Experiment::correct_answer(const Case& stimulus) const {
    const std::optional<unsigned> facets = facets_of(stimulus);
    for (std::size_t i = 0; i < spec.answers.size(); ++i) {
        const Answer& answer = spec.answers[i];
        if (answer.correct_for.empty() ? facets && answer.facets == facets : matches(answer.correct_for, stimulus))
            return i;
    }
    return std::nullopt;
}

std::optional<std::size_t> Experiment::correct_answer(const Trial& trial) const {
    const Condition& condition = conditions[trial.condition];
    if (!condition.standard)
        return correct_answer(stimulus(condition));
    const std::optional<bool> right = is_right(*this, condition);
    return right ? std::optional<std::size_t>(*right == trial.standard_first ? 1 : 0) : std::nullopt;
}

void find_conditions(Experiment& experiment) {
    const Study& study = experiment.study;
    const bool compare = experiment.spec.task == Task::compare;
    std::vector<std::size_t> standards, stimuli;
    for (std::size_t i = 0; i < study.cases.size(); ++i)
        (compare && matches(experiment.spec.standard, study.cases[i]) ? standards : stimuli).push_back(i);
    if (compare && standards.empty())
        throw UsageError("standard = \"{}\" names no case; the first is {}", experiment.spec.standard,
                         study.cases.front().name);
    if (stimuli.empty())
        throw UsageError("standard = \"{}\" names every case, so that there is nothing to compare with it",
                         experiment.spec.standard);
    for (const std::size_t stimulus : stimuli)
        experiment.conditions.push_back(
            {stimulus, compare ? std::optional(standard_for(study, standards, stimulus)) : std::nullopt});
}

void find_tracks(Experiment& experiment) {
    if (experiment.spec.track.empty())
        return;
    const std::vector<std::string> varying = varying_keys_of(experiment);
    experiment.track_key = axis_of(experiment.spec.track, varying, "track", true);
    const Key& key = schema_keys()[key_index(experiment.track_key)];
    experiment.track_unit = key.kind == ValueKind::quantity ? dimension_info(key.dimension).unit : "1";
    experiment.tracks = tracks_of(experiment, varying);
}

std::vector<Trial> trials_of(const Experiment& experiment, const std::string& subject, std::uint64_t session) {
    const ExperimentSpec& spec = experiment.spec;
    const bool tracked = !experiment.tracks.empty();
    const std::vector<std::size_t> asked = experiment.asked();
    const std::size_t units = tracked ? experiment.tracks.size() : experiment.listed.size();
    const std::uint64_t ordinal = ordinal_of(subject, session);
    Random random(spec.seed, subject + "/" + std::to_string(session));
    std::vector<Trial> trials;
    const auto add = [&](std::uint64_t block, std::size_t condition) {
        trials.push_back({trials.size() + 1, block, condition, random.word()});
    };
    const auto add_unit = [&](std::uint64_t block, std::size_t unit) {
        add(block, tracked ? 0 : experiment.listed[unit]);
        if (tracked)
            trials.back().track = unit;
    };
    for (std::uint64_t done = 0; done < spec.practice;) // each condition before one comes again
        for (const std::size_t condition : shuffled(asked.size(), 1, random))
            if (done++ < spec.practice)
                add(0, asked[condition]);
    if (!spec.block_by.empty()) {
        const std::vector<std::vector<std::size_t>> blocks = blocks_of(experiment);
        // Each row of the blocks' square is joined with each of the conditions'.
        const std::uint64_t rows = blocks.size() % 2 == 0 ? blocks.size() : 2 * blocks.size();
        std::uint64_t number = 0;
        for (const std::size_t block : arranged(spec.order, blocks.size(), 1, ordinal, random)) {
            ++number;
            for (const std::size_t unit :
                 arranged(spec.order, blocks[block].size(), spec.trials, ordinal / rows, random))
                add_unit(number, blocks[block][unit]);
        }
    } else if (spec.order == Order::balanced) {
        for (std::uint64_t block = 1; block <= spec.blocks; ++block)
            for (const std::size_t unit : shuffled(units, spec.trials / spec.blocks, random))
                add_unit(block, unit);
    } else {
        const auto order = arranged(spec.order, units, spec.trials, ordinal, random);
        for (std::size_t i = 0; i < order.size(); ++i)
            add_unit(1 + i * spec.blocks / order.size(), order[i]);
    }
    if (spec.task == Task::compare)
        place_standards(experiment, trials, random);
    return trials;
}

} // namespace forceshade::experiment

#include "host/sweep/sweep.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/program.h"
#include "host/reference/chunks.h"
#include "host/scene/cases.h"
#include "host/text.h"

namespace forceshade {

namespace {

std::size_t slurm_number(const char* name) {
    const char* text = std::getenv(name);
    const std::optional<std::size_t> value = text ? number_in<std::size_t>(text) : std::nullopt;
    if (!value)
        throw UsageError("--shard slurm: {} is {}: say --shard I/N (1/1: everything)", name,
                         text ? fmt::format("\"{}\"", text) : "not set");
    return *value;
}

// The whole of a job that has no array.
Shard array_part() {
    if (!std::getenv("SLURM_ARRAY_TASK_ID"))
        return {};
    const std::size_t id = slurm_number("SLURM_ARRAY_TASK_ID"), count = slurm_number("SLURM_ARRAY_TASK_COUNT");
    const std::size_t first = slurm_number("SLURM_ARRAY_TASK_MIN"), last = slurm_number("SLURM_ARRAY_TASK_MAX");
    if (first > 1 || last != first + count - 1 || count < 2 || id < first || id > last)
        throw UsageError(
            "--shard slurm: this is task {} of a Slurm array of {} from {} to {}; only the arrays 1-N and 0-(N-1) "
            "define the part of the study: say --shard I/N, for example --shard $SLURM_ARRAY_TASK_ID/8",
            id, count, first, last);
    return {id - first + 1, count};
}

// Of the tasks that one srun started.
Shard step_part() {
    if (!std::getenv("SLURM_STEP_NUM_TASKS"))
        return {};
    const std::size_t count = slurm_number("SLURM_STEP_NUM_TASKS"), rank = slurm_number("SLURM_PROCID");
    if (rank >= count)
        throw UsageError(
            "--shard slurm: this is task {} of {} of a step, which cannot be: say --shard I/N (1/1: everything)", rank,
            count);
    return {rank + 1, count};
}

Shard slurm_part() {
    if (!std::getenv("SLURM_ARRAY_TASK_ID") && !std::getenv("SLURM_STEP_NUM_TASKS"))
        throw UsageError("--shard slurm: this is not a task of a Slurm array or an srun");
    const Shard array = array_part(), step = step_part();
    return {(array.index - 1) * step.count + step.index, array.count * step.count};
}

constexpr std::size_t kMostShards = 1'000'000'000;

bool is_shard(const Shard& shard) {
    return shard.index >= 1 && shard.index <= shard.count && shard.count <= kMostShards;
}

std::string note_name(const Shard& shard) {
    return fmt::format("{}-of-{}.json", shard.index, shard.count);
}

std::filesystem::path notes_folder(const std::filesystem::path& folder) {
    return folder / "manifest.d" / "shards";
}

Json as_json(const ShardNote& note) {
    Json failures = Json::array();
    for (const ShardNote::Failure& failure : note.failures)
        failures.push_back({{"case", failure.name}, {"message", failure.message}});
    return {{"shard", note.shard.index}, {"of", note.shard.count},    {"only", note.only},    {"cases", note.cases},
            {"kept", note.kept},         {"computed", note.computed}, {"failures", failures}, {"host", note.host},
            {"process", note.process},   {"started", note.started},   {"told", note.updated}, {"ended", note.ended}};
}

// Folders and machines may have names that are not UTF-8.
std::string text_of(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

ShardNote note_of(const Json& json) {
    ShardNote note;
    const auto whole = [&json](const char* name) {
        std::uint64_t value = 0;
        read_whole(json.at(name), value);
        return value;
    };
    note.shard = {whole("shard"), whole("of")};
    note.only = json.at("only").get<std::string>();
    note.cases = whole("cases");
    note.kept = whole("kept");
    note.computed = whole("computed");
    for (const Json& failure : json.at("failures"))
        note.failures.push_back({failure.at("case").get<std::string>(), failure.at("message").get<std::string>()});
    note.host = json.at("host").get<std::string>();
    note.process = static_cast<std::int64_t>(whole("process"));
    note.started = json.at("started").get<double>();
    note.updated = json.at("told").get<double>();
    note.ended = json.at("ended").get<bool>();
    return note;
}

} // namespace

Shard parse_shard(const std::string& text) {
    if (text == "slurm")
        return slurm_part();
    const std::size_t slash = text.find('/');
    if (slash != std::string::npos) {
        const auto index = number_in<std::size_t>(std::string_view(text).substr(0, slash));
        const auto total = number_in<std::size_t>(std::string_view(text).substr(slash + 1));
        if (index && total && is_shard({*index, *total}))
            return {*index, *total};
    }
    throw UsageError("--shard {}: it is I/N with 1 <= I <= N, for example 3/8, or slurm", text);
}

void require_whole() {
    const char* const tasks = std::getenv("SLURM_STEP_NUM_TASKS");
    const bool step = tasks && std::string_view(tasks) != "1";
    if (step || std::getenv("SLURM_ARRAY_TASK_ID"))
        throw UsageError(
            "Slurm's variables say that this is one of several tasks (of {}), or was begun by one: say --shard slurm "
            "to do the part of the study that they name, --shard I/N to do another, --shard 1/1 to do all of it",
            step ? "an srun" : "an array");
}

std::string ShardNote::name() const {
    return fmt::format("{}/{}", shard.index, shard.count);
}

void write_note(const std::filesystem::path& folder, const ShardNote& note) {
    write_file_atomically(notes_folder(folder) / note_name(note.shard), text_of(as_json(note)));
}

std::vector<ShardNote> read_notes(const std::filesystem::path& folder) {
    std::vector<ShardNote> notes;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(notes_folder(folder), error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (!is_plain_name(name))
            continue;
        try {
            if (ShardNote note = note_of(read_json(entry->path()));
                is_shard(note.shard) && note_name(note.shard) == name)
                notes.push_back(std::move(note));
        } catch (const Error&) {
            continue; // being replaced, or damaged
        } catch (const Json::exception&) {
            continue;
        }
    }
    std::ranges::sort(notes, {}, [](const ShardNote& one) { return std::pair(one.shard.count, one.shard.index); });
    return notes;
}

namespace {

// The shards of one sweep.
struct Standing {
    std::size_t shards = 0, done = 0, at_work = 0, failed = 0;
    std::size_t cases = 0, cases_done = 0; // of the shards that began
    double left = 0;                       // s: of the slowest at work; infinite where none has done a case
};

constexpr double kSilent = 600; // s without a word

bool is_silent(const ShardNote& note, double now) {
    return !note.ended && now - note.updated > kSilent;
}

double seconds_left(const ShardNote& note) {
    const double rate = static_cast<double>(note.computed) / std::max(1e-3, note.updated - note.started);
    return static_cast<double>(note.cases - std::min(note.cases, note.done() + note.failures.size())) / rate;
}

std::map<std::size_t, Standing> standings(const std::vector<ShardNote>& notes, double now) {
    std::map<std::size_t, Standing> result; // by the number of shards
    for (const ShardNote& note : notes) {
        Standing& standing = result[note.shard.count];
        ++standing.shards;
        standing.done += note.ended && note.failures.empty();
        standing.failed += note.ended && !note.failures.empty();
        standing.cases += note.cases;
        standing.cases_done += note.done();
        if (!note.ended && !is_silent(note, now)) {
            ++standing.at_work;
            standing.left = std::max(standing.left, seconds_left(note));
        }
    }
    return result;
}

std::string state_of(const ShardNote& note, double now) {
    if (note.ended)
        return note.failures.empty() ? "done" : "failed";
    return is_silent(note, now) ? "silent" : "at work";
}

} // namespace

std::string status_text(const std::vector<ShardNote>& notes, double now) {
    std::string text;
    for (const auto& [count, standing] : standings(notes, now)) {
        text += fmt::format(
            "{} shards: {} done, {} at work, {} failed, {} silent, {} not begun; {} of {} cases of those that began\n",
            count, standing.done, standing.at_work, standing.failed,
            standing.shards - standing.done - standing.at_work - standing.failed, count - standing.shards,
            standing.cases_done, standing.cases);
        if (standing.at_work > 0)
            text += standing.left < 1e9 ? fmt::format("those at work need about {} more\n", clock_text(standing.left))
                                        : "those at work have not computed a case yet\n";
        for (const ShardNote& note : notes) {
            if (note.shard.count != count || (note.ended && note.failures.empty()))
                continue;
            text += fmt::format("  {:>9}  {:<7}  {:>6} of {:<6}  {} (process {}), {} ago\n", note.name(),
                                state_of(note, now), note.done(), note.cases, note.host, note.process,
                                clock_text(std::max(0.0, now - note.updated)));
            for (const ShardNote::Failure& failure : note.failures)
                text += fmt::format("             {}{}\n", failure.name.empty() ? "" : failure.name + ": ",
                                    failure.message);
        }
    }
    return text;
}

std::string status_json(const std::vector<ShardNote>& notes, double now) {
    Json shards = Json::array();
    for (const ShardNote& note : notes) {
        Json one = as_json(note);
        one["state"] = state_of(note, now);
        if (!note.ended && note.computed > 0)
            one["seconds_left"] = seconds_left(note);
        shards.push_back(std::move(one));
    }
    return text_of({{"shards", shards}});
}

namespace {

bool is_there(const std::filesystem::path& folder, const FileRecord& file, bool verify) {
    if (verify)
        return file_is_intact(folder / file.name, file.sha256);
    std::error_code error;
    return std::filesystem::file_size(folder / file.name, error) == file.bytes && !error;
}

void drop_without_files(const MergeOptions& options, std::vector<std::optional<CaseRecord>>& records) {
    const Stage stage(options.verify ? "verifying files" : "looking at files");
    reference::share_out(most_threads(), records.size(), [&](std::size_t, std::size_t i) {
        if (records[i] && !is_interrupted() && !std::ranges::all_of(records[i]->files, [&](const FileRecord& file) {
                return is_there(options.folder, file, options.verify);
            }))
            records[i].reset();
    });
    check_interrupt();
}

// Which shard each case belongs to, as the study was shared out last; empty without notes.
std::map<std::string, Shard> owners(const Study& study, const std::vector<ShardNote>& notes) {
    std::map<std::string, Shard> result;
    if (notes.empty())
        return result;
    const ShardNote& last = *std::ranges::max_element(notes, {}, &ShardNote::started);
    std::size_t place = 0;
    for (const Case* one : cases_named(study, last.only))
        result[one->name] = {place++ % last.shard.count + 1, last.shard.count};
    return result;
}

void require_readable(const std::filesystem::path& folder) {
    std::error_code error;
    const std::filesystem::directory_iterator entries(folder, error);
    if (error)
        throw file_error("read", folder, error.value());
}

} // namespace

MergeResult merge_sweep(Study study, const MergeOptions& options) {
    if (!std::filesystem::is_directory(options.folder))
        throw IoError("{}: there is no such folder to merge", options.folder.string());
    if (!options.replace)
        require_same_study(options.folder, study);
    make_subfolder(options.folder, "manifest.d");
    require_readable(options.folder / "manifest.d");
    const std::array folders{options.folder, options.folder / "manifest.d", notes_folder(options.folder)};
    for (const std::filesystem::path& one : folders)
        clear_stale_temporaries(one);
    const Fingerprints fingerprints = identify(study);
    std::vector<std::optional<CaseRecord>> records = records_of(options.folder, study, fingerprints);
    drop_without_files(options, records);
    MergeResult result;
    result.cases = study.cases.size();
    for (const std::filesystem::path& one : folders)
        result.temporaries += temporaries_of_others(one).size();
    const std::vector<ShardNote> notes = read_notes(options.folder);
    std::map<std::string, std::string> messages; // by case
    for (const ShardNote& note : notes)
        for (const ShardNote::Failure& failure : note.failures)
            messages[failure.name] = failure.message;
    const std::map<std::string, Shard> owner = owners(study, notes);
    std::set<Shard> shards;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (records[i]) {
            ++result.recorded;
            if (std::string wrong = error_text(*records[i]); !wrong.empty())
                result.wrong.push_back(std::move(wrong));
            continue;
        }
        const std::string& name = study.cases[i].name;
        result.missing.push_back(name);
        if (const auto found = owner.find(name); found != owner.end())
            shards.insert(found->second);
        if (const auto found = messages.find(name); found != messages.end())
            result.failures.push_back(fmt::format("{}: {}", name, found->second));
        else if (!fingerprints.contains(name))
            result.failures.push_back(
                fmt::format("{}: a file that it names cannot be read, or is not the one that the study means", name));
        else if (const auto record = read_record(options.folder, name))
            result.others += !fingerprints.at(name).contains(record->fingerprint);
    }
    for (const Shard& shard : shards)
        result.shards.push_back(fmt::format("{}/{}", shard.index, shard.count));
    for (const ShardNote& note : notes)
        for (const ShardNote::Failure& failure : note.failures)
            if (failure.name.empty() && shards.contains(note.shard)) // it stopped all that were left
                result.failures.push_back(fmt::format("shard {}: {}", note.name(), failure.message));
    if (result.recorded == 0 && result.failures.empty())
        throw UsageError("{}: no case there is of this study and program {}; name the file that the shards were given, "
                         "and run the same program with the same flags",
                         options.folder.string(), version());
    if (result.recorded > 0) {
        write_file_atomically(options.folder / "study.toml", resolved_toml(study));
        write_manifest(options.folder, study, records, nullptr);
    }
    return result;
}

} // namespace forceshade

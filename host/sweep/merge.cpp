#include "host/sweep/merge.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/reference/chunks.h"
#include "host/scene/cases.h"
#include "host/sweep/manifest.h"

namespace forceshade {

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
        throw IoError(fmt::format("{}: there is no such folder to merge", options.folder.string()));
    if (!options.replace)
        require_same_study(options.folder, study);
    make_subfolder(options.folder, "manifest.d");
    require_readable(options.folder / "manifest.d");
    for (const std::filesystem::path& one :
         {options.folder, options.folder / "manifest.d", options.folder / "manifest.d" / "shards"})
        clear_stale_temporaries(one);
    const Fingerprints fingerprints = identify(study);
    std::vector<std::optional<CaseRecord>> records = records_of(options.folder, study, fingerprints);
    drop_without_files(options, records);
    MergeResult result;
    result.cases = study.cases.size();
    for (const std::filesystem::path& one :
         {options.folder, options.folder / "manifest.d", options.folder / "manifest.d" / "shards"})
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
        throw UsageError(fmt::format(
            "{}: no case there is of this study and program {}; name the file that the shards were given, and run the "
            "same program with the same flags",
            options.folder.string(), version()));
    if (result.recorded > 0) {
        write_file_atomically(options.folder / "study.toml", resolved_toml(study));
        write_manifest(options.folder, study, records, nullptr);
    }
    return result;
}

} // namespace forceshade

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

// Which shard each case belongs to, if all notes speak of one way to share the study out; else nothing.
std::map<std::string, Shard> owners(const Study& study, const std::vector<ShardNote>& notes) {
    std::map<std::string, Shard> result;
    const auto differs = [&](const ShardNote& note) {
        return note.shard.count != notes.front().shard.count || note.only != notes.front().only;
    };
    if (notes.empty() || std::ranges::any_of(notes, differs))
        return result;
    std::size_t place = 0;
    const std::size_t count = notes.front().shard.count;
    for (const Case* one : cases_named(study, notes.front().only))
        result[one->name] = {place++ % count + 1, count};
    return result;
}

} // namespace

MergeResult merge_sweep(Study study, const MergeOptions& options) {
    if (!std::filesystem::is_directory(options.folder))
        throw IoError(fmt::format("{}: there is no such folder to merge", options.folder.string()));
    if (!options.replace)
        require_same_study(options.folder, study);
    make_subfolder(options.folder, "manifest.d");
    for (const std::filesystem::path& one :
         {options.folder, options.folder / "manifest.d", options.folder / "manifest.d" / "shards"})
        clear_stale_temporaries(one);
    const Fingerprints fingerprints = identify(study);
    std::vector<std::optional<CaseRecord>> records = records_of(options.folder, study, fingerprints);
    if (std::ranges::none_of(records, [](const auto& record) { return record.has_value(); }))
        throw UsageError(fmt::format(
            "{}: no case there is of this study and program {}; name the file that the shards were given, and run the "
            "same program",
            options.folder.string(), version()));
    drop_without_files(options, records);
    write_file_atomically(options.folder / "study.toml", resolved_toml(study));
    write_manifest(options.folder, study, records, nullptr);

    MergeResult result;
    result.cases = study.cases.size();
    for (const std::filesystem::path& one : {options.folder, options.folder / "manifest.d"})
        result.temporaries += temporaries_of_others(one).size();
    const std::vector<ShardNote> notes = read_notes(options.folder);
    const std::map<std::string, Shard> owner = owners(study, notes);
    std::set<std::size_t> shards;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (records[i]) {
            ++result.recorded;
            if (std::string complaint_text = complaint(*records[i]); !complaint_text.empty())
                result.wrong.push_back(std::move(complaint_text));
            continue;
        }
        result.missing.push_back(study.cases[i].name);
        if (const auto found = owner.find(study.cases[i].name); found != owner.end())
            shards.insert(found->second.index);
    }
    for (const std::size_t index : shards)
        result.shards.push_back(fmt::format("{}/{}", index, notes.front().shard.count));
    const std::set<std::string> missing(result.missing.begin(), result.missing.end());
    for (const ShardNote& note : notes)
        for (const ShardNote::Failure& failure : note.failures)
            if (missing.contains(failure.name))
                result.failures.push_back(fmt::format("{}: {}", failure.name, failure.message));
            else if (failure.name.empty() && std::ranges::find(result.shards, note.name()) != result.shards.end())
                result.failures.push_back(fmt::format("shard {}: {}", note.name(), failure.message));
    return result;
}

} // namespace forceshade

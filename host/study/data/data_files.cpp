#include "host/study/data/data_files.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/output/reading.h"

namespace forceshade::study {
namespace {

const char* const kAccount = "study.json";

// What the account of the run before names; nothing if there is none that could be read.
std::vector<FileRecord> files_of_former(const std::filesystem::path& folder, const std::string& study) {
    try {
        return files_named_by(read_json(folder / kAccount), study);
    } catch (const Error&) {
        return {};
    }
}

FileRecord written(const std::filesystem::path& folder, const TextFile& file) {
    write_file_atomically(folder / file.name, file.text);
    return {file.name, sha256_of(file.text), file.text.size()};
}

// Those of `former` that `data` does not name, if they are there.
std::vector<FileRecord> left_over(const std::filesystem::path& folder, const std::vector<FileRecord>& former,
                                  const StudyData& data) {
    std::set<std::string> named{kAccount};
    for (const auto* files : {&data.files, &data.volumes})
        for (const FileRecord& file : *files)
            named.insert(file.name);
    std::vector<FileRecord> left;
    std::error_code ignored;
    for (const FileRecord& file : former)
        if (is_plain_name(file.name) && !named.contains(file.name) &&
            std::filesystem::symlink_status(folder / file.name, ignored).type() == std::filesystem::file_type::regular)
            left.push_back(file);
    return left;
}

// Returns the names of those that are no longer what was written, which stay.
std::vector<std::string> remove_intact(const std::filesystem::path& folder, const std::vector<FileRecord>& files) {
    std::vector<std::string> changed;
    for (const FileRecord& file : files) {
        if (!file_is_intact(folder / file.name, file.sha256)) {
            changed.push_back(file.name);
            continue;
        }
        std::error_code error;
        std::filesystem::remove(folder / file.name, error);
        if (error)
            throw IoError(fmt::format("cannot remove {}, which an earlier run left: {}", (folder / file.name).string(),
                                      error.message()));
    }
    return changed;
}

} // namespace

std::string table_csv(const Table& table) {
    CsvText csv;
    for (const Column& column : table.columns)
        csv.add(column.name);
    csv.end();
    for (const std::vector<Cell>& row : table.rows) {
        for (const Cell& one : row)
            csv.add(one.text());
        csv.end();
    }
    return csv.text();
}

std::vector<std::string> write_data(const std::filesystem::path& folder, StudyData& data,
                                    const std::vector<TextFile>& pictures) {
    data.files.clear();
    for (const Table& table : data.tables)
        data.files.push_back(written(folder, {table.name + ".csv", table_csv(table)}));
    for (const TextFile& picture : pictures)
        data.files.push_back(written(folder, picture));
    // As long as the former account stands, an interrupted run can be told what it left.
    TemporaryFile account(folder / kAccount);
    account.write(data_json(data));
    account.flush_to_disk();
    const std::vector<FileRecord> former = files_of_former(folder, data.study);
    std::vector<std::string> changed = remove_intact(folder, left_over(folder, former, data));
    account.publish();
    return changed;
}

bool files_are_intact(const std::filesystem::path& folder, const StudyData& data) {
    const auto intact = [&](const FileRecord& file) {
        return is_plain_name(file.name) && file_is_intact(folder / file.name, file.sha256);
    };
    return std::ranges::all_of(data.files, intact) && std::ranges::all_of(data.volumes, intact);
}

StudyData read_data(const std::filesystem::path& folder) {
    return parse_data(read_json(folder / kAccount));
}

} // namespace forceshade::study

// A study's data as files: study.json holds everything, TABLE.csv each table, FIGURE.svg each figure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Of the layout of study.json; another is refused on reading.
inline constexpr int kDataFormat = 4;

std::string data_json(const StudyData& data);

/// \throws DataError if data are missing, damaged or of another format.
StudyData parse_data(const nlohmann::ordered_json& json);

/// A header of column names, then a line a row; numbers read back exactly, empty cells stay empty.
std::string table_csv(const Table& table);

/// A file next to study.json.
struct TextFile {
    std::string name, text;
};

/// FIGURE.svg of each figure. \throws DataError for a figure whose table or column is missing.
std::vector<TextFile> figure_files(const StudyData& data);

/// Writes TABLE.csv of each table and the pictures, names them in data.files, then writes study.json, which ends the
/// run: files that the study.json before it names and the new one does not are removed, if unchanged. Returns the
/// names of the changed ones, which stay. \throws IoError.
std::vector<std::string> write_data(const std::filesystem::path& folder, StudyData& data,
                                    const std::vector<TextFile>& pictures);

/// Whether all files that the data name exist unchanged.
bool files_are_intact(const std::filesystem::path& folder, const StudyData& data);

/// \throws IoError if FOLDER/study.json cannot be read, DataError as parse_data.
StudyData read_data(const std::filesystem::path& folder);

} // namespace forceshade::study

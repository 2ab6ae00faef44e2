// A study's data as files: study.json holds everything, TABLE.csv each table.
#pragma once

#include <filesystem>
#include <string>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Of the layout of study.json; another is refused on reading.
inline constexpr int kDataFormat = 1;

std::string data_json(const StudyData& data);

/// \throws DataError that says what is missing, damaged or of another format.
StudyData parse_data(const std::string& json);

/// A header of column names, then a line a row; numbers read back exactly, nothing is empty.
std::string table_csv(const Table& table);

/// As in CSV: the word, the number, or nothing.
std::string cell_text(const Cell& cell);

/// study.json and TABLE.csv of each table. \throws IoError.
void write_data(const std::filesystem::path& folder, const StudyData& data);

/// \throws IoError if FOLDER/study.json cannot be read, DataError as parse_data.
StudyData read_data(const std::filesystem::path& folder);

} // namespace forceshade::study

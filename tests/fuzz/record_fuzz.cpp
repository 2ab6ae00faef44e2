// JSON of a case and of a study: what is understood is written and read as the same, its tables as CSV too.
#include <nlohmann/json.hpp>

#include "host/output/json.h"
#include "host/output/record.h"
#include "host/paths/path_reader.h"
#include "host/study/study_data.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::require;

/// Whether what is written stands in what was read: numbers as they were unless a type rounds them.
bool stems_from(const Json& written, const Json& read) {
    if (written.is_object() && read.is_object()) {
        for (const auto& [key, value] : written.items())
            if (read.contains(key) && key != "relative_error" && key != "evaluations_saved" &&
                !stems_from(value, read[key]))
                return false;
        return true;
    }
    if (written.is_array() && read.is_array() && written.size() == read.size()) {
        for (std::size_t i = 0; i < written.size(); ++i)
            if (!stems_from(written[i], read[i]))
                return false;
        return true;
    }
    if (written.is_number_unsigned() && read.is_number_integer()) // what is written is never negative
        return written.dump() == read.dump();
    if (written.is_number_float() && read.is_number())
        return written.get<double>() == read.get<double>();
    return !written.is_string() || written == read;
}

void check_case(const Json& json) {
    const std::optional<CaseRecord> record = record_of(json);
    if (!record)
        return;
    require(!record->files.empty(), "a record without files");
    const bool rests = !record->paths || (record->paths->error.beyond == 0 && record->paths->error.metrics == 0 &&
                                          record->paths->unfinished == 0);
    require(error_text(*record).empty() == (record->error.beyond == 0 && rests), "\"{}\" is complained of",
            error_text(*record));
    const std::string text = record_json(*record);
    const std::optional<CaseRecord> again = record_of(Json::parse(text));
    require(again.has_value(), "a record cannot be read again");
    require(record_json(*again) == text, "a record becomes another");
    const Json written = Json::parse(text);
    require(stems_from(written, json) && written.contains("compare") == json.contains("compare") &&
                written.contains("paths") == json.contains("paths") &&
                (!json.contains("paths") || written["paths"].contains("compare") == json["paths"].contains("compare")),
            "a record is not what was read: {}", text);
}

void check_csv(const study::Table& table) {
    static fuzz::MemoryFile file;
    file.write(study::table_csv(table));
    CsvReader reader(file.path());
    // A line of one empty cell is an empty one, which readers skip; a mark at the beginning of the file is none of its
    // text.
    const bool marked = !table.columns.empty() && table.columns[0].name.starts_with("\xEF\xBB\xBF");
    if (table.columns.size() < 2 || marked)
        return;
    require(reader.next() && reader.size() == table.columns.size(), "the header has {} cells", reader.size());
    for (std::size_t i = 0; i < reader.size(); ++i)
        require(reader.text(i) == table.columns[i].name, "the column \"{}\" is called \"{}\"", table.columns[i].name,
                reader.text(i));
    for (const std::vector<study::Cell>& row : table.rows) {
        require(reader.next() && reader.size() == row.size(), "a row has {} cells", reader.size());
        for (std::size_t i = 0; i < row.size(); ++i)
            if (const double* number = std::get_if<double>(&row[i]))
                require(std::strtod(std::string(reader.text(i)).c_str(), nullptr) == *number, "{} is read as {}",
                        *number, reader.text(i));
            else
                require(reader.text(i) == row[i].text(), "\"{}\" is read as \"{}\"", row[i].text(), reader.text(i));
    }
    require(!reader.next(), "there is more than the table");
}

/// A study with the cells of its tables written out.
Json unpacked(Json json) {
    if (!json.is_object() || !json.contains("tables") || !json["tables"].is_array())
        return json;
    for (Json& table : json["tables"])
        for (Json& column : table.is_object() && table.contains("cells") ? table["cells"] : table) {
            if (!column.is_object() || !column.contains("of") || !column.contains("at") || !column["of"].is_array() ||
                !column["at"].is_array())
                continue;
            Json cells = Json::array();
            for (const Json& place : column["at"])
                if (place.is_number_unsigned() && place.get<std::uint64_t>() < column["of"].size())
                    cells.push_back(column["of"][place.get<std::size_t>()]);
            if (cells.size() == column["at"].size())
                column = cells;
        }
    return json;
}

std::optional<study::StudyData> understood(const Json& json) {
    try {
        return study::parse_data(json);
    } catch (const study::DataError&) {
        return {};
    }
}

void check_study(const Json& json) {
    const std::optional<study::StudyData> packed = understood(json), plain = understood(unpacked(json));
    require(packed.has_value() == plain.has_value(),
            "a study is understood, but not with its cells written out, or so alone");
    if (!packed)
        return;
    const study::StudyData& data = *packed;
    const std::string text = study::data_json(data);
    const study::StudyData again = study::parse_data(Json::parse(text));
    require(study::data_json(again) == text, "a study becomes another");
    Json written = Json::parse(text);
    written.erase("tables");
    require(stems_from(written, json), "a study is not what was read: {}", text);
    for (const study::StudyData& other : {again, *plain})
        require(std::ranges::equal(data.tables, other.tables, {}, &study::Table::rows, &study::Table::rows),
                "a table holds other cells");
    for (const study::Table& table : data.tables)
        check_csv(table);
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto json = forceshade::Json::parse(data, data + size, nullptr, false);
    forceshade::check_case(json);
    forceshade::check_study(json);
    return 0;
}

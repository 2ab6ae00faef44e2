// study.json, both ways.
#include "host/study/data/data_files.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/reading.h"

/// A struct as an object of its members, in this order; read by NLOHMANN_JSON_FROM, or ..._WITH_DEFAULT where files of
/// the same format may lack some.
#define FORCESHADE_FIELDS_READ_BY(READ, Struct, ...)                                                                   \
    void to_json(Json& nlohmann_json_j, const Struct& nlohmann_json_t) {                                               \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_TO, __VA_ARGS__))                                       \
    }                                                                                                                  \
    void from_json(const Json& nlohmann_json_j, Struct& nlohmann_json_t) {                                             \
        [[maybe_unused]] const Struct nlohmann_json_default_obj{};                                                     \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(READ, __VA_ARGS__))                                                   \
    }
#define FORCESHADE_FIELDS(...) FORCESHADE_FIELDS_READ_BY(NLOHMANN_JSON_FROM, __VA_ARGS__)

namespace forceshade {

FORCESHADE_FIELDS(FileRecord, name, sha256, bytes)

namespace study {

void to_json(Json& json, const Cell& cell) {
    if (const double* number = std::get_if<double>(&cell))
        json = *number;
    else if (const std::string* word = std::get_if<std::string>(&cell))
        json = *word;
    else
        json = nullptr;
}

void from_json(const Json& json, Cell& cell) {
    if (json.is_string())
        cell = Cell(json.get<std::string>());
    else
        cell = json.is_null() ? Cell() : Cell(json.get<double>());
}

FORCESHADE_FIELDS(Column, name, unit, meaning)

// Tables go by columns; a column of few different cells as these and whereabouts they are.
Json column_json(const Table& table, std::size_t column) {
    Json cells = Json::array(), different = Json::array(), at = Json::array();
    std::map<Cell, std::size_t> numbers;
    for (const std::vector<Cell>& row : table.rows) {
        const auto [found, is_new] = numbers.try_emplace(row[column], numbers.size());
        if (is_new)
            different.push_back(row[column]);
        cells.push_back(row[column]);
        at.push_back(found->second);
    }
    return 4 * different.size() < table.rows.size() ? Json{{"of", different}, {"at", at}} : cells;
}

void to_json(Json& json, const Table& table) {
    json = {{"name", table.name}, {"title", table.title}, {"columns", table.columns}, {"cells", Json::array()}};
    for (std::size_t column = 0; column < table.columns.size(); ++column)
        json["cells"].push_back(column_json(table, column));
}

void from_json(const Json& json, Table& table) {
    json.at("name").get_to(table.name);
    json.at("title").get_to(table.title);
    json.at("columns").get_to(table.columns);
    const Json& cells = json.at("cells");
    for (std::size_t column = 0; column < cells.size(); ++column) {
        const bool packed = cells[column].is_object();
        const Json& values = packed ? cells[column].at("at") : cells[column];
        table.rows.resize(std::max(table.rows.size(), values.size()));
        for (std::size_t row = 0; row < values.size(); ++row)
            table.rows[row].push_back(
                (packed ? cells[column].at("of").at(values[row].get<std::size_t>()) : values[row]).get<Cell>());
    }
}

constexpr const char* kKinds[] = {"scatter", "map", "bars"};

void to_json(Json& json, const FigureKind& kind) {
    json = kKinds[static_cast<int>(kind)];
}

void from_json(const Json& json, FigureKind& kind) {
    const auto found = std::ranges::find(kKinds, json.get<std::string>());
    if (found == std::end(kKinds))
        throw DataError(fmt::format("no figure is of kind {}", json.dump()));
    kind = static_cast<FigureKind>(found - std::begin(kKinds));
}

FORCESHADE_FIELDS(FigureAxis, column, label, logarithmic)
FORCESHADE_FIELDS(Curve, table, where, x, y, label, dashed)
FORCESHADE_FIELDS_READ_BY(NLOHMANN_JSON_FROM_WITH_DEFAULT, Figure, name, title, caption, kind, table, where, x, y,
                          series, label, low, high, x_low, x_high, joined, value, value_label, value_logarithmic,
                          value_limit, value_words, curves, panels, pick, linked)
FORCESHADE_FIELDS(Finding, name, text, figure, place, condition, interval)
FORCESHADE_FIELDS(RunFacts, engine, device, driver, software, cpu, cores, quick, fingerprint, seconds)

std::string data_json(const StudyData& data) {
    const Json json{{"format", kDataFormat},     {"study", data.study},
                    {"program", data.program},   {"run", static_cast<const RunFacts&>(data)},
                    {"scene", data.scene},       {"notes", data.notes},
                    {"findings", data.findings}, {"tables", data.tables},
                    {"figures", data.figures},   {"files", data.files},
                    {"volumes", data.volumes}};
    return json.dump() + "\n";
}

StudyData parse_data(const Json& json) {
    if (json.is_discarded())
        throw DataError("it is damaged");
    try {
        if (!json.is_object() || !json.contains("format") || !json.contains("study"))
            throw DataError("it is no account of a study");
        if (json.at("format") != kDataFormat)
            throw DataError(fmt::format("its format is {}, this program reads {}; run the study again",
                                        json.at("format").dump(), kDataFormat));
        StudyData data;
        json.at("run").get_to(static_cast<RunFacts&>(data));
        json.at("study").get_to(data.study);
        json.at("program").get_to(data.program);
        json.at("scene").get_to(data.scene);
        json.at("notes").get_to(data.notes);
        json.at("findings").get_to(data.findings);
        json.at("tables").get_to(data.tables);
        json.at("figures").get_to(data.figures);
        json.at("files").get_to(data.files);
        json.at("volumes").get_to(data.volumes);
        for (const Table& table : data.tables)
            for (std::size_t row = 0; row < table.rows.size(); ++row)
                if (table.rows[row].size() != table.columns.size())
                    throw DataError(fmt::format("row {} of table {}: {} of {} columns", row + 1, table.name,
                                                table.rows[row].size(), table.columns.size()));
        return data;
    } catch (const Json::exception& error) {
        throw DataError(fmt::format("it is damaged: {}", error.what()));
    }
}

// Of any format: an account that cannot be understood names nothing.
std::vector<FileRecord> files_named_by(const Json& json, const std::string& study) {
    if (!json.is_object() || !json.contains("study") || json["study"] != study)
        return {};
    std::vector<FileRecord> all;
    for (const char* key : {"files", "volumes"})
        try {
            const auto some = json.value(key, Json::array()).get<std::vector<FileRecord>>();
            all.insert(all.end(), some.begin(), some.end());
        } catch (const Json::exception&) {
            continue;
        }
    return all;
}

} // namespace study
} // namespace forceshade

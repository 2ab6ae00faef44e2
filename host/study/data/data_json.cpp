#include "host/study/data/data_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/reading.h"
#include "host/study/data/data_error.h"

namespace forceshade::study {
namespace {

constexpr const char* kKinds[] = {"scatter", "map", "bars"};

Json cell_json(const Cell& cell) {
    if (const double* number = std::get_if<double>(&cell))
        return *number;
    if (const std::string* word = std::get_if<std::string>(&cell))
        return *word;
    return nullptr;
}

Cell cell_of(const Json& json) {
    if (json.is_null())
        return {};
    if (json.is_string())
        return json.get<std::string>();
    return cell(json.get<double>());
}

Json table_json(const Table& table) {
    Json json{{"name", table.name}, {"title", table.title}, {"columns", Json::array()}, {"rows", Json::array()}};
    for (const Column& column : table.columns)
        json["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}});
    for (const std::vector<Cell>& row : table.rows) {
        Json cells = Json::array();
        for (const Cell& one : row)
            cells.push_back(cell_json(one));
        json["rows"].push_back(std::move(cells));
    }
    return json;
}

Table table_of(const Json& json) {
    Table table{json.at("name"), json.at("title"), {}, {}};
    for (const Json& column : json.at("columns"))
        table.columns.push_back({column.at("name"), column.at("unit"), column.at("meaning")});
    for (const Json& cells : json.at("rows")) {
        std::vector<Cell> row;
        for (const Json& one : cells)
            row.push_back(cell_of(one));
        if (row.size() != table.columns.size())
            throw DataError(fmt::format("row {} of table {} has {} cells for {} columns", table.rows.size() + 1,
                                        table.name, row.size(), table.columns.size()));
        table.rows.push_back(std::move(row));
    }
    return table;
}

Json where_json(const Where& where) {
    Json json = Json::object();
    for (const auto& [column, word] : where)
        json[column] = word;
    return json;
}

Where where_of(const Json& json) {
    Where where;
    for (const auto& [column, word] : json.items())
        where.emplace_back(column, word.get<std::string>());
    return where;
}

Json axis_json(const FigureAxis& axis) {
    return {{"column", axis.column}, {"label", axis.label}, {"logarithmic", axis.logarithmic}};
}

FigureAxis axis_of(const Json& json) {
    return {json.at("column"), json.at("label"), json.at("logarithmic")};
}

Json figure_json(const Figure& figure) {
    Json json{{"name", figure.name},
              {"title", figure.title},
              {"caption", figure.caption},
              {"kind", kKinds[static_cast<int>(figure.kind)]},
              {"table", figure.table},
              {"where", where_json(figure.where)},
              {"x", axis_json(figure.x)},
              {"y", axis_json(figure.y)},
              {"series", figure.series},
              {"label", figure.label},
              {"low", figure.low},
              {"high", figure.high},
              {"x_low", figure.x_low},
              {"x_high", figure.x_high},
              {"joined", figure.joined},
              {"value", figure.value},
              {"value_label", figure.value_label},
              {"value_logarithmic", figure.value_logarithmic},
              {"value_limit", figure.value_limit},
              {"value_words", figure.value_words},
              {"curves", Json::array()},
              {"panels", figure.panels},
              {"pick", figure.pick},
              {"linked", figure.linked}};
    for (const Curve& curve : figure.curves)
        json["curves"].push_back({{"table", curve.table},
                                  {"where", where_json(curve.where)},
                                  {"x", curve.x},
                                  {"y", curve.y},
                                  {"label", curve.label},
                                  {"dashed", curve.dashed}});
    return json;
}

FigureKind kind_of(const std::string& name) {
    for (int i = 0; i < 3; ++i)
        if (name == kKinds[i])
            return static_cast<FigureKind>(i);
    throw DataError(fmt::format("no figure is of kind \"{}\"", name));
}

Figure figure_of(const Json& json) {
    Figure figure;
    figure.name = json.at("name");
    figure.title = json.at("title");
    figure.caption = json.at("caption");
    figure.kind = kind_of(json.at("kind"));
    figure.table = json.at("table");
    figure.where = where_of(json.at("where"));
    figure.x = axis_of(json.at("x"));
    figure.y = axis_of(json.at("y"));
    figure.series = json.at("series");
    figure.label = json.at("label");
    figure.low = json.at("low");
    figure.high = json.at("high");
    figure.x_low = json.value("x_low", "");
    figure.x_high = json.value("x_high", "");
    figure.joined = json.at("joined");
    figure.value = json.at("value");
    figure.value_label = json.at("value_label");
    figure.value_logarithmic = json.at("value_logarithmic");
    figure.value_limit = json.at("value_limit");
    figure.value_words = json.at("value_words").get<std::vector<std::string>>();
    for (const Json& curve : json.at("curves"))
        figure.curves.push_back({curve.at("table"), where_of(curve.at("where")), curve.at("x"), curve.at("y"),
                                 curve.at("label"), curve.at("dashed")});
    figure.panels = json.value("panels", "");
    figure.pick = json.value("pick", "");
    figure.linked = json.value("linked", std::vector<std::string>());
    return figure;
}

Json files_json(const std::vector<FileRecord>& files) {
    Json json = Json::array();
    for (const FileRecord& file : files)
        json.push_back({{"name", file.name}, {"sha256", file.sha256}, {"bytes", file.bytes}});
    return json;
}

std::vector<FileRecord> files_of(const Json& json) {
    std::vector<FileRecord> files;
    for (const Json& file : json)
        files.push_back({file.at("name"), file.at("sha256"), file.at("bytes")});
    return files;
}

StudyData data_of(const Json& json) {
    StudyData data;
    data.study = json.at("study");
    data.program = json.at("program");
    const Json& run = json.at("run");
    data.engine = run.at("engine");
    data.device = run.at("device");
    data.driver = run.at("driver");
    data.software = run.at("software");
    data.cpu = run.at("cpu");
    data.cores = run.at("cores");
    data.quick = run.at("quick");
    data.fingerprint = run.at("fingerprint");
    data.seconds = run.at("seconds");
    data.scene = json.at("scene");
    data.notes = json.at("notes").get<std::vector<std::string>>();
    for (const Json& finding : json.at("findings"))
        data.findings.push_back({finding.at("name"), finding.at("text"), finding.at("figure"), finding.at("place"),
                                 finding.at("condition"), finding.at("interval")});
    for (const Json& table : json.at("tables"))
        data.tables.push_back(table_of(table));
    for (const Json& figure : json.at("figures"))
        data.figures.push_back(figure_of(figure));
    data.files = files_of(json.at("files"));
    data.volumes = files_of(json.at("volumes"));
    return data;
}

} // namespace

std::string data_json(const StudyData& data) {
    Json json;
    json["format"] = kDataFormat;
    json["study"] = data.study;
    json["program"] = data.program;
    json["run"] = {
        {"engine", data.engine},  {"device", data.device}, {"driver", data.driver}, {"software", data.software},
        {"cpu", data.cpu},        {"cores", data.cores},   {"quick", data.quick},   {"fingerprint", data.fingerprint},
        {"seconds", data.seconds}};
    json["scene"] = data.scene;
    json["notes"] = data.notes;
    json["findings"] = Json::array();
    for (const Finding& finding : data.findings)
        json["findings"].push_back({{"name", finding.name},
                                    {"text", finding.text},
                                    {"figure", finding.figure},
                                    {"place", finding.place},
                                    {"condition", finding.condition},
                                    {"interval", finding.interval}});
    json["tables"] = Json::array();
    for (const Table& table : data.tables)
        json["tables"].push_back(table_json(table));
    json["figures"] = Json::array();
    for (const Figure& figure : data.figures)
        json["figures"].push_back(figure_json(figure));
    json["files"] = files_json(data.files);
    json["volumes"] = files_json(data.volumes);
    return json.dump(1) + "\n";
}

StudyData parse_data(const std::string& text) {
    return data_from(parse_json(text));
}

StudyData data_from(const Json& json) {
    if (json.is_discarded())
        throw DataError("it is damaged");
    try {
        if (!json.is_object() || !json.contains("format") || !json.contains("study"))
            throw DataError("it is no account of a study");
        if (json.at("format") != kDataFormat)
            throw DataError(fmt::format("its format is {}, this program reads {}; run the study again",
                                        json.at("format").dump(), kDataFormat));
        return data_of(json);
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
            const std::vector<FileRecord> some = files_of(json.value(key, Json::array()));
            all.insert(all.end(), some.begin(), some.end());
        } catch (const Json::exception&) {
            continue;
        }
    return all;
}

} // namespace forceshade::study

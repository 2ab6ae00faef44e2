#include "host/study/study_data.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "host/output/json.h"
#include "host/output/raw_formats.h"
#include "host/picture/frame.h"
#include "host/random.h"

namespace forceshade::study {
namespace {

double take_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1)
        return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

} // namespace

std::string Cell::text() const {
    if (const double* number = std::get_if<double>(this))
        return fmt::format("{}", *number);
    const std::string* word = std::get_if<std::string>(this);
    return word ? *word : std::string();
}

std::size_t Table::index(std::string_view column) const {
    const auto found = std::ranges::find(columns, column, &Column::name);
    if (found != columns.end())
        return static_cast<std::size_t>(found - columns.begin());
    std::vector<std::string> names;
    for (const Column& one : columns)
        names.push_back(one.name);
    throw DataError(fmt::format("table {} has no column {}; it has {}", name, column, fmt::join(names, ", ")));
}

std::optional<double> Table::number(std::size_t row, std::string_view column) const {
    const double* value = std::get_if<double>(&rows.at(row)[index(column)]);
    return value ? std::optional(*value) : std::nullopt;
}

double Table::needed(std::size_t row, std::string_view column) const {
    if (const auto value = number(row, column))
        return *value;
    throw DataError(fmt::format("row {} of table {} has no {}", row + 1, name, column));
}

std::string Table::word(std::size_t row, std::string_view column) const {
    const std::string* value = std::get_if<std::string>(&rows.at(row)[index(column)]);
    return value ? *value : std::string();
}

const Table& StudyData::table(std::string_view wanted) const {
    const auto found = std::ranges::find(tables, wanted, &Table::name);
    if (found == tables.end())
        throw DataError(fmt::format("the study {} has no table {}", study, wanted));
    return *found;
}

Interval bootstrap_median(const std::vector<double>& values) {
    constexpr std::size_t kResamples = 1000, kManyValues = 5000;
    if (values.empty())
        return {};
    std::vector<double> sample = values, medians;
    const double median = take_median(sample);
    if (values.size() > kManyValues) { // by order statistics, which is where bootstrap samples end
        std::ranges::sort(sample);
        const double count = static_cast<double>(sample.size()), ranks = 1.96 * std::sqrt(count) / 2;
        return {sample[static_cast<std::size_t>(count / 2 - ranks)], median,
                sample[static_cast<std::size_t>(count / 2 + ranks)]};
    }
    Random draw(7);
    for (std::size_t i = 0; i < kResamples; ++i) {
        for (double& one : sample)
            one = values[static_cast<std::size_t>(draw(0, static_cast<double>(values.size())))];
        medians.push_back(take_median(sample));
    }
    std::ranges::sort(medians);
    return {medians[kResamples / 40], median, medians[kResamples - 1 - kResamples / 40]};
}

std::string ratio_text(const Interval& ratio) {
    int digits = 2;
    const double nearest = std::min(std::abs(ratio.low - 1), std::abs(ratio.high - 1));
    while (is_significant(ratio) && digits < 5 && nearest < 0.5 * std::pow(10, -digits))
        ++digits;
    return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", ratio.median, digits, ratio.low, digits, ratio.high, digits);
}

std::string times_text(const Interval& measured) {
    const Interval ratio = across_reruns(measured);
    return takes_other_time(ratio) ? ratio_text(ratio) : fmt::format("[{:.2f}, {:.2f}]", ratio.low, ratio.high);
}

std::string times_as_long(const Interval& measured, const char* other) {
    return fmt::format("takes {} times as long as {}", times_text(measured), other);
}

double quantile(std::vector<double> values, double share) {
    if (values.empty())
        return 0;
    std::ranges::sort(values);
    const double rank = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], rank - static_cast<double>(below));
}

} // namespace forceshade::study

// As files.

/// A struct as an object of its members, in this order; read by FORCESHADE_FROM, or NLOHMANN_JSON_FROM_WITH_DEFAULT
/// if files of the same format may lack some.
#define FORCESHADE_FIELDS_READ_BY(READ, Struct, ...)                                                                   \
    void to_json(Json& nlohmann_json_j, const Struct& nlohmann_json_t) {                                               \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_TO, __VA_ARGS__))                                       \
    }                                                                                                                  \
    void from_json(const Json& nlohmann_json_j, Struct& nlohmann_json_t) {                                             \
        [[maybe_unused]] const Struct nlohmann_json_default_obj{};                                                     \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(READ, __VA_ARGS__))                                                   \
    }
#define FORCESHADE_FROM(member) read_member(nlohmann_json_j.at(#member), nlohmann_json_t.member);
#define FORCESHADE_FIELDS(...) FORCESHADE_FIELDS_READ_BY(FORCESHADE_FROM, __VA_ARGS__)

namespace forceshade {

template <typename T> static void read_member(const Json& json, T& value) {
    if constexpr (Whole<T>)
        read_whole(json, value);
    else
        json.get_to(value);
}

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

// Tables are stored by columns; a column of few different cells as these and their indices.
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
        for (std::size_t row = 0; row < values.size(); ++row) {
            std::size_t place = 0;
            if (packed)
                read_whole(values[row], place);
            table.rows[row].push_back((packed ? cells[column].at("of").at(place) : values[row]).get<Cell>());
        }
    }
}

constexpr const char* kKinds[] = {"scatter", "cells", "bars"};

void to_json(Json& json, const FigureKind& kind) {
    json = kKinds[static_cast<int>(kind)];
}

void from_json(const Json& json, FigureKind& kind) {
    const auto found = std::ranges::find(kKinds, json.get<std::string>());
    if (found == std::end(kKinds))
        throw DataError(fmt::format("unknown figure kind {}", json.dump()));
    kind = static_cast<FigureKind>(found - std::begin(kKinds));
}

FORCESHADE_FIELDS(FigureAxis, column, label, logarithmic)
FORCESHADE_FIELDS_READ_BY(NLOHMANN_JSON_FROM_WITH_DEFAULT, Curve, table, where, x, y, label, dashed, low, high)
FORCESHADE_FIELDS_READ_BY(NLOHMANN_JSON_FROM_WITH_DEFAULT, Figure, name, title, caption, kind, table, where, x, y,
                          series, label, shape, low, high, x_low, x_high, joined, value, value_label, value_logarithmic,
                          value_limit, value_words, curves, panels, pick, linked)
FORCESHADE_FIELDS(Finding, name, text, figure, place, condition, interval)
FORCESHADE_FIELDS(RunFacts, engine, device, driver, software, cpu, cores, quick, fingerprint, seconds)

FORCESHADE_FIELDS(StudyData, study, program, scene, weak_places, notes, findings, tables, figures, files, volumes)

std::string data_json(const StudyData& data) {
    Json json{{"format", kDataFormat}, {"run", static_cast<const RunFacts&>(data)}};
    json.update(Json(data));
    return json.dump() + "\n";
}

StudyData parse_data(const Json& json) {
    if (json.is_discarded())
        throw DataError("it is damaged");
    try {
        if (!json.is_object() || !json.contains("format") || !json.contains("study"))
            throw DataError("it is not a study file");
        if (json.at("format") != kDataFormat)
            throw DataError(fmt::format("its format is {}, this program reads {}; run the study again",
                                        json.at("format").dump(), kDataFormat));
        auto data = json.get<StudyData>();
        json.at("run").get_to(static_cast<RunFacts&>(data));
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

namespace {

const char* const kAccount = "study.json";

// The files that the account of the run before names, in any format: tables, figures and volumes; none if it cannot be
// read, or is of another study.
std::vector<FileRecord> files_of_former(const std::filesystem::path& folder, const std::string& study) {
    std::vector<FileRecord> all;
    for (const char* key : {"files", "volumes"})
        try {
            const Json json = read_json(folder / kAccount);
            if (!json.is_object() || !json.contains("study") || json["study"] != study)
                break;
            const auto some = json.value(key, Json::array()).get<std::vector<FileRecord>>();
            all.insert(all.end(), some.begin(), some.end());
        } catch (const Error&) {
        } catch (const Json::exception&) {
        }
    return all;
}

// Removes those of `former` that `data` does not name. Returns the names of those that were changed since, which stay.
std::vector<std::string> remove_left_over(const std::filesystem::path& folder, const std::vector<FileRecord>& former,
                                          const StudyData& data) {
    std::set<std::string> named{kAccount};
    for (const auto* files : {&data.files, &data.volumes})
        for (const FileRecord& file : *files)
            named.insert(file.name);
    std::vector<std::string> changed;
    for (const FileRecord& file : former) {
        const std::filesystem::path path = folder / file.name;
        std::error_code error;
        if (!is_plain_name(file.name) || named.contains(file.name) ||
            std::filesystem::symlink_status(path, error).type() != std::filesystem::file_type::regular)
            continue;
        if (!file_is_intact(path, file.sha256))
            changed.push_back(file.name);
        else if (std::filesystem::remove(path, error); error)
            throw IoError("cannot remove {}, which an earlier run left: {}", path.string(), error.message());
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
    std::deque<TemporaryFile> files; // published when all are on the disk: a full one is left as it was
    const auto write = [&](const std::string& name, const std::string& text) {
        TemporaryFile& file = files.emplace_back(folder / name, false, 1);
        file.write(text);
        file.flush_to_disk();
    };
    const auto write_recorded = [&](const std::string& name, const std::string& text) {
        write(name, text);
        data.files.push_back({name, sha256_of(text), text.size()});
    };
    for (const Table& table : data.tables)
        write_recorded(table.name + ".csv", table_csv(table));
    for (const TextFile& picture : pictures)
        write_recorded(picture.name, picture.text);
    write(kAccount, data_json(data));
    // While the former account exists, the files of an interrupted run can be found.
    for (std::size_t i = 0; i + 1 < files.size(); ++i)
        files[i].publish();
    std::vector<std::string> changed = remove_left_over(folder, files_of_former(folder, data.study), data);
    files.back().publish();
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

// Figures as pictures.
namespace {

constexpr std::size_t kMostMarks = 100; // of a joined series; longer ones are drawn as a line only

bool shows(const Table& table, std::size_t row, const Where& where) {
    return std::ranges::all_of(
        where, [&](const auto& one) { return table.rows[row][table.index(one.first)].text() == one.second; });
}

std::optional<double> end_of(const Table& table, std::size_t row, const std::string& column) {
    return column.empty() ? std::nullopt : table.number(row, column);
}

std::string text_of(const Table& table, std::size_t row, const std::string& column) {
    return column.empty() ? "" : table.rows[row][table.index(column)].text();
}

picture::ChartSeries& series_named(picture::Chart& chart, const std::string& name, bool joined) {
    const auto found = std::ranges::find(chart.series, name, &picture::ChartSeries::name);
    return found != chart.series.end() ? *found
                                       : chart.series.emplace_back(picture::ChartSeries{name, {}, true, joined, false});
}

// Of a word among others, the last if it is new.
std::size_t place_in(std::vector<std::string>& words, const std::string& word) {
    const auto found = std::ranges::find(words, word);
    const auto place = static_cast<std::size_t>(found - words.begin());
    if (found == words.end())
        words.push_back(word);
    return place;
}

void add_row(picture::Chart& chart, const Figure& figure, const Table& table, std::size_t row) {
    const auto number = [&](const std::string& column) { return table.number(row, column).value_or(NAN); };
    if (figure.kind == FigureKind::cells) {
        const std::size_t panel =
            figure.panels.empty() ? 0 : place_in(chart.panels, text_of(table, row, figure.panels));
        const auto place = [&](const FigureAxis& axis, picture::ChartAxis& to) {
            const std::string word = table.word(row, axis.column);
            return word.empty() ? number(axis.column) : static_cast<double>(place_in(to.words, word));
        };
        const double x = place(figure.x, chart.x), y = place(figure.y, chart.y);
        const auto value = table.number(row, figure.value);
        if (const std::string word = table.word(row, figure.value); value || !word.empty())
            chart.cells.push_back({x, chart.y.words.empty() ? y : -y, value.value_or(0), word, panel});
        return;
    }
    picture::ChartPoint point;
    point.x = figure.kind == FigureKind::bars
                  ? static_cast<double>(place_in(chart.groups, text_of(table, row, figure.x.column)))
                  : number(figure.x.column);
    point.y = number(figure.y.column);
    point.y_low = end_of(table, row, figure.low);
    point.y_high = end_of(table, row, figure.high);
    point.x_low = end_of(table, row, figure.x_low);
    point.x_high = end_of(table, row, figure.x_high);
    point.label = text_of(table, row, figure.label);
    point.shape = text_of(table, row, figure.shape);
    series_named(chart, text_of(table, row, figure.series), figure.joined).points.push_back(std::move(point));
}

picture::Chart chart_of(const Figure& figure, const StudyData& data) {
    picture::Chart chart;
    chart.title = figure.title;
    chart.x = {figure.x.label, figure.x.logarithmic};
    chart.y = {figure.y.label, figure.y.logarithmic};
    if (figure.kind == FigureKind::bars) { // horizontal bars
        chart.x = chart.y;
        chart.y = {};
    }
    chart.value_label = figure.value_label;
    chart.value_logarithmic = figure.value_logarithmic;
    chart.value_limit = figure.value_limit;
    chart.words = figure.value_words;
    const Table& table = data.table(figure.table);
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (shows(table, row, figure.where))
            add_row(chart, figure, table, row);
    for (picture::ChartSeries& series : chart.series)
        for (picture::ChartPoint& point : series.points)
            point.marked = !series.joined || series.points.size() <= kMostMarks;
    for (const Curve& curve : figure.curves) {
        const Table& of = data.table(curve.table);
        picture::ChartSeries line{curve.label, {}, false, true, curve.dashed};
        for (std::size_t row = 0; row < of.rows.size(); ++row)
            if (shows(of, row, curve.where))
                if (const auto x = of.number(row, curve.x), y = of.number(row, curve.y); x && y)
                    line.points.push_back({*x, *y, {}, {}, {}, {}, ""});
        chart.series.push_back(std::move(line));
    }
    return chart;
}

} // namespace

std::vector<TextFile> figure_files(const StudyData& data) {
    std::vector<TextFile> files;
    for (const Figure& figure : data.figures)
        files.push_back({figure.name + ".svg", picture::draw_chart(chart_of(figure, data)).svg()});
    return files;
}

} // namespace study
} // namespace forceshade

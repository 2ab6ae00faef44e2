// Results of a study: tables of numbers with units, figures that show them, findings in a sentence each. Every study
// uses these; files, plots and the report depend on them alone. And medians with their intervals, the same on every
// machine.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/error.h"
#include "host/output/files.h"

namespace forceshade::study {

/// Incomplete data: "points has no column error_rms_deg; it has ...".
class DataError : public Error {
public:
    explicit DataError(const std::string& message) : Error(ExitCode::failed, message) {}
};

/// Empty (not applicable, not finite), a finite number, or a word. A number that is not finite becomes empty.
struct Cell : std::variant<std::monostate, double, std::string> {
    Cell() = default;
    Cell(double value) {
        if (std::isfinite(value))
            emplace<double>(value);
    }
    Cell(std::integral auto value) : Cell(static_cast<double>(value)) {}
    Cell(const std::optional<double>& value) : Cell(value.value_or(NAN)) {}
    Cell(std::string word) : variant(std::move(word)) {}
    Cell(const char* word) : variant(std::string(word)) {}

    /// As in CSV: the word, the number, or empty.
    std::string text() const;
};

struct Column {
    std::string name;    /* as in CSV and JSON, with its unit at the end: "error_rms_deg" */
    std::string unit;    /* "deg", "N", "1"; empty: words */
    std::string meaning; /* one sentence, for readers */
};

struct Table {
    std::string name;  /* the CSV's stem: "points" */
    std::string title; /* for readers */
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> rows; /* as long as columns */

    /// \throws DataError without such a column.
    std::size_t index(std::string_view column) const;
    /// The number in a row; empty: none. \throws DataError without such a column.
    std::optional<double> number(std::size_t row, std::string_view column) const;
    /// The number in a row. \throws DataError without one, or without such a column.
    double needed(std::size_t row, std::string_view column) const;
    /// The word in a row, or empty. \throws DataError without such a column.
    std::string word(std::size_t row, std::string_view column) const;
};

inline Cell cell(double value) {
    return value;
}

/// A column, and its cell of a row: a function, or a member.
template <typename Row> struct ColumnOf {
    Column column;
    std::function<Cell(const Row&)> value;
};

/// A table with a row for each of `rows`.
template <typename Row>
Table table_of(std::string name, std::string title, const std::vector<ColumnOf<Row>>& columns,
               const std::vector<Row>& rows) {
    Table table{std::move(name), std::move(title), {}, {}};
    for (const ColumnOf<Row>& one : columns)
        table.columns.push_back(one.column);
    for (const Row& row : rows) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        for (const ColumnOf<Row>& one : columns)
            cells.push_back(one.value(row));
    }
    return table;
}

/// scatter: points (x, y) by series, joined by lines or not. cells: one at each (x, y), coloured by a number or a
/// word. bars: a bar of height y for each word x, side by side by series.
enum class FigureKind { scatter, cells, bars };

struct FigureAxis {
    std::string column{};
    std::string label{}; /* "stiffness / (N/m)" */
    bool logarithmic = false;
};

/// Rows of a table that a figure shows: those whose column holds the word (numbers as CSV prints them).
using Where = std::map<std::string, std::string>;

/// A line drawn over a figure, through the rows of a table in their order.
struct Curve {
    std::string table;
    Where where;
    std::string x, y; /* columns */
    std::string label;
    bool dashed = false;
    std::string low{}, high{}; /* columns with the ends of a band about y, which pages show; empty: none */
};

/// What is drawn at a row's place.
struct FigureMarks {
    std::string shape{};           /* scatter: column whose words give the marks' shapes; empty: the series' */
    std::string low{}, high{};     /* columns with the ends of a spread about y; empty: none */
    std::string x_low{}, x_high{}; /* the same about x */
    bool joined = false;           /* scatter: points of a series are joined in the order of rows */
    std::string value{};           /* cells: column of the colour, numbers or words */
    std::string value_label{};
    bool value_logarithmic = false;
    double value_limit = 0; /* cells of numbers: the colours end at this size, 0: at the largest number shown */
    std::vector<std::string> value_words{}; /* cells of words: their order in the legend */
    std::string panels{}; /* cells: column whose words have a small diagram each, all on the same axes */
};

struct Figure : FigureMarks {
    std::string name;    /* the SVG's stem */
    std::string title;   /* one line */
    std::string caption; /* how to read it, and its result */
    FigureKind kind = FigureKind::scatter;
    std::string table{};
    Where where{};
    FigureAxis x{}, y{};
    std::string series{}; /* scatter, bars: column whose words name the series; empty: one */
    std::string label{};  /* scatter: column with the words to stand at points; empty: none */
    std::vector<Curve> curves{};
    std::string pick{};                /* column: picking a mark shows its word's rows in the `linked` figures */
    std::vector<std::string> linked{}; /* names of figures whose `where` has that column, with a word to begin with */
};

/// A figure without curves and linked figures.
inline Figure make_figure(std::string name, std::string title, std::string caption, FigureKind kind, std::string table,
                          Where where, FigureAxis x, FigureAxis y, std::string series = {}, std::string label = {},
                          FigureMarks marks = {}) {
    return {std::move(marks), std::move(name),  std::move(title), std::move(caption), kind,
            std::move(table), std::move(where), std::move(x),     std::move(y),       std::move(series),
            std::move(label)};
}

/// Adds `more` at the end of `all`.
template <typename T> void append(std::vector<T>& all, std::vector<T> more) {
    all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// A claim that follows from the tables: fixed words with the numbers in their slots.
struct Finding {
    std::string name;        /* does not depend on the numbers: "cheapest_1deg" */
    std::string text;        /* the claim, a sentence */
    std::string figure{};    /* that shows it; empty: none */
    std::string place{};     /* where it holds: "flat, crest and slope of the bump" */
    std::string condition{}; /* when: "default hand, 1 kHz" */
    std::string interval{}; /* uncertainty: "95 % of 2000 bootstrap samples: 1.9 to 2.3 times"; empty: no measurement */
};

struct RunFacts {
    std::string engine, device, driver, cpu;
    unsigned cores = 0;
    bool software = true; /* device */
    bool quick = false;
    std::string fingerprint; /* of program, device, scene and form: equal if a run would do the same */
    double seconds = 0;      /* that the run took */
};

struct StudyData : RunFacts {
    std::string study;              /* "error-time", "stability", "energy", "omission" */
    std::string program;            /* version */
    std::string scene;              /* resolved TOML; empty: the study's own */
    std::string weak_places;        /* of the scene's surface (limits.h); empty: not known */
    std::vector<std::string> notes; /* needed to read the numbers, a sentence each */
    std::vector<Table> tables;
    std::vector<Figure> figures;
    std::vector<Finding> findings;
    std::vector<FileRecord> files;    /* CSV and SVG files, by name in the study's folder */
    std::vector<FileRecord> volumes;  /* EXR files, by name in the study's folder */
    std::size_t failed_renderers = 0; /* of the user's own, in this run; not in the file */

    /// \throws DataError without it.
    const Table& table(std::string_view name) const;
};

/// The median of some values, and where 95 % of the medians of bootstrap samples lie (Efron 1979, percentiles).
struct Interval {
    double low = 0, median = 0, high = 0;
};
Interval bootstrap_median(const std::vector<double>& values);

/// Whether a ratio differs from 1, or another number from `none`: only then is it a finding.
inline bool is_significant(const Interval& ratio, double none = 1) {
    return ratio.high < none || ratio.low > none;
}

/// By how many times a ratio of times moves from run to run, beyond its interval, where nothing changed (a god-object
/// without its hint took 1.56 [1.51, 1.61] and 1.72 [1.62, 1.76] times as long in two).
inline constexpr double kRerun = 1.1;

/// The interval of a ratio of times that holds other runs', too.
inline Interval across_reruns(const Interval& ratio) {
    return {ratio.low / kRerun, ratio.median, ratio.high * kRerun};
}

/// Whether an interval across reruns is a twentieth off equal times: one that ended nearer to 1 did so in half of them.
inline bool takes_other_time(const Interval& ratio) {
    constexpr double kClear = 1.05;
    return ratio.low > kClear || ratio.high < 1 / kClear;
}

/// Whether a control, the ratio of the times of two equal sides, is so wide that other ratios say nothing.
inline bool was_busy(const Interval& control) {
    constexpr double kWide = 1.25;
    return control.high > kWide || control.low < 1 / kWide;
}

/// "1.30 [1.21, 1.42]", with as many digits as it takes for its ends to differ from 1.
std::string ratio_text(const Interval& ratio);

/// Across reruns "1.30 [1.10, 1.56]", or "0.95 to 1.15" where that may be 1.
std::string times_text(const Interval& measured);
/// "takes 1.30 [1.10, 1.56] times as long as the other".
std::string times_as_long(const Interval& measured, const char* other);

/// The quantile at this share, the middle of neighbours between ranks; 0 without values.
double quantile(std::vector<double> values, double share);

// A study's data as files: study.json holds everything, TABLE.csv each table, FIGURE.svg each figure.

/// Of the layout of study.json; another is refused on reading.
inline constexpr int kDataFormat = 7;

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

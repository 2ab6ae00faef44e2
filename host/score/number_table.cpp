#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/paths/path_reader.h"
#include "host/scene/toml.h"
#include "host/score/strokes.h"
#include "host/spelling.h"
#include "host/text.h"

namespace forceshade::score {
namespace {

constexpr std::size_t kLongestWord = 40;                   // bytes, in an error
constexpr std::size_t kLongestLine = std::size_t(1) << 16; // bytes

// Of "text" the text.
std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
}

// "#1": a column's number, with which no comment begins.
bool is_counted(std::string_view text) {
    return text.size() > 1 && std::all_of(text.begin() + 1, text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// By the first line that is no comment.
char separator_of(std::string_view text) {
    std::string_view line;
    do {
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
        line = text.substr(0, text.find('\n'));
        text.remove_prefix(line.size());
    } while (line.starts_with('#') && !text.empty());
    for (const char one : {';', '\t', ','})
        if (trimmed(line).find(one) != line.npos)
            return one;
    return ' ';
}

// NaN where a text is no number.
double number_of(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        text.remove_prefix(1);
    return number_in<double>(text).value_or(NAN);
}

// "0,5" as 0.5.
double number_with_comma(std::string_view text) {
    if (text.find('.') != text.npos)
        return number_of(text);
    std::string point(text);
    std::ranges::replace(point, ',', '.');
    return number_of(point);
}

bool is_word(std::string_view text) {
    const std::string lower = lower_case(text);
    return !text.empty() && std::isnan(number_with_comma(text)) && lower != "nan" && lower != "-nan" && lower != "na";
}

using Cells = std::vector<std::string_view>;

// Takes rows one after the other. The first one, or a comment before it, may be a header.
class TableBuilder {
public:
    explicit TableBuilder(NumberTable& table, bool decimal_commas = false)
        : table_(table), number_(decimal_commas ? number_with_comma : number_of) {}

    // Of a line that begins with #, its cells without it.
    void comment(const Cells& cells) {
        if (!table_.columns.empty())
            return;
        comment_.clear();
        if (std::ranges::all_of(cells, is_word))
            comment_.assign(cells.begin(), cells.end());
    }

    void row(const Cells& cells, std::uint32_t line) {
        if (table_.columns.empty() && begin(cells))
            return;
        if (cells.size() != table_.columns.size())
            throw UsageError("{}:{}: {} numbers in this row, {} in the first; every row has a number a column",
                             table_.source, line, cells.size(), table_.columns.size());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double value = number_(cells[i]);
            if (std::isnan(value) && table_.words[i].empty() &&
                (is_word(cells[i]) || cells[i].find(',') != cells[i].npos))
                table_.words[i] = fmt::format("{}: \"{}\"", line, printable(cells[i].substr(0, kLongestWord)));
            table_.cells[i].push_back(value);
        }
        table_.lines.push_back(line);
    }

private:
    // Whether this row is a header.
    bool begin(const Cells& cells) {
        const bool is_header = std::ranges::any_of(cells, is_word);
        table_.cells.resize(cells.size());
        table_.words.resize(cells.size());
        table_.named = is_header || comment_.size() == cells.size();
        for (std::size_t i = 0; i < cells.size(); ++i)
            table_.columns.push_back(is_header      ? std::string(cells[i])
                                     : table_.named ? comment_[i]
                                                    : fmt::format("#{}", i + 1));
        return is_header;
    }

    NumberTable& table_;
    double (*number_)(std::string_view);
    std::vector<std::string> comment_; // the last one that may be a header
};

void read_csv(NumberTable& table, const std::filesystem::path& file) {
    CsvReader reader(file);
    TableBuilder builder(table);
    Cells cells;
    while (reader.next()) {
        cells.clear();
        for (std::size_t i = 0; i < reader.size(); ++i)
            cells.push_back(reader.text(i));
        if (cells.front().starts_with('#') && !is_counted(cells.front())) {
            cells.front() = trimmed(cells.front().substr(1));
            builder.comment(cells);
        } else {
            builder.row(cells, reader.where(0).line);
        }
    }
}

// Rows between semicolons, tabs or blanks.
void read_rows(NumberTable& table, std::string_view text, char between) {
    TableBuilder builder(table, between != ' ');
    Cells cells;
    std::uint32_t line = 0;
    while (!text.empty()) {
        std::string_view row = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(row.size() + 1, text.size()));
        ++line;
        if (row.size() > kLongestLine)
            throw UsageError("{}:{}: a line of {} bytes; is this a file of strokes?", table.source, line, row.size());
        if (row.ends_with('\r'))
            row.remove_suffix(1);
        if (between == ' ' || trimmed(row).empty())
            row = trimmed(row);
        const bool comment = row.starts_with('#');
        if (comment)
            row = trimmed(row.substr(1));
        if (row.empty())
            continue;
        cells.clear();
        for (std::size_t end = 0; end != row.npos; row.remove_prefix(std::min(end + 1, row.size()))) {
            end = row.find_first_of(between == ' ' ? " \t" : std::string_view(&between, 1));
            cells.push_back(unquoted(trimmed(row.substr(0, end))));
            if (between == ' ' && cells.back().empty())
                cells.pop_back();
        }
        if (cells.back().empty() && (table.columns.empty() ? between == ' ' : cells.size() > table.columns.size()))
            cells.pop_back(); // a separator at the end
        comment ? builder.comment(cells) : builder.row(cells, line);
    }
}

// The text between a key of an array's header and the next comma or end.
std::string_view value_of(std::string_view header, std::string_view key, char end) {
    const std::size_t at = header.find(key);
    if (at == std::string_view::npos)
        return "";
    const std::string_view rest = header.substr(at + key.size());
    return rest.substr(0, rest.find(end));
}

template <typename Real> void take_array(NumberTable& table, std::string_view bytes, std::size_t columns) {
    const std::size_t rows = bytes.size() / sizeof(Real) / columns;
    table.cells.assign(columns, std::vector<double>(rows));
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            Real value;
            std::memcpy(&value, bytes.data() + (row * columns + column) * sizeof value, sizeof value);
            table.cells[column][row] = static_cast<double>(value);
        }
    for (std::size_t row = 0; row < rows; ++row)
        table.lines.push_back(static_cast<std::uint32_t>(row));
}

void read_array(NumberTable& table, std::string_view text) {
    const auto refuse = [&](const std::string& why) {
        throw UsageError("{}: {}; expected a NumPy array of rows of numbers, as numpy.save writes it", table.source,
                         why);
    };
    if (!text.starts_with("\x93NUMPY") || text.size() < 12)
        refuse("this is no .npy file");
    const bool wide = text[6] > 1; // format 2 and 3: four bytes of length
    const std::size_t begins = wide ? 12 : 10;
    std::size_t length = 0;
    for (std::size_t i = begins; i-- > 8;)
        length = length << 8 | static_cast<unsigned char>(text[i]);
    if (text.size() < begins + length)
        refuse("its header is cut off");
    const std::string_view header = text.substr(begins, length), data = text.substr(begins + length);
    const std::string_view type = value_of(header, "'descr': '", '\'');
    if (type != "<f8" && type != "<f4")
        refuse(fmt::format("its numbers are \"{}\"; convert it: array.astype(float)", type));
    if (!value_of(header, "'fortran_order':", ',').ends_with("False"))
        refuse("its columns stand one after the other; convert it: numpy.ascontiguousarray(array)");
    std::vector<std::size_t> shape;
    std::string_view sizes = value_of(header, "'shape': (", ')');
    while (!sizes.empty()) {
        std::size_t size = 0;
        const std::string_view one = sizes.substr(0, sizes.find(','));
        const std::size_t digit = one.find_first_not_of(' ');
        if (digit != std::string_view::npos) {
            std::from_chars(one.data() + digit, one.data() + one.size(), size);
            shape.push_back(size);
        }
        sizes.remove_prefix(std::min(one.size() + 1, sizes.size()));
    }
    if (shape.size() != 2 || shape[1] == 0 || shape[1] > 1000)
        refuse(fmt::format("it has {} dimensions; reshape it to rows of columns", shape.size()));
    const std::size_t bytes = type == "<f8" ? 8 : 4;
    if (data.size() % (bytes * shape[1]) != 0 || data.size() / (bytes * shape[1]) != shape[0])
        refuse("it is cut off");
    for (std::size_t i = 0; i < shape[1]; ++i)
        table.columns.push_back(fmt::format("#{}", i + 1));
    bytes == 8 ? take_array<double>(table, data, shape[1]) : take_array<float>(table, data, shape[1]);
}

} // namespace

NumberTable read_numbers(const std::filesystem::path& file) {
    NumberTable table;
    table.source = file.string();
    const std::string text = read_file(file);
    if (file.extension() == ".npy") {
        read_array(table, text);
    } else {
        std::string_view rows = text;
        if (rows.starts_with("\xEF\xBB\xBF"))
            rows.remove_prefix(3);
        if (rows.starts_with("\xFF\xFE") || rows.starts_with("\xFE\xFF"))
            throw UsageError("{}: the text is UTF-16; save it as UTF-8 or ASCII", table.source);
        const char between = separator_of(rows);
        between == ',' ? read_csv(table, file) : read_rows(table, rows, between);
    }
    if (table.rows() == 0)
        throw UsageError("{}: there is no row of numbers", table.source);
    return table;
}

} // namespace forceshade::score

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

namespace forceshade::score {
namespace {

constexpr std::size_t kLongestLine = std::size_t(1) << 16; // bytes

// NaN where a text is no number.
double number_of(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        text.remove_prefix(1);
    double value = NAN;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : NAN;
}

bool is_word(std::string_view text) {
    const std::string lower = [&] {
        std::string all(text);
        std::ranges::transform(all, all.begin(), [](unsigned char c) { return std::tolower(c); });
        return all;
    }();
    return !text.empty() && std::isnan(number_of(text)) && lower != "nan" && lower != "-nan";
}

void add_row(NumberTable& table, const std::vector<std::string_view>& cells, std::uint32_t line) {
    if (cells.size() != table.columns.size())
        throw UsageError("{}:{}: {} numbers in this row, {} in the first; every row has a number a column",
                         table.source, line, cells.size(), table.columns.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
        table.cells[i].push_back(number_of(cells[i]));
    table.lines.push_back(line);
}

// The first row, which a header may be.
void begin(NumberTable& table, const std::vector<std::string_view>& cells, std::uint32_t line) {
    table.named = std::ranges::any_of(cells, is_word);
    for (std::size_t i = 0; i < cells.size(); ++i)
        table.columns.push_back(table.named ? std::string(cells[i]) : fmt::format("#{}", i + 1));
    table.cells.resize(cells.size());
    if (!table.named)
        add_row(table, cells, line);
}

void read_csv(NumberTable& table, const std::filesystem::path& file) {
    CsvReader reader(file);
    std::vector<std::string_view> cells;
    while (reader.next()) {
        cells.clear();
        for (std::size_t i = 0; i < reader.size(); ++i)
            cells.push_back(reader.text(i));
        if (cells.front().starts_with('#') && table.columns.empty() && cells.size() == 1)
            continue;
        const std::uint32_t line = reader.where(0).line;
        table.columns.empty() ? begin(table, cells, line) : add_row(table, cells, line);
    }
}

void read_rows(NumberTable& table, const std::string& text) {
    std::vector<std::string_view> cells;
    std::uint32_t line = 0;
    for (std::string_view rest = text; !rest.empty();) {
        std::string_view row = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(row.size() + 1, rest.size()));
        ++line;
        if (row.size() > kLongestLine)
            throw UsageError("{}:{}: a line of {} bytes; is this a file of strokes?", table.source, line, row.size());
        cells.clear();
        const std::string_view between = row.find(';') != row.npos ? ";\r" : " \t\r";
        for (row.remove_prefix(std::min(row.find_first_not_of(between), row.size())); !row.empty();
             row.remove_prefix(std::min(row.find_first_not_of(between), row.size()))) {
            cells.push_back(row.substr(0, row.find_first_of(between)));
            row.remove_prefix(cells.back().size());
            while (cells.back().ends_with(' '))
                cells.back().remove_suffix(1);
            while (cells.back().starts_with(' '))
                cells.back().remove_prefix(1);
        }
        if (cells.empty() || cells.front().starts_with('#'))
            continue;
        table.columns.empty() ? begin(table, cells, line) : add_row(table, cells, line);
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
        const std::size_t first = text.find_first_not_of("\r\n");
        std::string_view line = first == std::string::npos ? "" : std::string_view(text).substr(first);
        while (line.starts_with('#') && line.find('\n') != std::string_view::npos)
            line.remove_prefix(line.find('\n') + 1);
        line = line.substr(0, line.find('\n'));
        line.find(',') != line.npos&& line.find(';') == line.npos ? read_csv(table, file) : read_rows(table, text);
    }
    if (table.rows() == 0)
        throw UsageError("{}: there is no row of numbers", table.source);
    return table;
}

} // namespace forceshade::score

// CSV: recorded paths read or refused, the same in pieces of any size and kept or not, and as a plain reader reads
// them; text and numbers that the program writes are read as the same.
#include <array>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/output/raw_formats.h"
#include "host/paths/path_reader.h"
#include "host/paths/recorded.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::Bytes;
using fuzz::require;

constexpr double kFarthest = 1e15;                           // m
constexpr std::uint64_t kMostExact = std::uint64_t{1} << 53; // doubles tell whole numbers apart up to here

std::vector<PathSample> read_all(const std::filesystem::path& path, std::size_t most) {
    PathReader reader(path, kFarthest);
    std::vector<PathSample> all, some;
    do {
        reader.read(some, most);
        all.insert(all.end(), some.begin(), some.end());
    } while (!some.empty());
    return all;
}

bool same(const PathSample& one, const PathSample& other) {
    return one.path == other.path && one.time == other.time && one.probe == other.probe && one.line == other.line;
}

/// Every number as strtod reads it.
void check_numbers(const std::filesystem::path& path, const std::vector<PathSample>& samples) {
    CsvReader csv(path);
    csv.next();
    static const std::set<std::string, std::less<>> names{"path", "t", "x", "y", "z"};
    std::map<std::string, std::size_t, std::less<>> columns;
    for (std::size_t i = 0; i < csv.size(); ++i)
        require(columns.emplace(csv.text(i), i).second || !names.contains(csv.text(i)), "two columns are called {}",
                csv.text(i));
    const bool numbered = columns.contains("path"); // of a single path the column may be left out
    for (const PathSample& sample : samples) {
        csv.next();
        const auto cell = [&](const char* name) {
            return std::string(!numbered && std::string_view(name) == "path" ? "0" : csv.text(columns.at(name)));
        };
        const auto number = [&](const char* name) { return std::strtod(cell(name).c_str(), nullptr); };
        require(std::strtold(cell("path").c_str(), nullptr) == static_cast<long double>(sample.path),
                "line {}: path {} is taken for {}", sample.line, cell("path"), sample.path);
        require(sample.path <= kMostExact || cell("path").find_first_not_of("0123456789") == std::string::npos,
                "line {}: path {} may be a rounded number", sample.line, cell("path"));
        require(number("t") == sample.time && number("x") == sample.probe.x && number("y") == sample.probe.y &&
                    number("z") == sample.probe.z,
                "line {}: numbers are others", sample.line);
    }
}

/// The samples of each path, in the order of the file, later and later.
void check_recorded(const RecordedFile& file, const std::vector<PathSample>& samples) {
    RecordedCursor cursor(file);
    for (const std::uint64_t id : file.ids()) {
        double before = -std::numeric_limits<double>::infinity();
        for (const PathSample& sample : samples) {
            if (sample.path != id)
                continue;
            require(same(cursor.next(), sample), "path {}: the sample of line {} is another", id, sample.line);
            require(sample.time > before, "line {}: it comes no later", sample.line);
            before = sample.time;
        }
    }
}

/// What a message shows of a cell stands where it says: FILE:LINE:COLUMN: NAME: "CELL..., columns counted in
/// characters.
void check_place(const std::string& message, std::string_view text) {
    static const std::regex kForm(R"re(^[^:]*:(\d+):(\d+): (?:path|t|x|y|z): "(.*)" is [^"]*$)re");
    std::smatch parts;
    if (text.starts_with("\xEF\xBB\xBF"))
        text.remove_prefix(3);
    if (!std::regex_match(message, parts, kForm))
        return;
    for (unsigned long line = std::stoul(parts[1]); line > 1; --line)
        text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
    const auto skip_rest_of_character = [&] { text = {std::ranges::find_if_not(text, continues), text.end()}; };
    skip_rest_of_character(); // a line may begin with bytes that begin no character, and they are in no column
    for (unsigned long column = std::stoul(parts[2]); column > 1 && !text.empty(); --column) {
        text.remove_prefix(1);
        skip_rest_of_character();
    }
    std::string shown = parts[3];
    if (text.starts_with('"') || continues(shown[0])) // no character begins so
        return;
    shown.resize(shown.ends_with("...") ? shown.size() - 3 : shown.size()); // it was cut
    const auto begins = [&](std::string_view there) {
        return std::ranges::equal(shown, there.substr(0, shown.size()),
                                  [](char a, char b) { return a == b || a == '?'; });
    };
    const std::string_view number = text.substr(text.starts_with('+')); // a first plus is none of it
    require(begins(text) || begins(number), "{}, but there stands {}", message, text.substr(0, shown.size()));
}

/// How far the samples go, and how long half of the steps between them are at most.
void check_scale(const StepScale& scale, const std::vector<PathSample>& samples) {
    double farthest = 0;
    std::map<std::uint64_t, glm::dvec3> before;
    std::vector<long double> steps;
    for (const PathSample& sample : samples) {
        for (int axis = 0; axis < 3; ++axis)
            farthest = std::max(farthest, std::abs(sample.probe[axis]));
        if (const auto [known, is_new] = before.try_emplace(sample.path, sample.probe); !is_new) {
            const long double step = glm::length(glm::vec<3, long double>(sample.probe - known->second));
            known->second = sample.probe;
            if (step > 0)
                steps.push_back(step);
        }
    }
    require(scale.farthest() == farthest, "samples reach {}, not {}", farthest, scale.farthest());
    if (steps.empty() || *std::ranges::min_element(steps) < 1e-150L)
        return;
    std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
    const auto ratio = static_cast<double>(steps[steps.size() / 2] / static_cast<long double>(scale.median_step()));
    require(ratio > 0.8 && ratio < 1.25, "the median step is {} times {}", ratio, scale.median_step());
}

/// The cells of a line without quotes.
std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells{""};
    for (const char c : line)
        c == ',' ? void(cells.emplace_back()) : cells.back().push_back(c);
    for (std::string& cell : cells) {
        const std::size_t begin = cell.find_first_not_of(" \t"), end = cell.find_last_not_of(" \t");
        cell = begin == cell.npos ? "" : cell.substr(begin, end - begin + 1);
    }
    return cells;
}

/// A plain number: not one that is 0 only because it is so small.
std::optional<double> plain_number(const std::string& cell) {
    char* end = nullptr;
    const double value = std::strtod(cell.c_str(), &end);
    const bool plain = !cell.empty() && *end == '\0' && cell.find_first_not_of("+-.0123456789eE") == cell.npos &&
                       std::isfinite(value) && (value != 0 || cell.find_first_of("123456789eE") == cell.npos);
    return plain ? std::optional(value) : std::nullopt;
}

/// The samples of a file read another way, line by line; nothing of a file that this reader does not understand, or
/// that may be refused.
std::optional<std::vector<PathSample>> simply_read(const std::string& text) {
    const auto is_simple = [](char c) {
        return c == '\n' || c == '\r' || c == '\t' || (c >= ' ' && c <= '~' && c != '"');
    };
    if (!std::ranges::all_of(text, is_simple))
        return {};
    std::istringstream lines(text);
    std::map<std::string, std::size_t> columns;
    std::size_t width = 0;
    std::uint32_t number = 0;
    std::vector<PathSample> samples;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.ends_with('\r') && !lines.eof())
            line.pop_back();
        if (line.find('\r') != line.npos || (!line.empty() && line.find_first_not_of(" \t") == line.npos))
            return {};
        if (line.empty())
            continue;
        const std::vector<std::string> cells = cells_of(line);
        if (columns.empty()) {
            width = cells.size();
            for (std::size_t i = 0; i < width; ++i)
                if (!columns.emplace(cells[i], i).second)
                    return {};
            for (const char* name : {"path", "t", "x", "y", "z"})
                if (!columns.contains(name))
                    return {}; // where only "path" is missing, its name may be misspelled
            continue;
        }
        if (cells.size() != width)
            return {};
        std::array<double, 5> values{};
        for (std::size_t i = 0; const char* name : {"path", "t", "x", "y", "z"}) {
            const std::optional<double> value = plain_number(cells[columns.at(name)]);
            if (!value || (i == 0 && (*value < 0 || *value > kMostExact || *value != std::floor(*value))) ||
                (i > 1 && std::abs(*value) > kFarthest))
                return {};
            values[i++] = *value;
        }
        samples.push_back(
            {static_cast<std::uint64_t>(values[0]), values[1], {values[2], values[3], values[4]}, number});
    }
    return samples.empty() ? std::nullopt : std::optional(samples);
}

void check_paths(std::string_view text) {
    static fuzz::MemoryFile file;
    file.write(text);
    const auto expected = simply_read(std::string(text));
    std::vector<PathSample> samples;
    try {
        samples = read_all(file.path(), 1000);
    } catch (const UsageError& error) {
        require(!expected, "plain samples are refused: {}", error.what());
        require(std::string_view(error.what()).starts_with("/proc/self/fd/"), "a message without its place: {}",
                error.what());
        check_place(error.what(), text);
        return;
    }
    require(!expected || std::ranges::equal(samples, *expected, same), "plain samples are read as others");
    for (const PathSample& sample : samples)
        require(std::isfinite(sample.time) && std::abs(sample.probe.x) <= kFarthest &&
                    std::abs(sample.probe.y) <= kFarthest && std::abs(sample.probe.z) <= kFarthest,
                "line {}: numbers out of range", sample.line);
    require(std::ranges::equal(samples, read_all(file.path(), 1), same), "one by one, samples are others");
    check_numbers(file.path(), samples);
    try {
        const RecordedFile kept(file.path(), {.largest_coordinate = kFarthest});
        require(kept.samples() == samples.size(), "{} samples of {}", kept.samples(), samples.size());
        check_recorded(kept, samples);
        check_scale(kept.scale(), samples);
        const RecordedFile streamed(file.path(), {.largest_coordinate = kFarthest, .most_kept = 0});
        RecordedCursor one(kept), other(streamed);
        for (std::uint64_t i = 0; i < kept.samples(); ++i)
            require(same(one.next(), other.next()), "sample {} is another if the file is not kept", i);
    } catch (const UsageError&) {
    }
}

/// Cells of text and numbers, written and read.
void check_cells(Bytes& bytes) {
    static fuzz::MemoryFile file;
    CsvText csv;
    std::vector<std::vector<std::string>> rows;
    const std::size_t width = 2 + bytes.below(3);
    while (!bytes.empty()) {
        std::vector<std::string>& row = rows.emplace_back();
        for (std::size_t cell = 0; cell < width; ++cell) {
            const std::uint8_t kind = bytes.byte();
            if (kind % 4 == 0) {
                const auto value = std::bit_cast<double>(bytes.bits());
                csv.add(value);
                row.push_back(fmt::format("{}", value));
                char* end = nullptr;
                const double back = std::strtod(row.back().c_str(), &end);
                require(std::memcmp(&back, &value, sizeof value) == 0 || value != value, "{} is read as {}", value,
                        back);
            } else {
                row.emplace_back(bytes.text(kind / 4 % 16));
                csv.add(row.back());
            }
        }
        csv.end();
    }
    if (!rows.empty() && rows[0][0].starts_with("\xEF\xBB\xBF")) // a mark at the beginning is none of the text
        return;
    file.write(csv.text());
    if (csv.text().starts_with("\xFF\xFE") || csv.text().starts_with("\xFE\xFF"))
        return; // it looks like UTF-16
    CsvReader reader(file.path());
    for (const std::vector<std::string>& row : rows) {
        require(reader.next(), "a row is missing");
        require(reader.size() == row.size(), "{} cells become {}", row.size(), reader.size());
        for (std::size_t i = 0; i < row.size(); ++i)
            require(reader.text(i) == row[i], "\"{}\" is read as \"{}\"", row[i], reader.text(i));
    }
    require(!reader.next(), "there is a row more");
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    forceshade::Bytes bytes(data, size);
    if (size > 0 && data[0] == 0) {
        bytes.byte();
        forceshade::check_cells(bytes);
    } else {
        forceshade::check_paths(bytes.rest());
    }
    return 0;
}

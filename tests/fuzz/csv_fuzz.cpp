// CSV: recorded paths read or refused, the same in pieces of any size and kept or not; text and numbers that the
// program writes are read as the same.
#include <map>

#include "host/error.h"
#include "host/output/raw_formats.h"
#include "host/paths/path_reader.h"
#include "host/paths/recorded.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::Bytes;
using fuzz::require;

constexpr double kFarthest = 1e15; // m

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
    std::map<std::string, std::size_t, std::less<>> columns;
    for (std::size_t i = 0; i < csv.size(); ++i)
        columns.emplace(csv.text(i), i);
    for (const PathSample& sample : samples) {
        csv.next();
        const auto cell = [&](const char* name) { return std::string(csv.text(columns.at(name))); };
        const auto number = [&](const char* name) { return std::strtod(cell(name).c_str(), nullptr); };
        require(std::strtold(cell("path").c_str(), nullptr) == static_cast<long double>(sample.path),
                "line {}: path {} is taken for {}", sample.line, cell("path"), sample.path);
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

void check_paths(std::string_view text) {
    static fuzz::MemoryFile file;
    file.write(text);
    std::vector<PathSample> samples;
    try {
        samples = read_all(file.path(), 1000);
    } catch (const UsageError& error) {
        require(std::string_view(error.what()).starts_with("/proc/self/fd/"), "a message without its place: {}",
                error.what());
        return;
    }
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

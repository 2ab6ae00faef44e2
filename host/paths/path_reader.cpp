#include "host/paths/path_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/numbers.h"
#include "host/spelling.h"
#include "host/text.h"

namespace forceshade {

namespace {

constexpr std::size_t kBuffer = std::size_t(1) << 18;     // bytes
constexpr std::size_t kMostRecord = std::size_t(1) << 20; // bytes: no row of numbers comes near

bool is_blank(int c) {
    return c == ' ' || c == '\t';
}

} // namespace

CsvReader::CsvReader(const std::filesystem::path& path) : source_(path.string()), buffer_(kBuffer) {
    file_.emplace(path);
    refill();
    begin();
}

CsvReader::CsvReader(const std::filesystem::path& path, std::string_view content)
    : source_(path.string()), filled_(content.size()) {
    const auto bytes = std::as_bytes(std::span(content));
    buffer_.assign(bytes.begin(), bytes.end());
    begin();
}

void CsvReader::begin() {
    const auto starts_with = [&](std::string_view mark) {
        return std::string_view(reinterpret_cast<const char*>(buffer_.data()), filled_).starts_with(mark);
    };
    if (starts_with("\xEF\xBB\xBF"))
        next_ = 3;
    else if (starts_with("\xFF\xFE") || starts_with("\xFE\xFF"))
        fail(source_, here_, "the text is UTF-16; save it as UTF-8 or ASCII");
}

std::string_view CsvReader::text(std::size_t cell) const {
    return std::string_view(text_).substr(cells_[cell].begin, cells_[cell].end - cells_[cell].begin);
}

void CsvReader::refill() {
    filled_ = file_ ? file_->read_some(offset_, buffer_) : 0;
    offset_ += filled_;
    next_ = 0;
}

inline int CsvReader::peek() {
    if (next_ == filled_)
        refill();
    return next_ < filled_ ? static_cast<int>(buffer_[next_]) : kEnd;
}

// Columns count characters, so the second and further bytes of one do not.
inline void CsvReader::take() {
    const auto byte = static_cast<unsigned char>(buffer_[next_++]);
    if (byte == '\n') {
        ++here_.line;
        here_.column = 1;
    } else if ((byte & 0xC0) != 0x80) {
        ++here_.column;
    }
    if (++record_bytes_ > kMostRecord)
        fail(source_, begin_, "what begins here is longer than 1 MiB without an end of line; is this a CSV file?");
}

bool CsvReader::next() {
    do {
        begin_ = here_;
        record_bytes_ = 0;
        if (peek() == kEnd)
            return false;
        read_record();
    } while (cells_.size() == 1 && cells_[0].begin == cells_[0].end && record_bytes_ <= 2);
    return true;
}

void CsvReader::read_record() {
    text_.clear();
    cells_.clear();
    do
        read_cell();
    while (!take_line_end());
}

// After a cell: true if the record ends with it, else the comma is taken.
bool CsvReader::take_line_end() {
    end_ = here_;
    const int c = peek();
    ends_open_ = c == kEnd;
    if (ends_open_)
        return true;
    if (c == '\r') {
        take();
        if (peek() != '\n')
            fail(source_, end_, "a carriage return without a line feed; lines end in LF or CRLF");
    }
    take();
    return c != ',';
}

void CsvReader::skip_blanks() {
    while (is_blank(peek()))
        take();
}

void CsvReader::read_cell() {
    skip_blanks();
    cells_.push_back({text_.size(), text_.size(), here_});
    if (peek() == '"')
        read_quoted();
    else
        read_plain();
    cells_.back().end = text_.size();
}

void CsvReader::read_plain() {
    for (int c = peek(); c != ',' && c != '\n' && c != '\r' && c != kEnd; c = peek()) {
        text_ += static_cast<char>(c);
        take();
    }
    while (text_.size() > cells_.back().begin && is_blank(text_.back()))
        text_.pop_back();
}

void CsvReader::read_quoted() {
    const Location opened = here_;
    take();
    for (;;) {
        const int c = peek();
        if (c == kEnd)
            fail(source_, opened, "the quote that opens here is not closed");
        take();
        if (c == '"') {
            if (peek() != '"')
                break;
            take(); // two quotes within a cell stand for one
        }
        text_ += static_cast<char>(c);
    }
    skip_blanks();
    if (const int c = peek(); c != ',' && c != '\n' && c != '\r' && c != kEnd)
        fail(source_, here_, "text after a closing quote; expected a comma or the end of the line");
}

namespace {

constexpr std::array<const char*, 5> kNames{"path", "t", "x", "y", "z"};
constexpr std::array<const char*, 5> kWanted{"a whole number from 0, such as 7", "seconds, such as 0.25",
                                             "metres, such as -0.0125", "metres, such as -0.0125",
                                             "metres, such as -0.0125"};
constexpr double kLargestWhole = 9007199254740992; // 2^53: doubles represent whole numbers up to here

// A cell as an error shows it: not too long, and without control characters.
std::string shown(std::string_view text) {
    constexpr std::size_t kMost = 40;
    std::string safe(text.substr(0, kMost));
    std::replace_if(
        safe.begin(), safe.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
    return fmt::format("\"{}{}\"", safe, text.size() > kMost ? "..." : "");
}

// Spreadsheets of some countries write these.
std::string separator_hint(std::string_view header) {
    if (header.find(';') != std::string_view::npos)
        return "; its cells are separated by semicolons instead of commas";
    if (header.find('\t') != std::string_view::npos)
        return "; its cells are separated by tabs instead of commas";
    return "";
}

} // namespace

PathReader::PathReader(const std::filesystem::path& path, double largest_coordinate)
    : csv_(path), largest_coordinate_(largest_coordinate) {
    read_header();
}

void PathReader::read_header() {
    if (!csv_.next())
        fail(csv_.source(), {}, "the file is empty; its first line must be a header with path,t,x,y,z");
    width_ = csv_.size();
    for (std::size_t column = 0; column < kColumns; ++column) {
        std::vector<std::size_t> found;
        for (std::size_t cell = 0; cell < width_; ++cell)
            if (csv_.text(cell) == kNames[column])
                found.push_back(cell);
        if (found.empty() && (column != kPath || is_path_meant()))
            refuse_header();
        if (found.size() > 1)
            fail(csv_.source(), csv_.where(found[1]),
                 fmt::format("the header has two columns \"{}\"; give the other one another name", kNames[column]));
        cells_[column] = found.empty() ? kNone : found.front();
    }
}

// Whether a column has nearly the name "path".
bool PathReader::is_path_meant() const {
    for (std::size_t cell = 0; cell < width_; ++cell)
        if (csv_.text(cell).size() > 1 &&
            !nearest(std::string(csv_.text(cell)), std::vector<std::string>{kNames[kPath]}).empty())
            return true;
    return false;
}

void PathReader::refuse_header() const {
    std::vector<std::string> there, missing;
    for (std::size_t cell = 0; cell < width_; ++cell)
        there.emplace_back(csv_.text(cell));
    for (const char* name : kNames)
        if (std::find(there.begin(), there.end(), name) == there.end())
            missing.emplace_back(name);
    std::string hint = width_ == 1 ? separator_hint(there.front()) : "";
    // Every name of one letter is near to every other; only another case is a hint.
    for (const std::string& name : there)
        for (const std::string& wanted : missing)
            if (hint.empty() && (name.size() > 1 || std::tolower(static_cast<unsigned char>(name[0])) == wanted[0]))
                if (!nearest(name, std::vector{wanted}).empty())
                    hint = fmt::format("; {} there is meant to be \"{}\"?", shown(name), wanted);
    std::string header = fmt::format("{}", fmt::join(there, ","));
    fail(csv_.source(), csv_.where(0),
         fmt::format("the header lacks {} \"{}\": got {}{}; expected path,t,x,y,z in any order (s, m), of a single "
                     "path t,x,y,z",
                     missing.size() > 1 ? "columns" : "column", fmt::join(missing, "\", \""), shown(header), hint));
}

void PathReader::read(std::vector<PathSample>& samples, std::size_t most) {
    samples.clear();
    while (samples.size() < most && csv_.next()) {
        check_width();
        samples.push_back(
            {path_id(), number(kTime), {coordinate(kX), coordinate(kY), coordinate(kZ)}, csv_.where(0).line});
    }
    any_ = any_ || !samples.empty();
    if (!any_)
        fail(csv_.source(), {}, "there is no sample below the header; write a row for each");
}

void PathReader::check_width() const {
    if (csv_.size() == width_)
        return;
    const Location where = csv_.size() > width_ ? csv_.where(width_) : csv_.end();
    fail(csv_.source(), where,
         fmt::format("{} in this row, the header has {}{}", numbers::counted(csv_.size(), "cell"), width_,
                     csv_.ends_open()       ? "; the file ends here without a line feed: was it cut off?"
                     : csv_.size() > width_ ? "; are there decimal commas? Use points"
                                            : ""));
}

void PathReader::refuse(Column column, const std::string& message) const {
    fail(csv_.source(), csv_.where(cells_[column]), fmt::format("{}: {}", kNames[column], message));
}

double PathReader::number(Column column) const {
    std::string_view text = csv_.text(cells_[column]);
    if (text.empty())
        refuse(column, fmt::format("the cell is empty; expected {}", kWanted[column]));
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        text.remove_prefix(1); // std::from_chars knows no plus sign
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = end == text.data() + text.size();
    if (error == std::errc::result_out_of_range && whole)
        refuse(column, fmt::format("{} is beyond double precision: 0, or sizes from 4.9e-324 to 1.8e308", shown(text)));
    if (error != std::errc() || !whole)
        refuse(column, fmt::format("{} is not a number; expected {}", shown(text), kWanted[column]));
    if (!std::isfinite(value))
        refuse(column, fmt::format("{} is not finite; expected {}", shown(text), kWanted[column]));
    return value;
}

double PathReader::coordinate(Column column) const {
    const double value = number(column);
    if (std::abs(value) > largest_coordinate_)
        refuse(column, fmt::format("{} m is too far away for this scene and precision: at most {:.3g} m", value,
                                   largest_coordinate_));
    return value;
}

// Also as a floating point number, since that is how some programs write every column.
std::uint64_t PathReader::path_id() const {
    if (cells_[kPath] == kNone)
        return 0;
    const std::string_view text = csv_.text(cells_[kPath]);
    if (const auto id = number_in<std::uint64_t>(text))
        return *id;
    const double value = number(kPath);
    if (value < 0)
        refuse(kPath, fmt::format("{} is negative; expected {}", shown(text), kWanted[kPath]));
    if (value != std::floor(value))
        refuse(kPath, fmt::format("{} is not whole; expected {}", shown(text), kWanted[kPath]));
    if (value > kLargestWhole)
        refuse(kPath, fmt::format("{} is too large; expected {}", shown(text), kWanted[kPath]));
    return static_cast<std::uint64_t>(value);
}

void StepScale::begin(const glm::dvec3& place) {
    const glm::dvec3 from = place - origin_;
    farthest_ = std::max({farthest_, std::abs(from.x), std::abs(from.y), std::abs(from.z)});
}

void StepScale::add(const glm::dvec3& place, const glm::dvec3& before) {
    begin(place);
    const glm::dvec3 step = place - before;
    const double square = step.x * step.x + step.y * step.y + step.z * step.z;
    if (square > 0 && std::isfinite(square))
        ++steps_[static_cast<std::size_t>(std::ilogb(square) - kLeast)];
}

double StepScale::median_step() const {
    const std::uint64_t all = std::accumulate(steps_.begin(), steps_.end(), std::uint64_t(0));
    std::uint64_t before = 0;
    for (std::size_t i = 0; i < kExponents; ++i)
        if (before += steps_[i]; 2 * before > all)
            return std::exp2((static_cast<int>(i) + kLeast + 0.5) / 2);
    return 0;
}

namespace {

constexpr double kTolerance = 0.01; // of the period

} // namespace

std::size_t PathCensus::add(const PathSample& sample) {
    if (ids_.empty() || ids_[last_] != sample.path) { // most samples go on with the same path
        const auto [known, added] = numbers_.try_emplace(sample.path, ids_.size());
        last_ = known->second;
        if (added) {
            ids_.push_back(sample.path);
            times_.push_back(sample.time);
            places_.push_back(sample.probe);
            scale_.begin(sample.probe);
            return last_;
        }
        if (!first_return_)
            first_return_ = sample.line;
    }
    check_time(sample, times_[last_]);
    times_[last_] = sample.time;
    scale_.add(sample.probe, places_[last_]);
    places_[last_] = sample.probe;
    return last_;
}

void PathCensus::check_time(const PathSample& sample, double before) const {
    const double passed = sample.time - before;
    if (!(passed > 0))
        fail(source_, {sample.line, 1},
             fmt::format("t: {} s comes after {} s on path {}: times of a path must increase", sample.time, before,
                         sample.path));
    if (period_ > 0 && !(std::abs(passed - period_) <= kTolerance * period_))
        fail(source_, {sample.line, 1},
             fmt::format("t: {} s is {:.4g} s after the sample before it on path {}; a hand moves the probe in steps "
                         "of {:.4g} s (paths.rate): give that rate, or resample",
                         sample.time, passed, sample.path, period_));
}

} // namespace forceshade

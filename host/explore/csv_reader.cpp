#include "host/explore/csv_reader.h"

#include <fmt/format.h>

namespace forceshade {
namespace {

constexpr std::size_t kBuffer = std::size_t(1) << 18;     // bytes
constexpr std::size_t kMostRecord = std::size_t(1) << 20; // bytes: no row of numbers comes near

bool is_blank(int c) {
    return c == ' ' || c == '\t';
}

} // namespace

CsvReader::CsvReader(const std::filesystem::path& path) : file_(path), source_(path.string()), buffer_(kBuffer) {
    refill();
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
    filled_ = file_.read_some(offset_, buffer_);
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
        fail(source_, here_, "text after a closing quote; a comma or the end of the line is wanted");
}

} // namespace forceshade

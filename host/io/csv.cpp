#include "host/io/csv.h"

#include <fmt/core.h>

namespace forceshade {

void CsvText::separate() {
    if (!first_)
        text_ += ',';
    first_ = false;
}

CsvText& CsvText::add(std::string_view text) {
    separate();
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
        text_ += text;
        return *this;
    }
    text_ += '"';
    for (const char c : text) {
        if (c == '"')
            text_ += '"';
        text_ += c;
    }
    text_ += '"';
    return *this;
}

CsvText& CsvText::add(double value) {
    separate();
    text_ += fmt::format("{}", value);
    return *this;
}

CsvText& CsvText::add(float value) {
    separate();
    text_ += fmt::format("{}", value);
    return *this;
}

void CsvText::end() {
    text_ += '\n';
    first_ = true;
}

} // namespace forceshade

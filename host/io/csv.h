// Comma-separated values as RFC 4180 quotes them; numbers print so that they read back exactly, in every locale.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace forceshade {

/// One line at a time: `row.add("a,b").add(0.1); row.end();` Lines end in a single line feed.
class CsvText {
public:
    CsvText& add(std::string_view text); /* quoted where it holds a comma, a quote or a line break */
    CsvText& add(const char* text) { return add(std::string_view(text)); }
    CsvText& add(double value); /* shortest text that reads back to the same double */
    CsvText& add(float value);
    CsvText& add(std::integral auto value) { return add(std::string_view(std::to_string(value))); }
    void end();
    const std::string& text() const noexcept { return text_; }

private:
    void separate();
    std::string text_;
    bool first_ = true;
};

} // namespace forceshade

// What somebody meant who wrote a statement that is no TOML: a value without quotes, a bracket that is missing, ":" for
// "=".
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace forceshade {

/// One statement of a text and what to put there, of as many lines.
struct TomlMend {
    std::size_t begin = 0, end = 0; // of the statement, in bytes
    std::size_t at = 0;             // where it goes wrong
    std::string message;            // what is wrong and what to write instead
    std::string text;               // the statement as it was meant, or blank
    bool left_out = false;          // it is blank although something was meant
};

/// Mends the statement that ends the parser's way: `at` and `complaint` are where it gave up and what it says. `parses`
/// tells whether a text is TOML by itself.
TomlMend mend_toml(std::string_view text, std::size_t at, std::string_view complaint,
                   const std::function<bool(const std::string&)>& parses);

/// Behind the last quote of the quoted text that begins at `at`, or where it breaks off.
std::size_t end_of_quoted(std::string_view text, std::size_t at);

} // namespace forceshade

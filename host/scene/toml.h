// TOML text to a plain tree in file order, each node with its location, and errors of a configuration: where each
// stands, and all of a file told together. The TOML library is known to toml.cpp alone.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {

/// Counted from 1, in characters. Line 0: no place in a file, but a default or, with column 1, an override.
struct Location {
    std::uint32_t line = 0;
    std::uint32_t column = 0;
    bool is_default() const { return *this == Location{}; }
    friend auto operator<=>(const Location&, const Location&) = default;
};

/// `bump.toml:12:5: `, or `bump.toml: ` for line 0.
std::string location_prefix(std::string_view source, Location location);

/// The most errors of a file that are told.
inline constexpr std::size_t kMostErrors = 20;
/// So many that looking for more helps nobody.
inline constexpr std::size_t kEnoughErrors = 1000;

/// One error of a file, or several. Its text has a line for each, in the order of the file, and says how many they are.
class FileError : public UsageError {
public:
    struct One {
        Location where;
        std::string source, message;
        friend auto operator<=>(const One&, const One&) = default;
    };
    /// `all` is not empty; each error counts once.
    explicit FileError(std::vector<One> all);
    const std::vector<One>& all() const { return all_; }

private:
    std::vector<One> all_;
};

/// Throws FileError `bump.toml:12:5: message`.
[[noreturn]] void fail(std::string_view source, Location location, const std::string& message);
template <typename Part, typename... Parts>
[[noreturn]] void fail(std::string_view source, Location location, fmt::format_string<Part, Parts...> message,
                       Part&& part, Parts&&... parts) {
    fail(source, location, fmt::format(message, std::forward<Part>(part), std::forward<Parts>(parts)...));
}

/// Keeps what several calls throw, to throw it as one.
class Errors {
public:
    /// False if the call threw a FileError, which is kept.
    template <typename Call> bool attempt(Call&& call) {
        try {
            std::forward<Call>(call)();
            return true;
        } catch (const FileError& error) {
            add(error);
            return false;
        }
    }
    void add(const FileError& error) { all_.insert(all_.end(), error.all().begin(), error.all().end()); }
    bool none() const { return all_.empty(); }
    bool enough() const { return all_.size() >= kEnoughErrors; }
    /// Throws them, if there are any.
    void report() const {
        if (!all_.empty())
            throw FileError(all_);
    }

private:
    std::vector<FileError::One> all_;
};

inline constexpr std::size_t kLargestToml = std::size_t{16} << 20; /* bytes; a study is a page or two */

struct TomlNode {
    enum class Type { string, integer, real, boolean, date, array, table };
    Type type = Type::table;
    std::string key;    // of a member of a table
    Location key_where; // where that stands
    Location where;     // of the value
    std::string text;   // of a string
    std::int64_t integer = 0;
    double real = 0;
    bool truth = false;          // of a boolean
    std::vector<TomlNode> items; // of an array, or the members of a table in file order

    /// The member of a table; null if it has none of this key.
    const TomlNode* find(std::string_view name) const;
};

/// "a table", "a boolean", `"text"`, `0.2`: how messages name what was found.
std::string describe(const TomlNode& node);

/// Parses a whole TOML document (UTF-8, with or without a byte order mark).
/// Throws UsageError `source:line:column: message` for a syntax error, a key given twice, or text that is not UTF-8.
TomlNode parse_toml(std::string_view text, const std::string& source);

/// `text` as a TOML basic string, quotes included.
std::string toml_string(std::string_view text);

} // namespace forceshade

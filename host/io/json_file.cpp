#include "host/io/json_file.h"

#include <array>
#include <cstddef>

#include <fmt/core.h>

#include "host/io/memory_limit.h"
#include "host/io/readable_file.h"

namespace forceshade {
namespace {

constexpr std::size_t kDeepest = 32;
constexpr std::size_t kMostMembers = 1000;

// Brackets and colons outside of strings; whether they fit together, the parser finds out.
bool is_modest(std::string_view text) {
    std::array<std::size_t, kDeepest + 1> members{};
    std::size_t depth = 0;
    bool quoted = false;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (c == '"')
            quoted = !quoted;
        else if (quoted)
            at += c == '\\';
        else if ((c == '[' || c == '{') && ++depth > kDeepest)
            return false;
        else if (c == '[' || c == '{')
            members[depth] = 0;
        else if ((c == ']' || c == '}') && depth > 0)
            --depth;
        else if (c == ':' && ++members[depth] > kMostMembers)
            return false;
    }
    return true;
}

} // namespace

Json parse_json(std::string_view text) {
    return is_modest(text) ? Json::parse(text, nullptr, false) : Json(Json::value_t::discarded);
}

Json read_json(const std::filesystem::path& path) {
    constexpr double kExpansion = 8; // of the program's own files: bytes in memory for a byte of text
    const auto size = static_cast<double>(ReadableFile(path).size());
    require_memory(path, fmt::format("JSON of {} bytes", size), size * kExpansion);
    return parse_json(read_file(path));
}

} // namespace forceshade

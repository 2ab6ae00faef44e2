#include "host/output/json.h"

#include <array>
#include <limits>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "host/output/files.h"

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

namespace {

std::uint64_t whole_number(const Json& json, std::uint64_t most) {
    const bool whole = json.is_number_unsigned() || (json.is_number_integer() && json.get<std::int64_t>() >= 0);
    if (!whole || json.get<std::uint64_t>() > most)
        throw Json::type_error::create(302, fmt::format("must be a whole number from 0 to {}", most), &json);
    return json.get<std::uint64_t>();
}

} // namespace

void read_whole(const Json& json, std::uint64_t& value) {
    value = whole_number(json, std::numeric_limits<std::uint64_t>::max());
}

void read_whole(const Json& json, unsigned& value) {
    value = static_cast<unsigned>(whole_number(json, std::numeric_limits<unsigned>::max()));
}

void read_whole(const Json& json, std::array<std::uint64_t, 3>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        read_whole(json.at(i), values[i]);
}

void to_json(Json& json, const FileRecord& file) {
    json = {{"name", file.name}, {"sha256", file.sha256}, {"bytes", file.bytes}};
}

void from_json(const Json& json, FileRecord& file) {
    file.name = json.at("name");
    file.sha256 = json.at("sha256");
    read_whole(json.at("bytes"), file.bytes);
}

} // namespace forceshade

// JSON that anybody may have written: refused where reading it, or what is done with it then, would take memory, stack
// or time out of proportion.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace forceshade {

struct FileRecord;

using Json = nlohmann::ordered_json;

/// What stands in the text; is_discarded() if that is no JSON, is nested more than 32 deep or has an object of more
/// than 1000 members: the program's own files have none such. The library copies, writes and compares a level a call,
/// and looks for each new member among all before it.
Json parse_json(std::string_view text);

/// Of a whole file. \throws IoError if it cannot be read or is no regular file, UsageError if it is too large for the
/// memory that is allowed (require_memory).
Json read_json(const std::filesystem::path& path);

/// Reads a whole number from 0 on. Json itself converts any number, however large. \throws Json::exception for a number
/// that is negative, too large for the type or no integer, and for anything else
void read_whole(const Json& json, std::uint64_t& value);
void read_whole(const Json& json, unsigned& value);
void read_whole(const Json& json, std::array<std::uint64_t, 3>& values);

/// A file as accounts name it.
void to_json(Json& json, const FileRecord& file);
void from_json(const Json& json, FileRecord& file);

template <typename T>
concept Whole = requires(const Json& json, T& value) {
    read_whole(json, value);
};

} // namespace forceshade

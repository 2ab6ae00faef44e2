// JSON that anybody may have written: refused where reading it, or what is done with it then, would take memory, stack
// or time out of proportion.
#pragma once

#include <filesystem>
#include <string_view>

#include <nlohmann/json.hpp>

namespace forceshade {

using Json = nlohmann::ordered_json;

/// What stands in the text; is_discarded() if that is no JSON, is nested more than 32 deep or has an object of more
/// than 1000 members: the program's own files have none such. The library copies, writes and compares a level a call,
/// and looks for each new member among all before it.
Json parse_json(std::string_view text);

/// Of a whole file. \throws IoError if it cannot be read or is no regular file, UsageError if it is too large for the
/// memory that is allowed (host/io/memory_limit.h).
Json read_json(const std::filesystem::path& path);

} // namespace forceshade

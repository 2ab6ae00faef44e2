// The schema as JSON, for editors and other programs.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace forceshade {

struct Key;

/// {"keys": [{"key", "type", "default", ...}]}; and the row of one key.
nlohmann::ordered_json schema_json();
nlohmann::ordered_json schema_row(const Key& key);

} // namespace forceshade

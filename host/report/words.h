// Text, links and data as markup. Everything that comes from a file is escaped here.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "host/numbers.h"

namespace forceshade::report {

using namespace numbers;

/// Text as it stands in HTML; bytes that are not UTF-8 and characters that HTML may not have are replaced.
std::string escaped(std::string_view text);

/// JSON within a <script>: its text cannot end the element.
std::string script_text(const nlohmann::ordered_json& json);

/// A path below the report's folder as a relative address, without another scheme, host or query.
std::string address(std::string_view path);

/// Bytes within text.
std::string base64(std::string_view bytes);

/// <a href="address">text</a>
std::string link(std::string_view path, std::string_view text);

} // namespace forceshade::report

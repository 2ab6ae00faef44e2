// Numbers, links and files as the page words them. Everything that comes from a file is escaped here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace forceshade::report {

/// Text as it stands in HTML; bytes that are not UTF-8 and characters that HTML may not have are replaced.
std::string escaped(std::string_view text);

/// A number with `digits` significant digits: "−12.5", "3.2×10⁻⁷".
std::string number_text(double value, int digits);

/// JSON within a <script>: its text cannot end the element.
std::string script_text(const nlohmann::ordered_json& json);

/// "12 345 678", with spaces that do not break.
std::string count_text(std::uint64_t count);

/// "1 min 5 s", "3.2 s".
std::string duration_text(double seconds);

/// "3.1 MiB"
std::string size_text(std::uint64_t bytes);

/// A path below the report's folder as a relative address, without another scheme, host or query.
std::string address(std::string_view path);

/// Bytes within text.
std::string base64(std::string_view bytes);

/// <a href="address">text</a>
std::string link(std::string_view path, std::string_view text);

} // namespace forceshade::report

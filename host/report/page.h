// report.html around its parts: styles, the viewer's script, and a policy that lets nothing else run or load.
#pragma once

#include <filesystem>
#include <string>

namespace forceshade::report {

/// `body` is markup.
std::string page(const std::string& title, const std::string& body);

/// True for a file that begins as such a page does.
bool is_page(const std::filesystem::path& path);

} // namespace forceshade::report

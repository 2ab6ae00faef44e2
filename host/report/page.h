// report.html around its parts: styles, the viewer's script, and a policy that lets nothing else run or load.
#pragma once

#include <filesystem>
#include <string>

namespace forceshade::report {

/// The scripts of a page: `in_space` those that draw in 3D, too.
std::string page_script(bool in_space);

/// `body` is markup.
std::string page(const std::string& title, const std::string& body, const std::string& script);

/// True for a file that begins as such a page does.
bool is_page(const std::filesystem::path& path);

} // namespace forceshade::report

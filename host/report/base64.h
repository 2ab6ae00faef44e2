// Bytes within text.
#pragma once

#include <string>
#include <string_view>

namespace forceshade::report {

std::string base64(std::string_view bytes);

} // namespace forceshade::report

// Text of unknown origin inside XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace forceshade::plot {

/// Safe as text and within quotes: & < > " ' are escaped; what is no UTF-8 or no character of XML becomes U+FFFD.
std::string escaped(std::string_view text);

} // namespace forceshade::plot

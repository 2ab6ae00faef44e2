// Text for the person at the terminal, on stderr.
#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace forceshade {

/// Formats a text onto stderr. A stderr that takes nothing (closed, or a log on a full disk) stops no work.
template <typename... Arguments> void remark(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace forceshade

// Names of files as accounts tell them, which may be anybody's.
#pragma once

#include <string>

namespace forceshade {

/// True for the name of a file right in its folder; another is foreign and not followed.
inline bool is_plain_name(const std::string& name) {
    return !name.empty() && name.front() != '.' && name.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
}

} // namespace forceshade

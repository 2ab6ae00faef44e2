// A file as accounts name it.
#pragma once

#include <cstdint>
#include <string>

namespace forceshade {

struct FileRecord {
    std::string name; /* in its folder */
    std::string sha256;
    std::uint64_t bytes = 0;
};

} // namespace forceshade

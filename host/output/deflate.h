// What compresses the blocks of EXR files.
#pragma once

#include <string>

namespace forceshade {

/// Library and version, which decide a file's bytes: "libdeflate 1.14".
std::string deflate_name();

} // namespace forceshade

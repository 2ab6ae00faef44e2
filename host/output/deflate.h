// What compresses the blocks of EXR, VTI and VTP files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace forceshade {

/// Library and version, which decide a file's bytes: "libdeflate 1.14".
std::string deflate_name();

/// In zlib's format. The same bytes on every machine. \throws std::bad_alloc, std::runtime_error if what was packed is
/// not what comes out again.
void deflate(std::span<const std::byte> from, std::vector<std::byte>& to);

} // namespace forceshade

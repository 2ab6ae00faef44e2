// A look at an EXR's header before OpenEXR sees the file: what it announces must be possible for a file of its size.
#pragma once

#include <cstdint>
#include <filesystem>

#include "host/io/readable_file.h"

namespace forceshade::exr {

/// OpenEXR allocates what a header announces; damaged headers announce gigabytes. Throws IoError naming `name` if an
/// attribute, the number of blocks or a block's size cannot be, and for deep images, which no volume or map is.
void require_plausible(const ReadableFile& file, const std::filesystem::path& name);

} // namespace forceshade::exr

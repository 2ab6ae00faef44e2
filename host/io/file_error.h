// What the operating system said about a file, as an error that names the file, the reason and what to do.
#pragma once

#include <filesystem>

#include "host/error.h"

namespace forceshade {

/// `cannot write results/a.exr: No space left on device; free space there or choose another folder`.
/// `verb` is "write" or "read" (it decides the advice), `number` an errno. English in every locale.
IoError file_error(const char* verb, const std::filesystem::path& path, int number);

} // namespace forceshade

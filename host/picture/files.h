// Pictures in files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/picture/picture.h"

namespace forceshade::picture {

/// Which of the files of a picture are wanted.
struct Endings {
    bool png = false, svg = false, pdf = false;
    bool any() const { return png || svg || pdf; }
    /// False if `name` is none of them.
    bool add(std::string_view name);
};

/// "STEM.png" and so on.
std::vector<std::string> names_with(const std::string& stem, const Endings& endings);

/// Writes them, each whole or not at all. \throws IoError.
std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture);

} // namespace forceshade::picture

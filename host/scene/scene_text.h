// The text of a scene or study, of a file or of standard input.
#pragma once

#include <filesystem>
#include <string>

namespace forceshade {

struct SceneText {
    std::string text;
    std::string source;           // what errors call it
    std::filesystem::path folder; // that names of files are relative to
};

/// Whether a path stands for standard input: "-".
bool is_standard_input(const std::filesystem::path& path);

/// Reads a whole file, or standard input, which is read once and given again when it is asked for again.
/// Throws IoError if it cannot be read, UsageError for a mesh, an image or other data, and for a text without content:
/// each says what to do instead.
SceneText read_scene_text(const std::filesystem::path& path);

} // namespace forceshade

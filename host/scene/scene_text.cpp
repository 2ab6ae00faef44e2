#include "host/scene/study.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iostream>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/scene/toml.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

/// What is no scene, by how its name ends or its content begins.
struct Foreign {
    std::string_view endings; // between blanks
    std::string_view magic;
    std::string_view what;
    std::string_view advice; // {0}: the file, {1}: its name without the ending
};

constexpr std::string_view kMeshAdvice = "a scene of it: forceshade init mesh {0} -o {1}.toml";
constexpr std::string_view kImageAdvice =
    "as a height map a scene names it: [surface] with kind = \"height_map\" and file = \"{0}\"";
constexpr std::string_view kTableAdvice = "as recorded paths a scene names it: [paths] with kind = \"recorded\" and "
                                          "file = \"{0}\"; or forceshade explore SCENE.toml --paths {0}";
constexpr std::string_view kOtherAdvice = "a scene to start from: forceshade init bump -o bump.toml";
constexpr Foreign kForeign[] = {{" .obj .off .stl ", "solid ", "a mesh", kMeshAdvice},
                                {" .ply ", "ply\n", "a mesh", kMeshAdvice},
                                {" .exr ", "\x76\x2f\x31\x01", "an image or a volume", kImageAdvice},
                                {" .png ", "\x89PNG", "an image", kImageAdvice},
                                {" .jpg .jpeg .bmp .tif .tiff .gif ", "\xff\xd8\xff",
                                 "an image that forceshade does not read", "as PNG or EXR it may be a height map"},
                                {" .csv ", "path,", "a table", kTableAdvice},
                                {" .npy ", "\x93NUMPY", "an array of NumPy's", kOtherAdvice},
                                {" .json .html .vti .vtp .svg .pdf ", "%PDF", "a result", kOtherAdvice},
                                {" .gz .zip .xz ", "\x1f\x8b", "an archive", kOtherAdvice}};

void refuse_foreign(const std::filesystem::path& path, std::string_view text) {
    const std::string ending = fmt::format(" {} ", lower_case(path.extension().string()));
    for (const Foreign& one : kForeign)
        if (one.endings.find(ending) != one.endings.npos || text.starts_with(one.magic))
            throw UsageError("{} is {}, not a scene; {}", path.string(), one.what,
                             fmt::format(fmt::runtime(one.advice), path.string(), path.stem().string()));
}

// Comments alone are no content.
bool has_content(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark))
        text.remove_prefix(kMark.size());
    for (std::size_t at = 0; at < text.size();) {
        at = text.find_first_not_of(" \t\r\n", at);
        if (at == text.npos)
            return false;
        if (text[at] != '#')
            return true;
        at = std::min(text.find('\n', at), text.size());
    }
    return false;
}

[[noreturn]] void refuse_folder(const std::filesystem::path& path) {
    std::vector<std::string> scenes;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error))
        if (entry->path().extension() == ".toml")
            scenes.push_back(entry->path().filename().string());
    std::ranges::sort(scenes);
    constexpr std::size_t kShown = 5;
    const bool more = scenes.size() > kShown;
    scenes.resize(std::min(scenes.size(), kShown));
    throw IoError("cannot read {}: it is a folder, not a TOML file{}{}{}", path.string(),
                  scenes.empty() ? "" : "; in it: ", fmt::join(scenes, ", "), more ? ", ..." : "");
}

// Not to the end of what has none, as /dev/zero: parse_toml says that it is too much.
std::string read_all(std::istream& file) {
    std::string text, piece(std::size_t{1} << 16, '\0');
    while (text.size() <= kLargestToml && (file.read(piece.data(), std::ssize(piece)) || file.gcount() > 0))
        text.append(piece, 0, static_cast<std::size_t>(file.gcount()));
    return text;
}

std::string read_text(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        refuse_folder(path);
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::string text = read_all(file);
    if (!file.is_open() || file.bad())
        throw IoError("cannot read {}: {}{}", path.string(), std::generic_category().message(errno),
                      errno == ENOENT ? missing_file_advice(path) : "");
    return text;
}

const std::string& standard_input() {
    static const std::string text = read_all(std::cin);
    return text;
}

} // namespace

bool is_standard_input(const std::filesystem::path& path) {
    return path == "-";
}

SceneText read_scene_text(const std::filesystem::path& path) {
    SceneText read = is_standard_input(path) ? SceneText{standard_input(), "<stdin>", {}}
                                             : SceneText{read_text(path), path.string(), path.parent_path()};
    refuse_foreign(read.source, read.text);
    if (!has_content(read.text))
        throw UsageError(
            "{} has no [surface], nor anything else; a scene to start from: forceshade init bump -o bump.toml",
            read.source);
    return read;
}

} // namespace forceshade

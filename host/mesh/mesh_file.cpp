#include "host/mesh/mesh_file.h"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/formats.h"
#include "host/output/files.h"
#include "host/output/reading.h"

namespace forceshade {

namespace {

using mesh_file::Source;

enum class Format { obj, off, ply, stl, unknown };

constexpr std::array<std::string_view, 4> kNames{"OBJ", "OFF", "PLY", "STL"};
constexpr std::array<std::string_view, 4> kExtensions{".obj", ".off", ".ply", ".stl"};

std::string lower_case(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

Format format_of_extension(const std::filesystem::path& path) {
    const std::string extension = lower_case(path.extension().string());
    for (std::size_t i = 0; i < kExtensions.size(); ++i)
        if (extension == kExtensions[i])
            return static_cast<Format>(i);
    return Format::unknown;
}

// What the bytes look like from their beginning.
Format format_of_contents(std::string_view bytes) {
    if (mesh_file::is_binary_stl(bytes))
        return Format::stl;
    mesh_file::TextLines lines("", bytes.substr(0, 65536));
    std::string_view line;
    if (!lines.next_words(line))
        return Format::unknown;
    const std::string_view word = mesh_file::take_word(line);
    if (word == "ply")
        return Format::ply;
    if (word.size() <= 8 && word.ends_with("OFF"))
        return Format::off;
    if (lower_case(std::string(word.substr(0, 5))) == "solid")
        return Format::stl;
    for (const std::string_view keyword : {"v", "vt", "vn", "f", "o", "g", "mtllib", "usemtl", "s"})
        if (word == keyword)
            return Format::obj;
    return Format::unknown;
}

void refuse_wrong_extension(const std::string& name, Format extension, Format contents) {
    const auto named = [](Format format) { return kNames[static_cast<std::size_t>(format)]; };
    const std::string looks = contents == Format::unknown ? "its contents look like none of them"
                                                          : fmt::format("its contents look like {}", named(contents));
    if (extension == Format::unknown)
        throw UsageError(fmt::format("{}: a mesh is read from a file with the extension {}; {}", name,
                                     fmt::join(kExtensions, ", "), looks));
    if (contents != Format::unknown && contents != extension)
        throw UsageError(fmt::format("{}: the extension says {}, but {}; rename it to {}", name, named(extension),
                                     looks, kExtensions[static_cast<std::size_t>(contents)]));
}

void refuse_what_is_not_finite(const std::string& name, const PolygonSoup& polygons) {
    for (std::size_t i = 0; i < polygons.vertices.size(); ++i) {
        const glm::dvec3& vertex = polygons.vertices[i];
        if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z))
            throw UsageError(fmt::format("{}: vertex {} of {} (counted from 1) is ({}, {}, {}); every coordinate must "
                                         "be a finite number",
                                         name, i + 1, polygons.vertices.size(), vertex.x, vertex.y, vertex.z));
    }
}

PolygonFile read(const Source& source, Format format) {
    PolygonFile file;
    file.format = kNames[static_cast<std::size_t>(format)];
    switch (format) {
    case Format::obj:
        file.polygons = mesh_file::read_obj(source);
        break;
    case Format::off:
        file.polygons = mesh_file::read_off(source);
        break;
    case Format::ply:
        file.format = mesh_file::ply_flavour(source);
        file.polygons = mesh_file::read_ply(source);
        break;
    default:
        file.format += mesh_file::is_binary_stl(source.bytes) ? " (binary)" : " (text)";
        file.polygons = mesh_file::read_stl(source);
    }
    return file;
}

} // namespace

PolygonFile read_polygons(const std::filesystem::path& path) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;
    if (const std::uint64_t size = ReadableFile(path).size(); size > kMostBytes)
        throw IoError(fmt::format("{}: {} bytes; a mesh is read from a file of up to 4 GiB", path.string(), size));
    return parse_polygons(path, read_file(path));
}

PolygonFile parse_polygons(const std::filesystem::path& path, std::string_view bytes) {
    const std::string name = path.string();
    if (bytes.empty())
        throw IoError(fmt::format("{}: the file is empty", name));
    const Format format = format_of_extension(path);
    refuse_wrong_extension(name, format, format_of_contents(bytes));
    PolygonFile file = read({name, bytes}, format);
    refuse_what_is_not_finite(name, file.polygons);
    file.sha256 = sha256_of(bytes);
    return file;
}

} // namespace forceshade

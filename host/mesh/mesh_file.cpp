#include "host/mesh/mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <optional>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/mesh/formats.h"
#include "host/mesh/places.h"
#include "host/output/files.h"
#include "host/output/reading.h"

namespace forceshade {

namespace {

using mesh_file::Source;

struct Format {
    std::string_view name, extension;
    PolygonFile (*read)(const Source&);
};

constexpr std::array<Format, 4> kFormats{{{"OBJ", ".obj", mesh_file::read_obj},
                                          {"OFF", ".off", mesh_file::read_off},
                                          {"PLY", ".ply", mesh_file::read_ply},
                                          {"STL", ".stl", mesh_file::read_stl}}};

// The format that the first bytes suggest; null if none.
const Format* format_of_contents(std::string_view bytes) {
    const auto& [obj, off, ply, stl] = kFormats;
    const std::optional<std::size_t> behind = mesh_file::bytes_behind_binary_stl(bytes);
    mesh_file::TextLines lines("", bytes.substr(0, 65536));
    std::string_view line;
    const std::string_view word = lines.next_words(line) ? mesh_file::take_word(line) : std::string_view();
    if (word == "ply" && behind != 0) // a binary PLY file may by chance have a small number where STL has its count
        return &ply;
    if (behind)
        return &stl;
    if (!mesh_file::looks_like_text(bytes))
        return nullptr;
    if (mesh_file::parse_off_keyword(word))
        return &off;
    if (mesh_file::is_keyword(word.substr(0, 5), "solid"))
        return &stl;
    for (const std::string_view keyword : {"v", "vt", "vn", "f", "o", "g", "mtllib", "usemtl", "s"})
        if (word == keyword)
            return &obj;
    return nullptr;
}

const Format& format_of(const std::string& name, const std::filesystem::path& path, std::string_view bytes) {
    const std::string extension = path.extension().string();
    const auto named = std::ranges::find_if(
        kFormats, [&](const Format& format) { return mesh_file::is_keyword(extension, format.extension); });
    const Format* contents = format_of_contents(bytes);
    const std::string looks =
        contents ? fmt::format("its contents look like {}", contents->name) : "its contents look like none of them";
    if (named == kFormats.end())
        throw UsageError(
            fmt::format("{}: a mesh is read from a file with the extension .obj, .off, .ply, .stl; {}", name, looks));
    if (contents && contents != named)
        throw UsageError(fmt::format("{}: the extension says {}, but {}; rename it to {}", name, named->name, looks,
                                     contents->extension));
    return *named;
}

void refuse_what_is_not_finite(const std::string& name, const PolygonSoup& polygons) {
    for (std::size_t i = 0; i < polygons.vertices.size(); ++i) {
        const glm::dvec3& vertex = polygons.vertices[i];
        if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z))
            throw UsageError(fmt::format(
                "{}: vertex {} of {} (counted from 1) is ({}, {}, {}); every coordinate must be a finite number", name,
                i + 1, polygons.vertices.size(), vertex.x, vertex.y, vertex.z));
    }
}

void require_normals(const std::string& name, const PolygonSoup& polygons) {
    if (polygons.normals.empty())
        throw UsageError(fmt::format("{}: has no vertex normals; normals = \"file\" is for an OBJ file with vn and "
                                     "corners such as 7//3, or a PLY file with nx, ny and nz: take \"plain\" or "
                                     "\"angle\", which follow from the facets",
                                     name));
    for (std::size_t i = 0; i < polygons.corners.size(); ++i) {
        const glm::dvec3 &normal = polygons.normals[i], &place = polygons.vertices[polygons.corners[i]];
        if (normal == glm::dvec3(0) || !std::isfinite(normal.x + normal.y + normal.z))
            throw UsageError(fmt::format("{}: the vertex at ({}, {}, {}) has the normal ({}, {}, {}), which is not "
                                         "a direction",
                                         name, place.x, place.y, place.z, normal.x, normal.y, normal.z));
    }
}

} // namespace

PolygonFile read_polygons(const std::filesystem::path& path, bool normals) {
    const Stage stage("reading " + path.filename().string());
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;
    if (const std::uint64_t size = ReadableFile(path).size(); size > kMostBytes)
        throw IoError(fmt::format("{}: {} bytes; a mesh is read from a file of up to 4 GiB", path.string(), size));
    return parse_polygons(path, read_file(path), normals);
}

namespace {

/// Steps after reading, for every format.
void finish(const std::string& name, bool normals, PolygonFile& file) {
    refuse_what_is_not_finite(name, file.polygons);
    if (normals)
        require_normals(name, file.polygons);
    file.joined_vertices = join_vertices(file.polygons).vertices;
}

} // namespace

PolygonFile parse_polygons(const std::filesystem::path& path, std::string_view bytes, bool normals) {
    const std::string name = path.string();
    if (bytes.empty())
        throw IoError(fmt::format("{}: the file is empty", name));
    std::future<std::string> sha256 = std::async(std::launch::async, [bytes] { return sha256_of(bytes); });
    PolygonFile file = format_of(name, path, bytes).read({name, bytes, normals});
    finish(name, normals, file);
    if (file.format.starts_with("STL"))
        file.joined_vertices = 0; // it has no vertices of its own
    file.sha256 = sha256.get();
    return file;
}

PolygonFile polygons_of(const std::string& name, std::vector<glm::dvec3> vertices,
                        std::span<const std::int64_t> corners, std::span<const std::size_t> counts, bool normals) {
    PolygonFile file;
    file.format = "arrays";
    std::string bytes;
    const auto add = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
    add(vertices.data(), vertices.size() * sizeof(glm::dvec3));
    add(corners.data(), corners.size_bytes());
    add(counts.data(), counts.size_bytes());
    file.sha256 = sha256_of(bytes);
    file.polygons.vertices = std::move(vertices);
    mesh_file::Skipped skipped("at facet");
    for (std::size_t facet = 0, first = 0; facet < counts.size(); first += counts[facet++]) {
        const std::span<const std::int64_t> outline = corners.subspan(first, counts[facet]);
        for (const std::int64_t corner : outline) {
            if (corner < 0 || static_cast<std::size_t>(corner) >= file.polygons.vertices.size())
                throw UsageError(fmt::format("{}: facet {} has the vertex {}; vertices are counted from 0, and there "
                                             "are {}",
                                             name, facet, corner, file.polygons.vertices.size()));
            if (outline.size() >= 3)
                file.polygons.corners.push_back(static_cast<std::uint32_t>(corner));
        }
        if (outline.size() >= 3)
            file.polygons.end_facet();
        else
            skipped.add(mesh_file::kShortFaces[outline.size()], facet);
    }
    file.warnings = skipped.warnings();
    finish(name, normals, file);
    return file;
}

} // namespace forceshade

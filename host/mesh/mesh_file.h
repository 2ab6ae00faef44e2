// Polygons from OBJ, OFF, PLY and STL files, every coordinate as the double that is nearest to what the file says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

struct PolygonFile {
    PolygonSoup polygons;                   /* in the file's unit; vertices at one place (0 being -0) are one */
    std::string sha256;                     /* of the file's bytes, 64 hex digits */
    std::string format;                     /* "OBJ", "OFF", "PLY (binary, little endian)", ... */
    std::vector<std::string> warnings = {}; /* what was skipped: "3 edges: skipped (the first in line 7)" */
    std::size_t joined_vertices = 0;        /* that the file gives again at the place of an earlier one */
};

/// Reads OBJ, OFF, PLY (text, and binary of both byte orders) or STL (text or binary) of up to 4 GiB. Facets keep their
/// corners and their order, vertices theirs, one for each place (places.h). Colours and everything else are left out,
/// normals unless `normals` asks for those of the corners (vn of an OBJ, nx, ny, nz of a PLY's vertices). Triangle
/// strips of a PLY become triangles. No file is repaired, and what is missing is an error: where a file breaks off,
/// announces more than it can hold or holds more numbers than it announces, it is refused. All but facets (faces of
/// fewer than three corners, edges, lines, points, text, bytes behind the last facet of an STL) is skipped, with a
/// warning.
/// \throws IoError a missing, unreadable, empty, truncated or damaged file, with file:line where it is text
/// \throws UsageError an extension that is none of the four or not that of the contents, a coordinate that is not
///         finite (with its vertex), a flavour of a format that is not read (binary OFF), normals that are asked for
///         and are not there, or 0
PolygonFile read_polygons(const std::filesystem::path& path, bool normals = false);

/// The same from the bytes of a file whose name is `path`.
PolygonFile parse_polygons(const std::filesystem::path& path, std::string_view bytes, bool normals = false);

/// The same from a program's arrays, whose name in messages is `name`: the first counts[0] of the corners, numbers of
/// vertices from 0 on, are the first facet, and so on. The SHA-256 is of the arrays.
/// \throws UsageError as above, and for a corner that is not a vertex
PolygonFile polygons_of(const std::string& name, std::vector<glm::dvec3> vertices,
                        std::span<const std::int64_t> corners, std::span<const std::size_t> counts,
                        bool normals = false);

} // namespace forceshade

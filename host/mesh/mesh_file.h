// Polygons from OBJ, OFF, PLY and STL files, every coordinate as the double that is nearest to what the file says.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "host/mesh/mesh.h"

namespace forceshade {

struct PolygonFile {
    PolygonSoup polygons;            /* in the file's unit; vertices at one place (0 being -0) are one */
    std::string sha256;              /* of the file's bytes, 64 hex digits */
    std::string format;              /* "OBJ", "OFF", "PLY (binary, little endian)", ... */
    std::size_t joined_vertices = 0; /* that the file gives again at the place of an earlier one */
};

/// Reads OBJ, OFF, PLY (text, and binary of both byte orders) or STL (text or binary) of up to 4 GiB. Facets keep their
/// corners and their order, vertices theirs, one for each place (places.h). Colours and everything else are left out,
/// normals unless `normals` asks for those of the corners (vn of an OBJ, nx, ny, nz of a PLY's vertices). Nothing is
/// repaired and nothing dropped: where a file breaks off, announces more than it can hold or holds more than it
/// announces, it is refused.
/// \throws IoError a missing, unreadable, empty, truncated or damaged file, with file:line where it is text
/// \throws UsageError an extension that is none of the four or not that of the contents, a coordinate that is not
///         finite (with its vertex), a flavour of a format that is not read (binary OFF, triangle strips), normals
///         that are asked for and are not there, or 0
PolygonFile read_polygons(const std::filesystem::path& path, bool normals = false);

/// The same from the bytes of a file whose name is `path`.
PolygonFile parse_polygons(const std::filesystem::path& path, std::string_view bytes, bool normals = false);

} // namespace forceshade

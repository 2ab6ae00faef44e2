// The same polygons as files of every format, written for tests.
#pragma once

#include <string>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade::testing {

std::string as_obj(const PolygonSoup& polygons);
std::string as_off(const PolygonSoup& polygons);
std::string as_ply_text(const PolygonSoup& polygons);
/// Vertices of doubles (or floats), lists of int with a length of uchar (or int).
std::string as_ply_binary(const PolygonSoup& polygons, bool big_endian, bool floats = false, bool long_lists = false);
/// Triangles only.
std::string as_stl_text(const PolygonSoup& polygons);
std::string as_stl_binary(const PolygonSoup& polygons);

struct WrittenFile {
    std::string extension, bytes;
};

/// One of each of the above; polygons must be triangles.
std::vector<WrittenFile> all_formats(const PolygonSoup& triangles);

/// A tetrahedron whose coordinates need all the digits of a double, or only those of a float.
PolygonSoup fine_tetrahedron(bool floats = false);

} // namespace forceshade::testing

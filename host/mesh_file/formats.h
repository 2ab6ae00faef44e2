// The readers of the formats, each from the whole file in memory.
#pragma once

#include <string>
#include <string_view>

#include "host/mesh/mesh.h"

namespace forceshade::mesh_file {

/// A file that has been read: its name for messages, and its bytes.
struct Source {
    std::string name;
    std::string_view bytes;
};

PolygonSoup read_obj(const Source& source);
PolygonSoup read_off(const Source& source);
PolygonSoup read_ply(const Source& source);
PolygonSoup read_stl(const Source& source);

/// True if the bytes have exactly the length that a binary STL file announces.
bool is_binary_stl(std::string_view bytes);

/// "PLY (text)", "PLY (binary, little endian)" or "PLY (binary, big endian)".
std::string ply_flavour(const Source& source);

} // namespace forceshade::mesh_file

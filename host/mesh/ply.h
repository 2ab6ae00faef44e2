// The header of a PLY file: which elements follow, and how each is laid out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace forceshade::mesh_file {

enum class PlyEncoding { text, little, big };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type; // of the value, or of each item of a list
    bool list = false;
    PlyType count_type = PlyType::uint8; // of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// The position of a property, or -1.
    int find(std::string_view property) const;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0; // where the data begin
    std::size_t lines = 0;
};

std::size_t size_of(PlyType type);
bool is_integer(PlyType type);

/// \throws IoError naming `file` and the line
PlyHeader read_ply_header(const std::string& file, std::string_view bytes);

} // namespace forceshade::mesh_file

// A mesh file, after a byte that says of which format: read or refused, and what is read is written and read again as
// the same, in text and in binary.
#include "host/error.h"
#include "host/mesh/mesh_file.h"
#include "tests/fuzz/meshes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

using fuzz::require;

bool same(const PolygonSoup& one, const PolygonSoup& other) {
    return one.vertices == other.vertices && one.begins == other.begins && one.corners == other.corners;
}

void check_file(const std::string& name, std::string_view bytes, bool normals) {
    PolygonSoup soup;
    try {
        soup = parse_polygons(name, bytes, normals).polygons;
    } catch (const Error& error) {
        require(std::string_view(error.what()).find(name) != std::string_view::npos, "a message without the file: {}",
                error.what());
        return;
    }
    fuzz::check_sound(soup);
    require(normals != soup.normals.empty() || soup.corners.empty(), "normals are not as asked for");
    if (soup.facets() == 0)
        return;
    soup.normals.clear();
    require(same(soup, parse_polygons("a.obj", testing::as_obj(soup)).polygons), "not the same as OBJ");
    require(same(soup, parse_polygons("a.off", testing::as_off(soup)).polygons), "not the same as OFF");
    require(same(soup, parse_polygons("a.ply", testing::as_ply_binary(soup, true, false, true)).polygons),
            "not the same as PLY");
    if (soup.corners.size() < 200) {
        fuzz::Bytes places(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        fuzz::check_preparation(soup, places);
    }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const char* const kNames[] = {"a.obj", "a.off", "a.ply", "a.stl"};
    forceshade::fuzz::Bytes bytes(data, size);
    const std::uint8_t kind = bytes.byte();
    forceshade::check_file(kNames[kind % 4], bytes.rest(), (kind & 4) != 0);
    return 0;
}

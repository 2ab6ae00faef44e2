// Any polygons, prepared, and their tree against loops over all triangles.
#include "tests/fuzz/meshes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    forceshade::fuzz::Bytes bytes(data, size);
    const bool solid = bytes.byte() % 4 == 0;
    const forceshade::PolygonSoup soup =
        solid ? forceshade::fuzz::take_solid(bytes) : forceshade::fuzz::take_soup(bytes);
    forceshade::fuzz::check_preparation(soup, bytes);
    return 0;
}

#include "tests/mesh/patch.h"

#include <cmath>
#include <map>
#include <numbers>

namespace forceshade::study {
namespace {

void add_facet(PolygonSoup& polygons, std::initializer_list<std::uint32_t> corners) {
    polygons.corners.insert(polygons.corners.end(), corners);
    polygons.begins.push_back(static_cast<std::uint32_t>(polygons.corners.size()));
}

/// Vertices made once for each place of a lattice.
class Lattice {
public:
    Lattice(PolygonSoup& polygons, const std::function<double(double, double)>& height)
        : polygons_(polygons), height_(height) {}

    std::uint32_t vertex(long column, long row, double x, double y) {
        const auto [at, fresh] =
            numbers_.try_emplace({column, row}, static_cast<std::uint32_t>(polygons_.vertices.size()));
        if (fresh)
            polygons_.vertices.push_back({x, y, height_(x, y)});
        return at->second;
    }

private:
    PolygonSoup& polygons_;
    const std::function<double(double, double)>& height_;
    std::map<std::pair<long, long>, std::uint32_t> numbers_;
};

PolygonSoup hexagon_patch(unsigned cells, const std::function<double(double, double)>& height) {
    PolygonSoup result;
    Lattice lattice(result, height);
    const double half = 0.5 / cells;                    // half a width
    const double side = 2 * half / std::numbers::sqrt3; // of a hexagon with its flats to the left and right
    const long reach = static_cast<long>(cells) + 1;
    for (long row = -reach; row <= reach; ++row)
        for (long column = -2 * reach; column <= 2 * reach; ++column) {
            if ((column + row) % 2 != 0)
                continue;
            const double x = double(column) * half, y = double(row) * 1.5 * side;
            if (std::abs(x) > 0.5 + 1e-12 || std::abs(y) > 0.5 + 1e-12)
                continue;
            // Corners on a lattice of half widths and half sides.
            constexpr long kSteps[6][2] = {{1, -1}, {1, 1}, {0, 2}, {-1, 1}, {-1, -1}, {0, -2}};
            for (const auto& step : kSteps) {
                const long i = column + step[0], j = 3 * row + step[1];
                result.corners.push_back(lattice.vertex(i, j, double(i) * half, double(j) * 0.5 * side));
            }
            result.begins.push_back(static_cast<std::uint32_t>(result.corners.size()));
        }
    return result;
}

} // namespace

PolygonSoup patch(Cells kind, unsigned cells, const std::function<double(double, double)>& height) {
    if (kind == Cells::hexagons)
        return hexagon_patch(cells, height);
    PolygonSoup result;
    for (std::uint32_t j = 0; j <= cells; ++j)
        for (std::uint32_t i = 0; i <= cells; ++i) {
            const double x = double(i) / cells - 0.5, y = double(j) / cells - 0.5;
            result.vertices.push_back({x, y, height(x, y)});
        }
    for (std::uint32_t j = 0; j < cells; ++j)
        for (std::uint32_t i = 0; i < cells; ++i) {
            const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = b + cells + 1, d = a + cells + 1;
            if (kind == Cells::quads) {
                add_facet(result, {a, b, c, d});
            } else {
                add_facet(result, {a, b, c});
                add_facet(result, {a, c, d});
            }
        }
    return result;
}

} // namespace forceshade::study

// The table of direction errors of L7, on patches of triangles, quads and hexagons.
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/reference/mesh_shading.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using layout::uint;
using shapes::Cells;
using Vector = reference::Vector<double>;

constexpr double kDegree = std::numbers::pi / 180;

double angle(const Vector& u, const Vector& v) {
    const Vector normal = reference::cross(u, v);
    return std::atan2(std::sqrt(reference::dot(normal, normal)), reference::dot(u, v));
}

/// A smooth surface over the square: height and normal.
struct Smooth {
    std::function<double(double, double)> height;
    std::function<Vector(double, double)> normal; /* of any length */
};

const Smooth kCylinder{[](double x, double) { return std::sqrt(1 - x * x); },
                       [](double x, double) { return Vector(x, 0, std::sqrt(1 - x * x)); }};
const Smooth kSphere{[](double x, double y) { return std::sqrt(1 - x * x - y * y); },
                     [](double x, double y) { return Vector(x, y, std::sqrt(1 - x * x - y * y)); }};
const Smooth kSaddle{[](double x, double y) { return (x * x - y * y) / 2; },
                     [](double x, double y) { return Vector(-x, y, 1); }};

struct Errors {
    double rms, largest, jump; /* deg */
};

/// A patch, and the facets of it that count.
class Study {
public:
    /// Facets that touch no border edge and lie within |x|, |y| <= `within`.
    Study(const Smooth& smooth, Cells kind, unsigned cells, double within = 1)
        : smooth_(smooth), polygons_(shapes::patch(kind, cells, smooth.height)),
          structure_(build_structure(shapes::mesh_of(polygons_))), tables_(make_mesh_tables<double>(structure_, 1)),
          mesh_(tables_.view()) {
        for (uint facet = 0; facet < polygons_.facets(); ++facet)
            for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i)
                facets_of_[edge_of(facet, i)].push_back(facet);
        std::vector<bool> on_border(polygons_.vertices.size());
        for (const auto& [ends, facets] : facets_of_)
            if (facets.size() == 1)
                on_border[ends.first] = on_border[ends.second] = true;
        for (uint facet = 0; facet < polygons_.facets(); ++facet) {
            bool counts = true;
            for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
                const glm::dvec3& at = polygons_.vertices[polygons_.corners[i]];
                counts = counts && !on_border[polygons_.corners[i]] && std::abs(at.x) <= within + 1e-12 &&
                         std::abs(at.y) <= within + 1e-12;
            }
            counts_.push_back(counts);
        }
    }

    Errors errors(uint shading) const {
        double squares = 0, area = 0, largest = 0, jump = 0;
        for (uint facet = 0; facet < polygons_.facets(); ++facet) {
            if (!counts_[facet])
                continue;
            over_facet(facet, [&](const glm::dvec3& world, double weight) {
                const Vector point = to_mesh_frame(structure_, world);
                const double error =
                    angle(reference::shading_direction(mesh_, shading, facet, point), smooth_.normal(world.x, world.y));
                squares += weight * error * error;
                area += weight;
                largest = std::max(largest, error);
            });
        }
        for (const auto& [ends, facets] : facets_of_)
            if (facets.size() == 2 && counts_[facets[0]] && counts_[facets[1]])
                jump = std::max(jump, largest_jump(ends, facets, shading));
        return {std::sqrt(squares / area) / kDegree, largest / kDegree, jump / kDegree};
    }

private:
    std::pair<uint, uint> edge_of(uint facet, uint i) const {
        const uint next = i + 1 == polygons_.begins[facet + 1] ? polygons_.begins[facet] : i + 1;
        return std::minmax(polygons_.corners[i], polygons_.corners[next]);
    }

    /// Uniformly over (x, y) on the facet, a hexagon's plane being that of its Newell normal: use(point, weight).
    template <typename Use> void over_facet(uint facet, const Use& use) const {
        constexpr int kSteps = 24;
        std::vector<glm::dvec3> corners;
        glm::dvec3 middle(0);
        for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
            corners.push_back(polygons_.vertices[polygons_.corners[i]]);
            middle += corners.back();
        }
        middle /= double(corners.size());
        const Vector normal = reference::vector_at(mesh_.facet_normals, facet);
        for (std::size_t corner = 1; corner + 1 < corners.size(); ++corner) {
            const glm::dvec3 u = corners[corner] - corners[0], v = corners[corner + 1] - corners[0];
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; i + j < kSteps; ++j)
                    for (int upper = 0; upper < (i + j + 1 < kSteps ? 2 : 1); ++upper) {
                        const double third = (upper ? 2 : 1) / 3.0;
                        glm::dvec3 at = corners[0] + (i + third) / kSteps * u + (j + third) / kSteps * v;
                        at.z = middle.z - ((at.x - middle.x) * normal.x + (at.y - middle.y) * normal.y) / normal.z;
                        use(at, std::abs(u.x * v.y - u.y * v.x));
                    }
        }
    }

    double largest_jump(std::pair<uint, uint> ends, const std::vector<uint>& facets, uint shading) const {
        double jump = 0;
        for (int i = 0; i <= 64; ++i) {
            const glm::dvec3 world = polygons_.vertices[ends.first] +
                                     i / 64.0 * (polygons_.vertices[ends.second] - polygons_.vertices[ends.first]);
            const Vector point = to_mesh_frame(structure_, world);
            jump = std::max(jump, angle(reference::shading_direction(mesh_, shading, facets[0], point),
                                        reference::shading_direction(mesh_, shading, facets[1], point)));
        }
        return jump;
    }

    const Smooth& smooth_;
    PolygonSoup polygons_;
    MeshStructure structure_;
    MeshTables<double> tables_;
    layout::MeshView<double> mesh_;
    std::map<std::pair<uint, uint>, std::vector<uint>> facets_of_;
    std::vector<bool> counts_;
};

struct Row {
    Cells kind;
    unsigned cells;
    Errors flat, morgenbesser, exact;
};

class Table : public testing::TestWithParam<Row> {};

void expect_errors(const Errors& found, const Errors& printed) {
    EXPECT_NEAR(found.rms, printed.rms, 0.01 * printed.rms);
    EXPECT_NEAR(found.largest, printed.largest, 0.03 * printed.largest);
    EXPECT_NEAR(found.jump, printed.jump, 0.01 * printed.jump + 1e-9 / kDegree);
}

TEST_P(Table, OfDirectionErrorsOnACylinderIsReproduced) {
    const Row& row = GetParam();
    const Study study(kCylinder, row.kind, row.cells);
    expect_errors(study.errors(layout::kShadingNone), row.flat);
    expect_errors(study.errors(layout::kShadingMorgenbesser), row.morgenbesser);
    expect_errors(study.errors(layout::kShadingMeanValue), row.exact);
    if (row.kind == Cells::triangles)
        expect_errors(study.errors(layout::kShadingBarycentric), row.exact);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, Table,
    testing::Values(Row{Cells::triangles, 8, {2.12, 3.77, 7.42}, {1.26, 3.76, 3.47}, {0.076, 0.131, 0}},
                    Row{Cells::triangles, 32, {0.538, 0.98, 1.99}, {0.318, 0.97, 0.898}, {0.0064, 0.0135, 0}},
                    Row{Cells::quads, 8, {2.12, 3.76, 7.42}, {1.81, 3.34, 6.48}, {0.076, 0.131, 0}},
                    Row{Cells::hexagons, 8, {1.94, 3.85, 7.57}, {1.78, 3.64, 7.03}, {0.065, 0.133, 0}}));

TEST(Shading, ErrorsOnSphereAndSaddleAreReproduced) {
    const auto rms = [](const Smooth& smooth, uint shading) {
        return Study(smooth, Cells::triangles, 8).errors(shading).rms;
    };
    EXPECT_NEAR(rms(kSphere, layout::kShadingNone), 3.01, 0.0301);
    EXPECT_NEAR(rms(kSphere, layout::kShadingMorgenbesser), 1.79, 0.0179);
    EXPECT_NEAR(rms(kSphere, layout::kShadingMeanValue), 0.200, 0.00200);
    EXPECT_NEAR(rms(kSaddle, layout::kShadingNone), 2.74, 0.0274);
    EXPECT_NEAR(rms(kSaddle, layout::kShadingMorgenbesser), 1.64, 0.0164);
    EXPECT_NEAR(rms(kSaddle, layout::kShadingMeanValue), 0.098, 0.00098);
}

TEST(Shading, OrdersAreOneAndTwo) {
    const auto order = [](uint shading) {
        const double coarse = Study(kCylinder, Cells::triangles, 16, 0.375).errors(shading).rms;
        const double fine = Study(kCylinder, Cells::triangles, 32, 0.375).errors(shading).rms;
        return std::log2(coarse / fine);
    };
    EXPECT_NEAR(order(layout::kShadingNone), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingMorgenbesser), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingBarycentric), 2, 0.1);
    EXPECT_NEAR(order(layout::kShadingMeanValue), 2, 0.1);
}

} // namespace
} // namespace forceshade

// L7 on single facets: exact at corners, linear along edges, continuous hardly off them, the referee's angles; and the
// errors that its table says.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "host/touch/force_errors.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using layout::uint;

/// A polygon with its vertex normals all different.
struct OneFacet : shapes::MeshLaw<> {
    explicit OneFacet(const std::vector<glm::dvec3>& corners) : MeshLaw(make(corners)) {}

    static Mesh make(const std::vector<glm::dvec3>& corners) {
        PolygonSoup polygons;
        polygons.vertices = corners;
        for (std::uint32_t i = 0; i < corners.size(); ++i)
            polygons.corners.push_back(i);
        polygons.end_facet();
        Mesh result = shapes::mesh_of(polygons);
        for (std::size_t i = 0; i < result.vertex_normals.size(); ++i)
            result.vertex_normals[i] =
                reference::normalised(glm::dvec3(std::cos(2.0 * double(i)), std::sin(3.0 * double(i)), 1.5));
        return result;
    }
    glm::dvec3 direction(uint shading, const glm::dvec3& world) const {
        return reference::shading_direction(view, shading, 0, local(world));
    }
};

const std::vector<glm::dvec3> kTriangle{{0, 0, 0}, {3, 0, 0}, {1, 2, 0}};
const std::vector<glm::dvec3> kPentagon{{0, 0, 0}, {2, -1, 0}, {3, 1, 0}, {1.5, 2.5, 0}, {-0.5, 1, 0}};
const std::vector<glm::dvec3> kArrow{{0, 0, 0}, {3, 1, 0}, {0, 2, 0}, {1, 1, 0}};

TEST(Shading, IsExactAtCornersAndLinearAlongEdges) {
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const std::size_t next = (i + 1) % corners.size();
            EXPECT_LT(
                angle_between(facet.direction(layout::kShadingMeanValue, corners[i]), facet.mesh.vertex_normals[i]),
                1e-13);
            for (const double share : {1e-15, 1e-9, 0.2, 0.5, 0.77, 1 - 1e-12}) {
                const glm::dvec3 expected =
                    (1 - share) * facet.mesh.vertex_normals[i] + share * facet.mesh.vertex_normals[next];
                const glm::dvec3 at = corners[i] + share * (corners[next] - corners[i]);
                EXPECT_LT(angle_between(facet.direction(layout::kShadingMeanValue, at), expected), 1e-12)
                    << i << ' ' << share;
            }
        }
    }
}

TEST(Shading, HardlyOffAnEdgeOrCornerItIsWhatItIsOnIt) {
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 way = corners[(i + 1) % corners.size()] - corners[i];
            const glm::dvec3 inwards = reference::normalised(glm::dvec3(-way.y, way.x, 0));
            for (const double share : {0.0, 1e-12, 0.3, 0.9})
                for (double off = 1e-18; off < 1e-9; off *= 3) {
                    const glm::dvec3 on = corners[i] + share * way;
                    const glm::dvec3 expected = facet.direction(layout::kShadingMeanValue, on);
                    for (const double side : {-1.0, 1.0})
                        EXPECT_LT(angle_between(facet.direction(layout::kShadingMeanValue, on + side * off * inwards),
                                                expected),
                                  1e-12 + 20 * off)
                            << i << ' ' << share << ' ' << off;
                }
        }
    }
}

TEST(Shading, EqualsTheRefereesAngles) {
    using brute::MeshShading;
    const std::pair<uint, MeshShading> schemes[] = {{layout::kShadingMorgenbesser, MeshShading::morgenbesser},
                                                    {layout::kShadingBarycentric, MeshShading::barycentric},
                                                    {layout::kShadingMeanValue, MeshShading::mean_value}};
    std::mt19937 random(4);
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (const auto& [shading, scheme] : schemes) {
            if (scheme == MeshShading::barycentric && corners.size() != 3)
                continue;
            const brute::MeshReferee referee(facet.mesh, {.shading = scheme});
            for (int i = 0; i < 300; ++i) {
                const glm::dvec3 at(double(random()) / 4294967296.0 * 1.4 + 0.6,
                                    double(random()) / 4294967296.0 * 0.2 + 0.8, 0);
                const brute::Vector expected = referee.direction(0, {at.x, at.y, at.z});
                const glm::dvec3 found = facet.direction(shading, at);
                for (int axis = 0; axis < 3; ++axis)
                    EXPECT_NEAR(found[axis], double(expected[axis]), 2e-14);
            }
        }
    }
}

TEST(Shading, NormalsThatCancelGiveNoDirection) {
    Mesh mesh = OneFacet::make(kTriangle);
    for (glm::dvec3& normal : mesh.vertex_normals)
        normal = glm::dvec3(0);
    const shapes::MeshLaw<> facet(mesh);
    for (const uint shading : {layout::kShadingMorgenbesser, layout::kShadingBarycentric, layout::kShadingMeanValue})
        EXPECT_EQ(reference::shading_direction(facet.view, shading, 0, glm::dvec3(0.1, 0, 0)), glm::dvec3(0.0));
}

using shapes::Cells;

/// A smooth surface over the square [-1/2, 1/2]^2.
struct SmoothSurface {
    const char* name;
    std::function<double(double, double)> height;
    std::function<glm::dvec3(double, double)> normal; /* of any length */
};

const SmoothSurface kUnitCylinder{"cylinder", [](double x, double) { return std::sqrt(1 - x * x); },
                                  [](double x, double) { return glm::dvec3(x, 0, std::sqrt(1 - x * x)); }};
const SmoothSurface kUnitSphere{"sphere", [](double x, double y) { return std::sqrt(1 - x * x - y * y); },
                                [](double x, double y) { return glm::dvec3(x, y, std::sqrt(1 - x * x - y * y)); }};
const SmoothSurface kSaddle{"saddle", [](double x, double y) { return (x * x - y * y) / 2; },
                            [](double x, double y) { return glm::dvec3(-x, y, 1); }};

struct PatchErrors {
    double rms, largest; /* deg: area-uniform, against the true normal at the same (x, y) */
    double jump;         /* deg: the largest across an edge */
};

/// A patch, and the facets of it that count: those that touch no border edge and lie within |x|, |y| <= `within`.
/// `smooth` must outlive it.
class PatchStudy {
public:
    PatchStudy(const SmoothSurface& smooth, Cells kind, unsigned cells, double within = 1)
        : smooth_(smooth), polygons_(shapes::patch(kind, cells, smooth.height)), mesh_(polygons_) {
        for (uint facet = 0; facet < polygons_.facets(); ++facet)
            for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i)
                facets_of_[edge_of(facet, i)].push_back(facet);
        std::vector<bool> on_border(polygons_.vertices.size());
        for (const auto& [ends, facets] : facets_of_)
            if (facets.size() == 1)
                on_border[ends.first] = on_border[ends.second] = true;
        for (uint facet = 0; facet < polygons_.facets(); ++facet)
            counts_.push_back(counts(facet, on_border, within));
    }

    /// Of a shading, layout::kShadingNone or of L7.
    PatchErrors errors(uint shading) const {
        double squares = 0, area = 0, largest = 0, jump = 0;
        for (uint facet = 0; facet < polygons_.facets(); ++facet) {
            if (!counts_[facet])
                continue;
            over_facet(facet, [&](const glm::dvec3& world, double weight) {
                const glm::dvec3 point = mesh_.local(world);
                const double error = angle_between(reference::shading_direction(mesh_.view, shading, facet, point),
                                                   smooth_.normal(world.x, world.y));
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
    using Edge = std::pair<uint, uint>; // vertices, the lower first

    Edge edge_of(uint facet, uint i) const {
        const uint next = i + 1 == polygons_.begins[facet + 1] ? polygons_.begins[facet] : i + 1;
        return std::minmax(polygons_.corners[i], polygons_.corners[next]);
    }

    bool counts(uint facet, const std::vector<bool>& on_border, double within) const {
        for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
            const glm::dvec3& at = polygons_.vertices[polygons_.corners[i]];
            if (on_border[polygons_.corners[i]] || std::abs(at.x) > within + 1e-12 || std::abs(at.y) > within + 1e-12)
                return false;
        }
        return true;
    }

    // Uniformly over (x, y) on the facet, a hexagon's plane being that of its Newell normal: use(point, weight).
    template <typename Use> void over_facet(uint facet, const Use& use) const {
        constexpr int kSteps = 24;
        std::vector<glm::dvec3> corners;
        glm::dvec3 middle(0);
        for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
            corners.push_back(polygons_.vertices[polygons_.corners[i]]);
            middle += corners.back();
        }
        middle /= double(corners.size());
        const glm::dvec3 normal = reference::vector_at(mesh_.view.facet_normals, facet);
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

    double largest_jump(const Edge& ends, const std::vector<uint>& facets, uint shading) const {
        double jump = 0;
        for (int i = 0; i <= 64; ++i) {
            const glm::dvec3 world = polygons_.vertices[ends.first] +
                                     i / 64.0 * (polygons_.vertices[ends.second] - polygons_.vertices[ends.first]);
            const glm::dvec3 point = mesh_.local(world);
            jump = std::max(jump, angle_between(reference::shading_direction(mesh_.view, shading, facets[0], point),
                                                reference::shading_direction(mesh_.view, shading, facets[1], point)));
        }
        return jump;
    }

    const SmoothSurface& smooth_;
    PolygonSoup polygons_;
    shapes::MeshLaw<> mesh_;
    std::map<Edge, std::vector<uint>> facets_of_;
    std::vector<bool> counts_;
};

struct Row {
    Cells kind;
    unsigned cells;
    PatchErrors flat, morgenbesser, exact;
};

class Table : public ::testing::TestWithParam<Row> {};

void expect_errors(const PatchErrors& found, const PatchErrors& printed) {
    EXPECT_NEAR(found.rms, printed.rms, 0.01 * printed.rms);
    EXPECT_NEAR(found.largest, printed.largest, 0.03 * printed.largest);
    EXPECT_NEAR(found.jump, printed.jump, 0.01 * printed.jump + 1e-9 / kDegree);
}

TEST_P(Table, OfDirectionErrorsOnACylinderIsReproduced) {
    const Row& row = GetParam();
    const PatchStudy cut(kUnitCylinder, row.kind, row.cells);
    expect_errors(cut.errors(layout::kShadingNone), row.flat);
    expect_errors(cut.errors(layout::kShadingMorgenbesser), row.morgenbesser);
    expect_errors(cut.errors(layout::kShadingMeanValue), row.exact);
    if (row.kind == Cells::triangles)
        expect_errors(cut.errors(layout::kShadingBarycentric), row.exact);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, Table,
    ::testing::Values(Row{Cells::triangles, 8, {2.12, 3.77, 7.42}, {1.26, 3.76, 3.47}, {0.076, 0.131, 0}},
                      Row{Cells::triangles, 32, {0.538, 0.98, 1.99}, {0.318, 0.97, 0.898}, {0.0064, 0.0135, 0}},
                      Row{Cells::quads, 8, {2.12, 3.76, 7.42}, {1.81, 3.34, 6.48}, {0.076, 0.131, 0}},
                      Row{Cells::hexagons, 8, {1.94, 3.85, 7.57}, {1.78, 3.64, 7.03}, {0.065, 0.133, 0}}));

TEST(Shading, ErrorsOnSphereAndSaddleAreReproduced) {
    const auto rms = [](const SmoothSurface& smooth, uint shading) {
        return PatchStudy(smooth, Cells::triangles, 8).errors(shading).rms;
    };
    for (const auto& [smooth, shading, degrees] : {std::tuple{&kUnitSphere, layout::kShadingNone, 3.01},
                                                   {&kUnitSphere, layout::kShadingMorgenbesser, 1.79},
                                                   {&kUnitSphere, layout::kShadingMeanValue, 0.2},
                                                   {&kSaddle, layout::kShadingNone, 2.74},
                                                   {&kSaddle, layout::kShadingMorgenbesser, 1.64},
                                                   {&kSaddle, layout::kShadingMeanValue, 0.098}})
        EXPECT_NEAR(rms(*smooth, shading), degrees, 0.01 * degrees);
}

TEST(Shading, OrdersAreOneAndTwo) {
    const auto order = [](uint shading) {
        const double coarse = PatchStudy(kUnitCylinder, Cells::triangles, 16, 0.375).errors(shading).rms;
        const double fine = PatchStudy(kUnitCylinder, Cells::triangles, 32, 0.375).errors(shading).rms;
        return std::log2(coarse / fine);
    };
    EXPECT_NEAR(order(layout::kShadingNone), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingMorgenbesser), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingBarycentric), 2, 0.1);
    EXPECT_NEAR(order(layout::kShadingMeanValue), 2, 0.1);
}

} // namespace
} // namespace forceshade

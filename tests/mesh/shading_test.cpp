// L7 on single facets: exact at corners, linear along edges, continuous hardly off them, the referee's angles; and the
// errors that its table says.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "host/touch/angle.h"
#include "tests/mesh/patch_errors.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using layout::uint;

double angle(const glm::dvec3& u, const glm::dvec3& v) {
    const glm::dvec3 normal = reference::cross(u, v);
    return std::atan2(std::sqrt(reference::dot(normal, normal)), reference::dot(u, v));
}

/// A polygon with its vertex normals all different.
struct OneFacet {
    Mesh mesh;
    MeshStructure structure;
    MeshTables<double> tables;

    explicit OneFacet(std::vector<glm::dvec3> corners)
        : mesh(make(std::move(corners))), structure(build_structure(mesh)),
          tables(make_mesh_tables<double>(structure, 1)) {}

    static Mesh make(std::vector<glm::dvec3> corners) {
        PolygonSoup polygons;
        for (std::uint32_t i = 0; i < corners.size(); ++i)
            polygons.corners.push_back(i);
        polygons.begins.push_back(static_cast<std::uint32_t>(corners.size()));
        polygons.vertices = std::move(corners);
        Mesh result = shapes::mesh_of(polygons);
        for (std::size_t i = 0; i < result.vertex_normals.size(); ++i)
            result.vertex_normals[i] =
                reference::normalised(glm::dvec3(std::cos(2.0 * double(i)), std::sin(3.0 * double(i)), 1.5));
        return result;
    }
    glm::dvec3 direction(uint shading, const glm::dvec3& world) const {
        return reference::shading_direction(tables.view(), shading, 0, to_mesh_frame(structure, world));
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
            EXPECT_LT(angle(facet.direction(layout::kShadingMeanValue, corners[i]), facet.mesh.vertex_normals[i]),
                      1e-13);
            for (const double share : {1e-15, 1e-9, 0.2, 0.5, 0.77, 1 - 1e-12}) {
                const glm::dvec3 expected =
                    (1 - share) * facet.mesh.vertex_normals[i] + share * facet.mesh.vertex_normals[next];
                const glm::dvec3 at = corners[i] + share * (corners[next] - corners[i]);
                EXPECT_LT(angle(facet.direction(layout::kShadingMeanValue, at), expected), 1e-12) << i << ' ' << share;
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
                        EXPECT_LT(
                            angle(facet.direction(layout::kShadingMeanValue, on + side * off * inwards), expected),
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
    OneFacet facet(kTriangle);
    for (glm::dvec3& normal : facet.mesh.vertex_normals)
        normal = glm::dvec3(0);
    const MeshStructure structure = build_structure(facet.mesh);
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 1);
    for (const uint shading : {layout::kShadingMorgenbesser, layout::kShadingBarycentric, layout::kShadingMeanValue})
        EXPECT_EQ(reference::shading_direction(tables.view(), shading, 0, glm::dvec3(0.1, 0, 0)), glm::dvec3(0.0));
}

using study::Cells;
using study::PatchErrors;
using study::PatchStudy;
using study::SmoothSurface;

struct Row {
    Cells kind;
    unsigned cells;
    PatchErrors flat, morgenbesser, exact;
};

class Table : public testing::TestWithParam<Row> {};

void expect_errors(const PatchErrors& found, const PatchErrors& printed) {
    EXPECT_NEAR(found.rms, printed.rms, 0.01 * printed.rms);
    EXPECT_NEAR(found.largest, printed.largest, 0.03 * printed.largest);
    EXPECT_NEAR(found.jump, printed.jump, 0.01 * printed.jump + 1e-9 / kDegree);
}

TEST_P(Table, OfDirectionErrorsOnACylinderIsReproduced) {
    const Row& row = GetParam();
    const PatchStudy cut(study::kUnitCylinder, row.kind, row.cells);
    expect_errors(cut.errors(layout::kShadingNone), row.flat);
    expect_errors(cut.errors(layout::kShadingMorgenbesser), row.morgenbesser);
    expect_errors(cut.errors(layout::kShadingMeanValue), row.exact);
    if (row.kind == Cells::triangles)
        expect_errors(cut.errors(layout::kShadingBarycentric), row.exact);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, Table,
    testing::Values(Row{Cells::triangles, 8, {2.12, 3.77, 7.42}, {1.26, 3.76, 3.47}, {0.076, 0.131, 0}},
                    Row{Cells::triangles, 32, {0.538, 0.98, 1.99}, {0.318, 0.97, 0.898}, {0.0064, 0.0135, 0}},
                    Row{Cells::quads, 8, {2.12, 3.76, 7.42}, {1.81, 3.34, 6.48}, {0.076, 0.131, 0}},
                    Row{Cells::hexagons, 8, {1.94, 3.85, 7.57}, {1.78, 3.64, 7.03}, {0.065, 0.133, 0}}));

TEST(Shading, ErrorsOnSphereAndSaddleAreReproduced) {
    const auto rms = [](const SmoothSurface& smooth, uint shading) {
        return PatchStudy(smooth, Cells::triangles, 8).errors(shading).rms;
    };
    for (const auto& [smooth, shading, degrees] : {std::tuple{&study::kUnitSphere, layout::kShadingNone, 3.01},
                                                   {&study::kUnitSphere, layout::kShadingMorgenbesser, 1.79},
                                                   {&study::kUnitSphere, layout::kShadingMeanValue, 0.2},
                                                   {&study::kSaddle, layout::kShadingNone, 2.74},
                                                   {&study::kSaddle, layout::kShadingMorgenbesser, 1.64},
                                                   {&study::kSaddle, layout::kShadingMeanValue, 0.098}})
        EXPECT_NEAR(rms(*smooth, shading), degrees, 0.01 * degrees);
}

TEST(Shading, OrdersAreOneAndTwo) {
    const auto order = [](uint shading) {
        const double coarse = PatchStudy(study::kUnitCylinder, Cells::triangles, 16, 0.375).errors(shading).rms;
        const double fine = PatchStudy(study::kUnitCylinder, Cells::triangles, 32, 0.375).errors(shading).rms;
        return std::log2(coarse / fine);
    };
    EXPECT_NEAR(order(layout::kShadingNone), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingMorgenbesser), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingBarycentric), 2, 0.1);
    EXPECT_NEAR(order(layout::kShadingMeanValue), 2, 0.1);
}

} // namespace
} // namespace forceshade

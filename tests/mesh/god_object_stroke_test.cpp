// No ripple: along a stroke the force changes between samples only as the geometry does.
#include <memory>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

constexpr double kRate = 1000;                              // 1/s
constexpr double kMetre = 1 / 0.0254;                       // a bump 1 inch wide is 1 wide in the mesh
constexpr double kSpeeds[] = {0.005, 0.02, 0.05, 0.1, 0.2}; // m/s

struct Sample {
    glm::dvec3 force;
    reference::GodObjectContact<double> contact;
};

std::vector<Sample> stroke(const MeshStructure& structure, const glm::dvec3& from, const glm::dvec3& to, double speed) {
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 1.0);
    const layout::MeshView<double> mesh = tables.view();
    auto around = std::make_unique<reference::Neighbourhood<double>>();
    reference::GodObject<double> state;
    reference::update(mesh, state, *around, to_mesh_frame(structure, {from.x, from.y, 2.0}));
    std::vector<Sample> samples;
    const double step = speed * kMetre / kRate;
    const auto count = static_cast<int>(glm::length(to - from) / step);
    for (int i = 0; i <= count; ++i) {
        const glm::dvec3 world = from + (step * i / glm::length(to - from)) * (to - from);
        const glm::dvec3 probe = to_mesh_frame(structure, world);
        const auto contact = reference::update(mesh, state, *around, probe);
        EXPECT_TRUE(contact.finished);
        samples.push_back({contact.proxy - probe, contact});
    }
    return samples;
}

TEST(GodObjectStroke, APlaneOfManyTrianglesIsAPlane) {
    const MeshStructure structure = build_structure(
        shapes::mesh_of(shapes::patch(shapes::Cells::triangles, 40, [](double x, double) { return 0.25 * x; })));
    for (const double speed : kSpeeds) {
        // Along a row of edges exactly, and across them all.
        for (const double slant : {0.0, 0.31}) {
            const std::vector<Sample> samples =
                stroke(structure, {-0.45, -0.2, -0.15}, {0.45, -0.2 + slant, 0.075}, speed);
            for (const Sample& sample : samples)
                ASSERT_LE(glm::length(sample.force - samples[0].force), 1e-15) << speed;
        }
    }
}

TEST(GodObjectStroke, AcrossTheBumpOneChangeAnEdge) {
    for (const unsigned rows : {1U, 7U}) {
        const MeshStructure structure = build_structure(shapes::mesh_of(walks::bump(16, rows)));
        for (const double speed : kSpeeds) {
            const std::vector<Sample> samples = stroke(structure, {-0.8, 0.013, -0.04}, {0.8, 0.037, -0.04}, speed);
            unsigned turns = 0;
            for (std::size_t i = 1; i < samples.size(); ++i) {
                const glm::dvec3 one = glm::normalize(samples[i - 1].force), other = glm::normalize(samples[i].force);
                const double turn = glm::length(glm::cross(one, other));
                const bool corner = samples[i].contact.count > 1 || samples[i - 1].contact.count > 1;
                if (corner)
                    continue; // in the concave corner at the bump's foot the force turns with the probe
                const bool same =
                    glm::length(samples[i].contact.normals[0] - samples[i - 1].contact.normals[0]) < 1e-12;
                ASSERT_EQ(turn > 1e-12, !same) << speed << " sample " << i;
                turns += same ? 0 : 1;
            }
            EXPECT_LE(turns, 15u) << speed;
            EXPECT_GE(turns, speed < 0.1 ? 10u : 5u) << speed;
        }
    }
}

} // namespace
} // namespace forceshade

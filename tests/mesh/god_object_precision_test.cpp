// L6 in single precision against double, by angle, thickness and valence: the table of shaders/README.md.
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"
#include "tests/places.h"

namespace forceshade {
namespace {

struct PrecisionError {
    std::uint64_t steps = 0, jumps = 0; /* jumps: another probe within four skins has this contact in double */
    double contact = 0, force = 0;      /* the largest, in sizes and in stiffness times size */
    double outside = 0;                 /* the largest force where in double there is no contact */
};

/// Both precisions along the same strokes (walks::Stroker). Where they part at a jump, the stroke ends.
PrecisionError compare(const walks::Terrain& terrain) {
    constexpr unsigned kSteps = 12;
    constexpr double kJitter = 4 * double(reference::Skin<float>::kWidth);
    const unsigned strokes = terrain.valence > 100 ? 2000 : 20000;
    walks::Run<float> run32(terrain.polygons);
    walks::Run<double> run64(terrain.polygons), other(terrain.polygons);
    const auto follow = [](auto& run, const auto& probe) {
        return reference::update(run.mesh, run.state, *run.around, probe);
    };
    PrecisionError error;
    for (unsigned stroke = 0; stroke < strokes; ++stroke) {
        walks::Stroker walk(run64.structure, stroke);
        run32.state = {};
        run64.state = {};
        glm::dvec3 place(0);
        for (unsigned step = 0; step < kSteps; ++step) {
            place = step == 0 ? walk.begin() : walk.step(place);
            const glm::vec3 probe32(place);
            const glm::dvec3 probe = walks::wide(probe32);
            const reference::GodObject<double> before = run64.state;
            const glm::dvec3 contact32 = walks::wide(follow(run32, probe32).proxy);
            const reference::GodObjectContact<double> answer64 = follow(run64, probe);
            const glm::dvec3 contact64 = answer64.proxy;
            const double far = glm::length(contact64 - contact32);
            double nearest = far;
            for (int i = 0; i < 27 && nearest > kJitter; ++i) {
                other.state = before;
                const glm::dvec3 aside = kJitter * glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
                const glm::dvec3 there = follow(other, probe + aside).proxy;
                nearest = std::min(nearest, glm::length(there - contact32));
            }
            ++error.steps;
            if (far > 16 * kJitter && nearest < far / 2) {
                ++error.jumps;
                break;
            }
            error.contact = std::max(error.contact, far);
            if (!answer64.touching)
                error.outside = std::max(error.outside, glm::length(contact32 - probe));
            error.force =
                std::max(error.force, std::abs(glm::length(contact64 - probe) - glm::length(contact32 - probe)));
        }
    }
    return error;
}

std::string read_table() {
    std::ifstream file(in_source("shaders/README.md"));
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(GodObjectPrecision, SingleErrsAsTheTableSays) {
    std::vector<walks::Terrain> all;
    for (const double degrees : {60.0, 10.0, 1.0, 0.3, 0.1, 0.03})
        all.push_back({fmt::format("wedge of {}°", degrees), shapes::sharp_wedge(degrees)});
    for (const double degrees : {90.0, 10.0, 0.1})
        all.push_back({fmt::format("groove of {}°", degrees), walks::grooved_block(degrees)});
    for (const double thickness : {0.1, 3e-3, 1e-3, 3e-4, 1e-4})
        all.push_back({fmt::format("plate {} thick", thickness), shapes::plate(thickness)});
    for (const unsigned facets : {20U, 224U, 1000U})
        all.push_back({fmt::format("cone of {} facets", facets), shapes::double_cone(facets, 0.5), facets});
    const std::string table = read_table();
    for (const walks::Terrain& terrain : all) {
        const PrecisionError error = compare(terrain);
        const std::string row = fmt::format("| {} | {:.1e} | {:.1e} | {:.1e} | {} |", terrain.name, error.contact,
                                            error.force, error.outside, error.jumps);
        EXPECT_NE(table.find(row), std::string::npos) << row;
    }
}

} // namespace
} // namespace forceshade

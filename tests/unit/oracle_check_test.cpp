// The check of a field against the oracle looks where errors hide, the same places in every run.
#include <functional>

#include <gtest/gtest.h>

#include "host/referee/oracle_check.h"
#include "host/reference/field.h"
#include "host/scene/study.h"

namespace forceshade::test {
namespace {

PreparedCase checked_scene(const std::string& text) {
    return CasePreparation().prepare(parse_study(text, "test").cases.front());
}

using Spoil = std::function<void(std::size_t x, std::size_t z, float* force)>;

// What the check says of the oracle's own field, in chunks of so many bytes, after somebody spoilt it.
OracleError checked(const PreparedCase& prepared, const Spoil& spoil = {}, std::size_t bytes = 1 << 20,
                    unsigned threads = 2) {
    const FieldTables<float> tables = make_tables<float>(prepared.one.scene, prepared.images, Extent::what_varies);
    OracleCheck check(prepared, true);
    reference::FieldOptions options;
    options.chunk_bytes = bytes;
    reference::evaluate_field<float>(tables.input(), options, [&](const layout::FieldChunk<float>& chunk) {
        std::vector<float> force(chunk.force.begin(), chunk.force.end());
        for (std::size_t row = 0; spoil && row < chunk.y_count * chunk.z_count; ++row)
            for (std::size_t x = 0; x < chunk.x_count; ++x)
                spoil(x, chunk.z_first + row / chunk.y_count, &force[3 * (row * chunk.x_pitch + x)]);
        layout::FieldChunk<float> copy = chunk;
        copy.force = force;
        check.add(copy);
    });
    return check.compare(threads);
}

constexpr const char* kLarge = "[surface]\nfacets = 2\n[grid]\nsize = [2001, 1, 1000]\norigin = [\"-20 mm\", \"0 mm\", "
                               "\"-10 mm\"]\nspacing = \"20 um\"\n";

TEST(OracleCheck, ComparesAllOfASmallField) {
    const OracleError error = checked(checked_scene("[grid]\nsize = [32, 1, 16]\n"));
    EXPECT_EQ(error.compared, 32u * 16);
    EXPECT_EQ(error.differing, 0u);
    EXPECT_LT(error.relative(), 1e-6);
}

// A column of two million voxels beside the crest, or one in a hundred of those beside the boundary of contact.
TEST(OracleCheck, FindsWhatIsWrongAtAJumpOrABoundaryAlone) {
    const PreparedCase bump = checked_scene(kLarge);
    const OracleError right = checked(bump);
    EXPECT_EQ(right.differing, 0u);
    EXPECT_LT(right.compared, 70000u) << "of two million";
    const auto mirrored = [](std::size_t x, std::size_t, float* force) {
        if (x == 1000)
            force[0] = -force[0];
    };
    EXPECT_GT(checked(bump, mirrored).differing, 100u);
    std::size_t seen = 0;
    const auto pressed = [&](std::size_t x, std::size_t z, float* force) {
        if (x < 300 && z == 500 && force[2] == 0) // the plane's surface, z = 0
            force[2] = 1e-3f, ++seen;
    };
    EXPECT_GT(checked(bump, pressed).differing, 3u);
    EXPECT_EQ(seen, 300u);
}

TEST(OracleCheck, IsTheSameFromEveryRun) {
    const PreparedCase bump = checked_scene(kLarge);
    const OracleError one = checked(bump, {}, 1 << 20, 1), other = checked(bump, {}, 1 << 16, 3);
    EXPECT_EQ(one.compared, other.compared);
    EXPECT_EQ(one.on_edge, other.on_edge);
    EXPECT_EQ(one.largest, other.largest);
    EXPECT_EQ(one.largest_force, other.largest_force);
}

} // namespace
} // namespace forceshade::test

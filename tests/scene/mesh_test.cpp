// Scenes whose surface is a mesh: keys, defaults, refusals, the grid that follows from the mesh.
#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

using test::study_error;

constexpr const char* kScene = R"([surface]
kind = "mesh"
file = "spot.obj"
unit = "mm"
normals = "angle"
inside = "winding"
transform = { scale = 0.05, rotate = ["90 deg", "0 deg", "0 deg"], translate = ["1 mm", "0 m", "0 m"] }
[force]
shading = "mean_value"
)";

const std::string kGrid = "[grid]\nsize = [4, 5, 6]\norigin = [\"0 m\", \"0 m\", \"0 m\"]\nspacing = \"1 mm\"\n";

TEST(MeshScene, Keys) {
    const Case one = parse_scene(kScene, "f.toml", "/folder");
    const MeshSpec& mesh = one.scene.surface.mesh;
    EXPECT_EQ(one.scene.surface.kind, SurfaceKind::mesh);
    EXPECT_EQ(mesh.file, "spot.obj");
    EXPECT_EQ(mesh.path, "/folder/spot.obj");
    EXPECT_EQ(mesh.unit, 0.001);
    EXPECT_EQ(mesh.normals, NormalWeights::angle);
    EXPECT_EQ(mesh.inside, InsideTest::winding);
    EXPECT_EQ(mesh.scale, 0.05);
    EXPECT_NEAR(mesh.rotate[0], 1.5707963267948966, 1e-15);
    EXPECT_EQ(mesh.translate[0], 0.001);
    EXPECT_EQ(one.scene.force.shading, Shading::mean_value);
    EXPECT_TRUE(parse_scene(resolved_toml(one), "f.toml", "/folder").scene == one.scene);
}

TEST(MeshScene, GridFollowsFromTheMeshUnlessItIsGiven) {
    EXPECT_EQ(parse_scene(kScene, "f.toml").scene.grid.samples, 128u);
    EXPECT_EQ(parse_scene(std::string(kScene) + "[grid]\nsamples = 9\n", "f.toml").scene.grid.samples, 9u);
    const Case given = parse_scene(std::string(kScene) + kGrid, "f.toml");
    EXPECT_EQ(given.scene.grid.samples, 0u);
    EXPECT_EQ(given.scene.grid.size[1], 5u);
    EXPECT_EQ(parse_scene("", "f.toml").scene.grid.samples, 0u);
    const Case later = parse_scene(std::string(kScene) + kGrid + "[[variant]]\ngrid.samples = 7\n", "f.toml");
    EXPECT_EQ(later.scene.grid.samples, 7u);
}

TEST(MeshScene, Refusals) {
    const std::string start = "[surface]\nkind = \"mesh\"\n";
    EXPECT_EQ(study_error(start),
              "f.toml:2:8: kind \"mesh\" needs a file: file = \"NAME.obj\" (or .off, .ply, .stl) in [surface]");
    const std::string mesh = start + "file = \"a.obj\"\n";
    EXPECT_EQ(study_error(mesh + "unit = \"kg\"\n").substr(0, 12), "f.toml:4:8: ");
    EXPECT_EQ(study_error(mesh + "unit = 1\n").substr(0, 12), "f.toml:4:8: ");
    EXPECT_EQ(study_error(mesh + "transform = { scale = \"2\" }\n"),
              "f.toml:4:23: transform.scale is a number: write 2, without quotes");
    EXPECT_EQ(study_error(mesh + "transform = { scale = -1 }\n"),
              "f.toml:4:23: transform.scale must be positive and finite, got -1");
    EXPECT_EQ(study_error(mesh + "transform = { turn = 1 }\n").substr(0, 13), "f.toml:4:15: ");
    EXPECT_EQ(study_error(mesh + "[force]\nshading = \"reference\"\n"),
              "f.toml:5:11: shading \"reference\" does not fit kind \"mesh\", whose shading is none, morgenbesser, "
              "barycentric, mean_value or two_pass");
    EXPECT_EQ(
        study_error("[texture]\neffect = \"normal\"\n"),
        "f.toml:2:10: effect \"normal\" tilts the normals of a mesh; kind \"height_map\" does that for a plane (L5)");
    EXPECT_EQ(study_error(mesh + "transform = 3\n").substr(0, 38), "f.toml:4:1: transform is a table, for ");
    EXPECT_EQ(study_error(mesh + "[grid]\nsize = [1, 2, 3]\n"),
              "f.toml:5:9: a mesh's grid needs size, origin and spacing, of which origin is missing; or samples, which "
              "makes them from the mesh's box");
    EXPECT_EQ(study_error(mesh + kGrid + "samples = 3\n"),
              "f.toml:5:1: give \"samples\", which stands for size, origin and spacing, or \"size\", not both");
    EXPECT_EQ(study_error("[surface]\nunit = \"mm\"\n").substr(0, 12), "f.toml:2:1: ");
}

} // namespace
} // namespace forceshade

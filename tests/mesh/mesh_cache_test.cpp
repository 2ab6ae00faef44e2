// Prepared meshes kept between runs: they are what would be prepared anew, bit for bit, and whatever lies in the
// folder, nothing else comes of it.
#include <chrono>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/field/mesh_cache.h"
#include "host/output/kept.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

PolygonSoup without_top(const PolygonSoup& polygons) {
    return shapes::kept_facets(
        polygons, [&](std::size_t facet) { return polygons.vertices[polygons.outline(facet)[0]].z < 0.9; });
}

class MeshCache : public ::testing::Test {
protected:
    void TearDown() override { keep_meshes_in({}); }

    PreparedCase prepared(const std::string& more = "") {
        return CasePreparation().prepare(parse_scene(
            "[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\nunit = \"mm\"\n" + more, "scene", files_.path()));
    }
    // Without the cache, with it for the first time, and with what that kept.
    std::array<PreparedCase, 3> three(const std::string& more) {
        keep_meshes_in({});
        PreparedCase none = prepared(more);
        keep_meshes_in(cache_.path());
        PreparedCase first = prepared(more), later = prepared(more);
        return {std::move(none), std::move(first), std::move(later)};
    }
    // The whole mesh, as it would be kept.
    std::string bytes_of(const PreparedCase& one) {
        const testing::Folder folder;
        keep_meshes_in(folder.path());
        keep_mesh(one.one.scene.surface.mesh, *one.images.mesh);
        keep_meshes_in(cache_.path());
        return folder.names().empty() ? "nothing" : folder.read(folder.names().front());
    }
    static std::vector<glm::dvec3> forces(const PreparedCase& one) {
        const CaseLaw<double> law(one);
        std::vector<glm::dvec3> forces;
        std::mt19937 random(3);
        for (int i = 0; i < 300; ++i)
            forces.push_back(law.at(shapes::anywhere(random, 0.7e-3)).force);
        return forces;
    }

    testing::Folder files_, cache_;
};

TEST_F(MeshCache, HoldsWhatIsPreparedAnew) {
    const PolygonSoup sphere = shapes::icosphere(6);
    const std::pair<PolygonSoup, const char*> meshes[] = {
        {sphere, "normals = \"crease:0.5 deg\"\ntransform = { rotate = [\"10 deg\", \"0 deg\", \"5 deg\"] }\n"},
        {without_top(sphere), "inside = \"winding\"\n"},
        {shapes::merged(sphere, shapes::moved(shapes::icosphere(2), glm::dvec3(0.5), {1, 0, 0})),
         "orient = \"outward\"\n"},
    };
    for (const auto& [polygons, more] : meshes) {
        files_.write("mesh.obj", testing::as_obj(polygons));
        const auto [none, first, later] = three(more);
        const std::string whole = bytes_of(none);
        EXPECT_GT(whole.size(), 5'000'000u);
        EXPECT_TRUE(whole == bytes_of(first)) << more;
        EXPECT_TRUE(whole == bytes_of(later)) << more;
        EXPECT_EQ(none.warnings, later.warnings);
        EXPECT_EQ(none.scene, later.scene);
        EXPECT_TRUE(forces(none) == forces(later)) << more;
        EXPECT_EQ(none.images.mesh->structure.clearance != nullptr, later.images.mesh->structure.clearance != nullptr);
    }
    EXPECT_EQ(cache_.names().size(), 3u);
}

TEST_F(MeshCache, IsOfTheFileAndItsKeysAndOfLargeMeshesAlone) {
    keep_meshes_in(cache_.path());
    files_.write("mesh.obj", testing::as_obj(shapes::icosphere(5)));
    prepared();
    EXPECT_EQ(cache_.names().size(), 0u);
    files_.write("mesh.obj", testing::as_obj(shapes::icosphere(6)));
    prepared();
    prepared("weld = \"1e-9 m\"\n");
    EXPECT_EQ(cache_.names().size(), 2u);
    PolygonSoup moved = shapes::icosphere(6);
    moved.vertices[7] *= 1.01;
    files_.write("mesh.obj", testing::as_obj(moved));
    const PreparedCase other = prepared();
    EXPECT_EQ(cache_.names().size(), 3u);
    EXPECT_NEAR(reference::length(other.images.mesh->mesh.polygons.vertices[7]), 1.01e-3, 1e-9);
}

// What is refused without it is refused with it.
TEST_F(MeshCache, RefusesTheSame) {
    const PolygonSoup sphere = shapes::icosphere(6);
    const std::string twice = testing::as_obj(shapes::merged(sphere, sphere)); // half of the facets are left out
    files_.write("mesh.obj", twice);
    files_.write("mesh.ply", twice);
    keep_meshes_in(cache_.path());
    prepared();
    ASSERT_EQ(cache_.names().size(), 1u);
    EXPECT_THROW(CasePreparation().prepare(parse_scene(
                     "[surface]\nkind = \"mesh\"\nfile = \"mesh.ply\"\nunit = \"mm\"\n", "scene", files_.path())),
                 UsageError);
    set_memory_limit(150'000'000); // enough for one of the two spheres
    const std::string kept = testing::message_of<UsageError>([&] { prepared(); });
    keep_meshes_in({});
    EXPECT_EQ(kept, testing::message_of<UsageError>([&] { prepared(); }));
    set_memory_limit(kDefaultMemory);
    EXPECT_TRUE(testing::says(kept, "163840 triangles"));
}

TEST_F(MeshCache, IsMendedWhereItIsDamaged) {
    files_.write("mesh.obj", testing::as_obj(shapes::icosphere(6)));
    keep_meshes_in(cache_.path());
    const std::vector<glm::dvec3> expected = forces(prepared());
    const std::string name = cache_.names().at(0), intact = cache_.read(name);
    std::vector<std::string> damaged{"", intact.substr(0, intact.size() / 2), intact + "x"};
    for (const std::size_t at : {std::size_t(3), std::size_t(300), intact.size() / 3, intact.size() - 3}) {
        damaged.push_back(intact);
        damaged.back()[at] = static_cast<char>(damaged.back()[at] ^ 0x40);
    }
    for (const std::string& bytes : damaged) {
        cache_.write(name, bytes);
        EXPECT_TRUE(forces(prepared()) == expected);
        EXPECT_TRUE(cache_.read(name) == intact) << bytes.size();
    }
    std::filesystem::remove(cache_ / name);
    std::filesystem::create_directory(cache_ / name);
    EXPECT_TRUE(forces(prepared()) == expected);
    keep_meshes_in("/proc/nowhere");
    EXPECT_TRUE(forces(prepared()) == expected);
}

TEST(Kept, GoesWhenItWasUsedTheLongestAgo) {
    const testing::Folder folder;
    const auto now = std::filesystem::file_time_type::clock::now();
    for (int i = 0; i < 5; ++i) {
        const auto path = kept_path(folder.path(), "mesh", std::to_string(i));
        write_kept(path, std::vector<std::byte>(1000));
        std::filesystem::last_write_time(path, now - std::chrono::hours(i == 1 ? 100 : i));
    }
    write_kept(kept_path(folder.path(), "pipelines", "x"), std::vector<std::byte>(5000));
    folder.write("mesh.obj", std::string(9000, 'c'));
    write_kept(kept_path(folder.path(), "mesh", "large"), std::vector<std::byte>(4000)); // more than all may have
    limit_kept(folder.path(), "mesh", 3 * 1064);
    EXPECT_EQ(folder.names().size(), 5u); // three of them, and what is of another kind
    EXPECT_TRUE(read_kept(kept_path(folder.path(), "mesh", "1")).empty());
    EXPECT_TRUE(read_kept(kept_path(folder.path(), "mesh", "4")).empty());
    EXPECT_EQ(read_kept(kept_path(folder.path(), "mesh", "3")).size(), 1000u);
}

} // namespace
} // namespace forceshade

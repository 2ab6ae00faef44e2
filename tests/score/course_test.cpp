// The standard course: its files are those of its version, and its strokes touch what they are to touch.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/field/prepared_case.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh_file.h"
#include "host/output/files.h"
#include "host/scene/study.h"
#include "host/score/course.h"
#include "host/score/measures.h"
#include "host/score/score.h"
#include "tests/io/folder.h"

namespace forceshade::score {
namespace {

class Course : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = new testing::Folder;
        written_ = write_course(folder_->path());
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }
    static PreparedCase prepared(const std::string& scene) {
        CasePreparation preparation;
        return preparation.prepare(read_scene(*folder_ / (scene + ".toml")));
    }
    static Strokes strokes(const std::string& scene, const PreparedCase& of) {
        return read_strokes(*folder_ / ("strokes/" + scene + ".csv"), {}, {}, size_of(of));
    }

    static inline testing::Folder* folder_ = nullptr;
    static inline CourseWritten written_;
};

TEST_F(Course, IsThatOfItsVersion) {
    EXPECT_EQ(course().size(), 12U);
    EXPECT_EQ(written_.digest, kCourseDigest) << "the law or the course has changed: another version?";
    EXPECT_TRUE(written_.standard());
    EXPECT_EQ(sha256_of_file(*folder_ / "SHA256SUMS"), kCourseDigest);
    const std::vector<std::filesystem::path> files = course_files(folder_->path());
    EXPECT_EQ(files.size(), written_.files);
    const std::string sums = folder_->read("SHA256SUMS");
    for (const std::filesystem::path& file : files) {
        const std::string name = file.lexically_relative(folder_->path()).string();
        if (name != "README.md" && name != "SHA256SUMS") {
            EXPECT_TRUE(testing::says(sums, fmt::format("{}  {}\n", sha256_of_file(file), name)));
        }
    }
    EXPECT_TRUE(testing::says(folder_->read("README.md"), std::string(kCourseDigest), "sphere_1280"));
}

TEST_F(Course, IsTheSameWheneverItIsMade) {
    const testing::Folder again;
    EXPECT_EQ(write_course(again.path()).digest, written_.digest);
    for (const std::filesystem::path& file : course_files(folder_->path())) {
        const std::filesystem::path name = file.lexically_relative(folder_->path());
        EXPECT_EQ(testing::read_text(file), testing::read_text(again.path() / name)) << name;
    }
}

TEST_F(Course, HasMeshesThatBoundOneSolid) {
    std::size_t meshes = 0;
    for (const CourseScene& scene : course()) {
        if (scene.mesh.empty())
            continue;
        ++meshes;
        const MeshFindings found = inspect(parse_polygons(scene.name + ".obj", scene.mesh).polygons);
        EXPECT_TRUE(is_solid(found)) << scene.name;
        EXPECT_TRUE(found.inside_out.empty()) << scene.name;
        EXPECT_EQ(found.triangles, found.facets) << scene.name;
        EXPECT_EQ(found.unused_vertices + found.degenerate_facets, 0U) << scene.name;
        EXPECT_TRUE(prepared(scene.name).warnings.empty()) << scene.name;
    }
    EXPECT_EQ(meshes, 11U);
}

TEST_F(Course, HasStrokesThatBeginAndEndAboveTheSurfaceAndTouchItBetween) {
    for (const CourseScene& scene : course()) {
        const PreparedCase of = prepared(scene.name);
        const Strokes all = strokes(scene.name, of);
        EXPECT_EQ(all.all.size(), kCourseStrokes);
        EXPECT_NEAR(all.period.value_or(0), 1e-3, 1e-9);
        Yardstick yardstick(of);
        for (const Stroke& stroke : all.all) {
            const Truth truth = yardstick.along(stroke);
            const std::string where = fmt::format("{}, path {}", scene.name, stroke.id);
            EXPECT_EQ(stroke.probe.size(), kCourseSamples) << where;
            EXPECT_FALSE(truth.touching.front()) << where;
            EXPECT_FALSE(truth.touching.back()) << where;
            EXPECT_GT(std::ranges::count(truth.touching, true), 100) << where;
        }
    }
}

TEST_F(Course, HasForcesThatAreTheOracles) {
    for (const char* const name : {"bump", "needle", "scan"}) {
        const PreparedCase of = prepared(name);
        const Strokes all = strokes(name, of);
        const Track forces = read_forces(*folder_ / fmt::format("oracle/{}.csv", name), {}, all);
        Yardstick yardstick(of);
        for (std::size_t i = 0; i < all.all.size(); ++i) {
            const Truth truth = yardstick.along(all.all[i]);
            for (std::size_t k = 0; k < forces[i].size(); ++k)
                for (int axis = 0; axis < 3; ++axis)
                    ASSERT_NEAR(forces[i][k][axis], truth.force[k][axis], 0.6e-9) << name << ", path " << i;
        }
    }
}

} // namespace
} // namespace forceshade::score

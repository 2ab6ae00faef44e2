// Laws without history along paths: the same as evaluated directly, whatever the shape of the file.
#include <cmath>
#include <cstring>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/paths/path_files.h"
#include "host/paths/recorded.h"
#include "tests/io/picture.h"
#include "tests/paths/path_workplace.h"

namespace forceshade::testing {
namespace {

const char* const kHeader = "path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n";

template <typename T> bool same_bits(T a, T b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

class SurfacePath : public PathWorkplace {
protected:
    SurfacePath() {
        std::mt19937_64 random(1996);
        const auto between = [&](double low, double high) {
            return std::lerp(low, high, static_cast<double>(random() >> 11) / 0x1p53);
        };
        text_ = "path,t,x,y,z\n";
        for (int i = 0; i < 9000; ++i) {
            probes_.push_back({between(-0.016, 0.016), between(-0.013, 0.013), between(-0.005, 0.006)});
            text_ += fmt::format("{},{},{},{},{}\n", i / 1800, i * 1e-3, probes_[i].x, probes_[i].y, probes_[i].z);
        }
    }

    std::vector<std::string> scenes() const {
        const std::string texture =
            "[texture]\nstiffness = \"0.2 N/mm\"\nfunction = \"sine\"\nwidth = \"2 mm\"\nheight = \"0.1 mm\"\n";
        const std::string map = "[surface]\nkind = \"height_map\"\n", shaded = "[force]\nshading = \"height_map\"\n";
        std::vector<std::vector<png_byte>> rows(4, {0, 100, 200, 50});
        write_png(path("map.png"), 4, rows);
        return {
            "[surface]\nfacets = 1\n",
            "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n" + texture,
            "[surface]\nfacets = 16\n[force]\ndepth = \"normal\"\n",
            "[surface]\nfacets = 4\n[force]\nshading = \"reference\"\nreference = \"radial\"\n",
            "[surface]\nkind = \"cylinder_bump\"\n" + texture,
            map + shaded,
            map + "function = \"gaussian\"\nradius = \"5 mm\"\n" + shaded + texture,
            map + "file = \"map.png\"\n" + shaded,
        };
    }

    template <typename T> void expect_direct(const PreparedCase& prepared) const {
        const auto tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies);
        write("in.csv", text_);
        const PathRecord result = explore(prepared, "in.csv");
        const auto rows = rows_of(read("out.csv"));
        ASSERT_EQ(rows.size(), probes_.size());
        std::uint64_t in_contact = 0;
        double largest = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const glm::dvec3& p = probes_[i];
            ASSERT_EQ(rows[i].size(), 13u);
            EXPECT_EQ(rows[i][0], std::to_string(i / 1800));
            EXPECT_TRUE(same_bits(number_in<double>(rows[i][1]), double(i) * 1e-3));
            for (int k = 0; k < 3; ++k)
                EXPECT_TRUE(same_bits(number_in<T>(rows[i][std::size_t(2 + k)]), T(p[k]))) << "where it was evaluated";
            const auto direct = reference::evaluate(tables.law(), {T(p.x), T(p.y), T(p.z)});
            const T expected[7] = {direct.proxy.x, direct.proxy.y, direct.proxy.z, direct.force.x,
                                   direct.force.y, direct.force.z, direct.depth};
            for (std::size_t k = 0; k < 7; ++k)
                ASSERT_TRUE(same_bits(number_in<T>(rows[i][5 + k]), expected[k])) << i << ' ' << k;
            const bool free = direct.facet == layout::kNoFacet;
            EXPECT_EQ(rows[i][12], free ? "-1" : std::to_string(direct.facet));
            for (int k = 0; free && k < 3; ++k) {
                EXPECT_EQ(number_in<T>(rows[i][std::size_t(5 + k)]), T(p[k])) << "out of contact g is the probe";
            }
            in_contact += !free;
            const double size = std::hypot(double(direct.force.x), double(direct.force.y), double(direct.force.z));
            largest = std::max(largest, size);
        }
        EXPECT_GT(in_contact, 1000u);
        EXPECT_LT(in_contact, 8000u);
        EXPECT_EQ(result.samples, 9000u);
        EXPECT_EQ(result.paths, 5u);
        EXPECT_EQ(result.in_contact, in_contact);
        EXPECT_EQ(result.unfinished, 0u);
        EXPECT_NEAR(result.largest_force, largest, 2 * double(std::numeric_limits<T>::epsilon()) * largest);
    }

    std::vector<glm::dvec3> probes_;
    std::string text_;
};

TEST_F(SurfacePath, IsTheLawEvaluatedDirectly) {
    for (const std::string& scene : scenes()) {
        expect_direct<float>(prepare(scene, Precision::f32));
        expect_direct<double>(prepare(scene, Precision::f64));
    }
}

TEST_F(SurfacePath, DoesNotDependOnTheColumnsOfTheFile) {
    const PreparedCase prepared = prepare(scenes()[1]);
    const std::string plain = felt(prepared, text_);
    EXPECT_TRUE(plain.starts_with(kHeader));
    std::string turned = "z,note,path,y,t,x,fx\r\n";
    for (const auto& row : rows_of(text_))
        turned += fmt::format("{},\"a, b\",{},{},{},{},9\r\n", row[4], row[0], row[3], row[1], row[2]);
    EXPECT_TRUE(felt(prepared, turned) == plain);
    EXPECT_TRUE(felt(prepared, plain) == plain) << "what was written can be explored again";
}

TEST_F(SurfacePath, IsTheSameWhenPathsAreInterleaved) {
    const PreparedCase prepared = prepare(scenes()[1]);
    const auto given = rows_of(text_);
    std::string text = "path,t,x,y,z\n";
    for (std::size_t i = 0; i < given.size(); ++i)
        text += fmt::format("{}\n", fmt::join(given[i % 5 * 1800 + i / 5], ","));
    const std::string whole = felt(prepared, text_);
    EXPECT_TRUE(felt(prepared, text) == whole);
}

TEST_F(SurfacePath, WarnsOfALastLineWithoutEnd) {
    const PreparedCase prepared = prepare(scenes()[0]);
    write("in.csv", "path,t,x,y,z\n0,0,0,0,-0.001");
    const PathRecord result = explore(prepared, "in.csv");
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_TRUE(says(result.warnings[0], "in.csv:2:15: the last line has no line feed"));
    write("in.csv", "path,t,x,y,z\n0,0,0,0,-0.001\n");
    EXPECT_EQ(explore(prepared, "in.csv").warnings.size(), 0u);
}

TEST_F(SurfacePath, LeavesNothingWhereSomethingIsWrong) {
    const PreparedCase prepared = prepare(scenes()[0], Precision::f32);
    write("in.csv", text_ + "0,0,nan,0,0\n");
    EXPECT_TRUE(says(message_of<UsageError>([&] { explore(prepared, "in.csv"); }), "in.csv:9002:5: x: "));
    write("in.csv", "path,t,x,y,z\n0,0,1e16,0,0\n");
    EXPECT_TRUE(says(message_of<UsageError>([&] { explore(prepared, "in.csv"); }), "too far away"));
    write("in.csv", text_);
    EXPECT_NE(message_of<IoError>([&] { explore(prepared, "in.csv", "nosuch/out.csv"); }), "");
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"in.csv", "map.png"}));
    write("out.csv", "mine"); // what was there before an error stays
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0\n0,0,0,0\n");
    EXPECT_NE(message_of<UsageError>([&] { explore(prepared, "in.csv"); }), "");
    EXPECT_EQ(read("out.csv"), "mine");
}

// Where forces are as large as scenes and paths may make them, they are still numbers.
TEST_F(SurfacePath, IsFiniteAtTheLimitsOfItsPrecision) {
    const std::string scene = "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n";
    for (const Precision precision : {Precision::f32, Precision::f64}) {
        const char* far = precision == Precision::f32 ? "1e15" : "1e150";
        const auto rows = rows_of(
            felt(prepare(scene, precision), fmt::format("path,t,x,y,z\n0,0,0,0,-{0}\n0,1,-{0},{0},-{0}\n0,2,{0},0,{0}\n"
                                                        "0,3,1e-320,0,-1e-320\n",
                                                        far)));
        EXPECT_NEAR(number_in<double>(rows[0][10]) / number_in<double>(far), 1000, 1e-3);
        EXPECT_EQ(rows[2][12], "-1");
    }
}

} // namespace
} // namespace forceshade::testing

// Files of strokes and forces, as other programs write them.
#include <cstring>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/score/strokes.h"
#include "tests/io/folder.h"

namespace forceshade::score {
namespace {

class StrokeFile : public ::testing::Test {
protected:
    Strokes strokes(const std::string& text, const std::string& map = "", std::optional<double> rate = {},
                    const char* name = "strokes.csv") const {
        return read_strokes(folder_.write(name, text), parse_map(map), rate, 0.1);
    }
    std::string refusal(const std::string& text, const std::string& map = "", std::optional<double> rate = {}) const {
        return testing::message_of<UsageError>([&] { strokes(text, map, rate); });
    }
    static void expect_two(const Strokes& two) {
        ASSERT_EQ(two.all.size(), 1U);
        ASSERT_EQ(two.samples(), 2U);
        EXPECT_NEAR(two.all[0].probe[1].x, 0.002, 1e-12);
        EXPECT_NEAR(two.all[0].probe[1].y, -0.005, 1e-12);
        EXPECT_NEAR(two.all[0].probe[1].z, 0.003, 1e-12);
        EXPECT_NEAR(*two.period, 0.001, 1e-12);
    }

    testing::Folder folder_;
};

TEST_F(StrokeFile, IsReadWhateverItsNamesUnitsAndForm) {
    expect_two(strokes("path,t,x,y,z\n7,0,0,0,0\n7,0.001,0.002,-0.005,0.003\n"));
    expect_two(strokes("time_ms,x_mm,y_mm,z_mm\n0,0,0,0\n1,2,-5,3\n"));
    expect_two(strokes("t [ms],pos_x (mm),pos_y (mm),pos_z (mm)\n0,0,0,0\n1,2,-5,3\n"));
    expect_two(strokes("clock,a,b,c\n0,0,0,0\n1,2,3,5\n", "t=clock ms, x=a mm, y=-c mm, z=b mm"));
    expect_two(strokes("t_ms;a_mm;b [mm];c (mm)\n0;0;0;0\n1;2;-5;3\n", "x=a, y=b, z=c mm"));
    expect_two(strokes("# a .traj\n0 0 0\n2\t-5 3\n", "x=#1 mm, y=#2 mm, z=#3 mm", 1000));
    expect_two(strokes("# by numpy.savetxt\n# t_ms x_mm y_mm z_mm\n0 0 0 0\n1 2 -5 3\n"));
    expect_two(strokes("# t,x,y,z\n0,0,0,0\n# later\n0.001,0.002,-0.005,0.003\n"));
    expect_two(strokes("\xEF\xBB\xBFt\tpos x [mm]\ty\tz\n0\t0\t0\t0\n0.001\t2\t-0.005\t0.003\n", "x='pos x'"));
    expect_two(strokes("t;x;y;z\n0;0;0;0\n0,001;0,002;-0,005;0,003\n"));
    expect_two(strokes("\"t\";\"x\";\"y\";\"z\"\n0;0;0;0\n0,001;0,002;-0,005;0,003\n"));
    expect_two(strokes("\tt\tx\ty\tz\tnote\n0\t0\t0\t0\t0\t\n1\t0,001\t0,002\t-0,005\t0,003\tabc\n"));
    expect_two(strokes("t,lat_s,\"a, b\",c\n0,0,0,0\n0.001,2,-0.005,3\n", "x=lat_s mm, y='a, b', z=#4 mm"));
    expect_two(strokes("0;0;0\r\n0.002;-0.005;0.003\r\n", "x=#1,y=#2,z=#3", 1000));
    std::string array("\x93NUMPY\x01\x00\x76\x00", 10);
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
    header.resize(117, ' ');
    array += header + "\n";
    for (const double number : {0.0, 0.0, 0.0, 2.0, -5.0, 3.0})
        array.append(reinterpret_cast<const char*>(&number), sizeof number);
    expect_two(strokes(array, "x=#1 mm, y=#2 mm, z=#3 mm", 1000, "strokes.npy"));
    EXPECT_THROW(strokes(array.substr(0, array.size() - 1), "x=#1", 1000, "strokes.npy"), UsageError);
}

TEST_F(StrokeFile, ThatIsWrongIsRefusedWithWhatWouldBeRight) {
    EXPECT_TRUE(testing::says(refusal("t,a,b,c\n0,0,0,0\n"),
                              "no column is called x, y, z; the columns are t, a, b, c. Say which they are",
                              "z=COLUMN mm"));
    EXPECT_TRUE(testing::says(refusal("x,y,z\n0,0,0\n"), "--rate"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n1,12,0,0\n"),
                              "positions reach 12 m, the scene 0.1 m. If the file is in mm"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n0,0,0,0\n"), ":3: t: 0 s comes after 0 s"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,nan\n"), ":2: a position or time is missing or not finite"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0\n"), ":2: 3 numbers in this row, 4 in the first"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n1,a,0,0\n"), ":3: \"a\" in column x is no number"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n"), "no row of numbers"));
    EXPECT_TRUE(testing::says(refusal(std::string("\xFF\xFEt\0", 4)), "UTF-16"));
    EXPECT_TRUE(
        testing::says(refusal("t,a,y,z\n0,0,0,0\n", "x=q mm"), "--map names a column for x that is not there (q)"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n", "x=x furlong"), "--map: the unit of x"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n", "w=x"), "QUANTITY=COLUMN UNIT"));
    EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n", "", 1000), "leave --rate out"));
    for (const char* const map : {"x=z mm, z=z mm", "x=#4", "x=-z"})
        EXPECT_TRUE(testing::says(refusal("t,x,y,z\n0,0,0,0\n", map), "column z would be both x and z")) << map;
    EXPECT_EQ(strokes("t,x,y,z\n0,1,2,3\n", "x=y mm, y=x mm").all[0].probe[0].x, 0.002);
}

TEST_F(StrokeFile, AColumnOfTheMapThatNoFileHasIsRefused) {
    const ColumnMap map = parse_map("x=q mm");
    read_strokes(folder_.write("strokes.csv", "t,x,y,z\n0,0,0,0\n"), map, {}, 0.1);
    EXPECT_TRUE(testing::says(testing::message_of<UsageError>([&] { require_found(map); }), "no file has a column q"));
}

TEST_F(StrokeFile, WithGapsHasNoPeriodAndSaysWhere) {
    const Strokes gap = strokes("t,x,y,z\n0,0,0,0\n0.001,0,0,0\n0.005,0,0,0\n");
    EXPECT_FALSE(gap.period);
    ASSERT_EQ(gap.warnings.size(), 1U);
    EXPECT_TRUE(testing::says(gap.warnings[0], ":4: 0.004 s after the sample before"));
}

TEST_F(StrokeFile, ForcesBelongToTheSameSamples) {
    const Strokes two = strokes("path,t,x,y,z\n1,0,0,0,0\n2,0,0.001,0,0\n1,0.001,0,0,0.001\n");
    const auto forces = [&](const std::string& text) {
        return read_forces(folder_.write("forces.csv", text), {}, two);
    };
    const Track track = forces("path,fx,fy,fz_mN\n1,0,0,1\n1,0,0,2\n2,nan,0,3\n");
    EXPECT_NEAR(track[0][1].z, 0.002, 1e-12);
    EXPECT_NEAR(track[1][0].z, 0.003, 1e-12);
    EXPECT_TRUE(std::isnan(track[1][0].x));
    const Track in_order = forces("fx,fy,fz\n0,0,1\n0,0,2\n0,0,3\n");
    EXPECT_EQ(in_order[0][1].z, 3) << "rows as the strokes' file has them";
    EXPECT_EQ(in_order[1][0].z, 2);
    EXPECT_THROW(forces("fx,fy,fz\n0,0,0\n"), UsageError) << "too few";
    EXPECT_THROW(forces("path,fx,fy,fz\n1,0,0,0\n1,0,0,0\n3,0,0,0\n"), UsageError) << "another path";
    EXPECT_NO_THROW(forces("path,x,y,z,fx,fy,fz\n1,0,0,0,0,0,0\n2,0.001,0,0,0,0,0\n1,0,0,0.001,0,0,0\n"));
    EXPECT_THROW(forces("path,x,y,z,fx,fy,fz\n1,0,0,0,0,0,0\n2,0,0.001,0,0,0,0\n1,0,0,0.001,0,0,0\n"), UsageError)
        << "x and y exchanged";
}

} // namespace
} // namespace forceshade::score

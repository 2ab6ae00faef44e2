// The viewer's volumes: what they keep of the files, and how much of the page they take.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <zlib.h>

#include "host/report/sections.h"
#include "tests/io/folder.h"
#include "tests/report/sample_folder.h"

namespace forceshade::report {
namespace {

using namespace testing;

TEST(Base64, IsThatOfTheStandard) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

double value_of(std::uint16_t half) {
    const int exponent = half >> 10 & 31, fraction = half & 1023;
    const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    return half & 0x8000 ? -size : size;
}

// As the page unpacks them.
std::vector<double> unpacked(const PackedValues& packed, const SampledVolume& volume) {
    const std::size_t count = volume.size[0] * volume.size[1] * volume.size[2];
    std::vector<unsigned char> planes(6 * count);
    uLongf length = planes.size();
    EXPECT_EQ(
        uncompress(planes.data(), &length, reinterpret_cast<const Bytef*>(packed.bytes.data()), packed.bytes.size()),
        Z_OK);
    EXPECT_EQ(length, planes.size());
    std::vector<double> values(3 * count);
    for (std::size_t component = 0; component < 3; ++component) {
        std::uint16_t half = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const unsigned step = planes[2 * component * count + i] * 256u + planes[(2 * component + 1) * count + i];
            half = static_cast<std::uint16_t>((i % volume.size[0] ? half : 0) + step);
            values[3 * i + component] = value_of(half) * packed.scale;
        }
    }
    return values;
}

TEST(PackedForces, AreThoseOfTheFileToElevenBits) {
    const Folder folder;
    write_sample_case(folder.path(), {.name = "a", .strength = 3e-9});
    const SampledVolume volume = sample_volume(folder.path() / "a.exr", 1u << 20);
    EXPECT_EQ(volume.size, (std::array<std::uint64_t, 3>{24, 6, 16}));
    const std::vector<double> values = unpacked(pack_values(volume.force, 3, volume.size[0]), volume);
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(values[i], static_cast<double>(volume.force[i]),
                    std::fabs(static_cast<double>(volume.force[i])) * 0x1p-11 + 1e-9 * 0x1p-23);
}

TEST(SampledVolumes, OfFieldsAlikeInYHoldOneY) {
    const Folder folder;
    write_sample_case(folder.path(), {.name = "a", .alike_in_y = true});
    const SampledVolume volume = sample_volume(folder.path() / "a.exr", 1u << 20);
    EXPECT_TRUE(volume.alike_in_y);
    EXPECT_EQ(volume.size, (std::array<std::uint64_t, 3>{24, 1, 16}));
    EXPECT_EQ(volume.stride, (std::array<std::uint64_t, 3>{1, 6, 1}));
}

TEST(SampledVolumes, OfOneYStandForAllWhereTheSceneDoesNotDependOnY) {
    const Folder folder;
    const auto alike = [&](const std::string& scene, std::uint64_t ny = 1) {
        write_sample_case(folder.path(), {.name = "a", .size = {24, ny, 16}, .scene = scene});
        return sample_volume(folder.path() / "a.exr", 1u << 20).alike_in_y;
    };
    const std::string bump = "[surface]\nkind = \"bump\"\nfacets = 8\n";
    EXPECT_TRUE(alike(bump));
    EXPECT_TRUE(alike("# a remark\n" + bump + "[force]\nshading = \"reference\"\n"));
    EXPECT_FALSE(alike(bump, 6)) << "what the file holds at every y is shown at every y";
    EXPECT_FALSE(alike("[surface]\nkind = \"mesh\"\nfile = \"a.off\"\n"));
    EXPECT_TRUE(alike(bump + "[texture]\nfunction = \"sine\"\n"));
    EXPECT_FALSE(alike(bump + "[texture]\nfunction = \"gaussian\"\n"));
    EXPECT_FALSE(alike("")) << "nothing is known of it";
    EXPECT_TRUE(alike(bump + "[compare]\nsurface = { kind = \"cylinder\" }\n"));
    EXPECT_FALSE(alike(bump + "[compare]\nsurface = { kind = \"sphere\", radius = \"20 mm\" }\n"));
    EXPECT_FALSE(alike("kind = "));
    EXPECT_FALSE(alike("[surface]\nkind = \"of another version\"\n"));
}

TEST(SampledVolumes, AreThinnedToTheirNumber) {
    const Folder folder;
    write_sample_case(folder.path(), {.name = "a"});
    for (const std::uint64_t most : {1u, 10u, 300u, 2303u}) {
        const SampledVolume volume = sample_volume(folder.path() / "a.exr", most);
        EXPECT_LE(volume.size[0] * volume.size[1] * volume.size[2], most);
        EXPECT_EQ(volume.force.size(), 3 * volume.size[0] * volume.size[1] * volume.size[2]);
    }
}

TEST(Viewers, KeepToTheirBudget) {
    const Folder folder;
    Sweep sweep;
    for (const char* name : {"a", "b", "c"})
        sweep.cases.push_back(write_sample_case(folder.path(), {.name = name, .size = {64, 16, 32}, .noise = true}));
    const Contents contents{{sweep}, {}, {}};
    std::vector<std::string> troubles;
    std::vector<NamedScene> shown;
    const std::string whole = viewer_section(folder.path(), contents, troubles, 7'000'000, shown);
    EXPECT_GT(whole.size(), 600'000u);
    EXPECT_EQ(whole.find("thinned"), std::string::npos);
    const std::string small = viewer_section(folder.path(), contents, troubles, 100'000, shown);
    EXPECT_LT(small.size(), 120'000u); // the frame is a few kilobytes
    EXPECT_GT(small.size(), 30'000u) << "the budget is used";
    EXPECT_NE(small.find("3 of 3 volumes are thinned"), std::string::npos);
    EXPECT_TRUE(troubles.empty());
}

TEST(Viewers, AreLeftOutWithoutVolumes) {
    std::vector<std::string> troubles;
    std::vector<NamedScene> shown;
    EXPECT_EQ(viewer_section(".", {}, troubles, 1'000'000, shown), "");
}

// A row for each scheme that error-time has; a ratio of times that is told from 1, or none.
TEST(Verdict, SetsSchemesSideBySide) {
    struct Way {
        const char *surface, *family, *shading;
        double elements, direction, rms, one_sided, median, p95;
    };
    const std::vector<Way> ways{{"mesh", "god-object", "none", 8, 4.2, 0.13, 0.26, 0.084, 0.826},
                                {"mesh", "god-object", "barycentric", 8, 0.2, 0.11, 0.25, 0.076, 0.826},
                                {"mesh", "god-object", "none", 16, 2.1, 0.05, 0.02, 0.02, 0.3},
                                {"mesh", "god-object", "none", 64, 0.9, 0.009, 0, 0.001, 0.02}};
    StudyPart part;
    study::StudyData& data = part.data;
    data.study = "error-time";
    std::string busy = "no";
    const auto busy_word = [&](const Way&) { return busy; };
    const auto ways_table = [&] {
        return study::table_of<Way>(
            "ways", "",
            {{"surface", "", "", &Way::surface},
             {"family", "", "", &Way::family},
             {"busy", "", "", busy_word},
             {"precision", "", "", [](const Way&) { return "f64"; }},
             {"shading", "", "", &Way::shading},
             {"elements", "1", "", &Way::elements},
             {"direction_rms_deg", "deg", "", &Way::direction},
             {"direction_low_deg", "deg", "", [](const Way& way) { return 0.8 * way.direction; }},
             {"direction_high_deg", "deg", "", [](const Way& way) { return 1.2 * way.direction; }},
             {"typical_rms_1", "1", "", &Way::rms},
             {"one_sided", "1", "", &Way::one_sided},
             {"size_median_1", "1", "", &Way::median},
             {"size_p95_1", "1", "", &Way::p95}},
            ways);
    };
    data.tables.push_back(ways_table());
    struct Limit {
        const char* hand;
        double depth, usual, any;
    };
    StudyPart stability; // the least of every direction in which a hand may press, of its own and of deep places
    stability.data.study = "stability";
    stability.data.tables.push_back(study::table_of<Limit>(
        "loop_limits", "",
        {{"surface", "", "", [](const Limit&) { return "barycentric mesh"; }},
         {"hand", "", "", &Limit::hand},
         {"depth_mm", "mm", "", &Limit::depth},
         {"limit_N_per_m", "N/m", "", &Limit::usual},
         {"any_press_N_per_m", "N/m", "", &Limit::any}},
        std::vector<Limit>{{"own", 2, 1383, 766}, {"own", 0.2, 11, 10}, {"around", 2, 100, 90}}));
    stability.data.tables.push_back(
        study::table_of<double>("loop_tessellations", "",
                                {{"surface", "", "", [](double) { return "barycentric mesh"; }},
                                 {"tessellation", "1", "", [](double) { return 3; }},
                                 {"depth_mm", "mm", "", [](double) { return 2; }},
                                 {"any_press_N_per_m", "N/m", "", [](double of) { return of; }}},
                                std::vector<double>{800, 850}));
    const auto with_times = [&](double shaded) {
        struct Time {
            double round, way, time;
        };
        std::vector<Time> times;
        for (int round = 0; round < 9; ++round) {
            times.push_back({double(round), 1, 100.0 + round});
            times.push_back({double(round), 2, shaded * (100.0 + round) * (1 + 0.02 * (round % 3 - 1))});
            times.push_back({double(round), 4, 2 * shaded * (100.0 + round)});
        }
        Contents contents{{}, {part, stability}, {}};
        contents.studies[0].data.tables.push_back(study::table_of<Time>(
            "rounds", "",
            {{"round", "1", "", &Time::round}, {"way", "1", "", &Time::way}, {"time_ns", "ns", "", &Time::time}},
            times));
        return verdict_section(contents);
    };
    const std::string slower = with_times(1.5);
    for (const char* cell :
         {"deg RMS (of draws)\">0.2 (0.16 to 0.24)</td>", "RMS force\">11</td>", "places\">25</td>",
          "interval]\">1.50 [1.34, 1.68]</td>", "K = 500 N/m\">1.5 (1.5 to 1.6)</td>",
          "error goes from 8.4 to 7.6 % of the force in the median and stays at 83 % in the", "from 4.2 to 0.2 deg",
          "shape has a force goes from 26 to 25 %",
          "64 x 64 cells unshaded err by 0.9 deg and 0.9 % of the RMS force (both RMS), and take 2.00 [1.78, 2.24] "
          "times as long as 8 x 8 cells shaded"})
        EXPECT_TRUE(says(slower, cell)) << cell;
    EXPECT_FALSE(says(slower, "mesh, two_pass"));
    EXPECT_TRUE(says(with_times(1), ">[0.89, 1.12]</td>"));
    busy = "yes";
    part.data.tables[0] = ways_table();
    EXPECT_TRUE(says(with_times(1.5), "not known: the machine was busy"));
    EXPECT_FALSE(says(with_times(1.5), "times as long"));
    EXPECT_EQ(verdict_section({{}, {part}, {}}), "") << "without its rounds";
    EXPECT_EQ(verdict_section({}), "");
}

TEST(DeviceSection, TakesSurfacesOfStudiesAndNoVolumeWithoutAScene) {
    const std::string none = device_section({{"a volume", ""}});
    EXPECT_TRUE(says(none, "\"scene\":false")) << none;
    EXPECT_TRUE(says(none, "\"weak\":[]")) << none;
    EXPECT_TRUE(says(device_section({{"a volume", ""}, {"a study", "", "[{\"case\": \"the shaded bump\"}]"}}),
                     "\"weak\":[{\"case\":\"the shaded bump\"}]"));
}

TEST(SweepFindings, FollowTheData) {
    Sweep sweep;
    EXPECT_TRUE(sweep_findings(sweep).empty());
    CaseRecord a, b;
    a.name = "a";
    b.name = "b";
    a.voxels = b.voxels = b.evaluated = a.error.compared = b.error.compared = 1000;
    a.evaluated = 10;
    a.largest_force = 2;
    b.largest_force = 3;
    a.error.largest_force = b.error.largest_force = 2;
    a.error.largest = 1e-6;
    a.error.differing = 3;
    a.error.beyond = 1;
    a.engine_times.kernel = 1;
    b.engine_times.kernel = 0.5;
    sweep.cases = {a, b};
    const auto expect = [&](const std::string& name, const std::string& words) {
        const auto findings = sweep_findings(sweep);
        const auto found = std::ranges::find(findings, name, &study::Finding::name);
        ASSERT_NE(found, findings.end()) << name;
        EXPECT_TRUE(says(found->text, words));
    };
    expect("agreement", "3 differ, 1 of them by more than rounding allows");
    expect("largest_error", "5×10⁻⁷ of the case's largest force (10⁻⁶ N), in a.");
    expect("largest_force", "3 N, in b");
    expect("dearest_case", "1000 ms to compute, a.");
    expect("evaluated", "Only 1\u00a0010 of 2\u00a0000 voxels");
    sweep.cases[0].parameters = {{"facets", "2"}, {"shading", "none"}};
    sweep.cases[1].parameters = {{"facets", "2"}, {"shading", "reference"}};
    const auto touch = [](DrawnNumber direction, DrawnNumber force) {
        return TouchRecord{"the smooth shape", 1000, 8, 2e-3, direction, force, {1, 1, 1}, {0, 0, 0}};
    };
    sweep.cases[0].touch = touch({7.9, 7.2, 8.1}, {0.47, 0.44, 0.5});
    sweep.cases[1].touch = touch({1e-15, 1e-16, 1e-14}, {0.049, 0.047, 0.052});
    expect("touch", "7.9 (7.2 to 8.1) deg without shading and 0 deg with it (RMS) from that of the smooth shape (its "
                    "normal above the probe");
    expect("touch", "errs by 47 (44 to 50) % without shading and 4.9 (4.7 to 5.2) % with it (median; ranges are over "
                    "cases and 8 draws of places).");
    sweep.cases[0].touch->missed.value = 0.25;
    expect("touch", "Of a, 25 % of the places have no force.");
    sweep.cases[0].touch->direction = {};
    expect("touch", "direction is nowhere defined without shading and 0 deg with it");
    sweep.cases[0].touch->direction = {7.9, 7.2, 8.1};
    for (CaseRecord& one : sweep.cases)
        one.deviation = {
            .from = "the sphere", .angles = 10, .rms_angle = 3, .magnitudes = 10, .rms_magnitude_error = 0.5};
    expect("compare",
           "Compared with the sphere, the force's direction differs by 3 deg without shading and 3 deg with it");
    for (CaseRecord& one : sweep.cases) {
        one.paths.emplace();
        one.paths->paths = 4;
        one.paths->largest_force = one.name == "a" ? 2 : 3;
        one.paths->work = one.name == "a" ? -0.01 : 0.02;
    }
    expect("paths", "The largest force on a path is 2 N without shading and 3 N with it, the work on the hand per path "
                    "−2.5 mJ without shading and 5 mJ with it. 8 paths");
    study::StudyData data;
    add_path_figures(sweep, data);
    ASSERT_EQ(data.figures.size(), 2u) << "without [compare]";
    EXPECT_EQ(data.tables[0].number(1, "work_mJ"), 5);
    data = {};
    add_touch_figures(sweep, data);
    ASSERT_EQ(data.figures.size(), 2u);
    EXPECT_EQ(data.figures[0].kind, study::FigureKind::bars) << "no number varies";
    EXPECT_EQ(data.figures[0].x.column, "shading");
    sweep.cases[0].parameters.push_back({"file", "3spheres.obj"});
    sweep.cases[1].parameters.push_back({"file", "4spheres.obj"});
    data = {};
    add_touch_figures(sweep, data);
    EXPECT_EQ(data.figures[0].kind, study::FigureKind::scatter) << "3 and 4 are numbers of one unit";
    sweep.cases[1].parameters.back().second = "cow.obj";
    data = {};
    add_touch_figures(sweep, data);
    EXPECT_EQ(data.figures[0].kind, study::FigureKind::bars);
    EXPECT_EQ(data.figures[0].x.column, "file");
    for (CaseRecord& one : sweep.cases)
        one.parameters.pop_back();
    data = {};
    sweep.cases[1].parameters[0].second = "3";
    add_touch_figures(sweep, data);
    ASSERT_EQ(data.figures.size(), 2u);
    EXPECT_EQ(data.figures[0].x.column, "facets");
    EXPECT_EQ(data.table("touch").rows.size(), 2u);
    EXPECT_EQ(data.figures[0].panels, "");
    data = {};
    for (const char* radius : {"600 mil", "900 mil", "1 in"})
        for (std::size_t i : {0, 1})
            sweep.cases.push_back(sweep.cases[i]), sweep.cases.back().parameters.push_back({"radius", radius});
    add_touch_figures(sweep, data);
    EXPECT_EQ(data.figures[0].x.column, "facets") << "before the radius, which has more values";
    EXPECT_EQ(data.figures[0].panels, "radius");
    sweep.cases.resize(2);
    add_compare_figures(sweep, data);
    EXPECT_EQ(data.table("compare").needed(1, "angle_deg"), 3);
    EXPECT_EQ(data.figures.back().panels, "");
    sweep.cases[0].deviation->from = "the bump's own";
    sweep.cases[1].deviation->rms_angle = 5;
    data = {};
    add_compare_figures(sweep, data);
    EXPECT_EQ(data.figures.back().panels, "compared with") << "depth is read at another place";
    EXPECT_TRUE(says(data.figures.back().caption, "Compared with the bump's own, or the sphere, at"));
    expect("compare", "Compared with the bump's own, the force's direction differs by 3 deg");
    expect("compare", ". Compared with the sphere, the force's direction differs by 5 deg");
    sweep.cases[0].error.differing = sweep.cases[0].error.beyond = 0;
    sweep.cases[0].engine.engine = "cpu";
    expect("agreement", "Of 1\u00a0000 voxels"); // of the other case alone
    for (CaseRecord& one : sweep.cases)
        one.engine.engine = "cpu";
    EXPECT_EQ(std::ranges::count(sweep_findings(sweep), "agreement", &study::Finding::name), 0)
        << "an oracle that equals itself says nothing";
}

} // namespace
} // namespace forceshade::report

// What is shown in space, and "my device": turned, pointed at, played, computed and saved in headless Chromium.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/limits.h"
#include "host/output/exr_volume.h"
#include "host/report/sections.h"
#include "host/scene/study.h"
#include "tests/report/page_test.h"

namespace forceshade::report {
namespace {

using namespace testing;

constexpr const char* kScene = "[surface]\nkind = \"bump\"\nwidth = \"10 mm\"\nradius = \"6 mm\"\nfacets = 2\n"
                               "[force]\nstiffness = \"2 N/mm\"\nshading = \"reference\"\n[paths]\nrate = \"1 kHz\"\n";
constexpr const char* kRead = "document.getElementById('space-read').textContent";

void write_case_with_paths(const std::filesystem::path& folder) {
    write_sample_manifest(
        folder,
        {write_sample_case(folder, {.name = "bump_shading-none"}),
         write_sample_case(folder, {.name = "bump_shading-reference", .strength = 2, .scene = kScene, .paths = true})});
}

class Space : public ReportPage {
protected:
    static void SetUpTestSuite() {
        write_case_with_paths(folder_->path());
        write_sample_study(folder_->path() / "energy");
        begin();
    }

    static void open(const std::string& before = {}) {
        ReportPage::open(1200, false, before);
        browser_->evaluate("document.getElementById('space-box').scrollIntoView({block: 'center'})");
    }
    void open_space() {
        open();
        ASSERT_TRUE(browser_->wait_for("document.documentElement.dataset.space === 'ready'")) << browser_->text(kRead);
        browser_->evaluate("window.saved = {}; window.save = (name, address) => { saved[name] = address; }; 0");
    }
    // What the button saves.
    std::string saved(const std::string& button, const std::string& name) {
        browser_->click(button);
        return browser_->text("decodeURIComponent(saved['" + name + "'])");
    }
    // A slider put to a share of its range.
    void slide(const std::string& id, double share) {
        browser_->set("#" + id, "Number(e.min) + (e.max - e.min) * " + std::to_string(share), "input");
    }
    double number(const std::string& expression) { return browser_->evaluate(expression).get<double>(); }
};

TEST_F(Space, IsTurnedAndSavedAsPng) {
    open_space();
    const std::string before = saved("#space-png", "space.png");
    EXPECT_TRUE(before.starts_with("data:image/png"));
    EXPECT_GT(before.size(), 20'000u) << "something is drawn";
    browser_->drag("#space", 300, 200, 150, -60);
    const std::string turned = saved("#space-png", "space.png");
    EXPECT_NE(turned, before);
    browser_->click("#space-home");
    EXPECT_NE(saved("#space-png", "space.png"), turned);
}

TEST_F(Space, ASliceIsMovedPointedAtAndSavedAsCsv) {
    open_space();
    const std::string picture = saved("#space-png", "space.png");
    browser_->click("#axis-z");
    EXPECT_NE(saved("#space-png", "space.png"), picture);
    // Below 0 there is force; seen from above nothing of the slice is hidden.
    slide("slice", 0.1);
    const std::string before = browser_->text(kRead);
    browser_->drag("#space", 330, 250, 0, 0);
    const std::string text = browser_->text(kRead);
    EXPECT_NE(text, before) << "the place that was pointed at";
    EXPECT_TRUE(says(text, " from +y"));
    // The same number as in the table of the slices.
    const double read = number("Number(/A: ([0-9.]+) N/.exec(" + std::string(kRead) + ")[1])");
    EXPECT_NEAR(read, number("Number(document.getElementById('read-rows').children[0].children[1].textContent)"),
                0.01 * read);
    const std::string csv = saved("#space-csv", "slice.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 2 * 24 * 6) << "both cases' samples of a slice across z";
    EXPECT_TRUE(says(csv, "case,x_m,y_m,z_m,fx_N,fy_N,fz_N\n"));
}

TEST_F(Space, PathsAreChosenAndPlayed) {
    open_space();
    EXPECT_EQ(browser_->text("document.getElementById('path').options.length"), "2");
    const std::string text = "document.getElementById('path-text').value";
    EXPECT_EQ(browser_->text(text), "t = 0 s, B 2.00 N");
    slide("path-time", 0.5);
    EXPECT_EQ(browser_->text(text), "t = 0.00500 s, B 1.00 N");
    const std::string picture = saved("#space-png", "space.png");
    slide("path-time", 0.8);
    EXPECT_NE(saved("#space-png", "space.png"), picture) << "the probe moves";
    browser_->click("#path-play");
    EXPECT_TRUE(browser_->wait_for("document.getElementById('path-time').value === '10'"));
    EXPECT_TRUE(browser_->wait_for("document.getElementById('path-play').textContent.includes('play')"));
    browser_->set("#path", "'1'");
    EXPECT_EQ(browser_->text(text), "") << "the second path has ended before";
}

TEST_F(Space, TellsWhereThereIsNoWebGl) {
    open(kNoWebGl);
    EXPECT_TRUE(browser_->wait_for("document.getElementById('space-note').textContent.includes('has no WebGL')"));
    EXPECT_TRUE(browser_->evaluate("document.getElementById('space-box').hidden").get<bool>());
    EXPECT_FALSE(browser_->evaluate("document.getElementById('viewer-body').hidden").get<bool>());
}

// The limits of the laws: m, b, T; K_crit, K_crit one sample late.
TEST_F(Space, DeviceComputesTheLimits) {
    open();
    const double table[][5] = {{0.075, 0.5, 1, 1001.11, 333.95},  {0.1, 1, 1, 2003.34, 668.51},
                               {0.1, 5, 1, 10084.03, 3378.94},    {0.1, 1, 0.1, 20003.33, 6668.52},
                               {0.05, 20, 1, 42849.01, 14646.91}, {0.01, 50, 1, 165192.52, 48213.32}};
    for (const auto& [mass, damping, period, at_once, late] : table)
        for (const int delay : {0, 1})
            EXPECT_NEAR(number("criticalStiffness(" + std::to_string(mass) + ", " + std::to_string(damping) + ", " +
                               std::to_string(1e-3 * period) + ", " + std::to_string(delay) + ")"),
                        delay ? late : at_once, 0.006)
                << mass << ' ' << damping << ' ' << period;
    EXPECT_NEAR(number("passiveStiffness(1, 1e-3, 1)"), 1 / (1e-3 * 1.5), 1e-9);
    const double radius = 0.01524,
                 aside = 0.0127; // the rim of the paper's bump, and the limit that the study has there
    EXPECT_NEAR(number("heldStiffness(500, 0.01524, Math.asin(0.0127 / 0.01524), 2e-3)"),
                500 * (radius * radius - aside * aside) / radius / 2e-3, 1e-6);
}

// For any hand what the program finds at these places, by other code; for the scene's own hand what `live` says of it.
TEST_F(Space, DeviceComputesTheLimitsOfTheScenesSurface) {
    open();
    const PreparedCase prepared = CasePreparation().prepare(parse_scene(kScene, "test"));
    const std::vector<WeakPlace> weak = weak_places("test", prepared);
    ASSERT_GT(weak.size(), 4U);
    const auto least_of = [&](const HandSpec& hand, double rate) {
        double least = INFINITY;
        for (const WeakPlace& one : weak)
            if (one.usual)
                least =
                    std::min(least, linear_limit(hand, rate, one.hold, one.place.force_around()).value_or(INFINITY));
        return least;
    };
    const HandSpec own = prepared.one.scene.hand;
    HandSpec soft = own, stiff = own, late = own, quick = own;
    soft.grip_stiffness = 60;
    stiff.grip_stiffness = 4000;
    late.delay_samples = 3;
    quick.mass = 0.03;
    quick.damping = 4;
    for (const HandSpec& hand : {own, soft, stiff, late, quick})
        for (const double rate : {1000.0, 4000.0}) {
            const double least = least_of(hand, rate);
            const std::string values =
                fmt::format("{{mass: {}, damping: {}, grip: {}, spring: {}, period: {}, delay: {}}}", hand.mass,
                            hand.damping, hand.grip_damping, hand.grip_stiffness, 1 / rate, hand.delay_samples);
            EXPECT_NEAR(number("weakest(" + values +
                               ", JSON.parse(document.getElementById('device-data').textContent).weak.filter((one) => "
                               "one.usual), 1e7).limit"),
                        least, 1e-3 * least)
                << values;
        }
    const double said = *scene_limits(prepared).least->limit;
    EXPECT_NEAR(least_of(own, 1000), said, 1e-3 * said);
}

// Without a volume, too.
TEST_F(Space, DeviceTakesTheSceneOfAStudy) {
    const Folder folder;
    write_sample_study(folder / "stability", kScene);
    browser_->open(write_report(folder.path()).file);
    const std::string verdict = browser_->text("document.getElementById('device-verdict').textContent");
    EXPECT_TRUE(says(verdict, "2000 N/m on a wall")) << verdict;
    EXPECT_TRUE(says(verdict, " on the scene of study stability: ")) << verdict;
    EXPECT_EQ(number("document.querySelectorAll('#device-radius').length"), 0) << "the scene has it";
    write_sample_study(folder / "stability");
    browser_->open(write_report(folder.path()).file);
    EXPECT_TRUE(
        says(browser_->text("document.getElementById('device-verdict').textContent"), "On the shaded cylinder"));
}

TEST_F(Space, DeviceSaysWhetherAWallIsStable) {
    open();
    const std::string verdict = "document.getElementById('device-verdict').textContent";
    EXPECT_EQ(browser_->text("document.querySelector('#device label:last-child output').textContent"), "2000 N/m")
        << "the scene's stiffness";
    EXPECT_TRUE(says(browser_->text(verdict), "stable with any hand (passive"));
    slide("device-spring", 1);
    EXPECT_TRUE(says(browser_->text(verdict), "Stable on bump_shading-reference: pressed "));
    EXPECT_TRUE(says(browser_->text(verdict), "from straight down, it is stable below ")) << "of any press";
    slide("device-stiffness", 1);
    EXPECT_TRUE(says(browser_->text(verdict), "on a wall is unstable"));
    EXPECT_TRUE(says(browser_->text(verdict), "Unstable on bump_shading-reference: pressed "));
    const std::string limits = browser_->text("document.getElementById('device-limits').textContent");
    slide("device-delay", 0.4);
    EXPECT_NE(browser_->text("document.getElementById('device-limits').textContent"), limits);
    EXPECT_TRUE(says(browser_->text("document.getElementById('device-limits').textContent"), "2 samples late"));
}

TEST_F(Space, DeviceIsMarkedOnMapsOverStiffnessAndDamping) {
    open();
    EXPECT_EQ(number("document.querySelectorAll('path.device').length"), 0) << "the sample's maps have other columns";
    browser_->evaluate("(() => { const g = document.querySelector('svg.plot g[clip-path]'); g.place = { columns: "
                       "['stiffness_N_per_m', 'damping_N_s_per_m'], x: d3.scaleLinear().domain([0, 1e4]).range([0, "
                       "100]), y: d3.scaleLinear().domain([0, 10]).range([100, 0]) }; })()");
    slide("device-mass", 0.5);
    EXPECT_TRUE(says(browser_->text("document.querySelector('path.device').getAttribute('d')"), "M11,70"));
    slide("device-stiffness", 1);
    EXPECT_EQ(number("document.querySelectorAll('path.device').length"), 0) << "it lies outside";
}

// A surface that is not at hand is where the field ends: of a ball's forces, the ball.
TEST_F(Space, TheEndOfAFieldIsItsSurface) {
    open();
    const std::string ball =
        "(() => { const n = 20, pitch = 1e-3, radius = 7.3e-3, stiffness = 500, v = Object.create(Volume.prototype); "
        "const components = [0, 1, 2].map(() => new Float32Array(n ** 3)); Object.assign(v, { size: [n, n, n], first: "
        "[-9.5e-3, -9.5e-3, -9.5e-3], pitch: [pitch, pitch, pitch], about: { size: [n, n, n] }, components }); for "
        "(let i = 0; i < n ** 3; ++i) { const p = [i % n, Math.floor(i / n) % n, Math.floor(i / n / n)].map((k, a) => "
        "v.position(a, k)), far = length(p); if (far < radius) p.forEach((x, a) => { components[a][i] = stiffness * "
        "(radius - far) * x / far; }); } const at = boundarySolid(v, stiffness).attributes.position.array; return "
        "d3.max(d3.range(at.length / 3), (i) => Math.abs(Math.hypot(...at.slice(3 * i, 3 * i + 3)) - 7.3)); })()";
    EXPECT_LT(number(ball), 0.12) << "mm; samples lie 1 mm apart";
}

// three.js is in a page that has something in space, once.
TEST(SpaceOfAPage, IsThereOnlyWhereItIsNeeded) {
    const auto count = [](const std::filesystem::path& file) {
        const std::string page = read_text(file), mark = "REVISION=\"111\"";
        std::size_t found = 0;
        for (std::size_t at = page.find(mark); at != std::string::npos; at = page.find(mark, at + 1))
            ++found;
        EXPECT_LE(page.size(), 2'500'000u);
        return found;
    };
    const Folder with, without;
    write_case_with_paths(with.path());
    EXPECT_EQ(count(write_report(with.path()).file), 1u);
    write_sample_study(without.path() / "energy");
    EXPECT_EQ(count(write_report(without.path()).file), 0u);
}

TEST(SpaceData, KeepsSurfaceAndPaths) {
    const Folder folder;
    write_case_with_paths(folder.path());
    const SampledVolume volume = sample_volume(folder / "bump_shading-reference.exr", 100);
    const nlohmann::ordered_json surface = surface_data(volume);
    const double unit = surface["nominal"]["unit_m"];
    EXPECT_EQ(surface["nominal"]["x"].size(), 5u) << "two facets between two pieces of the plane";
    EXPECT_NEAR(unit * surface["nominal"]["z"][0][2].get<double>(), 0.006 - std::sqrt(0.006 * 0.006 - 0.005 * 0.005),
                1e-6)
        << "the crest";
    EXPECT_TRUE(surface.contains("smooth"));
    EXPECT_EQ(loop_data(kScene)["stiffness"], 2000);
    EXPECT_TRUE(loop_data("no scene").is_null());
    EXPECT_TRUE(surface_data(sample_volume(folder / "bump_shading-none.exr", 100)).is_null());

    const PathSamples read = read_paths(folder / "bump_shading-reference.paths.exr", 2, 6);
    EXPECT_EQ(read.paths, 2u);
    EXPECT_EQ(read.every_step, 2u);
    ASSERT_EQ(read.position.size(), 2u * 6 * 3);
    EXPECT_FLOAT_EQ(read.position[3], -0.006f);
    EXPECT_FLOAT_EQ(read.force[5], 1.6f);
    EXPECT_TRUE(std::isnan(read.proxy[3 * 9])) << "behind the end of the second path";
    EXPECT_THROW(read_paths(folder / "bump_shading-none.exr", 2, 6), IoError);
}

} // namespace
} // namespace forceshade::report

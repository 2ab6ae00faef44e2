// Height maps from pictures at the edge of what a picture can be.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"
#include "tests/io/picture.h"

namespace forceshade::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double bowl(int x, int y) {
    return 0.1 * x * x + 0.05 * y;
}

class ExtremeMap : public Workplace {
protected:
    std::string scene(const std::string& file) const {
        return fmt::format("[surface]\nkind = \"height_map\"\nfile = \"{}\"\nsize = [\"8 mm\", \"6 mm\"]\nheight = \"1 "
                           "mm\"\n[force]\nshading = \"height_map\"\n[grid]\nsize = [21, 17, 5]\n"
                           "origin = [\"-5 mm\", \"-4 mm\", \"-1 mm\"]\nspacing = \"0.5 mm\"\n",
                           file);
    }

    // As surface and as texture.
    void expect_right(const std::string& file) const {
        SCOPED_TRACE(file);
        write("map.toml", scene(file));
        write("texture.toml",
              fmt::format("[texture]\nfile = \"{}\"\nsize = [\"8 mm\", \"6 mm\"]\nheight = \"1 mm\"\n[grid]\n"
                          "size = [21, 17, 5]\norigin = [\"-5 mm\", \"-4 mm\", \"-1 mm\"]\nspacing = \"0.5 mm\"\n",
                          file));
        for (const char* name : {"map.toml", "texture.toml"}) {
            const Outcome outcome = expect_success({"validate", name, "--quiet"});
            EXPECT_EQ(last_line(outcome.out), fmt::format("{} voxels, 0 differ", 2 * 21 * 17 * 5)) << outcome.out;
        }
    }

    void expect_refused(const std::string& file, const std::vector<std::string>& words) const {
        SCOPED_TRACE(file);
        write("map.toml", scene(file));
        std::vector<std::string> all{file};
        all.insert(all.end(), words.begin(), words.end());
        const Outcome outcome = forceshade({"field", "map.toml", "--out", "map.exr"});
        EXPECT_TRUE(outcome.code == 2 || outcome.code == 4) << outcome.code;
        expect_failure(outcome.code, {"field", "map.toml", "--out", "field.exr"}, all);
        EXPECT_FALSE(std::filesystem::exists(path("field.exr")));
    }

    void write_bowl(const std::string& name, const std::string& channel, Imf::PixelType type,
                    const ExrKind& kind = {}) const {
        write_exr(path(name), {{channel, {type, bowl}}}, kind);
    }
};

TEST_F(ExtremeMap, pictures_of_every_usual_kind) {
    write_bowl("luminance_float.exr", "Y", Imf::FLOAT);
    write_bowl("luminance_half.exr", "Y", Imf::HALF);
    write_bowl("tiled.exr", "Y", Imf::FLOAT, {.tiled = true});
    write_png(path("eight.png"), 3, {{0, 128, 255}, {3, 2, 1}});
    write_png(path("sixteen.png"), 2, {{0, 1, 255, 255}, {128, 0, 0, 0}}, {.depth = 16});
    for (const char* name : {"luminance_float.exr", "luminance_half.exr", "tiled.exr", "eight.png", "sixteen.png"})
        expect_right(name);
}

TEST_F(ExtremeMap, pictures_of_one_pixel_one_row_and_one_column) {
    const auto box = [](int width, int height) { return Imath::Box2i({0, 0}, {width - 1, height - 1}); };
    write_bowl("pixel.exr", "Y", Imf::FLOAT, {box(1, 1), box(1, 1)});
    write_bowl("row.exr", "Y", Imf::FLOAT, {box(5, 1), box(5, 1)});
    write_bowl("column.exr", "Y", Imf::FLOAT, {box(1, 5), box(1, 5)});
    write_png(path("pixel.png"), 1, {{255}});
    write_png(path("two.png"), 2, {{0, 255}, {255, 0}});
    for (const char* name : {"pixel.exr", "row.exr", "column.exr", "pixel.png", "two.png"})
        expect_right(name);
}

TEST_F(ExtremeMap, pixels_that_are_no_numbers_are_refused_with_their_place) {
    for (const auto& [name, value] :
         {std::pair<std::string, double>("nan.exr", kNan), {"inf.exr", kInfinity}, {"minus.exr", -kInfinity}})
        for (const auto type : {Imf::FLOAT, Imf::HALF}) {
            write_exr(path(name),
                      {{"Y", {type, [value = value](int x, int y) { return x == 3 && y == 1 ? value : 0.5; }}}});
            expect_refused(name, {"row 1", "column 3"});
        }
}

TEST_F(ExtremeMap, data_windows_that_are_cropped_shifted_or_larger_than_the_picture) {
    write_bowl("cropped.exr", "Y", Imf::FLOAT, {{{0, 0}, {9, 9}}, {{3, 2}, {6, 5}}});
    write_bowl("shifted.exr", "Y", Imf::FLOAT, {{{-5, -5}, {-1, -2}}, {{-5, -5}, {-1, -2}}});
    write_bowl("overscan.exr", "Y", Imf::FLOAT, {{{0, 0}, {3, 3}}, {{-2, -2}, {6, 6}}});
    for (const char* name : {"cropped.exr", "shifted.exr", "overscan.exr"}) {
        write("map.toml", scene(name));
        const Outcome outcome = forceshade({"validate", "map.toml", "--quiet"});
        // A finite right answer or a clear error.
        if (outcome.code == 0)
            expect_right(name);
        else
            expect_refused(name, {"window"});
    }
}

TEST_F(ExtremeMap, samples_that_rounding_takes_across_the_rim_are_counted) {
    write_bowl("bowl.exr", "Y", Imf::FLOAT);
    // The outermost samples lie 1e-10 mm beyond the rim, which single precision does not tell from the rim itself.
    const std::string beyond = "[surface]\nkind = \"height_map\"\nfile = \"bowl.exr\"\nsize = [\"8 mm\", \"6 mm\"]\n"
                               "height = \"1 mm\"\n[force]\nshading = \"height_map\"\n[grid]\nsize = [9, 7, 3]\n"
                               "origin = [\"-4.0000000001 mm\", \"-3 mm\", \"-1 mm\"]\nspacing = \"1 mm\"\n";
    write("rim.toml", beyond);
    for (const std::vector<std::string>& engine : {std::vector<std::string>{}, {"--engine", "cpu"}}) {
        std::vector<std::string> arguments{"validate", "rim.toml", "--json", "--quiet"};
        arguments.insert(arguments.end(), engine.begin(), engine.end());
        const nlohmann::json report = nlohmann::json::parse(expect_success(arguments).out);
        const nlohmann::json& single = report.at("cases").at(0);
        EXPECT_EQ(single.at("precision"), "f32");
        for (const char* referee : {"oracle_f64", "closed_form"}) {
            EXPECT_EQ(single.at(referee).at("boundary_voxels"), 7);
            EXPECT_LT(single.at(referee).at("relative_error"), 1e-6);
            EXPECT_EQ(report.at("cases").at(1).at(referee).at("boundary_voxels"), 0);
        }
    }
    const auto record = nlohmann::json::parse(
        expect_success({"field", "rim.toml", "--out", "rim.exr", "--json", "--quiet", "--engine", "gpu"}).out);
    EXPECT_EQ(record.at("oracle").at("voxels_on_edge"), 7);
    EXPECT_LT(record.at("oracle").at("largest_error_N"), 1e-6);
}

TEST_F(ExtremeMap, shifting_a_picture_in_its_file_changes_no_force) {
    const auto at = [](int x, int y) {
        const Imath::Box2i box({x, y}, {x + 3, y + 2});
        return ExrKind{box, box};
    };
    write_exr(path("a.exr"), {{"Y", {Imf::FLOAT, bowl}}}, at(0, 0));
    write_exr(path("b.exr"), {{"Y", {Imf::FLOAT, [](int x, int y) { return bowl(x - 100, y + 7); }}}}, at(100, -7));
    for (const std::string name : {"a", "b"}) {
        write("map.toml", scene(name + ".exr"));
        expect_success(
            {"field", "map.toml", "--out", name + "_field.exr", "--also", "npy", "--quiet", "--engine", "gpu"});
    }
    EXPECT_TRUE(read_text(path("a_field.force.npy")) == read_text(path("b_field.force.npy")));
}

TEST_F(ExtremeMap, largest_and_smallest_values) {
    for (const auto& [name, value] : {std::pair<std::string, double>("large.exr", 3e38),
                                      {"small.exr", 1e-38},
                                      {"denormal.exr", 1e-42},
                                      {"negative.exr", -0.5}}) {
        write_exr(path(name), {{"Y", {Imf::FLOAT, [value = value](int x, int y) { return (x + y) % 2 ? value : 0; }}}});
        if (name == "large.exr") {
            write("map.toml", scene(name));
            const Outcome outcome = forceshade({"validate", "map.toml", "--quiet"});
            EXPECT_TRUE(outcome.code == 0 || (outcome.code == 2 && outcome.error.find(name) != std::string::npos))
                << outcome.out << outcome.error;
        } else {
            expect_right(name);
        }
    }
}

TEST_F(ExtremeMap, an_axis_of_pictures_is_swept) {
    write_bowl("a.exr", "Y", Imf::FLOAT);
    write_png(path("b.png"), 1, {{255}});
    std::string study = scene("a.exr");
    study.replace(study.find("\"a.exr\""), 7, "[\"a.exr\", \"b.png\"]");
    write("study.toml", study);
    expect_success({"sweep", "study.toml", "--out", "out", "--quiet"});
    EXPECT_EQ(read_json("out/manifest.json")["cases"].size(), 2u);
    // Another picture under the same name is another case.
    write_png(path("b.png"), 1, {{254}});
    const nlohmann::json said =
        nlohmann::json::parse(expect_success({"sweep", "study.toml", "--out", "out", "--quiet", "--json"}).out);
    EXPECT_EQ(said["computed"], 1);
    EXPECT_EQ(said["kept"], 1);
}

} // namespace
} // namespace forceshade::testing

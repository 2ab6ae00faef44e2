// What the reader refuses, and with which words.
#include "tests/scene/errors.h"

#include <fstream>

#include <gtest/gtest.h>

namespace forceshade {
namespace {

using test::study_error;
using test::usage_error;

TEST(Document, Misspelt) {
    EXPECT_EQ(study_error("[force]\nstifness = \"1 N/mm\"\n"),
              "f.toml:2:1: unknown key \"stifness\" in [force]; did you mean \"stiffness\"?");
    EXPECT_EQ(study_error("[srface]\nkind = \"bump\"\n"),
              "f.toml:1:2: unknown table [srface]; did you mean [surface]?");
    EXPECT_EQ(study_error("[surface]\nstiffness = \"1 N/mm\"\n"),
              "f.toml:2:1: unknown key \"stiffness\" in [surface]; it belongs in [force] or [texture]");
    EXPECT_EQ(study_error("[surface]\n[force]\nradius = \"1 m\"\n"),
              "f.toml:3:1: unknown key \"radius\" in [force]; it belongs in [surface]");
    EXPECT_EQ(study_error("[force]\nraduis = \"1 m\"\n"),
              "f.toml:2:1: unknown key \"raduis\" in [force]; did you mean \"radius\" in [surface] or [texture]?");
    EXPECT_EQ(study_error("[grid]\nresolution = 3\n"),
              "f.toml:2:1: unknown key \"resolution\" in [grid]; did you mean \"spacing\"?");
    EXPECT_EQ(study_error("[mesh]\nfile = \"a.obj\"\n"),
              "f.toml:1:2: unknown table [mesh]; did you mean [surface] with kind = \"mesh\"?");
    EXPECT_EQ(study_error("facets = 3\n"), "f.toml:1:1: \"facets\" stands in no table; it belongs in [surface]");
    EXPECT_EQ(study_error("[run]\nq = 1\n"), "f.toml:2:1: unknown key \"q\" in [run]; it has precision");
    EXPECT_EQ(study_error("[probes]\n"), "f.toml:1:2: unknown table [probes]; known are [surface], [force], "
                                         "[texture], [grid], [paths], [hand], [compare], [output], [run], [variant], "
                                         "[experiment]");
    EXPECT_EQ(study_error("[force]\n\"a.b\" = 1\n").substr(0, 26), "f.toml:2:1: unknown key \"a");
    EXPECT_EQ(study_error("[force]\nstiffness.x = 1\n"),
              "f.toml:2:1: stiffness is a stiffness with a unit, for example \"0.5 N/mm\"; got a table");
}

TEST(Document, Quantities) {
    EXPECT_EQ(study_error("[surface]\nradius = 600\n"),
              "f.toml:2:10: radius needs a unit: write \"600 mil\", \"600 mm\" or \"600 m\"");
    EXPECT_EQ(study_error("[surface]\nradius = \"600\"\n"),
              "f.toml:2:10: radius needs a unit: write \"600 mil\", \"600 mm\" or \"600 m\"");
    EXPECT_EQ(study_error("[surface]\nfacets = 16.0\n"),
              "f.toml:2:10: facets is a whole number: write 16, without a point");
    EXPECT_EQ(study_error("[grid]\nspacing = 0.2\n"),
              "f.toml:2:11: spacing needs a unit: write \"0.2 mm\" or \"0.2 m\"");
    EXPECT_EQ(study_error("[surface]\nradius = \"600 N\"\n"),
              "f.toml:2:10: \"N\" is a force, not a length; write for example \"0.2 mm\"");
    EXPECT_EQ(study_error("[surface]\nradius = [\"600 mil\",\n \"600 mils\"]\n"),
              "f.toml:3:2: unknown unit \"mils\": did you mean \"mil\"?");
    EXPECT_EQ(study_error("[force]\nstiffness = \"-3 N/m\"\n"), "f.toml:2:13: stiffness must be positive, got -3 N/m");
    EXPECT_EQ(study_error("[force]\nstiffness = nan\n"),
              "f.toml:2:13: stiffness is a stiffness with a unit, for example \"0.5 N/mm\"; got nan");
    EXPECT_EQ(study_error("[grid]\nspacing = \"0 mm\"\n"), "f.toml:2:11: spacing must be positive, got 0 mm");
    EXPECT_EQ(study_error("[grid]\nspacing = [\"1 mm\", \"-1 mm\", \"1 mm\"]\n"),
              "f.toml:2:20: spacing must be positive, got -1 mm");
    EXPECT_EQ(study_error("[grid]\norigin = [\"1 mm\", \"1 mm\"]\n"),
              "f.toml:2:10: origin takes 3 values, got 2; for a sweep write a list of lists");
    EXPECT_EQ(study_error("[surface]\nwidth = true\n"),
              "f.toml:2:9: width is a length with a unit, for example \"0.2 mm\"; got a boolean");
}

TEST(Document, IntegersAndChoices) {
    EXPECT_EQ(study_error("[surface]\nfacets = 0\n"), "f.toml:2:10: facets must be from 1 to 100000000, got 0");
    EXPECT_EQ(study_error("[surface]\nfacets = 2.5\n"),
              "f.toml:2:10: facets is a whole number without quotes; got 2.5");
    EXPECT_EQ(study_error("[surface]\nfacets = \"3\"\n"),
              "f.toml:2:10: facets is a whole number: write 3, without quotes");
    EXPECT_EQ(study_error("[grid]\nsize = [0, 1, 1]\n"), "f.toml:2:9: size must be from 1 to 1073741822, got 0");
    EXPECT_NE(study_error("[grid]\nsize = [18446744073709551616, 1, 1]\n").find("is not representable in 64 bits"),
              std::string::npos);
    EXPECT_EQ(study_error("[force]\nshading = \"refrence\"\n"),
              "f.toml:2:11: shading is one of none, reference, height_map, morgenbesser, barycentric, mean_value, "
              "two_pass; got \"refrence\"; did you mean \"reference\"?");
    EXPECT_EQ(
        study_error("[surface]\nkind = \"meshes\"\n"),
        "f.toml:2:8: kind is one of bump, cylinder_bump, height_map, mesh; got \"meshes\"; did you mean \"mesh\"?");
    EXPECT_EQ(study_error("[output]\nchannels = []\n"), "f.toml:2:12: empty list: channels needs at least one value");
    EXPECT_EQ(study_error("[output]\nchannels = [\"force\", \"depth\", \"depth\"]\n"),
              "f.toml:2:31: \"depth\" is given twice in channels");
    EXPECT_EQ(study_error("[output]\nchannels = \"depth\"\n"),
              "f.toml:2:12: channels is a list, for example [\"force\"]; got \"depth\"");
}

TEST(Document, Structure) {
    EXPECT_EQ(study_error("[surface]\nradius = []\n"), "f.toml:2:10: empty list: radius needs at least one value");
    EXPECT_EQ(study_error("[surface]\nradius = [[\"1 m\"]]\n"),
              "f.toml:2:11: a sweep axis of radius is a list of single values; got a list in it");
    EXPECT_EQ(study_error("surface = 3\n"), "f.toml:1:1: [surface] is a table of keys; got 3");
    EXPECT_EQ(study_error("[variant]\nsurface.facets = 2\n"),
              "f.toml:1:2: variants are tables, each written as [[variant]], with two brackets");
    EXPECT_EQ(study_error("[[variant]]\n[[variant.variant]]\n"),
              "f.toml:2:11: variants stand at the top of the file, each as [[variant]], with two brackets");
    EXPECT_EQ(study_error("[surface]\nfacets = 2\nfacets = 3\n").substr(0, 12), "f.toml:3:10:");
    EXPECT_EQ(study_error("[surface\n").substr(0, 11), "f.toml:1:9:");
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\nfunction = \"dip\"\nfile = \"u.png\"\n"),
              "f.toml:4:1: give \"function\" or \"file\", not both");
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\nfile = \"maps/\"\n"),
              "f.toml:3:8: \"maps/\" is a folder; file is the name of a file");
    for (const std::string folder : {".", "..", "maps/.", "./"})
        EXPECT_EQ(study_error("[surface]\nkind = \"mesh\"\nfile = \"" + folder + "\"\n"),
                  "f.toml:3:8: \"" + folder + "\" is a folder; file is the name of a file");
    EXPECT_EQ(study_error("[surface]\nkind = \"mesh\"\nfile = \"\"\n"), "f.toml:3:8: \"\" names no file");
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\nfile = \"u.png\"\nsha256 = \"12\"\n").substr(0, 12),
              "f.toml:4:10:");
}

TEST(Document, KeysThatDoNotApply) {
    EXPECT_EQ(study_error("[surface]\nkind = \"cylinder_bump\"\nfacets = 3\n"),
              "f.toml:3:1: \"facets\" does not apply to kind \"cylinder_bump\"; it applies to kind bump");
    EXPECT_EQ(study_error("[surface]\nfunction = \"dip\"\n"),
              "f.toml:2:1: \"function\" does not apply to kind \"bump\"; it applies to kind height_map with cylinder, "
              "dip, sine or "
              "gaussian");
    EXPECT_EQ(study_error("[texture]\nfunction = \"gaussian\"\nwidth = \"1 mm\"\n"),
              "f.toml:3:1: \"width\" does not apply to function \"gaussian\"; it applies to cylinder, dip or sine");
    EXPECT_EQ(
        study_error("[[variant]]\nsurface.kind = \"cylinder_bump\"\nsurface.facets = 2\n[[variant]]\n").substr(0, 12),
        "f.toml:3:9: ");
    EXPECT_EQ(study_error("[surface]\nfacets = 3\n[[variant]]\nsurface.kind = \"cylinder_bump\"\n"), "(no error)");
    const Study study = parse_study("[surface]\nkind = \"cylinder_bump\"\n[force]\ndepth = \"normal\"\n", "f.toml");
    ASSERT_EQ(study.warnings.size(), 1u);
    EXPECT_EQ(study.warnings[0],
              "f.toml:4:1: \"depth\" does not apply to kind \"cylinder_bump\"; it applies to kind bump");
}

TEST(Document, Encoding) {
    EXPECT_EQ(study_error("\xEF\xBB\xBF[surface]\nfacets = 3\n"), "(no error)");
    EXPECT_EQ(study_error("\xFF\xFE["), "f.toml:1:1: the text is UTF-16; save it as UTF-8");
    EXPECT_EQ(study_error("[surface]\nkind = \"\xC3\x28\"\n").substr(0, 9), "f.toml:2:");
    std::string deep = "a";
    for (int i = 0; i < 200000; ++i)
        deep += ".a";
    EXPECT_EQ(study_error(deep + " = 1\n"), "f.toml:1:66: unknown key: it has more than 32 dots");
    EXPECT_EQ(study_error("# " + std::string(100, '.') + "\n#" + deep + "\n[run] # " + std::string(100, '.') + "\n"),
              "(no error)");
    EXPECT_NE(study_error("a = " + std::string(100000, '[')), "(no error)");
}

// The TOML library would end the stack in freeing what it made of such keys, whatever stands in their quotes.
TEST(Document, KeysOfManyDotsAreRefusedWhateverTheyQuote) {
    const auto key_of = [](const std::string& part) {
        std::string key;
        for (int i = 0; i < 20000; ++i)
            key += part + ".";
        return key + "a";
    };
    for (const char* quoted :
         {"'['", "\"{\"", "'='", "','", "\"#\"", "'\"'", "\"'\"", R"("\"")", R"("\\")", "''", "\"\""}) {
        const std::string key = key_of(quoted);
        const std::string line = key + " = 1\n";
        for (const std::string& text : {line, "[" + key + "]\n", "a = { " + key + " = 1 }\n", "# don't\n" + line,
                                        "a = \"\"\"\n ' \"\" \\\"\"\"\"\"\n" + line, "a = { b = '''\n\" ''''', " + line,
                                        "a = [\"b\", # \"\n1]\n" + line})
            EXPECT_NE(study_error(text).find("more than 32 dots"), std::string::npos) << text.substr(0, 40);
    }
    EXPECT_EQ(study_error("# isn't it. \n[surface] # " + key_of("'") + "\nfacets = 3 # \"\n"), "(no error)");
}

TEST(Document, Overrides) {
    const std::vector<Override> f64{{"run.precision", "f64"}, {"surface.facets", "3"}, {"grid.size", "[2, 3, 4]"}};
    const Scene scene = parse_study("[surface]\nfacets = [1, 2]\n", "f.toml", {}, f64).cases.at(0).scene;
    EXPECT_EQ(scene.precision, Precision::f64);
    EXPECT_EQ(scene.surface.facets, 3u);
    EXPECT_EQ(scene.grid.size[2], 4u);
    const auto error = [](const char* path, const char* value) {
        const std::vector<Override> overrides{{path, value}};
        return usage_error([&] { parse_study("", "f.toml", {}, overrides); });
    };
    EXPECT_EQ(error("run.precison", "f64"),
              "override run.precison: unknown key \"run.precison\"; did you mean \"run.precision\"?");
    EXPECT_EQ(error("run.precision", "f16"), "override run.precision: precision is one of f32, f64, auto; got \"f16\"");
    EXPECT_EQ(error("grid.spacing", "1"), "override grid.spacing: spacing needs a unit: write \"1 mm\" or \"1 m\"");
    EXPECT_NE(error("surface.facets", "1\nx = 2"), "(no error)");
}

TEST(Document, Files) {
    EXPECT_THROW(read_study("no/such/file.toml"), IoError);
    EXPECT_THROW(read_study(testing::TempDir()), IoError);
    const std::string path = testing::TempDir() + "/scene_document_test.toml";
    std::ofstream(path)
        << "[surface]\nkind = \"height_map\"\nfile = \"maps/u.exr\"\n[force]\nshading = \"height_map\"\n";
    const Case one = read_scene(path);
    EXPECT_EQ(one.scene.surface.map.file, "maps/u.exr");
    EXPECT_EQ(one.scene.surface.map.path,
              (std::filesystem::path(testing::TempDir()) / "maps/u.exr").lexically_normal().string());
    EXPECT_EQ(one.scene.surface.map.function, MapFunction::file);
    std::filesystem::remove(path);
}

} // namespace
} // namespace forceshade

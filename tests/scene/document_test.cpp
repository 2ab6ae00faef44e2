// What the reader refuses: where, all in one run, and none that only follows from another.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/scene/document.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

using test::expect_places;
using test::study_error;
using test::usage_error;
using testing::lines_of;
using testing::says;

TEST(Document, Misspelt) {
    expect_places({
        {"[force]\nstifness = \"1 N/mm\"\n", "2:1"},
        {"[srface]\nkind = \"bump\"\n", "1:2"},
        {"[surface]\nstiffness = \"1 N/mm\"\n", "2:1"},
        {"[surface]\n[force]\nradius = \"1 m\"\n", "3:1"},
        {"[force]\nraduis = \"1 m\"\n", "2:1"},
        {"[grid]\nresolution = 3\n", "2:1"},
        {"[mesh]\nfile = \"a.obj\"\n", "1:2"},
        {"facets = 3\n", "1:1"},
        {"[run]\nq = 1\n", "2:1"},
        {"[probes]\n", "1:2"},
        {"[force]\n\"a.b\" = 1\n", "2:1"},
        {"[force]\nstiffness.x = 1\n", "2:1"},
    });
}

TEST(Document, Quantities) {
    expect_places({
        {"[surface]\nradius = 600\n", "2:10"},
        {"[surface]\nradius = \"600\"\n", "2:10"},
        {"[surface]\nfacets = 16.0\n", "2:10"},
        {"[grid]\nspacing = 0.2\n", "2:11"},
        {"[surface]\nradius = \"600 N\"\n", "2:10"},
        {"[surface]\nradius = [\"600 mil\",\n \"600 mils\"]\n", "3:2"},
        {"[force]\nstiffness = \"-3 N/m\"\n", "2:13"},
        {"[force]\nstiffness = nan\n", "2:13"},
        {"[grid]\nspacing = \"0 mm\"\n", "2:11"},
        {"[grid]\nspacing = [\"1 mm\", \"-1 mm\", \"1 mm\"]\n", "2:20"},
        {"[grid]\norigin = [\"1 mm\", \"1 mm\"]\n", "2:10"},
        {"[surface]\nwidth = true\n", "2:9"},
    });
}

TEST(Document, IntegersAndChoices) {
    expect_places({
        {"[surface]\nfacets = 0\n", "2:10"},
        {"[surface]\nfacets = 2.5\n", "2:10"},
        {"[surface]\nfacets = \"3\"\n", "2:10"},
        {"[grid]\nsize = [0, 1, 1]\n", "2:9"},
    });
    EXPECT_TRUE(says(study_error("[grid]\nsize = [18446744073709551616, 1, 1]\n"), "is not representable in 64 bits"));
    expect_places({
        {"[force]\nshading = \"refrence\"\n", "2:11"},
        {"[surface]\nkind = \"meshes\"\n", "2:8"},
        {"[output]\nchannels = []\n", "2:12"},
        {"[output]\nchannels = [\"force\", \"depth\", \"depth\"]\n", "2:31"},
        {"[output]\nchannels = \"depth\"\n", "2:12"},
    });
}

TEST(Document, Structure) {
    for (const std::string folder : {".", "..", "maps/.", "./"})
        EXPECT_EQ(study_error("[surface]\nkind = \"mesh\"\nfile = \"" + folder + "\"\n"),
                  "f.toml:3:8: \"" + folder + "\" is a folder; file is the name of a file");
    expect_places({
        {"[surface]\nradius = []\n", "2:10"},
        {"[surface]\nradius = [[\"1 m\"]]\n", "2:11"},
        {"surface = 3\n", "1:1"},
        {"[variant]\nsurface.facets = 2\n", "1:2"},
        {"[[variant]]\n[[variant.variant]]\n", "2:11"},
        {"[surface]\nfacets = 2\nfacets = 3\n", "3:10"},
        {"[surface\n", "1:9"},
        {"[surface]\nkind = \"height_map\"\nfunction = \"dip\"\nfile = \"u.png\"\n", "4:1"},
        {"[surface]\nkind = \"height_map\"\nfile = \"maps/\"\n", "3:8"},
        {"[surface]\nkind = \"mesh\"\nfile = \"\"\n", "3:8"},
        {"[surface]\nkind = \"height_map\"\nfile = \"u.png\"\nsha256 = \"12\"\n", "4:10"},
    });
}

TEST(Document, KeysThatDoNotApply) {
    expect_places({
        {"[surface]\nkind = \"cylinder_bump\"\nfacets = 3\n", "3:1"},
        {"[surface]\nfunction = \"dip\"\n", "2:1"},
        {"[texture]\nfunction = \"gaussian\"\nwidth = \"1 mm\"\n", "3:1"},
        {"[[variant]]\nsurface.kind = \"cylinder_bump\"\nsurface.facets = 2\n[[variant]]\n", "3:9"},
        {"[surface]\nfacets = 3\n[[variant]]\nsurface.kind = \"cylinder_bump\"\n", ""},
    });
    const Study study = parse_study("[surface]\nkind = \"cylinder_bump\"\n[force]\ndepth = \"normal\"\n", "f.toml");
    ASSERT_EQ(study.warnings.size(), 1u);
    EXPECT_EQ(study.warnings[0],
              "f.toml:4:1: \"depth\" does not apply to kind \"cylinder_bump\"; it applies to kind bump");
}

TEST(Document, Encoding) {
    EXPECT_EQ(study_error("[surface]\nkind = \"\xC3\x28\"\n").substr(0, 9), "f.toml:2:");
    expect_places({
        {"\xEF\xBB\xBF[surface]\nfacets = 3\n", ""},
        {"\xFF\xFE[", "1:1"},
    });
    std::string deep = "a";
    for (int i = 0; i < 200000; ++i)
        deep += ".a";
    expect_places({
        {deep + " = 1\n", "1:66"},
        {"# " + std::string(100, '.') + "\n#" + deep + "\n[run] # " + std::string(100, '.') + "\n", ""},
    });
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
            EXPECT_TRUE(says(study_error(text), "more than 32 dots")) << text.substr(0, 40);
    }
    expect_places({{"# isn't it. \n[surface] # " + key_of("'") + "\nfacets = 3 # \"\n", ""}});
}

TEST(Document, NestsAsDeepAsItMay) {
    // Inline tables as deep as the parser allows, each under a key of as many dots as are let through.
    std::string dots = "a";
    for (int i = 0; i < 32; ++i)
        dots += ".a";
    std::string text;
    for (int i = 0; i < 255; ++i)
        text += dots + " = { ";
    text += dots + " = 1" + std::string(255, '}') + "\n";
    const std::string message = study_error(text);
    EXPECT_TRUE(says(message, "nested more than 16 deep"));
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

// An override counts as given, though it stands in no file.
TEST(Document, OverridesAreNoDefaults) {
    const auto chooses = [](const std::vector<Override>& overrides) {
        return parse_study("", "f.toml", {}, overrides).cases.at(0).chooses_precision;
    };
    EXPECT_TRUE(chooses({}));
    EXPECT_TRUE(chooses({{"run.precision", "auto"}}));
    EXPECT_FALSE(chooses({{"run.precision", "f32"}}));
    EXPECT_FALSE(chooses({{"run.precision", "f64"}}));
    const std::string mesh = "[surface]\nkind = \"mesh\"\nfile = \"a.obj\"\n", origin = "[\"0 m\", \"0 m\", \"0 m\"]";
    const std::vector<Override> only{{"grid.origin", origin}};
    const std::string grid = "[grid]\nsize = [2, 2, 2]\nspacing = \"1 mm\"\n";
    EXPECT_EQ(parse_study(mesh + grid, "f.toml", {}, only).cases.size(), 1u);
    EXPECT_NE(usage_error([&] { parse_study(mesh, "f.toml", {}, only); }).find("of which size is missing"),
              std::string::npos);
}

TEST(Document, Files) {
    EXPECT_THROW(read_study("no/such/file.toml"), IoError);
    const testing::Folder folder;
    EXPECT_THROW(read_study(folder.path()), IoError);
    const Case one = read_scene(folder.write(
        "s.toml", "[surface]\nkind = \"height_map\"\nfile = \"maps/u.exr\"\n[force]\nshading = \"height_map\"\n"));
    EXPECT_EQ(one.scene.surface.map.file, "maps/u.exr");
    EXPECT_EQ(one.scene.surface.map.path, (folder / "maps/u.exr").string());
    EXPECT_EQ(one.scene.surface.map.function, MapFunction::file);
}

// The lines of the file at which there are errors, in the order in which they are told.
std::vector<int> places(const std::string& error) {
    std::vector<int> result;
    for (const std::string& line : lines_of(error))
        if (line.starts_with("f.toml:"))
            result.push_back(std::stoi(line.substr(7)));
    return result;
}

TEST(Errors, AllAreToldInTheOrderOfTheFile) {
    const std::string error = study_error(R"([surface]
radius = 600
radios = "1 mm"
facets = 2.5
[force]
stiffness = ["1 N/mm", "2 N", "-1 N/m"]
shading = "refrence"
[gird]
size = [1, 2]
[output]
channels = ["force", "dept", "proxi"]
)");
    EXPECT_EQ(places(error), (std::vector<int>{2, 3, 4, 6, 6, 7, 8, 11, 11})) << error;
    EXPECT_EQ(lines_of(error).back(), "9 errors in f.toml");
    EXPECT_EQ(lines_of(error).front(), "f.toml:2:10: radius needs a unit: write \"600 mil\", \"600 mm\" or \"600 m\"");
}

TEST(Errors, WhatOnlyTheWholeSceneShowsIsAmongThem) {
    const std::string error = study_error(R"([surface]
width = "2 m"
[force]
shading = "height_map"
[texture]
height = "1e30 m"
[output]
pixle = "half"
[paths]
speed = { mean = "1 m/s" }
press = "1 N"
loop = "open"
)");
    EXPECT_EQ(places(error), (std::vector<int>{2, 4, 6, 8, 10, 11})) << error;
}

// A table of which something was refused is not all there: what it lacks is no error.
TEST(Errors, NoneFollowsFromAnother) {
    for (const char* text :
         {"[surface]\nkind = \"mseh\"\nfile = \"a.obj\"\ntransform.scale = 2\n[force]\nshading = \"two_pass\"\n",
          "[surface]\nkind = \"mesh\"\nflie = \"a.obj\"\n[force]\nshading = \"two_pass\"\n[grid]\nsamples = 64\n",
          "[surfaec]\nkind = \"mesh\"\nfile = \"a.obj\"\n[force]\nshading = \"two_pass\"\n",
          "kind = \"mesh\"\n[surface]\nfile = \"a.obj\"\n", "[surface]\nkind = = \"mesh\"\nfile = \"a.obj\"\n",
          "[run]\nprecision = \"f65\"\n[surface]\nradius = \"1e16 m\"\n",
          "[paths]\nlop = \"closed\"\npress = \"1 N\"\n[hand]\nmass = \"1 kg\"\n",
          "[surface]\nkind = \"height_map\"\nfile = 3\nsha256 = \"" // of a file that was refused
          "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\"\n",
          "[surface]\nkind = \"mesh\"\n[surface]\nfile = \"a.obj\"\n[force]\nshading = \"two_pass\"\n"}) {
        const std::string error = study_error(text);
        EXPECT_EQ(lines_of(error).size(), 1u) << text << error;
        EXPECT_NE(error, "(no error)") << text;
    }
}

TEST(Errors, TwentyAreTold) {
    std::string text = "[surface]\nradius = [";
    for (int i = 0; i < 3000; ++i)
        text += "\n\"0 mm\",";
    const std::string error = study_error(text + "]\n");
    EXPECT_EQ(lines_of(error).size(), kMostErrors + 1);
    EXPECT_EQ(lines_of(error).back(), "1000 or more errors in f.toml, the first 20 are listed");
}

TEST(Errors, OfOverridesAndOfEachVariant) {
    const std::vector<Override> overrides{{"run.precison", "f64"}, {"grid.spacing", "1"}};
    const std::string error = usage_error([&] {
        parse_study("[run]\nq = 1\n[[variant]]\nsurface.facet = 1\n[[variant]]\nforce.k = 1\n", "f.toml", {},
                    overrides);
    });
    EXPECT_EQ(places(error), (std::vector<int>{2, 4, 6})) << error;
    EXPECT_EQ(lines_of(error).size(), 6u) << error;
}

// Where the parser stops, and what to write instead where the mistake is a common one.
TEST(Errors, WhatToWriteInsteadOfWhatIsNoToml) {
    const auto told = [](const std::string& line) {
        const std::string error = study_error("[surface]\n" + line + "\n[force]\nstifness = \"1 N/mm\"\n");
        EXPECT_EQ(lines_of(error).size(), 1u) << error;
        return error.substr(std::min(error.size(), std::string("f.toml:").size()));
    };
    EXPECT_EQ(told("kind = bump # of the paper"), "2:8: quotes are missing; write kind = \"bump\"");
    EXPECT_EQ(told("radius = 600mil"), "2:13: quotes are missing; write radius = \"600mil\"");
    EXPECT_EQ(told("radius = 0,5 in"),
              "2:11: a number has a decimal point; quotes are missing; write radius = \"0.5 in\"");
    EXPECT_EQ(told("transform.scale = .5"),
              "2:19: a number has digits on both sides of its point; write transform.scale = 0.5");
    EXPECT_EQ(told("radius = [600 mil, \"700 mil\",\n0.8 in]"),
              "2:15: quotes are missing; write radius = [\"600 mil\", \"700 mil\",");
    EXPECT_EQ(told("radius = [\"600 mil\", \"700 mil\",\n0.8 in, \"2 in\"]"),
              "3:5: quotes are missing; write \"0.8 in\", \"2 in\"]");
    EXPECT_EQ(told("radius = \"600\" mil"),
              "2:16: number and unit stand in quotes together; write radius = \"600 mil\"");
    EXPECT_EQ(told("radius = \"600 mil"), "2:18: a quote is not closed; write radius = \"600 mil\"");
    EXPECT_EQ(told("radius = \u201c600 mil\u201d"),
              "2:10: these quotes are not those of a keyboard; write radius = \"600 mil\"");
    EXPECT_EQ(told("radius: 600 mil"),
              "2:7: \"=\" stands between a key and its value; quotes are missing; write radius = \"600 mil\"");
    EXPECT_EQ(told("radius \"600 mil\""), "2:8: \"=\" stands between a key and its value; write radius = \"600 mil\"");
    EXPECT_EQ(told("radius = \"600 mil\"; // R"), "2:19: a comment begins with #; no comma or semicolon ends a line; "
                                                  "write radius = \"600 mil\"");
    EXPECT_EQ(told("radius = [\"600 mil\", \"700 mil\""),
              "2:31: a bracket is not closed; write radius = [\"600 mil\", \"700 mil\"]");
    EXPECT_EQ(told("[force"), "2:7: a table's name stands between brackets; write [force]");
    EXPECT_EQ(told("file = \"C:\\data\\a.obj\""),
              "2:12: a backslash means something else between double quotes; write file = 'C:\\data\\a.obj'");
    EXPECT_EQ(told("q = 1 2 3 {"), "2:7: this is no TOML (key-value pair): expected a comment or whitespace, saw '2'");
}

TEST(Errors, OfTomlThatNamesNoValueOrTwo) {
    expect_places({
        {"[surface]\nradius = # R\n", "2:10"},
        {"[surface]\nradius =\n", "2:9"},
        {"[surface]\nfacets = 2\nfacets = 3\n", "3:10"},
        {"[force]\n[surface]\nfacets = 2\n[force]\nshading = \"none\"\n", "4:1"},
    });
    EXPECT_TRUE(says(study_error("[surface]\nradius = \"600 \xB5m\"\n"), "f.toml:2:", "save the file as UTF-8"));
}

TEST(Errors, OfBytesThatAreNoText) {
    expect_places({
        {std::string("[surface]\nfac\0ets = 2\n", 22), "2:4"},
        {std::string("[\0s\0u\0", 6), "1:1"},
        {"[surface]\rfacets = 2\r", "1:1"},
    });
    EXPECT_TRUE(says(study_error("{\"surface\": {}}\n"), "JSON"));
    expect_places({{"\xEF\xBB\xBF[surface]\r\nfacets = 2\r\nkind = bump\r\n", "3:8"}});
}

} // namespace
} // namespace forceshade

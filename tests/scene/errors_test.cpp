// All errors of a text in one run, in its order, and none that only follows from another.
#include "tests/scene/errors.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/scene/document.h"

namespace forceshade {
namespace {

using test::study_error;
using test::usage_error;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
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
    EXPECT_EQ(study_error("[surface]\nradius = # R\n").substr(0, 11), "f.toml:2:10");
    EXPECT_EQ(study_error("[surface]\nradius =\n"),
              "f.toml:2:9: radius has no value; forceshade schema says what it may be");
    EXPECT_EQ(study_error("[surface]\nfacets = 2\nfacets = 3\n"),
              "f.toml:3:10: \"facets\" is given twice here; leave one");
    EXPECT_EQ(study_error("[force]\n[surface]\nfacets = 2\n[force]\nshading = \"none\"\n").substr(0, 45),
              "f.toml:4:1: [force] is there twice; write the");
    EXPECT_NE(study_error("[surface]\nradius = \"600 \xB5m\"\n").find("f.toml:2:"), std::string::npos);
    EXPECT_NE(study_error("[surface]\nradius = \"600 \xB5m\"\n").find("save the file as UTF-8"), std::string::npos);
}

TEST(Errors, OfBytesThatAreNoText) {
    EXPECT_EQ(study_error(std::string("[surface]\nfac\0ets = 2\n", 22)),
              "f.toml:2:4: a byte of value 0: this is no text file, or a damaged one");
    EXPECT_EQ(study_error(std::string("[\0s\0u\0", 6)), "f.toml:1:1: the text is UTF-16; save it as UTF-8");
    EXPECT_EQ(study_error("[surface]\rfacets = 2\r").substr(0, 49),
              "f.toml:1:1: lines end in a carriage return alone;");
    EXPECT_NE(study_error("{\"surface\": {}}\n").find("JSON"), std::string::npos);
    EXPECT_EQ(study_error("\xEF\xBB\xBF[surface]\r\nfacets = 2\r\nkind = bump\r\n"),
              "f.toml:3:8: quotes are missing; write kind = \"bump\"");
}

} // namespace
} // namespace forceshade

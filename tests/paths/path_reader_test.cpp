// CSV as the world writes it, rows into samples, and every way in which a file can fail to hold them.
#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "host/paths/path_reader.h"
#include "tests/paths/path_workplace.h"

namespace forceshade::testing {
namespace {

class PathFile : public PathWorkplace {
protected:
    std::vector<PathSample> samples(const std::string& text, std::size_t most = 1000) const {
        PathReader reader(write("in.csv", text), 1e15);
        std::vector<PathSample> all, some;
        for (reader.read(some, most); !some.empty(); reader.read(some, most))
            all.insert(all.end(), some.begin(), some.end());
        return all;
    }
    /// What is said about a file that is refused, without the folder.
    std::string complaint(const std::string& text) const {
        const std::string message = message_of<UsageError>([&] { samples(text); });
        const std::string prefix = path("in.csv").string();
        EXPECT_TRUE(message.starts_with(prefix)) << text << ": " << message;
        return message.substr(std::min(prefix.size(), message.size()));
    }
    void expect(const std::string& text, const std::string& where, const std::vector<std::string>& words) const {
        const std::string said = complaint(text);
        EXPECT_TRUE(said.starts_with(where)) << said;
        EXPECT_TRUE(says(said, words));
    }
    static std::string row(const std::string& cells) { return "path,t,x,y,z\n0,0,0,0,0\n" + cells; }
};

TEST_F(PathFile, IsReadInAnyOrderOfColumns) {
    for (const char* text :
         {"path,t,x,y,z\n7,0.5,1,-2,3e-3\n", "z,note,y,x,t,path\n3e-3,\"a,b\",-2,1,0.5,7\n",
          "path,t,x,y,z,gx,x2,note,note\n 7 ,+0.5,\"1\",-2.000,.003,nan,,,\n", "path,t,x,y,z\n7.0e0,0.5,1,-2,3e-3"}) {
        const std::vector<PathSample> read = samples(text);
        ASSERT_EQ(read.size(), 1u) << text;
        EXPECT_EQ(read[0].path, 7u);
        EXPECT_EQ(read[0].time, 0.5);
        EXPECT_EQ(read[0].probe, glm::dvec3(1, -2, 0.003));
        EXPECT_EQ(read[0].line, 2u);
    }
}

TEST_F(PathFile, GivesEveryDoubleAndEveryPathNumber) {
    const auto read = samples("path,t,x,y,z\n18446744073709551615,0.1,4.9406564584124654e-324,-0,"
                              "0.1000000000000000055511151231257827\n");
    EXPECT_EQ(read[0].path, std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(read[0].probe.x, std::numeric_limits<double>::denorm_min());
    EXPECT_TRUE(std::signbit(read[0].probe.y));
    EXPECT_EQ(read[0].probe.z, 0.1);
}

TEST_F(PathFile, IsReadInBatchesOfAnySize) {
    std::string text = "path,t,x,y,z\n";
    for (int i = 0; i < 100; ++i)
        text += fmt::format("{},0,{},0,0\n", i % 3, i);
    for (const std::size_t most : {1, 7, 100, 1000}) {
        const auto read = samples(text, most);
        ASSERT_EQ(read.size(), 100u);
        for (std::size_t i = 0; i < 100; ++i)
            EXPECT_EQ(read[i].probe.x, double(i));
    }
}

TEST_F(PathFile, NeedsAHeaderAndASample) {
    expect("", ": ", {"is empty", "path,t,x,y,z"});
    expect("\n\n", ": ", {"is empty"});
    expect("path,t,x,y,z\n", ": ", {"no sample below the header"});
    expect("path,t,x,y,z", ": ", {"no sample below the header"});
    expect("path,t,x,y\n0,0,0,0\n", ":1:1: ", {"lacks column \"z\"", "\"path,t,x,y\""});
    expect("t,x,y\n0,0,0\n", ":1:1: ", {"lacks columns \"path\", \"z\"", "of a single path t,x,y,z"});
    expect("0,0,0,0,0\n", ":1:1: ", {"lacks columns \"path\", \"t\", \"x\", \"y\", \"z\""});
    expect("path,t,X,y,z\n0,0,0,0,0\n", ":1:1: ", {"lacks column \"x\"", "\"X\" there is meant"});
    expect("pth,t,x,y,z\n0,0,0,0,0\n", ":1:1: ", {"lacks column \"path\"", "\"pth\" there is meant"});
    expect("path;t;x;y;z\n0;0;0;0;0\n", ":1:1: ", {"semicolons"});
    expect("path\tt\tx\ty\tz\n0\t0\t0\t0\t0\n", ":1:1: ", {"tabs"});
    expect("path,t,x,y,x,z\n0,0,0,0,0,0\n", ":1:12: ", {"two columns \"x\""});
}

TEST_F(PathFile, NeedsNoNumberOfASinglePath) {
    const auto read = samples("t,x,y,z\n0,1,2,3\n0.001,4,5,6\n", 10);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[1].path, 0u);
    EXPECT_EQ(read[1].time, 0.001);
    EXPECT_EQ(read[1].probe, glm::dvec3(4, 5, 6));
}

TEST_F(PathFile, HasAsManyCellsInEveryRow) {
    expect(row("1,2,3,4\n"), ":3:8: ", {"4 cells", "5", "header"});
    expect(row("1,2,3,4,5,6\n"), ":3:11: ", {"6 cells", "decimal commas"});
    expect(row("1,0,1\n"), ":3:6: ", {"3 cells"});
    expect(row("1,0,1"), ":3:6: ", {"3 cells", "cut off"});
    expect(row("   \n"), ":3:4: ", {"1 cell in"});
    expect(row(std::string("\0\0\0\n", 4)), ":3:", {"1 cell"});
}

TEST_F(PathFile, HoldsFiniteNumbersOnly) {
    expect(row("1,0,0.1,,0\n"), ":3:9: y: ", {"empty", "metres"});
    expect(row("1,,0.1,0,0\n"), ":3:3: t: ", {"empty", "seconds"});
    expect(row("1,0,nan,0,0\n"), ":3:5: x: ", {"\"nan\"", "not finite"});
    expect(row("1,-inf,0,0,0\n"), ":3:3: t: ", {"not finite"});
    expect(row("1,0,0,0,Infinity\n"), ":3:9: z: ", {"not finite"});
    expect(row("1,0,1e400,0,0\n"), ":3:5: x: ", {"\"1e400\"", "beyond double precision", "1.8e308"});
    expect(row("1,0,1e-400,0,0\n"), ":3:5: x: ", {"beyond double precision", "4.9e-324"});
    expect(row("1,0,1e300,0,0\n"), ":3:5: x: ", {"1e+300", "too far away", "1e+15 m"});
    expect(row("1,0,0,-2e15,0\n"), ":3:7: y: ", {"-2000000000000000 m is too far away"});
    expect(row("1,0,0x10,0,0\n"), ":3:5: x: ", {"not a number"});
    expect(row("1,0,1mm,0,0\n"), ":3:5: x: ", {"\"1mm\"", "not a number", "metres"});
    expect(row("1,0,+-1,0,0\n"), ":3:5: x: ", {"not a number"});
    expect(row("1,0,-,0,0\n"), ":3:5: x: ", {"not a number"});
    expect(row("1,0,1 2,0,0\n"), ":3:5: x: ", {"not a number"});
    expect(row("1,0,\"0,5\",0,0\n"), ":3:5: x: ", {"\"0,5\"", "not a number"});
    expect(row(std::string("1,0,\x1B[31m,0,0\n")), ":3:5: x: ", {"\"?[31m\""});
    expect(row("1,0," + std::string(100, 'a') + ",0,0\n"), ":3:5: x: ", {std::string(40, 'a') + "...\""});
}

TEST_F(PathFile, NumbersItsPaths) {
    expect(row("-1,0,0,0,0\n"), ":3:1: path: ", {"negative"});
    expect(row("1.5,0,0,0,0\n"), ":3:1: path: ", {"not whole"});
    expect(row("1e300,0,0,0,0\n"), ":3:1: path: ", {"too large"});
    expect(row("18446744073709551616,0,0,0,0\n"), ":3:1: path: ", {"too large"});
    expect(row(",0,0,0,0\n"), ":3:1: path: ", {"empty"});
    expect(row("a,0,0,0,0\n"), ":3:1: path: ", {"not a number", "whole number"});
    expect(row("nan,0,0,0,0\n"), ":3:1: path: ", {"not finite"});
}

TEST_F(PathFile, IsThere) {
    EXPECT_TRUE(says(message_of<IoError>([&] { PathReader(path("nosuch.csv"), 1); }), "nosuch.csv"));
    EXPECT_NE(message_of<IoError>([&] { PathReader(folder_.path(), 1); }), "");
}

using Records = std::vector<std::vector<std::string>>;

class CsvText : public PathWorkplace {
protected:
    Records records(const std::string& text) const {
        CsvReader reader(write("a.csv", text));
        Records all;
        while (reader.next()) {
            all.emplace_back();
            for (std::size_t i = 0; i < reader.size(); ++i)
                all.back().emplace_back(reader.text(i));
        }
        return all;
    }
    std::string complaint(const std::string& text) const {
        return message_of<UsageError>([&] { records(text); });
    }
};

TEST_F(CsvText, IsSplitAtCommasAndLineEnds) {
    const Records expected{{"a", "b"}, {"1", ""}, {"", "2"}};
    EXPECT_EQ(records("a,b\n1,\n,2\n"), expected);
    EXPECT_EQ(records("a,b\r\n1,\r\n,2\r\n"), expected);
    EXPECT_EQ(records("\xEF\xBB\xBF"
                      "a,b\n1,\n,2"),
              expected)
        << "a byte order mark, and no line feed at the end";
    EXPECT_EQ(records("a,b\n\n1,\n\r\n,2\n\n"), expected) << "empty lines";
    EXPECT_EQ(records(" a ,\tb\n1 , \n,  2\t\n"), expected) << "blanks";
    EXPECT_EQ(records(""), Records{});
    EXPECT_EQ(records("\n\n"), Records{});
}

TEST_F(CsvText, MayBeQuoted) {
    EXPECT_EQ(records("\"a\",\"b,c\"\n"), (Records{{"a", "b,c"}}));
    EXPECT_EQ(records("\"say \"\"a\"\"\" , \"two\nlines\"\n"), (Records{{"say \"a\"", "two\nlines"}}));
    EXPECT_EQ(records("\"\"\n"), (Records{{""}})) << "a quoted nothing is a cell";
    EXPECT_EQ(records("5\" nail,1\n"), (Records{{"5\" nail", "1"}}));
}

TEST_F(CsvText, IsRefusedWhereItHasNoMeaning) {
    EXPECT_TRUE(says(complaint("a,b\n1,\"2\n3,4\n"), ":2:3: the quote"));
    EXPECT_TRUE(says(complaint("a,\"b\"c\n"), ":1:6: text after a closing quote"));
    EXPECT_TRUE(says(complaint("a,b\r1,2\r"), ":1:4: a carriage return"));
    EXPECT_TRUE(says(complaint(std::string("\xFF\xFE") + std::string("a\0,\0", 4)), "UTF-16"));
    EXPECT_TRUE(says(complaint("a\n" + std::string(std::size_t(2) << 20, '1')), ":2:1: what begins here is longer"));
    EXPECT_TRUE(says(complaint("a\n\"" + std::string(std::size_t(2) << 20, '\n')), ":2:1: "));
}

TEST_F(CsvText, SaysWhereCellsStandInCharacters) {
    CsvReader reader(write("a.csv", "\xEF\xBB\xBF"
                                    "a,b\n\n\"\xC3\xBC\n\xE2\x82\xAC\",  7,8\n"));
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.where(0), (Location{1, 1}));
    EXPECT_EQ(reader.where(1), (Location{1, 3}));
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.where(0), (Location{3, 1}));
    EXPECT_EQ(reader.where(1), (Location{4, 6}));
    EXPECT_EQ(reader.where(2), (Location{4, 8}));
    EXPECT_EQ(reader.end(), (Location{4, 9}));
    EXPECT_FALSE(reader.ends_open());
}

// Wherever a buffer ends, the text goes on.
TEST_F(CsvText, IsTheSameAcrossTheEndsOfBuffers) {
    std::mt19937 random(1996);
    for (int round = 0; round < 4; ++round) {
        Records expected;
        std::string text;
        while (text.size() < 600000) {
            expected.emplace_back();
            for (int cell = 0; cell < 5; ++cell) {
                std::string content(random() % 9, 'x');
                const bool quoted = random() % 3 == 0;
                if (quoted && random() % 2)
                    content += "\"\n,";
                expected.back().push_back(content);
                if (cell)
                    text += ',';
                if (quoted)
                    text += '"';
                for (const char c : content)
                    text.append(c == '"' ? 2 : 1, c);
                if (quoted)
                    text += '"';
            }
            text += random() % 2 ? "\n" : "\r\n";
        }
        EXPECT_TRUE(records(text) == expected);
    }
}

} // namespace
} // namespace forceshade::testing

// CSV as the world writes it: quotes, line ends, marks, places, and lines that never end.
#include <random>

#include "host/paths/path_reader.h"
#include "tests/paths/path_workplace.h"

namespace forceshade::testing {
namespace {

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

TEST_F(CsvText, is_split_at_commas_and_line_ends) {
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

TEST_F(CsvText, may_be_quoted) {
    EXPECT_EQ(records("\"a\",\"b,c\"\n"), (Records{{"a", "b,c"}}));
    EXPECT_EQ(records("\"say \"\"a\"\"\" , \"two\nlines\"\n"), (Records{{"say \"a\"", "two\nlines"}}));
    EXPECT_EQ(records("\"\"\n"), (Records{{""}})) << "a quoted nothing is a cell";
    EXPECT_EQ(records("5\" nail,1\n"), (Records{{"5\" nail", "1"}}));
}

TEST_F(CsvText, is_refused_where_it_has_no_meaning) {
    EXPECT_NE(complaint("a,b\n1,\"2\n3,4\n").find(":2:3: the quote"), std::string::npos);
    EXPECT_NE(complaint("a,\"b\"c\n").find(":1:6: text after a closing quote"), std::string::npos);
    EXPECT_NE(complaint("a,b\r1,2\r").find(":1:4: a carriage return"), std::string::npos);
    EXPECT_NE(complaint(std::string("\xFF\xFE") + std::string("a\0,\0", 4)).find("UTF-16"), std::string::npos);
    EXPECT_NE(complaint("a\n" + std::string(std::size_t(2) << 20, '1')).find(":2:1: what begins here is longer"),
              std::string::npos);
    EXPECT_NE(complaint("a\n\"" + std::string(std::size_t(2) << 20, '\n')).find(":2:1: "), std::string::npos);
}

TEST_F(CsvText, says_where_cells_stand_in_characters) {
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
TEST_F(CsvText, is_the_same_across_the_ends_of_buffers) {
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

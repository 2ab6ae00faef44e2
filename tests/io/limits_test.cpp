// Files from strangers: what they may take of memory, stack and time, and what is not followed or waited for.
#include <sys/stat.h>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::says;

std::string nested(std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Json, IsTakenAsItIsWritten) {
    EXPECT_EQ(parse_json(R"({"a": [1, "}]\"[[{", {"b": null}], "c:": "\\"})").dump(),
              R"({"a":[1,"}]\"[[{",{"b":null}],"c:":"\\"})");
    EXPECT_EQ(parse_json(nested(32)).dump(), nested(32));
    EXPECT_TRUE(parse_json("").is_discarded());
    EXPECT_TRUE(parse_json("]]]]{").is_discarded());
    EXPECT_TRUE(parse_json("\"\\").is_discarded());
}

// The library dumps and copies a level a call.
TEST(Json, ThatIsNestedDeeplyIsNone) {
    for (const std::size_t depth : {33u, 300000u}) {
        EXPECT_TRUE(parse_json(nested(depth)).is_discarded());
        EXPECT_TRUE(parse_json("{\"a\":\"\\\\\", \"b\":" + nested(depth) + "}").is_discarded());
    }
    std::string objects = "1";
    for (int i = 0; i < 33; ++i)
        objects = "{\"a\":" + objects + "}";
    EXPECT_TRUE(parse_json(objects).is_discarded());
}

// The library compares each new name with all before it.
TEST(Json, WithAnObjectOfTooManyMembersIsNone) {
    const auto object_of = [](int members) {
        std::string text = "{\"a\":0";
        for (int i = 1; i < members; ++i)
            text += fmt::format(",\"{}\":[0,1]", i);
        return text + "}";
    };
    EXPECT_EQ(parse_json(object_of(1000)).size(), 1000u);
    EXPECT_TRUE(parse_json(object_of(1001)).is_discarded());
    EXPECT_TRUE(parse_json(object_of(3000000)).is_discarded());
    EXPECT_EQ(parse_json("[" + object_of(900) + "," + object_of(900) + "]").size(), 2u);
}

TEST(Json, OfWhatIsNoFileIsAnErrorAtOnce) {
    const Folder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.json").c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", folder / "zero.json");
    for (const char* name : {"pipe.json", "zero.json"})
        EXPECT_TRUE(says(message_of<IoError>([&] { read_json(folder / name); }), "it is not a regular file"));
    EXPECT_THROW(read_json(folder / "missing.json"), IoError);
}

TEST(Json, OfAFileThatIsTooLargeIsRefusedBeforeItIsRead) {
    const Folder folder;
    write_file_atomically(folder / "a.json", std::string_view("{}"));
    EXPECT_EQ(read_json(folder / "a.json").size(), 0u);
    std::filesystem::resize_file(folder / "a.json", std::uintmax_t{1} << 40); // nothing of it is on the disk
    EXPECT_TRUE(says(message_of<UsageError>([&] { read_json(folder / "a.json"); }), "--max-memory"));
}

TEST(MemoryLimit, IsANumberWithAUnit) {
    EXPECT_EQ(parse_memory("8 GiB"), std::uint64_t{8} << 30);
    EXPECT_EQ(parse_memory("1.5kB"), 1500u);
    EXPECT_EQ(parse_memory("500 MB"), 500000000u);
    for (const char* text :
         {"", "8", "GiB", "8 gib", "-1 GB", "0 GB", "nan GB", "inf TB", "1e300 TB", "8 GiB ", "8  GiB"})
        EXPECT_TRUE(says(message_of<UsageError>([&] { parse_memory(text); }), "for example \"8 GiB\""));
}

TEST(Subfolder, IsMadeAndNoLink) {
    const Folder folder, other;
    make_subfolder(folder / "new", "own.d");
    make_subfolder(folder / "new", "own.d");
    EXPECT_TRUE(std::filesystem::is_directory(folder / "new/own.d"));
    std::filesystem::create_directory_symlink(other.path(), folder / "link.d");
    std::filesystem::create_directory_symlink(other / "missing", folder / "dangling.d");
    for (const char* name : {"link.d", "dangling.d"})
        EXPECT_TRUE(says(message_of<IoError>([&] { make_subfolder(folder.path(), name); }), "it is a symbolic link"));
    EXPECT_TRUE(other.names().empty());
    write_file_atomically(folder / "file", std::string_view("x"));
    EXPECT_THROW(make_subfolder(folder.path(), "file"), IoError);
}

} // namespace
} // namespace forceshade

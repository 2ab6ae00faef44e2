#include <clocale>
#include <csignal>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::says;

TEST(TemporaryFile, AppearsUnderItsNameOnlyWhenPublished) {
    const Folder folder;
    TemporaryFile file(folder / "a.exr");
    file.write(std::string_view("hello"));
    file.flush_to_disk();
    EXPECT_EQ(read_file(file.temporary_path()), "hello");
    ASSERT_EQ(folder.names().size(), 1u);
    EXPECT_TRUE(folder.names()[0].starts_with(".a.exr."));
    EXPECT_TRUE(folder.names()[0].ends_with(".tmp"));
    file.publish();
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
    EXPECT_EQ(read_file(folder / "a.exr"), "hello");
}

TEST(TemporaryFile, LeavesNothingWhenItIsGivenUp) {
    const Folder folder;
    write_file_atomically(folder / "a", std::string_view("old"));
    {
        TemporaryFile file(folder / "a");
        file.write(std::string_view("new"));
        file.flush_to_disk();
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
    EXPECT_EQ(read_file(folder / "a"), "old");
}

TEST(TemporaryFile, WritesWhereItWasToldTo) {
    const Folder folder;
    {
        TemporaryFile file(folder / "a");
        file.write(std::string(3 << 20, 'x'));
        file.seek(5);
        file.write(std::string_view("abc"));
        EXPECT_EQ(file.tell(), 8u);
        file.seek(3 << 20);
        file.write(std::string_view("end"));
        file.publish();
    }
    std::string expected(3 << 20, 'x');
    expected.replace(5, 3, "abc");
    EXPECT_TRUE(read_file(folder / "a") == expected + "end");
}

TEST(TemporaryFile, KnowsItsHashHoweverItWasWritten) {
    const Folder folder;
    std::string text(9'000'001, 'x');
    for (std::size_t i = 0; i < text.size(); ++i)
        text[i] = static_cast<char>(i * i / 977);
    for (const std::size_t piece : {std::size_t(777), std::size_t(1) << 20, text.size()}) {
        TemporaryFile file(folder / "a", true);
        for (std::size_t at = 0; at < text.size(); at += piece)
            file.write(std::string_view(text).substr(at, piece));
        file.flush_to_disk();
        EXPECT_EQ(file.sha256(), sha256_of(text)) << piece;
        EXPECT_TRUE(read_file(file.temporary_path()) == text) << piece;
    }
    TemporaryFile again(folder / "a", true);
    again.write(text);
    again.seek(3 << 20);
    again.write(std::string_view("abc"));
    again.flush_to_disk();
    EXPECT_EQ(again.sha256(), sha256_of(text.replace(3 << 20, 3, "abc")));
    TemporaryFile without(folder / "a");
    without.write(text);
    without.flush_to_disk();
    EXPECT_EQ(without.sha256(), sha256_of(text));
}

TEST(TemporaryFile, TakesTwoWritersOfOneName) {
    const Folder folder;
    TemporaryFile first(folder / "a"), second(folder / "a");
    first.write(std::string_view("first"));
    second.write(std::string_view("second"));
    second.publish();
    EXPECT_EQ(read_file(folder / "a"), "second");
    first.publish();
    EXPECT_EQ(read_file(folder / "a"), "first");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
}

TEST(TemporaryFile, SaysWhatStandsInItsWay) {
    const Folder folder;
    write_file_atomically(folder / "file", std::string_view("x"));
    std::filesystem::create_directory(folder / "folder");
    const auto why = [](const std::filesystem::path& path) {
        return message_of<IoError>([&] { write_file_atomically(path, std::string_view("x")); });
    };
    EXPECT_TRUE(
        says(why(folder / "missing/a.exr"), "missing/a.exr: No such file or directory; create its folder first"));
    EXPECT_TRUE(says(why(folder / "file/a.exr"), "not a folder"));
    EXPECT_TRUE(says(why(folder / "folder"), "a folder has that name"));
    EXPECT_TRUE(says(why(folder / ""), "a folder has that name"));
    EXPECT_TRUE(says(why("/proc/a.exr"), "cannot write /proc/a.exr")); // not even root may
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"file", "folder"}));
}

TEST(TemporaryFile, KeepsLongNamesWithinWhatAFileSystemTakes) {
    const Folder folder;
    write_file_atomically(folder / std::string(250, 'n'), std::string_view("x"));
    EXPECT_EQ(folder.names(), std::vector<std::string>{std::string(250, 'n')});
}

/// A child process that holds a temporary of NAME until it is killed.
class Holder {
public:
    Holder(const std::filesystem::path& path) {
        int ready[2];
        EXPECT_EQ(::pipe(ready), 0);
        child_ = ::fork();
        if (child_ == 0) {
            TemporaryFile file(path);
            file.write(std::string_view("unfinished"));
            [[maybe_unused]] const auto told = ::write(ready[1], "r", 1);
            for (;;)
                ::pause();
        }
        char byte = 0;
        EXPECT_EQ(::read(ready[0], &byte, 1), 1);
        ::close(ready[0]), ::close(ready[1]);
    }
    ~Holder() { kill(); }
    void kill() {
        if (child_ > 0) {
            ::kill(child_, SIGKILL);
            ::waitpid(child_, nullptr, 0);
        }
        child_ = -1;
    }

private:
    pid_t child_ = -1;
};

TEST(StaleTemporaries, AreThoseThatNoLiveProcessHolds) {
    const Folder folder;
    const std::string own = TemporaryFile(folder / "a.exr").temporary_path().filename().string();
    const std::vector<std::string> others{".a.exr.tmp", ".hidden", "a.exr", own.substr(1),
                                          own.substr(0, own.size() - 5) + "X.tmp"};
    for (const std::string& name : others)
        folder.write(name, name);
    const std::filesystem::path name = TemporaryFile(folder / "d").temporary_path();
    std::filesystem::create_directory(name);
    Holder holder(folder / "b.exr");
    const std::size_t before = folder.names().size();
    EXPECT_EQ(clear_stale_temporaries(folder.path()), 0u);
    EXPECT_EQ(folder.names().size(), before);
    holder.kill();
    EXPECT_EQ(folder.names().size(), before);
    EXPECT_EQ(clear_stale_temporaries(folder.path()), 1u);
    EXPECT_EQ(folder.names().size(), others.size() + 1);
}

// Locks may not reach further than the machine.
TEST(StaleTemporaries, OfOtherMachinesStay) {
    const Folder folder;
    const std::string of_another = ".a.exr.fs.other-node.17.0123456789abcdef.tmp";
    folder.write(of_another, "half");
    EXPECT_EQ(clear_stale_temporaries(folder.path()), 0u);
    EXPECT_EQ(temporaries_of_others(folder.path()), std::vector<std::string>{of_another});
}

TEST(StaleTemporaries, MayBeClearedWhileTheirWritersWork) {
    const Folder folder;
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t cleaner = ::fork();
    if (cleaner == 0) {
        [[maybe_unused]] const auto told = ::write(ready[1], "r", 1);
        for (;;)
            clear_stale_temporaries(folder.path());
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    for (int i = 0; i < 3000; ++i) { // the cleaner may come between the making of a file and its locking
        const TemporaryFile file(folder / "unfinished");
        EXPECT_TRUE(std::filesystem::exists(file.temporary_path()));
    }
    for (int i = 0; i < 50; ++i)
        EXPECT_NO_THROW(write_file_atomically(folder / std::to_string(i), std::to_string(i)));
    ::kill(cleaner, SIGKILL);
    ::waitpid(cleaner, nullptr, 0);
    EXPECT_EQ(folder.names().size(), 50u);
}

TEST(StaleTemporaries, AreNoneInAFolderThatIsNotThere) {
    EXPECT_EQ(clear_stale_temporaries("/no/such/folder"), 0u);
}

TEST(ReadableFile, SaysWhatStandsInItsWay) {
    const Folder folder;
    EXPECT_TRUE(
        says(message_of<IoError>([&] { read_file(folder / "missing"); }), "missing: No such file or directory"));
    EXPECT_TRUE(says(message_of<IoError>([&] { read_file(folder.path()); }), "not a regular file"));
}

TEST(Sha256, AgreesWithTheStandardsExamples) {
    EXPECT_EQ(sha256_of(std::string_view("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_of(std::string_view("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
    const testing::Folder folder;
    const std::string text(1000003, 'q');
    write_file_atomically(folder / "q", text);
    EXPECT_EQ(sha256_of_file(folder / "q"), sha256_of(text));
    EXPECT_THROW(sha256_of_file(folder / "missing"), IoError);
}

TEST(Csv, QuotesWhatNeedsItAndPrintsNumbersExactly) {
    std::setlocale(LC_ALL, "de_DE.UTF-8"); // changes nothing where it is installed
    CsvText csv;
    csv.add("plain").add("a,b").add("say \"x\"").add("two\nlines").add("").add(" a b\t").end();
    csv.add(0.1).add(0.1f).add(1e300).add(-0.0).add(3u).add(std::uint64_t{18446744073709551615u}).end();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(csv.text(), "plain,\"a,b\",\"say \"\"x\"\"\",\"two\nlines\",,\" a b\t\"\n"
                          "0.1,0.1,1e+300,-0,3,18446744073709551615\n");
}

} // namespace
} // namespace forceshade

#include "host/output/files.h"

#include <gtest/gtest.h>

#include "tests/io/folder.h"

namespace forceshade {
namespace {

TEST(Sha256, agrees_with_the_standards_examples) {
    EXPECT_EQ(sha256_of(std::string_view("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_of(std::string_view("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, of_a_file_is_that_of_its_bytes) {
    const testing::Folder folder;
    const std::string text(1000003, 'q');
    write_file_atomically(folder / "q", text);
    EXPECT_EQ(sha256_of_file(folder / "q"), sha256_of(text));
    EXPECT_THROW(sha256_of_file(folder / "missing"), IoError);
}

} // namespace
} // namespace forceshade

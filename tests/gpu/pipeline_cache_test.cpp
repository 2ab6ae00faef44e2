// Compiled kernels kept on disk: whatever lies there, results are the same and nothing fails.
#include <iterator>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "host/field/engine.h"
#include "host/output/kept.h"
#include "tests/gpu/software_device.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using testing::Folder;
using Bytes = std::vector<std::byte>;

const std::string kDevice = "a device and its driver";

std::filesystem::path path_in(const std::filesystem::path& folder, const std::string& device = kDevice) {
    return kept_path(folder, "pipelines", device);
}

Bytes some_bytes(std::size_t count) {
    Bytes bytes;
    for (std::size_t i = 0; i < count; ++i)
        bytes.push_back(static_cast<std::byte>(i * 37 % 251));
    return bytes;
}

TEST(PipelineCacheFile, RoundTrip) {
    const Folder folder;
    const auto deep = folder.path() / "made" / "on demand";
    const Bytes bytes = some_bytes(10000);
    write_kept(path_in(deep), bytes);
    EXPECT_EQ(read_kept(path_in(deep)), bytes);
    EXPECT_TRUE(read_kept(path_in(deep, "another device")).empty());
    write_kept(path_in(deep, "another device"), some_bytes(3));
    EXPECT_EQ(read_kept(path_in(deep)), bytes);
    write_kept(path_in(deep), some_bytes(1));
    EXPECT_EQ(read_kept(path_in(deep)), some_bytes(1));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(deep), {}), 2); // and no temporary file
}

TEST(PipelineCacheFile, DamageIsSeen) {
    spdlog::set_level(spdlog::level::off);
    const Folder folder;
    const std::string name = path_in(folder.path()).filename();
    write_kept(path_in(folder.path()), some_bytes(1000));
    const std::string intact = folder.read(name);
    const auto refused = [&](const std::string& text) {
        folder.write(name, text);
        return read_kept(path_in(folder.path())).empty();
    };
    EXPECT_FALSE(refused(intact));
    for (const std::size_t length :
         {std::size_t(0), std::size_t(1), std::size_t(63), std::size_t(64), intact.size() - 1})
        EXPECT_TRUE(refused(intact.substr(0, length))) << length;
    for (std::size_t at = 0; at < intact.size(); at += 13) {
        std::string flipped = intact;
        flipped[at] = static_cast<char>(flipped[at] ^ 4);
        EXPECT_TRUE(refused(flipped)) << at;
    }
    EXPECT_TRUE(refused(intact + "x"));
    EXPECT_TRUE(refused("not ours at all, though long enough to be mistaken for a digest and something behind it"));
}

TEST(PipelineCacheFile, WhatIsNoFileIsIgnored) {
    const Folder folder;
    const auto path = path_in(folder.path());
    std::filesystem::create_directories(path); // a folder of that name
    EXPECT_TRUE(read_kept(path_in(folder.path())).empty());
    EXPECT_NO_THROW(write_kept(path_in(folder.path()), some_bytes(10)));
    std::filesystem::remove(path);
    folder.write(path.filename(), "");
    std::filesystem::resize_file(path, std::uintmax_t(1) << 40); // sparse: reading it would end the test
    EXPECT_TRUE(read_kept(path_in(folder.path())).empty());
    EXPECT_TRUE(read_kept(path_in({})).empty());
    EXPECT_NO_THROW(write_kept(path_in({}), some_bytes(10)));
}

// Not even root can write below a file.
TEST(PipelineCacheFile, AFolderThatCannotBeWrittenIsNoError) {
    const Folder folder;
    folder.write("file", "");
    EXPECT_NO_THROW(write_kept(path_in(folder / "file" / std::string("below")), some_bytes(10)));
    EXPECT_TRUE(read_kept(path_in(folder / "file" / std::string("below"))).empty());
}

class EngineCache : public ::testing::Test {
protected:
    static EngineOptions options(const std::filesystem::path& cache) {
        EngineOptions options;
        options.gpu = test::tested_gpu();
        options.validation = test::has_validation_layer();
        options.cache = cache;
        return options;
    }

    // Holds the engine against the oracle; the cache is written when the engine ends.
    static void run(const std::filesystem::path& cache) {
        const auto engine = make_engine(options(cache));
        Scene scene;
        scene.grid.size = {33, 2, 9};
        const FieldTables<float> tables = make_tables<float>(scene, {}, Extent::everything);
        EXPECT_TRUE(is_equal(test::hold_field(*engine, tables.input())));
    }
};

TEST_F(EngineCache, IsWrittenAndSurvivesDamage) {
    const Folder folder;
    run(folder.path());
    const auto names = folder.names();
    ASSERT_EQ(names.size(), 1u);
    const std::string intact = folder.read(names[0]);
    EXPECT_GT(intact.size(), 64u);
    for (const std::string& damaged : {intact, intact.substr(0, intact.size() / 2), std::string(), intact + intact}) {
        folder.write(names[0], damaged);
        run(folder.path());
        EXPECT_EQ(folder.names(), names);
    }
    folder.write("file", "");
    run(folder / "file" / std::string("below"));
}

// Bytes with a digest of their own that no driver wrote, or another one: the driver takes them or leaves them.
TEST_F(EngineCache, SurvivesForeignBytes) {
    const Bytes kept = [] {
        compute::Device device = test::open_software_device(false);
        compute::FieldKernel kernel(device);
        const FieldTables<float> tables = make_tables<float>(Scene{}, {}, Extent::what_varies);
        kernel.evaluate<float>(tables.input(), [](const layout::FieldChunk<float>&) {});
        return device.cache();
    }();
    constexpr std::size_t kOurs = 16; // bytes before the header that Vulkan prescribes
    ASSERT_GE(kept.size(), kOurs + 32);
    Bytes other_vendor = kept, other_uuid = kept;
    other_vendor[kOurs + 8] ^= std::byte{1};
    other_uuid[kOurs + 16] ^= std::byte{1};
    Bytes too_many_groups = kept;
    too_many_groups[kOurs - 1] = std::byte{0x7F};
    const Bytes half(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(kept.size() / 2));
    const Bytes header(kept.begin(), kept.begin() + 20);
    for (const Bytes& bytes :
         {kept, other_vendor, other_uuid, too_many_groups, half, header, some_bytes(10), some_bytes(10000)}) {
        compute::DeviceOptions options;
        options.wanted = test::tested_gpu();
        options.cache = bytes;
        compute::Device device(options);
        compute::FieldKernel kernel(device);
        const FieldTables<float> tables = make_tables<float>(Scene{}, {}, Extent::what_varies);
        EXPECT_TRUE(is_equal(test::hold_field(kernel, tables.input()))) << bytes.size() << " bytes";
    }
}

} // namespace
} // namespace forceshade

// Volumes that must not come into being, and files that were damaged after they were written: noticed, and never a
// crash.
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::kAllChannels;
using testing::message_of;
using testing::sample_header;
using testing::SampleField;
using testing::says;

struct Sound {
    Folder folder;
    std::string bytes, sha256;
    std::filesystem::path path = folder / "a.exr";

    explicit Sound(std::uint32_t channels) {
        VolumeWriter writer(path, sample_header(testing::kSampleSize, channels));
        SampleField(testing::kSampleSize).write_to(writer);
        sha256 = writer.finish().sha256;
        bytes = read_file(path);
    }
};

void read_all(const std::filesystem::path& path) {
    VolumeReader reader(path);
    std::vector<float> values;
    for (const std::uint32_t channel :
         {layout::kChannelForce, layout::kChannelDepth, layout::kChannelProxy, layout::kChannelUnshaded})
        if (reader.header().channels & channel)
            reader.read(channel, 0, reader.rows(), values);
    std::vector<std::uint32_t> ids;
    if (reader.header().channels & layout::kChannelFacet)
        reader.read_ids(0, reader.rows(), ids);
}

TEST(DamagedVolume, IsNoticedWhereverItWasCut) {
    const Sound sound(kAllChannels);
    EXPECT_NO_THROW(read_all(sound.path));
    for (std::size_t size = 0; size < sound.bytes.size(); size += 1 + size / 50) {
        write_file_atomically(sound.path, std::string_view(sound.bytes).substr(0, size));
        EXPECT_THROW(read_all(sound.path), IoError) << size;
        EXPECT_FALSE(file_is_intact(sound.path, sound.sha256));
    }
    std::filesystem::remove(sound.path);
    EXPECT_THROW(read_all(sound.path), IoError);
    EXPECT_FALSE(file_is_intact(sound.path, sound.sha256));
}

// OpenEXR would allocate what the header announces.
TEST(DamagedVolume, IsRefusedBeforeItCostsMemory) {
    const Sound sound(1);
    const auto refusal_of = [&](const std::string& name, std::size_t offset, std::uint32_t value) {
        std::string bytes = sound.bytes;
        bytes.replace(bytes.find(name) + name.size() + offset, sizeof value, reinterpret_cast<const char*>(&value), 4);
        write_file_atomically(sound.path, bytes);
        return message_of<IoError>([&] { read_all(sound.path); });
    };
    using namespace std::string_literals;
    EXPECT_TRUE(says(refusal_of("forceshade.scene\0string\0"s, 0, 0x7fffffff), "no valid EXR file"));
    EXPECT_TRUE(says(refusal_of("dataWindow\0box2i\0"s, 4 + 12, 0x3ffffff0), "too short for the pixels"));
    EXPECT_TRUE(says(refusal_of("dataWindow\0box2i\0"s, 4 + 8, 0x3ffffff0), "more than 1 GiB"));
    EXPECT_TRUE(says(refusal_of("forceshade.grid\0v3i\0"s, 4 + 8, 0x3ffffff0), "not a volume of this program"));
}

/// Changes a byte in the middle of a file.
void damage(const std::filesystem::path& path) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(path) / 2);
    file.seekg(middle);
    const int byte = file.get();
    file.seekp(middle);
    file.put(static_cast<char>(byte ^ 0x10));
}

// What a failing disk does behind the writer's back, before the volume has its name.
TEST(DamagedVolume, IsNoticedBeforeItGetsItsName) {
    const Folder folder;
    constexpr std::array<std::uint64_t, 3> kLarge{512, 64, 64}; // so that most is on the disk when the damage is done
    SampleField field(kLarge);
    std::mt19937 random(5);
    for (float& value : field.force) // nothing compresses it
        value = static_cast<float>(random()) / 4294967296.0f;
    for (const Compression compression : {Compression::none, Compression::zip})
        for (const int threads : {0, 2}) {
            VolumeHeader header = sample_header(kLarge, layout::kChannelForce);
            header.compression = compression;
            header.threads = threads;
            EXPECT_TRUE(says(message_of<IoError>([&] {
                                 VolumeWriter writer(folder / "a.exr", header);
                                 field.write_to(writer);
                                 damage(folder / folder.names().at(0));
                                 writer.finish();
                             }),
                             "differs from what was written"));
            EXPECT_TRUE(folder.names().empty());
        }
}

TEST(DamagedVolume, IsNotTakenForOneOfAnotherKind) {
    const Folder folder;
    write_file_atomically(folder / "a.exr", std::string_view("no EXR at all, but long enough to look into"));
    EXPECT_THROW(read_all(folder / "a.exr"), IoError);
    EXPECT_THROW(read_all(folder.path()), IoError);
}

template <typename E>
std::string refusal(const Folder& folder, const VolumeHeader& header, const SampleField<float>& field) {
    return message_of<E>([&] {
        VolumeWriter writer(folder / "a.exr", header);
        field.write_in_pieces(writer, 4);
        writer.finish();
    });
}

std::size_t sample_of(const SampleField<float>& field, std::size_t x, std::size_t y, std::size_t z) {
    return (z * testing::kSampleSize[1] + y) * field.pitch + x;
}

TEST(Refusal, OfValuesThatAreNotFiniteNamesTheFirst) {
    const Folder folder;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        SampleField field(testing::kSampleSize);
        field.force[3 * sample_of(field, 36, 10, 1) + 2] = bad;
        field.force[3 * sample_of(field, 2, 3, 4) + 1] = bad;
        EXPECT_TRUE(says(refusal<Error>(folder, sample_header(testing::kSampleSize), field),
                         std::isnan(bad) ? "force is nan at voxel (36, 10, 1): 2 values"
                                         : "force is inf at voxel (36, 10, 1): 2 values"));
    }
    SampleField field(testing::kSampleSize);
    field.depth[sample_of(field, 0, 0, 6)] = -std::numeric_limits<float>::infinity();
    EXPECT_TRUE(
        says(refusal<Error>(folder, sample_header(testing::kSampleSize), field), "depth is -inf at voxel (0, 0, 6)"));
    EXPECT_TRUE(folder.names().empty());
}

TEST(Refusal, OfWhatHalfCannotHoldNamesTheLargest) {
    const Folder folder;
    VolumeHeader header = sample_header(testing::kSampleSize);
    header.pixel = PixelType::half;
    SampleField field(testing::kSampleSize);
    field.force[3 * sample_of(field, 1, 2, 3)] = 65519.0f; // rounds to 65504
    EXPECT_EQ(refusal<Error>(folder, header, field), "");
    field.force[3 * sample_of(field, 1, 2, 3)] = 65520.0f; // rounds to infinity
    field.force[3 * sample_of(field, 5, 6, 6) + 2] = -1.2e6f;
    std::filesystem::remove(folder / "a.exr");
    EXPECT_TRUE(says(refusal<UsageError>(folder, header, field),
                     "half cannot hold -1.2e+06 N at voxel (5, 6, 6), its largest is 65504: write pixel = \"float\""));
    field = SampleField(testing::kSampleSize);
    field.depth[sample_of(field, 7, 8, 5)] = 1e5f;
    EXPECT_TRUE(says(refusal<UsageError>(folder, header, field), "100000 m at voxel (7, 8, 5)"));
    EXPECT_TRUE(folder.names().empty());
}

TEST(Refusal, OfANewVolumeLeavesTheOldOne) {
    const Folder folder;
    SampleField field(testing::kSampleSize);
    VolumeWriter writer(folder / "a.exr", sample_header(testing::kSampleSize));
    field.write_to(writer);
    const std::string hash = writer.finish().sha256;
    field.force[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal<Error>(folder, sample_header(testing::kSampleSize), field), "");
    EXPECT_TRUE(file_is_intact(folder / "a.exr", hash));
}

TEST(Refusal, OfGridsThatNoExrHolds) {
    const Folder folder;
    for (const std::array<std::uint64_t, 3> size : {std::array<std::uint64_t, 3>{0, 1, 1},
                                                    {1, 0, 1},
                                                    {1, 1, 0},
                                                    {1, 1ull << 32, 1ull << 32},
                                                    {1, 1ull << 20, 1024},
                                                    {1ull << 40, 1, 1},
                                                    {~0ull, ~0ull, ~0ull}})
        EXPECT_THROW(VolumeWriter(folder / "a.exr", sample_header(size)), UsageError);
    EXPECT_TRUE(folder.names().empty());
}

} // namespace
} // namespace forceshade

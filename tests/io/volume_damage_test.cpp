// Files that were damaged after they were written: noticed, and never a crash.
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/reading.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"
#include "tests/io/short_block.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::kAllChannels;
using testing::sample_header;
using testing::SampleField;

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

TEST(DamagedVolume, is_noticed_wherever_it_was_cut) {
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
TEST(DamagedVolume, is_refused_before_it_costs_memory) {
    const Sound sound(1);
    const auto refusal_of = [&](const std::string& name, std::size_t offset, std::uint32_t value) {
        std::string bytes = sound.bytes;
        bytes.replace(bytes.find(name) + name.size() + offset, sizeof value, reinterpret_cast<const char*>(&value), 4);
        write_file_atomically(sound.path, bytes);
        return testing::message_of<IoError>([&] { read_all(sound.path); });
    };
    using namespace std::string_literals;
    EXPECT_NE(refusal_of("forceshade.scene\0string\0"s, 0, 0x7fffffff).find("no valid EXR file"), std::string::npos);
    EXPECT_NE(refusal_of("dataWindow\0box2i\0"s, 4 + 12, 0x3ffffff0).find("too short for the pixels"),
              std::string::npos);
    EXPECT_NE(refusal_of("dataWindow\0box2i\0"s, 4 + 8, 0x3ffffff0).find("more than 1 GiB"), std::string::npos);
    EXPECT_NE(refusal_of("forceshade.grid\0v3i\0"s, 4 + 8, 0x3ffffff0).find("not a volume of this program"),
              std::string::npos);
}

TEST(DamagedVolume, never_does_more_than_throw_io_errors) {
    for (const std::uint32_t channels : {1u, kAllChannels}) {
        const Sound sound(channels);
        std::mt19937 random(7);
        for (int round = 0; round < 400; ++round) {
            std::string bytes = sound.bytes;
            // The header is small and the more dangerous half.
            const std::size_t most = round % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 3000);
            for (std::uint32_t i = 0; i <= random() % 4; ++i)
                bytes[random() % most] = static_cast<char>(random() % 3 ? random() : 0xff);
            write_file_atomically(sound.path, bytes);
            try {
                read_all(sound.path);
            } catch (const IoError&) {
            }
            EXPECT_EQ(file_is_intact(sound.path, sound.sha256), bytes == sound.bytes);
        }
    }
}

TEST(DamagedVolume, whose_block_is_too_short_is_noticed) {
    const Folder folder;
    constexpr std::array<std::uint64_t, 3> kOneBlock{64, 1, 1};
    for (const auto& [compression, packing] : {std::pair(Compression::none, testing::Packing::none),
                                               {Compression::zip1, testing::Packing::zips},
                                               {Compression::zip, testing::Packing::zip},
                                               {Compression::pxr24, testing::Packing::pxr24}})
        for (const PixelType pixel : {PixelType::float32, PixelType::half})
            for (const int threads : {0, 2}) {
                SCOPED_TRACE(static_cast<int>(packing));
                VolumeHeader header = sample_header(kOneBlock, layout::kChannelForce);
                header.compression = compression;
                header.pixel = pixel;
                VolumeWriter writer(folder / "a.exr", header);
                SampleField(kOneBlock).write_to(writer);
                writer.finish();
                const std::string file = read_file(folder / "a.exr");
                const std::size_t whole = 64 * 3 *
                                          (pixel == PixelType::half            ? 2
                                           : compression == Compression::pxr24 ? 3
                                                                               : 4);
                const auto values_with = [&](std::size_t size) {
                    write_file_atomically(folder / "a.exr",
                                          testing::with_block(file, testing::packed_zeros(packing, size)));
                    std::vector<float> values;
                    VolumeReader(folder / "a.exr", threads).read(layout::kChannelForce, 0, 1, values);
                    return values;
                };
                EXPECT_EQ(values_with(whole), std::vector<float>(64 * 3, 0.0f));
                for (const std::size_t size : {whole - 1, whole / 2, std::size_t{1}, std::size_t{0}})
                    EXPECT_THROW(values_with(size), IoError) << size;
            }
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
TEST(DamagedVolume, is_noticed_before_it_gets_its_name) {
    const Folder folder;
    constexpr std::array<std::uint64_t, 3> kLarge{512, 64, 16}; // so that most is on the disk when the damage is done
    SampleField field(kLarge);
    std::mt19937 random(5);
    for (float& value : field.force) // nothing compresses it
        value = static_cast<float>(random()) / 4294967296.0f;
    for (const Compression compression : {Compression::none, Compression::zip})
        for (const int threads : {0, 2}) {
            VolumeHeader header = sample_header(kLarge, layout::kChannelForce);
            header.compression = compression;
            header.threads = threads;
            const std::string message = testing::message_of<IoError>([&] {
                VolumeWriter writer(folder / "a.exr", header);
                field.write_to(writer);
                damage(folder / folder.names().at(0));
                writer.finish();
            });
            EXPECT_NE(message.find("differs from what was written"), std::string::npos) << message;
            EXPECT_TRUE(folder.names().empty());
        }
}

TEST(DamagedVolume, is_not_taken_for_one_of_another_kind) {
    const Folder folder;
    write_file_atomically(folder / "a.exr", std::string_view("no EXR at all, but long enough to look into"));
    EXPECT_THROW(read_all(folder / "a.exr"), IoError);
    EXPECT_THROW(read_all(folder.path()), IoError);
}

} // namespace
} // namespace forceshade

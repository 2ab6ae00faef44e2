// Volumes as EXR files, and the rounding and watching of their pixels.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/rows.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::kAllChannels;
using testing::sample_header;
using testing::SampleField;
using testing::tight;

constexpr std::array<std::uint64_t, 3> kSize{37, 11, 7};
constexpr std::array kCompressions{Compression::none, Compression::zip1, Compression::zip, Compression::pxr24};

VolumeResult write_volume(const std::filesystem::path& path, const VolumeHeader& header, const auto& field) {
    VolumeWriter writer(path, header);
    field.write_to(writer);
    return writer.finish();
}

std::vector<float> as_stored(std::vector<float> values, const VolumeHeader& header) {
    for (float& value : values) {
        if (header.pixel == PixelType::half) {
            std::array<std::byte, 2> bytes{};
            encode_row({&value, 1}, PixelFormat::half, bytes.data());
            const auto bits = std::bit_cast<std::uint16_t>(bytes);
            const int exponent = bits >> 10 & 31, fraction = bits & 1023; // spelt out: not the library's own way back
            value =
                std::ldexp(static_cast<float>(exponent == 0 ? fraction : fraction + 1024), std::max(exponent, 1) - 25) *
                (bits >> 15 ? -1.0f : 1.0f);
        } else if (header.compression == Compression::pxr24) {
            value = round_to_float24(value);
        }
    }
    return values;
}

void expect_same_bits(const std::vector<float>& expected, const std::vector<float>& found, const char* what) {
    ASSERT_EQ(expected.size(), found.size()) << what;
    EXPECT_EQ(std::memcmp(expected.data(), found.data(), expected.size() * sizeof(float)), 0) << what;
}

TEST(Volume, ReadsBackBitForBit) {
    const Folder folder;
    const SampleField field(kSize);
    for (const Compression compression : kCompressions)
        for (const PixelType pixel : {PixelType::float32, PixelType::half})
            for (const std::uint32_t channels : {1u, 3u, 5u, 9u, 17u, kAllChannels}) {
                VolumeHeader header = sample_header(kSize, channels);
                header.compression = compression;
                header.pixel = pixel;
                write_volume(folder / "a.exr", header, field);
                VolumeReader reader(folder / "a.exr");
                std::vector<float> values;
                const auto expect = [&](std::uint32_t channel, const std::vector<float>& pitched,
                                        std::size_t components) {
                    if (!(channels & channel))
                        return;
                    reader.read(channel, 0, reader.rows(), values);
                    expect_same_bits(as_stored(tight(pitched, kSize, field.pitch, components), header), values,
                                     std::to_string(channel).c_str());
                };
                expect(layout::kChannelForce, field.force, 3);
                expect(layout::kChannelDepth, field.depth, 1);
                expect(layout::kChannelProxy, field.proxy, 3);
                expect(layout::kChannelUnshaded, field.unshaded, 3);
                if (channels & layout::kChannelFacet) {
                    std::vector<std::uint32_t> ids;
                    reader.read_ids(0, reader.rows(), ids);
                    EXPECT_EQ(ids, tight(field.facet, kSize, field.pitch, 1));
                }
            }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(Volume, KeepsWhatItsHeaderSays) {
    const Folder folder;
    VolumeHeader header = sample_header(kSize, layout::kChannelForce | layout::kChannelDepth);
    header.compression = Compression::zip1;
    write_volume(folder / "a.exr", header, SampleField(kSize));
    VolumeReader reader(folder / "a.exr");
    EXPECT_EQ(reader.header().size, kSize);
    EXPECT_EQ(reader.header().origin, header.origin);
    EXPECT_EQ(reader.header().spacing, header.spacing);
    EXPECT_EQ(reader.header().channels, header.channels);
    EXPECT_EQ(reader.header().compression, header.compression);
    EXPECT_EQ(reader.header().scene, header.scene);
    EXPECT_EQ(reader.header().version, header.version);
    EXPECT_EQ(reader.header().omitted, header.omitted);
    EXPECT_EQ(reader.rows(), 77u);
    std::vector<float> values;
    EXPECT_THROW(reader.read(layout::kChannelProxy, 0, 1, values), IoError);
    EXPECT_THROW(reader.read(layout::kChannelForce, 70, 8, values), IoError);
    std::vector<float> row;
    reader.read(layout::kChannelForce, 0, 77, values);
    reader.read(layout::kChannelForce, 40, 1, row);
    EXPECT_TRUE(std::equal(row.begin(), row.end(), values.begin() + 40 * 37 * 3));
}

// A block of zlib's begins with how hard its writer tried.
TEST(Volume, IsPackedByTheFastestLevel) {
    const Folder folder;
    for (const Compression compression : {Compression::zip1, Compression::zip, Compression::pxr24}) {
        VolumeHeader header = sample_header(kSize, layout::kChannelForce);
        header.compression = compression;
        write_volume(folder / "a.exr", header, SampleField(kSize));
        const std::string bytes = read_file(folder / "a.exr");
        int fastest = 0;
        for (std::size_t at = 0; (at = bytes.find("\x78\x01", at)) != std::string::npos; ++at)
            ++fastest;
        EXPECT_GE(fastest, compression == Compression::zip1 ? 77 : 5); // blocks of 77 rows
    }
}

TEST(Volume, HasTheSameBytesHoweverItWasWritten) {
    const Folder folder;
    const std::array<std::uint64_t, 3> size{12000, 13, 3}; // groups of 16 rows, so that pieces cross them
    const SampleField field(size);
    for (const std::uint32_t channels : {1u, kAllChannels}) {
        VolumeHeader header = sample_header(size, channels);
        const VolumeResult whole = write_volume(folder / "a.exr", header, field);
        EXPECT_EQ(whole.sha256, write_volume(folder / "a.exr", header, field).sha256);
        for (const std::size_t most : {1u, 7u, 16u, 20u}) {
            VolumeWriter writer(folder / "a.exr", header);
            field.write_in_pieces(writer, most);
            EXPECT_EQ(whole.sha256, writer.finish().sha256) << most;
        }
        header.threads = 2;
        EXPECT_EQ(whole.sha256, write_volume(folder / "a.exr", header, field).sha256);
        EXPECT_TRUE(file_is_intact(folder / "a.exr", whole.sha256));
        EXPECT_EQ(whole.bytes, std::filesystem::file_size(folder / "a.exr"));
    }
}

TEST(Volume, MayBeWrittenBesideAnother) {
    const Folder folder;
    const SampleField field({256, 32, 16});
    VolumeHeader header = sample_header(field.size);
    const std::string expected = write_volume(folder / "a.exr", header, field).sha256;
    header.threads = 2;
    std::vector<std::thread> workers;
    std::array<std::string, 4> hashes;
    for (std::size_t i = 0; i < hashes.size(); ++i) // two of them under one name
        workers.emplace_back([&, i] {
            hashes[i] = write_volume(folder / (i < 2 ? "same.exr" : std::to_string(i)), header, field).sha256;
        });
    for (std::thread& worker : workers)
        worker.join();
    for (const std::string& hash : hashes)
        EXPECT_EQ(hash, expected);
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"2", "3", "a.exr", "same.exr"}));
}

TEST(Volume, RepeatsRowsAsIfTheyHadBeenWrittenOut) {
    const Folder folder;
    const std::array<std::uint64_t, 3> size{12000, 13, 3};
    const SampleField field(size, false);
    const VolumeResult whole = write_volume(folder / "a.exr", sample_header(size), field);
    const SampleField row_a_layer({size[0], 1, size[2]}, false);
    VolumeWriter writer(folder / "b.exr", sample_header(size));
    auto chunk = row_a_layer.chunk(0, 2);
    writer.write(chunk, size[1]);
    chunk = row_a_layer.chunk(2, 1);
    writer.write(chunk, size[1]);
    const VolumeResult repeated = writer.finish();
    EXPECT_EQ(whole.sha256, repeated.sha256);
    EXPECT_EQ(whole.largest_force, repeated.largest_force);
    EXPECT_EQ(whole.largest_voxel, repeated.largest_voxel);
}

TEST(Volume, RoundsDoublesToFloats) {
    const Folder folder;
    const SampleField<double> field(kSize);
    write_volume(folder / "a.exr", sample_header(kSize), field);
    std::vector<float> expected, found;
    for (const double value : tight(field.force, kSize, field.pitch, 3))
        expected.push_back(static_cast<float>(value));
    VolumeReader(folder / "a.exr").read(layout::kChannelForce, 0, 77, found);
    expect_same_bits(expected, found, "force");
}

TEST(Volume, FindsTheLargestForce) {
    const Folder folder;
    SampleField field(kSize);
    const std::size_t sample = ((5 * 11) + 4) * field.pitch + 30;
    field.force[3 * sample] = -3.0f, field.force[3 * sample + 1] = 0.0f, field.force[3 * sample + 2] = 4.0f;
    const VolumeResult result = write_volume(folder / "a.exr", sample_header(kSize), field);
    EXPECT_EQ(result.largest_force, 5.0);
    EXPECT_EQ(result.largest_voxel, (std::array<std::uint64_t, 3>{30, 4, 5}));
}

TEST(Volume, MayBeASingleVoxel) {
    const Folder folder;
    for (const Compression compression : kCompressions) {
        VolumeHeader header = sample_header({1, 1, 1});
        header.compression = compression;
        SampleField field({1, 1, 1});
        field.force = {1e-45f, -0.0f, 3.4028235e38f, 0, 0, 0};
        write_volume(folder / "a.exr", header, field);
        std::vector<float> values;
        VolumeReader(folder / "a.exr").read(layout::kChannelForce, 0, 1, values);
        expect_same_bits(as_stored({1e-45f, -0.0f, 3.4028235e38f}, header), values, "force");
        EXPECT_TRUE(std::isfinite(values[2]));
    }
}

TEST(Volume, WantsItsRowsInOrderAndAllOfThem) {
    const Folder folder;
    const SampleField field(kSize);
    VolumeWriter writer(folder / "a.exr", sample_header(kSize));
    EXPECT_THROW(writer.write(field.chunk(11, 11), 1), std::logic_error);
    writer.write(field.chunk(0, 11), 1);
    EXPECT_THROW(writer.write(field.chunk(0, 11), 1), std::logic_error);
    EXPECT_THROW(writer.finish(), std::logic_error);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));
}

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Float24, IsTheNearestWithFifteenBitsOfFraction) {
    EXPECT_TRUE(rc::check([](std::uint32_t bits) {
        const auto value = std::bit_cast<float>(bits);
        RC_PRE(std::isfinite(value) && value != 0.0f);
        const float rounded = round_to_float24(value);
        RC_ASSERT(std::isfinite(rounded));
        RC_ASSERT(round_to_float24(rounded) == rounded);
        RC_ASSERT((std::bit_cast<std::uint32_t>(rounded) & 0xffu) == 0);
        const double step =
            std::max(std::ldexp(1.0, std::ilogb(value) - 15), 0x1p-141); // below 2^-126 the grid is even
        const bool at_the_end = std::abs(value) > 0x1.fffep127f;         // truncated rather than infinite
        RC_ASSERT(std::abs(static_cast<double>(rounded) - static_cast<double>(value)) <=
                  (at_the_end ? 1.0 : 0.5) * step);
    }));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(round_to_float24(-0.0f)), 0x80000000u);
    EXPECT_EQ(round_to_float24(kLargest), 0x1.fffep127f);
    EXPECT_EQ(round_to_float24(-kInfinity), -kInfinity);
    EXPECT_TRUE(std::isnan(round_to_float24(std::numeric_limits<float>::quiet_NaN())));
    EXPECT_TRUE(std::isnan(round_to_float24(std::bit_cast<float>(0x7f800001u))));
}

TEST(Half, OverflowsFrom65520) {
    EXPECT_FALSE(overflows_half(65519.996f));
    EXPECT_TRUE(overflows_half(65520.0f));
    EXPECT_TRUE(overflows_half(-kLargest));
    EXPECT_FALSE(overflows_half(kInfinity)); // it is none that becomes infinite
}

TEST(PixelWatch, FindsTheFirstOfTheLargest) {
    PixelWatch watch(3);
    const std::vector<float> first{0, 0, 0, 3, 4, 0}, second{0, -5, 0, 0, 0, 4};
    watch.add(first, 0, 0, 2);
    watch.add(second, 2, 0, 1);
    EXPECT_EQ(watch.largest().value, -5.0);
    EXPECT_EQ(watch.largest().voxel, (Voxel{0, 2, 0}));
    EXPECT_EQ(watch.longest().value, 5.0);
    EXPECT_EQ(watch.longest().voxel, (Voxel{1, 0, 0}));
    EXPECT_EQ(watch.non_finite(), 0u);
}

TEST(PixelWatch, CountsWhatIsNotFiniteAndLooksPastIt) {
    PixelWatch watch(3);
    const std::vector<float> row{kInfinity, 9, 0, 0, 2, 0, std::nanf(""), 0, 0, kLargest, kLargest, kLargest};
    watch.add(row, 1, 2, 10);
    EXPECT_EQ(watch.non_finite(), 20u);
    EXPECT_EQ(watch.first_non_finite().voxel, (Voxel{0, 1, 2}));
    EXPECT_EQ(watch.largest().value, static_cast<double>(kLargest));
    EXPECT_NEAR(watch.longest().value / static_cast<double>(kLargest), std::sqrt(3.0), 1e-15);
    EXPECT_EQ(watch.longest().voxel, (Voxel{3, 1, 2}));
}

TEST(PixelWatch, OfNothingButZerosIsTheFirstVoxel) {
    PixelWatch watch(3);
    watch.add(std::vector<float>(9, 0.0f), 0, 0, 1);
    EXPECT_TRUE(watch.longest().found);
    EXPECT_EQ(watch.longest().value, 0.0);
    EXPECT_EQ(watch.longest().voxel, (Voxel{0, 0, 0}));
}

} // namespace
} // namespace forceshade

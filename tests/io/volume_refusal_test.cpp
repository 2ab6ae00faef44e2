// Volumes that must not come into being: values that a file would falsify, grids that no EXR holds.
#include <limits>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/reading.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::sample_header;
using testing::SampleField;

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

TEST(Refusal, of_values_that_are_not_finite_names_the_first) {
    const Folder folder;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        SampleField field(testing::kSampleSize);
        field.force[3 * sample_of(field, 36, 10, 1) + 2] = bad;
        field.force[3 * sample_of(field, 2, 3, 4) + 1] = bad;
        const std::string message = refusal<Error>(folder, sample_header(testing::kSampleSize), field);
        EXPECT_NE(message.find(std::isnan(bad) ? "force is nan at voxel (36, 10, 1): 2 values"
                                               : "force is inf at voxel (36, 10, 1): 2 values"),
                  std::string::npos)
            << message;
    }
    SampleField field(testing::kSampleSize);
    field.depth[sample_of(field, 0, 0, 6)] = -std::numeric_limits<float>::infinity();
    EXPECT_NE(
        refusal<Error>(folder, sample_header(testing::kSampleSize), field).find("depth is -inf at voxel (0, 0, 6)"),
        std::string::npos);
    EXPECT_TRUE(folder.names().empty());
}

TEST(Refusal, of_values_that_are_not_finite_can_be_waived) {
    const Folder folder;
    SampleField field(testing::kSampleSize);
    field.force[3 * sample_of(field, 2, 3, 4) + 1] = std::numeric_limits<float>::quiet_NaN();
    for (const Compression compression : {Compression::zip, Compression::pxr24})
        for (const PixelType pixel : {PixelType::float32, PixelType::half}) {
            VolumeHeader header = sample_header(testing::kSampleSize);
            header.allow_non_finite = true;
            header.compression = compression;
            header.pixel = pixel;
            VolumeWriter writer(folder / "a.exr", header);
            field.write_to(writer);
            EXPECT_EQ(writer.finish().non_finite, 1u);
            std::vector<float> values;
            VolumeReader(folder / "a.exr").read(layout::kChannelForce, 0, 77, values);
            EXPECT_TRUE(std::isnan(values[((4 * 11 + 3) * 37 + 2) * 3 + 1]));
        }
}

TEST(Refusal, of_what_half_cannot_hold_names_the_largest) {
    const Folder folder;
    VolumeHeader header = sample_header(testing::kSampleSize);
    header.pixel = PixelType::half;
    SampleField field(testing::kSampleSize);
    field.force[3 * sample_of(field, 1, 2, 3)] = 65519.0f; // rounds to 65504
    EXPECT_EQ(refusal<Error>(folder, header, field), "");
    field.force[3 * sample_of(field, 1, 2, 3)] = 65520.0f; // rounds to infinity
    field.force[3 * sample_of(field, 5, 6, 6) + 2] = -1.2e6f;
    std::filesystem::remove(folder / "a.exr");
    EXPECT_NE(
        refusal<UsageError>(folder, header, field)
            .find("half cannot hold -1.2e+06 N at voxel (5, 6, 6), its largest is 65504: write pixel = \"float\""),
        std::string::npos)
        << refusal<UsageError>(folder, header, field);
    field = SampleField(testing::kSampleSize);
    field.depth[sample_of(field, 7, 8, 5)] = 1e5f;
    EXPECT_NE(refusal<UsageError>(folder, header, field).find("100000 m at voxel (7, 8, 5)"), std::string::npos)
        << refusal<UsageError>(folder, header, field);
    EXPECT_TRUE(folder.names().empty());
}

TEST(Refusal, of_a_new_volume_leaves_the_old_one) {
    const Folder folder;
    SampleField field(testing::kSampleSize);
    VolumeWriter writer(folder / "a.exr", sample_header(testing::kSampleSize));
    field.write_to(writer);
    const std::string hash = writer.finish().sha256;
    field.force[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal<Error>(folder, sample_header(testing::kSampleSize), field), "");
    EXPECT_TRUE(file_is_intact(folder / "a.exr", hash));
}

TEST(Refusal, of_grids_that_no_exr_holds) {
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

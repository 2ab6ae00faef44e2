// NumPy and ParaView files, read here by hand.
#include <cstring>

#include <gtest/gtest.h>
#include <zlib.h>

#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/output/reading.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::SampleField;
using testing::tight;

template <typename T> std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string written(ChunkSink& sink, const auto& field, const std::filesystem::path& path) {
    field.write_in_pieces(sink, 4);
    const VolumeResult result = sink.finish();
    std::string bytes = read_file(path);
    EXPECT_EQ(result.sha256, sha256_of(bytes));
    EXPECT_EQ(result.bytes, bytes.size());
    return bytes;
}

TEST(Npy, is_a_header_and_the_samples) {
    const Folder folder;
    const SampleField field(testing::kSampleSize);
    NpyWriter force(folder / "a.npy", testing::kSampleSize, layout::kChannelForce, Precision::f32);
    const std::string bytes = written(force, field, folder / "a.npy");
    const std::string start(
        "\x93NUMPY\x01\x00\x76\x00{'descr': '<f4', 'fortran_order': False, 'shape': (7, 11, 37, 3), }", 74);
    EXPECT_TRUE(bytes.starts_with(start)) << bytes.substr(0, 128);
    EXPECT_EQ(bytes[127], '\n');
    EXPECT_TRUE(bytes.substr(128) == bytes_of(tight(field.force, testing::kSampleSize, field.pitch, 3)));
    NpyWriter facet(folder / "b.npy", testing::kSampleSize, layout::kChannelFacet, Precision::f64);
    const std::string ids = written(facet, field, folder / "b.npy");
    EXPECT_NE(ids.find("'<u4', 'fortran_order': False, 'shape': (7, 11, 37), "), std::string::npos);
    EXPECT_TRUE(ids.substr(128) == bytes_of(tight(field.facet, testing::kSampleSize, field.pitch, 1)));
}

TEST(Npy, keeps_doubles) {
    const Folder folder;
    const SampleField<double> field(testing::kSampleSize);
    NpyWriter depth(folder / "a.npy", testing::kSampleSize, layout::kChannelDepth, Precision::f64);
    const std::string bytes = written(depth, field, folder / "a.npy");
    EXPECT_NE(bytes.find("'<f8'"), std::string::npos);
    EXPECT_TRUE(bytes.substr(128) == bytes_of(tight(field.depth, testing::kSampleSize, field.pitch, 1)));
}

TEST(RawFormats, repeat_rows_as_if_they_had_been_written_out) {
    const Folder folder;
    const SampleField field(testing::kSampleSize, false),
        row_a_layer({testing::kSampleSize[0], 1, testing::kSampleSize[2]}, false);
    const VtiHeader header{testing::kSampleSize, {}, {1, 1, 1}, testing::kAllChannels, Precision::f32};
    VtiWriter whole(folder / "a.vti", header), repeated(folder / "b.vti", header);
    field.write_to(whole);
    repeated.write(row_a_layer.chunk(0, 3), testing::kSampleSize[1]);
    repeated.write(row_a_layer.chunk(3, 4), testing::kSampleSize[1]);
    EXPECT_EQ(whole.finish().sha256, repeated.finish().sha256);
}

TEST(Vti, is_xml_and_the_arrays) {
    const Folder folder;
    const SampleField field(testing::kSampleSize);
    const VtiHeader header{testing::kSampleSize, {-0.025, 0, 1e-9}, {0.0002, 0.1, 1}, 31, Precision::f32};
    VtiWriter writer(folder / "a.vti", header);
    const std::string bytes = written(writer, field, folder / "a.vti");
    EXPECT_NE(
        bytes.find("<ImageData WholeExtent=\"0 36 0 10 0 6\" Origin=\"-0.025 0 1e-09\" Spacing=\"0.0002 0.1 1\">"),
        std::string::npos);
    EXPECT_NE(bytes.find("<PointData Vectors=\"force\" Scalars=\"depth\">"), std::string::npos);
    EXPECT_NE(bytes.find("type=\"Int32\" Name=\"facet\""), std::string::npos) << "no facet is -1";
    EXPECT_TRUE(bytes.ends_with("\n</AppendedData>\n</VTKFile>\n"));
    const std::size_t data = bytes.find("encoding=\"raw\">\n_") + 17;
    const auto expect_array = [&](const char* name, const std::string& samples) {
        const std::size_t tag = bytes.find(std::string("Name=\"") + name + "\"");
        ASSERT_NE(tag, std::string::npos) << name;
        const std::size_t offset = std::stoul(bytes.substr(bytes.find("offset=\"", tag) + 8));
        std::array<std::uint64_t, 3> counts{}; // blocks, bytes of one, of the last one
        std::memcpy(counts.data(), bytes.data() + data + offset, sizeof counts);
        std::vector<std::uint64_t> packed(counts[0]);
        std::memcpy(packed.data(), bytes.data() + data + offset + sizeof counts, 8 * packed.size());
        std::string unpacked;
        std::size_t from = data + offset + sizeof counts + 8 * packed.size();
        for (const std::uint64_t size : packed) {
            std::string block(counts[1], '\0');
            uLongf room = block.size();
            ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &room,
                                 reinterpret_cast<const Bytef*>(bytes.data() + from), size),
                      Z_OK);
            unpacked += block.substr(0, room);
            from += size;
        }
        EXPECT_EQ(unpacked.size() % counts[1], counts[2]) << name;
        EXPECT_TRUE(unpacked == samples) << name;
    };
    expect_array("force", bytes_of(tight(field.force, testing::kSampleSize, field.pitch, 3)));
    expect_array("depth", bytes_of(tight(field.depth, testing::kSampleSize, field.pitch, 1)));
    expect_array("facet", bytes_of(tight(field.facet, testing::kSampleSize, field.pitch, 1)));
    expect_array("proxy", bytes_of(tight(field.proxy, testing::kSampleSize, field.pitch, 3)));
    expect_array("unshaded", bytes_of(tight(field.unshaded, testing::kSampleSize, field.pitch, 3)));
}

} // namespace
} // namespace forceshade

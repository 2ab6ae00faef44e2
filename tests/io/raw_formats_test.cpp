// NumPy and ParaView files, read here by hand.
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"
#include "tests/io/vtk_bytes.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::SampleField;
using testing::says;
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

TEST(Npy, IsAHeaderAndTheSamples) {
    const Folder folder;
    const auto expect_file = [&](const auto& field, layout::uint channel, Precision precision, const char* header,
                                 const auto& pitched, std::size_t components) {
        NpyWriter writer(folder / "a.npy", testing::kSampleSize, channel, precision);
        const std::string bytes = written(writer, field, folder / "a.npy");
        EXPECT_TRUE(bytes.starts_with(std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header)) << bytes.substr(0, 128);
        EXPECT_EQ(bytes[127], '\n');
        EXPECT_TRUE(bytes.substr(128) == bytes_of(tight(pitched, testing::kSampleSize, field.pitch, components)));
    };
    const SampleField single(testing::kSampleSize);
    const SampleField<double> twice(testing::kSampleSize);
    expect_file(single, layout::kChannelForce, Precision::f32,
                "{'descr': '<f4', 'fortran_order': False, 'shape': (7, 11, 37, 3), }", single.force, 3);
    expect_file(single, layout::kChannelFacet, Precision::f64,
                "{'descr': '<u4', 'fortran_order': False, 'shape': (7, 11, 37), }", single.facet, 1);
    expect_file(twice, layout::kChannelDepth, Precision::f64,
                "{'descr': '<f8', 'fortran_order': False, 'shape': (7, 11, 37), }", twice.depth, 1);
}

TEST(RawFormats, RepeatRowsAsIfTheyHadBeenWrittenOut) {
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

TEST(Vti, IsXmlAndTheArrays) {
    const Folder folder;
    const SampleField field(testing::kSampleSize);
    const VtiHeader header{testing::kSampleSize, {-0.025, 0, 1e-9}, {0.0002, 0.1, 1}, 31, Precision::f32};
    VtiWriter writer(folder / "a.vti", header);
    const std::string bytes = written(writer, field, folder / "a.vti");
    EXPECT_TRUE(
        says(bytes, "<ImageData WholeExtent=\"0 36 0 10 0 6\" Origin=\"-0.025 0 1e-09\" Spacing=\"0.0002 0.1 1\">"));
    EXPECT_TRUE(says(bytes, "<PointData Vectors=\"force\" Scalars=\"depth\">"));
    EXPECT_TRUE(says(bytes, "type=\"Int32\" Name=\"facet\"")) << "no facet is -1";
    EXPECT_TRUE(bytes.ends_with("\n</AppendedData>\n</VTKFile>\n"));
    const auto expect_array = [&](const char* name, const char* type, std::size_t components,
                                  const std::string& samples) {
        EXPECT_TRUE(testing::vtk_bytes(bytes, name, type, components) == samples) << name;
    };
    const auto expect_reals = [&](const char* name, const std::vector<float>& pitched, std::size_t components) {
        expect_array(name, "Float32", components,
                     bytes_of(tight(pitched, testing::kSampleSize, field.pitch, components)));
    };
    expect_reals("force", field.force, 3);
    expect_reals("depth", field.depth, 1);
    expect_reals("proxy", field.proxy, 3);
    expect_reals("unshaded", field.unshaded, 3);
    expect_array("facet", "Int32", 1, bytes_of(tight(field.facet, testing::kSampleSize, field.pitch, 1)));
}

// Polylines over 40000 points: several blocks of each array, with numbers that are none.
class Vtp : public ::testing::Test {
protected:
    static constexpr std::size_t kPoints = 40000;

    Vtp() {
        for (std::size_t i = 0; i < kPoints; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                places_.push_back(std::sin(double(3 * i + c)));
                force_.push_back(float(i) / 7);
            }
            order_.push_back(static_cast<std::int64_t>(kPoints - 1 - i));
        }
        force_[5] = std::numeric_limits<float>::quiet_NaN();
        force_[6] = -std::numeric_limits<float>::infinity();
    }
    static PolyData lines() {
        PolyData data;
        data.polygons = false;
        data.points = data.corners = kPoints;
        data.cells = 2;
        data.point_data = {{"force", "Float32", 3, kPoints}};
        data.cell_data = {{"path", "Int64", 1, 2}};
        data.active_points = "Vectors=\"force\"";
        data.active_cells = "Scalars=\"path\"";
        data.field_data = "<FieldData/>\n";
        return data;
    }
    template <typename T> static std::vector<std::span<const T>> pieces(const std::vector<T>& all, std::size_t most) {
        std::vector<std::span<const T>> result;
        for (std::size_t at = 0; at < all.size(); at += most)
            result.push_back(std::span(all).subspan(at, std::min(most, all.size() - at)));
        return result;
    }
    void write_ids(VtkFile& file) const {
        file.write("path", std::as_bytes(std::span(ids_)));
        file.write("offsets", std::as_bytes(std::span(ends_)));
        file.write("connectivity", std::as_bytes(std::span(order_)));
    }
    Folder folder_;
    std::vector<double> places_;
    std::vector<float> force_;
    std::vector<std::int64_t> order_, ids_{7, std::int64_t(1) << 40}, ends_{100, kPoints};
};

TEST_F(Vtp, IsXmlAndTheArrays) {
    VtkFile file = make_vtp(folder_ / "a.vtp", lines());
    file.write("force", std::as_bytes(std::span(force_)));
    write_ids(file);
    file.write("Points", std::as_bytes(std::span(places_)));
    const VolumeResult result = file.finish();
    const std::string bytes = read_file(folder_ / "a.vtp");
    EXPECT_EQ(result.sha256, sha256_of(bytes));
    EXPECT_EQ(result.bytes, bytes.size());
    const std::string start =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<FieldData/>\n<Piece "
        "NumberOfPoints=\"40000\" NumberOfVerts=\"0\" NumberOfLines=\"2\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"0\">\n<PointData Vectors=\"force\">\n<DataArray type=\"Float32\" Name=\"force\" ";
    EXPECT_TRUE(bytes.starts_with(start)) << bytes.substr(0, 600);
    std::size_t at = 0;
    for (const char* tag : {"<PointData", "\"force\" N", "</PointData>", "<CellData Scalars=\"path\">", "\"path\" N",
                            "</CellData>", "<Points>", "</Points>", "<Lines>", "\"connectivity\"", "\"offsets\"",
                            "</Lines>", "</Piece>", "</PolyData>", "<AppendedData", "</AppendedData>", "</VTKFile>"}) {
        at = bytes.find(tag, at);
        ASSERT_NE(at, std::string::npos) << tag << " is not where it belongs";
    }
    EXPECT_TRUE(testing::vtk_bytes(bytes, "force", "Float32", 3) == bytes_of(force_)) << "NaN and infinity, too";
    EXPECT_EQ(testing::vtk_numbers<double>(bytes, "Points", 3), places_);
    EXPECT_EQ(testing::vtk_numbers<std::int64_t>(bytes, "path"), ids_);
    EXPECT_EQ(testing::vtk_numbers<std::int64_t>(bytes, "offsets"), ends_);
    EXPECT_EQ(testing::vtk_numbers<std::int64_t>(bytes, "connectivity"), order_);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.vtp"});
}

TEST_F(Vtp, IsTheSameHoweverItsArraysArrive) {
    std::string first;
    for (const std::size_t most : {kPoints * 3, std::size_t(65536), std::size_t(1000), std::size_t(7)}) {
        VtkFile file = make_vtp(folder_ / "a.vtp", lines());
        const auto forces = pieces(force_, most);
        const auto places = pieces(places_, most);
        for (std::size_t i = 0; i < forces.size(); ++i) {
            file.write("Points", std::as_bytes(places[i]));
            file.write("force", std::as_bytes(forces[i]));
        }
        write_ids(file);
        file.finish();
        const std::string bytes = read_file(folder_ / "a.vtp");
        if (first.empty())
            first = bytes;
        EXPECT_TRUE(bytes == first) << most;
    }
}

TEST_F(Vtp, RefusesTooFewAndTooManySamplesAndLeavesNothing) {
    {
        VtkFile file = make_vtp(folder_ / "a.vtp", lines());
        file.write("force", std::as_bytes(std::span(force_)));
        write_ids(file);
        file.write("Points", std::as_bytes(std::span(places_).first(30)));
        EXPECT_TRUE(says(message_of<std::logic_error>([&] { file.finish(); }), "of Points have come"));
        EXPECT_TRUE(says(message_of<std::logic_error>([&] { write_ids(file); }), "no room"));
        EXPECT_TRUE(says(message_of<std::logic_error>([&] { file.write("none", {}); }), "none"));
    }
    EXPECT_TRUE(folder_.names().empty());
}

} // namespace
} // namespace forceshade

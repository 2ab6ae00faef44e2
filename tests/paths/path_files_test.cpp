// The files that explored paths are written to: what stands where, the same bytes however paths arrive.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <random>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/paths/path_files.h"
#include "tests/io/folder.h"
#include "tests/io/vtk_bytes.h"
#include "tests/paths/sample_paths.h"

namespace forceshade::testing {
namespace {

const std::vector<layout::uint> kLengths{5, 7, 1, 7, 3, 6, 2, 7, 7, 4, 5, 7, 7, 7, 1, 2, 7, 7, 7, 3};
constexpr std::size_t kLongest = 7;

class PathFiles : public ::testing::Test {
protected:
    std::string read(const std::string& name) const { return folder_.read(name); }
    static PathVolumeHeader header() {
        PathVolumeHeader header;
        header.steps = kLongest;
        header.paths = kLengths.size();
        header.rate = 1000;
        header.channels = kPathChannels;
        header.scene = "[paths]\n";
        header.version = "0.1.0";
        return header;
    }
    template <typename T>
    VolumeResult write_exr(const std::string& name, const PathVolumeHeader& header, std::size_t most = 6,
                           std::size_t window = 3) const {
        PathVolumeWriter writer(folder_ / name, header);
        return write_paths<T>(writer, kLengths, kLongest, most, window);
    }
    Folder folder_;
};

std::vector<float> channel_of(const std::filesystem::path& path, const std::string& part, const char* name) {
    Imf::MultiPartInputFile file(path.c_str());
    for (int i = 0; i < file.parts(); ++i) {
        if (file.header(i).name() != part)
            continue;
        Imf::InputPart input(file, i);
        const Imath::Box2i box = input.header().dataWindow();
        const auto width = static_cast<std::size_t>(box.max.x + 1), height = static_cast<std::size_t>(box.max.y + 1);
        std::vector<float> values(width * height);
        Imf::FrameBuffer frame;
        frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 4 * width));
        input.setFrameBuffer(frame);
        input.readPixels(0, static_cast<int>(height) - 1);
        return values;
    }
    ADD_FAILURE() << "no part " << part;
    return {};
}

TEST_F(PathFiles, ExrHasARowAPathAndNanBehindItsEnd) {
    const VolumeResult result = write_exr<float>("a.exr", header());
    EXPECT_EQ(result.bytes, std::filesystem::file_size(folder_ / "a.exr"));
    double channel = 1;
    for (const char* part : {"force", "position", "proxy"}) {
        std::size_t component = 0;
        for (const char* name : {"R", "G", "B"}) {
            const std::vector<float> values = channel_of(folder_ / "a.exr", part, name);
            ASSERT_EQ(values.size(), kLongest * kLengths.size());
            for (std::size_t path = 0; path < kLengths.size(); ++path)
                for (std::size_t step = 0; step < kLongest; ++step) {
                    const float value = values[path * kLongest + step];
                    if (step < kLengths[path])
                        EXPECT_EQ(value, float(sample_value(path, step, component, channel))) << part << name;
                    else
                        EXPECT_TRUE(std::isnan(value)) << part << name << path << ' ' << step;
                }
            ++component;
        }
        ++channel;
    }
    EXPECT_EQ(channel_of(folder_ / "a.exr", "depth", "Z")[kLongest], 4001);
    EXPECT_TRUE(std::isnan(channel_of(folder_ / "a.exr", "depth", "Z")[5]));
    const std::vector<float> facets = channel_of(folder_ / "a.exr", "facet", "id");
    EXPECT_EQ(facets[0], float(layout::kNoFacet));
    EXPECT_EQ(facets[kLongest + 1], 1);
    EXPECT_EQ(facets[5], float(layout::kNoFacet)) << "behind the end";
}

TEST_F(PathFiles, ExrSaysWhatItHolds) {
    PathVolumeHeader recorded = header(); // with times of its own
    recorded.rate = 0;
    write_exr<float>("b.exr", recorded);
    EXPECT_EQ(Imf::MultiPartInputFile((folder_ / "b.exr").c_str())
                  .header(0)
                  .findTypedAttribute<Imf::DoubleAttribute>("forceshade.rate"),
              nullptr);
    write_exr<float>("a.exr", header());
    Imf::MultiPartInputFile file((folder_ / "a.exr").c_str());
    ASSERT_EQ(file.parts(), 5);
    for (int i = 0; i < 5; ++i) {
        const Imf::Header& part = file.header(i);
        EXPECT_EQ(part.typedAttribute<Imf::V2iAttribute>("forceshade.paths").value(), Imath::V2i(7, 20));
        EXPECT_EQ(part.typedAttribute<Imf::DoubleAttribute>("forceshade.rate").value(), 1000);
        EXPECT_EQ(part.typedAttribute<Imf::StringAttribute>("forceshade.scene").value(), "[paths]\n");
        EXPECT_EQ(part.typedAttribute<Imf::StringAttribute>("forceshade.version").value(), "0.1.0");
    }
    EXPECT_EQ(file.header(0).name(), "force");
    EXPECT_EQ(file.header(0).typedAttribute<Imf::StringAttribute>("forceshade.units").value(), "m N");
    EXPECT_EQ(file.header(1).name(), "position");
    EXPECT_EQ(file.header(1).typedAttribute<Imf::StringAttribute>("forceshade.units").value(), "m m");
}

TEST_F(PathFiles, ExrIsTheSameHoweverPathsArrive) {
    write_exr<float>("a.exr", header());
    for (const auto& [most, window] : {std::pair<std::size_t, std::size_t>{1, 1}, {1, 2}, {100, 7}, {3, 2}}) {
        write_exr<float>("b.exr", header(), most, window);
        EXPECT_EQ(read("a.exr"), read("b.exr")) << most << ' ' << window;
    }
    write_exr<double>("b.exr", header());
    EXPECT_EQ(read("a.exr"), read("b.exr")) << "values that floats hold";
    PathVolumeHeader threads = header();
    threads.threads = 3;
    write_exr<float>("b.exr", threads);
    EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(PathFiles, ExrWithoutFurtherChannelsHasTwoParts) {
    PathVolumeHeader plain = header();
    plain.channels = 0;
    plain.compression = Compression::pxr24;
    write_exr<float>("a.exr", plain);
    Imf::MultiPartInputFile file((folder_ / "a.exr").c_str());
    EXPECT_EQ(file.parts(), 2);
    EXPECT_EQ(channel_of(folder_ / "a.exr", "position", "R")[1], float(sample_value(0, 1, 0, 2)))
        << "positions are exact whatever the compression";
    plain.pixel = PixelType::half;
    plain.compression = Compression::zip;
    write_exr<float>("b.exr", plain);
    EXPECT_EQ(channel_of(folder_ / "b.exr", "position", "R")[1], float(sample_value(0, 1, 0, 2)));
    EXPECT_NE(channel_of(folder_ / "b.exr", "force", "R")[1], float(sample_value(0, 1, 0, 1)));
}

TEST_F(PathFiles, ExrSaysWhereInAPartOfAPathAValueStands) {
    PathVolumeHeader one = header();
    one.paths = 1;
    one.channels = 0;
    PathVolumeWriter writer(folder_ / "a.exr", one);
    const std::vector<layout::uint> steps{5};
    for (const std::size_t step : {0, 3}) {
        std::vector<float> force(9, 1.f), position = force;
        if (step == 3)
            force[4] = 7;
        writer.write(PathRows<float>{0, 1, step == 0 ? 3u : 2u, steps, position, force, {}, {}, {}, step});
    }
    const VolumeResult result = writer.finish();
    EXPECT_EQ(result.largest_voxel[0], 4u);
    EXPECT_EQ(result.largest_voxel[1], 0u);
}

TEST_F(PathFiles, ExrRefusesWhatIsNotFinite) {
    PathVolumeHeader one = header();
    one.paths = 1;
    one.steps = 3;
    one.channels = 0;
    std::vector<float> force(9, 1.f), position = force;
    force[4] = INFINITY;
    const std::vector<layout::uint> steps{3};
    const PathRows<float> rows{0, 1, 3, steps, position, force, {}, {}, {}};
    PathVolumeWriter writer(folder_ / "a.exr", one);
    writer.write(rows);
    EXPECT_TRUE(says(message_of<Error>([&] { writer.finish(); }), "force is inf at step 1 of path 0"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr"));
    PathVolumeHeader long_one = header();
    long_one.steps = std::uint64_t(1) << 31;
    EXPECT_TRUE(says(message_of<UsageError>([&] { PathVolumeWriter(folder_ / "a.exr", long_one); }), ".csv"));
}

TEST_F(PathFiles, CsvHoldsWhatWasFeltPathAfterPath) {
    for (const std::size_t most : {1, 4, 100}) {
        PathCsvWriter writer(folder_ / "a.csv", {[](std::uint64_t path) { return path; },
                                                 [](std::uint64_t, std::uint64_t step) { return double(step) / 100; }});
        write_paths<float>(writer, {2, 1}, 2, most, 1);
        EXPECT_EQ(read("a.csv"), "path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n"
                                 "0,0,2000,2000.25,2000.5,3000,3000.25,3000.5,1000,1000.25,1000.5,4000,-1\n"
                                 "0,0.01,2000.001,2000.251,2000.501,3000.001,3000.251,3000.501,1000.001,1000.251,"
                                 "1000.501,4000.001,0\n"
                                 "1,0,2001,2001.25,2001.5,3001,3001.25,3001.5,1001,1001.25,1001.5,4001,-1\n");
    }
}

TEST(ShortestNumbers, AreThoseOfTheLibrary) {
    std::mt19937_64 random(11);
    const auto expect_same = [](auto value) {
        std::array<char, 64> text{}, expected{};
        const std::string_view ours(text.data(), put_shortest(text.data(), value));
        ASSERT_EQ(ours, std::string_view(expected.data(), std::to_chars(expected.begin(), expected.end(), value).ptr));
    };
    for (int i = 0; i < 200000; ++i) {
        const std::uint64_t bits = random();
        const int power = int(random() % 28) - 12;
        const double size = std::ldexp(double(bits >> 11) * 0x1p-53, power), few = double(bits % 20001) - 10000;
        for (const double value : {std::bit_cast<double>(bits), size, -size, few, few * std::pow(10.0, power % 6)}) {
            expect_same(value);
            expect_same(float(value));
        }
        expect_same(std::bit_cast<float>(std::uint32_t(bits)));
    }
}

// Numbers that come again are copied: of the row before, of the probe, of the path before.
TEST_F(PathFiles, CsvWritesNumbersThatComeAgainAsTheFirstTime) {
    constexpr std::size_t kPaths = 7, kSteps = 10001; // blocks end within paths; more than are formatted at once
    const std::vector<double> values{0,    -0.0,  1,        -1,        0.1,     1e-7,     123456.75, 5e-324, 1e-40,
                                     3e38, 1e300, 16777216, -0.000123, 1.0 / 3, 1e17 / 3, HUGE_VAL,  -NAN};
    const auto expect_same = [&]<typename T>(T) {
        std::mt19937 random(5);
        const auto value = [&] { return static_cast<T>(values[random() % values.size()]); };
        std::vector<T> position(3 * kPaths * kSteps), force(position.size()), proxy, depth(kPaths * kSteps);
        std::ranges::generate(position, value);
        proxy = position;
        for (std::vector<T>* channel : {&force, &proxy, &depth})
            for (std::size_t i = 0; i < channel->size(); ++i)
                if (random() % 3 == 0)
                    (*channel)[i] = value();
                else if (channel != &proxy && i > 0)
                    (*channel)[i] = (*channel)[i - 1];
        const std::vector<layout::uint> steps(kPaths, kSteps);
        std::vector<layout::uint> facet(kPaths * kSteps);
        std::ranges::generate(facet, [&] { return random() % 3 == 0 ? layout::kNoFacet : random() % 2; });
        std::string expected = "path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n";
        const auto add = [&](auto number) {
            std::array<char, 64> text{};
            expected.append(text.data(), std::to_chars(text.begin(), text.end(), number).ptr) += ',';
        };
        for (std::size_t i = 0; i < kPaths * kSteps; ++i) {
            add(i / kSteps + 3);
            add(double(i % kSteps) / 1000);
            for (const std::vector<T>* channel : {&position, &proxy, &force})
                for (std::size_t c = 0; c < 3; ++c)
                    add((*channel)[3 * i + c]);
            add(depth[i]);
            facet[i] == layout::kNoFacet ? add(-1) : add(facet[i]);
            expected.back() = '\n';
        }
        PathCsvWriter writer(folder_ / "a.csv",
                             {[](std::uint64_t path) { return path + 3; },
                              [](std::uint64_t, std::uint64_t step) { return double(step) / 1000; }});
        writer.write(PathRows<T>{0, kPaths, kSteps, steps, position, force, depth, facet, proxy});
        EXPECT_EQ(writer.finish().sha256, sha256_of(expected));
        EXPECT_TRUE(read("a.csv") == expected);
    };
    expect_same(float());
    expect_same(double());
}

TEST_F(PathFiles, NpyHasTheTimesOfAllPathsOrOfEach) {
    const auto values = [&](const char* name) {
        const std::string text = read(name);
        std::vector<double> found((text.size() - 128) / sizeof(double));
        std::memcpy(found.data(), text.data() + 128, found.size() * sizeof(double));
        return found;
    };
    const PathLabels labels{[](std::uint64_t path) { return path; },
                            [](std::uint64_t path, std::uint64_t step) { return double(path) + double(step) / 128; }};
    PathTimesWriter each(folder_ / "each.npy", kLengths.size(), kLongest, labels);
    write_paths<float>(each, kLengths, kLongest, 6, 3);
    EXPECT_TRUE(says(read("each.npy"), "'<f8', 'fortran_order': False, 'shape': (20, 7), }"));
    const std::vector<double> times = values("each.npy");
    ASSERT_EQ(times.size(), 20 * 7u);
    EXPECT_EQ(times[7 + 6], 1 + 6.0 / 128);
    EXPECT_TRUE(std::isnan(times[5])) << "behind the first path's end";
    PathTimesWriter all(folder_ / "all.npy", 0, kLongest, labels);
    write_paths<float>(all, {7, 7, 7}, kLongest, 1, 2);
    EXPECT_TRUE(says(read("all.npy"), "'shape': (7,), }"));
    EXPECT_EQ(values("all.npy"),
              (std::vector<double>{0, 1.0 / 128, 2.0 / 128, 3.0 / 128, 4.0 / 128, 5.0 / 128, 6.0 / 128}));
}

TEST_F(PathFiles, NpyIsShapedByPathAndStep) {
    PathNpyWriter force(folder_ / "force.npy", kLengths.size(), kLongest, layout::kChannelForce, Precision::f64);
    write_paths<double>(force, kLengths, kLongest, 6, 3);
    const std::string text = read("force.npy");
    EXPECT_TRUE(says(text, "'shape': (20, 7, 3), }")) << text.substr(0, 128);
    EXPECT_TRUE(says(text, "'<f8'"));
    ASSERT_EQ(text.size(), 128 + 20 * 7 * 3 * 8u);
    std::vector<double> values(20 * 7 * 3);
    std::memcpy(values.data(), text.data() + 128, values.size() * 8);
    EXPECT_EQ(values[3 * (7 + 6) + 2], sample_value(1, 6, 2, 1));
    EXPECT_TRUE(std::isnan(values[3 * 5])) << "behind the first path's end";
    PathNpyWriter facet(folder_ / "facet.npy", kLengths.size(), kLongest, layout::kChannelFacet, Precision::f64);
    write_paths<double>(facet, kLengths, kLongest, 6, 3);
    EXPECT_TRUE(says(read("facet.npy"), "'<u4', 'fortran_order': False, 'shape': (20, 7), }"));
    PathNpyWriter alone(folder_ / "alone.npy", kLengths.size(), kLongest, layout::kChannelForce, Precision::f64);
    write_paths<double>(alone, kLengths, kLongest, 1, 2);
    EXPECT_EQ(read("alone.npy"), text) << "path by path, in pieces";
}

// Recorded paths have numbers and times of their own.
PathLabels vtp_labels() {
    return {[](std::uint64_t path) { return 100 - path; },
            [](std::uint64_t path, std::uint64_t step) { return double(path) + double(step) / 128; }};
}

constexpr std::uint64_t kSamples = 102; // sum of kLengths

TEST_F(PathFiles, VtpIsAPolylineAPath) {
    PathVtpWriter writer(folder_ / "a.vtp", {kLengths.size(), kSamples, true, Precision::f32}, vtp_labels());
    const VolumeResult result = write_paths<float>(writer, kLengths, kLongest, 6, 3);
    const std::string text = read("a.vtp");
    EXPECT_EQ(result.bytes, text.size());
    EXPECT_TRUE(says(text, "<Piece NumberOfPoints=\"102\" NumberOfVerts=\"0\" NumberOfLines=\"20\" ",
                     "<PointData Vectors=\"force\" Scalars=\"depth\">", "<CellData Scalars=\"path\">", "<Lines>"));
    const auto force = vtk_numbers<float>(text, "force", 3), points = vtk_numbers<float>(text, "Points", 3),
               proxy = vtk_numbers<float>(text, "proxy", 3), depth = vtk_numbers<float>(text, "depth");
    const auto facet = vtk_numbers<std::int32_t>(text, "facet");
    const auto time = vtk_numbers<double>(text, "time");
    const auto ids = vtk_numbers<std::int64_t>(text, "path"), ends = vtk_numbers<std::int64_t>(text, "offsets"),
               order = vtk_numbers<std::int64_t>(text, "connectivity");
    ASSERT_EQ(points.size(), 3 * kSamples);
    ASSERT_EQ(ends.size(), kLengths.size());
    ASSERT_EQ(time.size(), kSamples);
    std::size_t at = 0;
    for (std::size_t path = 0; path < kLengths.size(); ++path) {
        EXPECT_EQ(ids[path], 100 - std::int64_t(path));
        for (std::size_t step = 0; step < kLengths[path]; ++step, ++at) {
            EXPECT_EQ(order[at], std::int64_t(at));
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(force[3 * at + c], float(sample_value(path, step, c, 1)));
                EXPECT_EQ(points[3 * at + c], float(sample_value(path, step, c, 2)));
                EXPECT_EQ(proxy[3 * at + c], float(sample_value(path, step, c, 3)));
            }
            EXPECT_EQ(depth[at], float(sample_value(path, step, 0, 4)));
            EXPECT_EQ(facet[at], step == 0 ? -1 : std::int32_t(path));
            EXPECT_EQ(time[at], double(path) + double(step) / 128);
        }
        EXPECT_EQ(ends[path], std::int64_t(at));
    }
}

TEST_F(PathFiles, VtpIsTheSameHoweverPathsArriveAndKeepsDoubles) {
    std::string first;
    for (const auto& [most, window] : {std::pair<std::size_t, std::size_t>{6, 3}, {1, 1}, {1, 2}, {100, 7}}) {
        PathVtpWriter writer(folder_ / "a.vtp", {kLengths.size(), kSamples, false, Precision::f64}, vtp_labels());
        write_paths<double>(writer, kLengths, kLongest, most, window);
        const std::string text = read("a.vtp");
        if (first.empty())
            first = text;
        EXPECT_TRUE(text == first) << most << ' ' << window;
    }
    EXPECT_EQ(vtk_numbers<double>(first, "force", 3)[5], sample_value(0, 1, 2, 1));
    EXPECT_FALSE(says(first, "proxy"));
}

} // namespace
} // namespace forceshade::testing

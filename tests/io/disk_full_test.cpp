// What happens when the disk takes no more; with a real full disk: tests/e2e/disk_test.cpp.
#include <csignal>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/raw_formats.h"
#include "tests/io/folder.h"
#include "tests/io/sample_field.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::sample_header;
using testing::SampleField;
using testing::says;

constexpr std::array<std::uint64_t, 3> kFieldSize{256, 32, 32};

/// While it lives no file can grow beyond `bytes`: writes fail with EFBIG.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit before_{};
    void (*handler_)(int);
};

/// White noise: nothing compresses it, so that the file's size is known about.
SampleField<float> noise() {
    SampleField field(kFieldSize);
    std::mt19937 random(3);
    for (float& value : field.force)
        value = static_cast<float>(random()) / 4294967296.0f;
    return field;
}

std::string write_all(ChunkSink& sink, const SampleField<float>& field) {
    return message_of<IoError>([&] {
        field.write_in_pieces(sink, 5);
        sink.finish();
    });
}

TEST(DiskFull, EndsInAnErrorAndNoFile) {
    const Folder folder;
    const SampleField field = noise();
    for (const int threads : {0, 2})
        for (const rlim_t bytes : {0, 100, 4096, 1 << 20, 2000000}) { // of about 2.7 MB
            const FileSizeLimit limit(bytes);
            VolumeHeader header = sample_header(kFieldSize, layout::kChannelForce | layout::kChannelDepth);
            header.threads = threads;
            {
                VolumeWriter writer(folder / "a.exr", header);
                EXPECT_TRUE(says(write_all(writer, field), "a.exr: File too large; the file system or a limit"));
            }
            EXPECT_TRUE(folder.names().empty());
        }
}

// The table of the blocks' offsets is written last, into the file's beginning.
TEST(DiskFull, AtAnyByteEndsInAnErrorAndNoFile) {
    const Folder folder;
    const std::array<std::uint64_t, 3> size{16, 4, 4};
    const SampleField field(size);
    VolumeWriter writer(folder / "sound.exr", sample_header(size));
    field.write_to(writer);
    const std::uint64_t bytes = writer.finish().bytes;
    for (rlim_t most = 0; most < bytes; most += 61) {
        const FileSizeLimit limit(most);
        {
            VolumeWriter cut(folder / "a.exr", sample_header(size));
            EXPECT_NE(write_all(cut, field), "") << most;
        }
        EXPECT_EQ(folder.names(), std::vector<std::string>{"sound.exr"}) << most;
    }
}

TEST(DiskFull, EndsInAnErrorForTheOtherFormats) {
    const Folder folder;
    const SampleField field = noise();
    const FileSizeLimit limit(1 << 20);
    {
        NpyWriter npy(folder / "a.npy", kFieldSize, layout::kChannelForce, Precision::f32);
        EXPECT_TRUE(says(write_all(npy, field), "a.npy: File too large"));
        VtiWriter vti(folder / "a.vti", {kFieldSize, {}, {1, 1, 1}, layout::kChannelForce, Precision::f32});
        EXPECT_TRUE(says(write_all(vti, field), "a.vti: File too large"));
        VtkFile vtp(folder / "a.vtp", "PolyData",
                    {{"small", "Float32", 1, 1}, {"large", "Float32", 1, field.force.size()}}, "");
        EXPECT_TRUE(says(message_of<IoError>([&] {
                             vtp.write("large", std::as_bytes(std::span(field.force)));
                             vtp.write("small", std::as_bytes(std::span(field.force).first(1)));
                             vtp.finish();
                         }),
                         "a.vtp.large: File too large"))
            << "an array that is compressed beside the file";
    }
    EXPECT_TRUE(folder.names().empty());
}

} // namespace
} // namespace forceshade

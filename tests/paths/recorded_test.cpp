// Recorded paths: read whole or piece by piece, they are the file's.
#include "host/paths/recorded.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "tests/io/folder.h"
#include "tests/paths/explored.h"

namespace forceshade {
namespace {

using testing::says;

class Recorded : public ::testing::Test {
protected:
    std::filesystem::path write(const std::string& text) const { return folder_.write("paths.csv", text); }
    std::string error(const std::string& text, const RecordedOptions& options) const {
        const std::string message =
            forceshade::testing::message_of<UsageError>([&] { RecordedFile(write(text), options); });
        return message.empty() ? "(no error)" : message.substr(message.find("paths.csv"));
    }

    forceshade::testing::Folder folder_;
};

const RecordedOptions kLoose{.largest_coordinate = 10};

// Path p has `3 + p % 5` samples; sample i stands at (p, i, -p i).
std::string rows(int path, int begin, int end) {
    std::string text;
    for (int i = begin; i < end; ++i)
        text += fmt::format("{},{},{},{},{}\n", 100 - path, 0.001 * i, 0.001 * path, 0.001 * i, -1e-6 * path * i);
    return text;
}
int samples_of(int path) {
    return 3 + path % 5;
}

std::string grouped(int paths) {
    std::string text = "path,t,x,y,z\n";
    for (int path = 0; path < paths; ++path)
        text += rows(path, 0, samples_of(path));
    return text;
}

void expect_rows(RecordedPaths<double>& recorded, std::size_t most, std::size_t window) {
    const std::size_t paths = recorded.file()->paths();
    for (std::size_t first = 0, count = 0; first < paths; first += count) {
        count = recorded.select(first, most);
        ASSERT_GE(count, 1u);
        for (std::size_t step = 0; step < recorded.file()->longest(); step += window) {
            const auto positions = recorded.positions(step, window + 1); // and one ahead
            for (std::size_t path = 0; path < count; ++path)
                for (std::size_t i = step; i < std::min<std::size_t>(step + window + 1, recorded.steps()[path]); ++i) {
                    const double* const at = &positions[3 * ((i - step) * count + path)];
                    EXPECT_DOUBLE_EQ(at[0], 0.001 * static_cast<double>(first + path));
                    EXPECT_DOUBLE_EQ(at[1], 0.001 * static_cast<double>(i));
                }
        }
    }
}

TEST_F(Recorded, WholeOrInPieces) {
    const auto path = write(grouped(40));
    for (const std::size_t kept : {0u, 1000u}) {
        const auto file = std::make_shared<const RecordedFile>(
            path, RecordedOptions{.largest_coordinate = 10, .period = 0.001, .most_kept = kept});
        EXPECT_EQ(file->kept().empty(), kept == 0);
        EXPECT_EQ(file->paths(), 40u);
        EXPECT_EQ(file->longest(), 7u);
        EXPECT_EQ(file->samples(), 200u);
        EXPECT_EQ(file->ids()[3], 97u);
        for (const std::size_t most : {1000u, 20u, 7u, 4u, 1u}) {
            RecordedPaths<double> recorded(file, most);
            for (const std::size_t window : {1u, 2u, 5u, 50u}) {
                expect_rows(recorded, 1000, window);
                expect_rows(recorded, 3, window); // and again from the beginning
            }
        }
    }
}

TEST_F(Recorded, PathsMayBeInterleavedInAShortFile) {
    std::string text = "path,t,x,y,z\n";
    for (int i = 0; i < 7; ++i)
        for (int path = 0; path < 40; ++path)
            text += rows(path, i, std::min(i + 1, samples_of(path)));
    const auto path = write(text);
    for (const std::size_t kept : {0u, 1000u}) {
        RecordedPaths<double> recorded(
            std::make_shared<const RecordedFile>(path, RecordedOptions{.largest_coordinate = 10, .most_kept = kept}));
        expect_rows(recorded, 1000, 3);
    }
    EXPECT_EQ(error(text, {.largest_coordinate = 10, .most_interleaved = 50}),
              "paths.csv:42:1: a path goes on here after samples of another; in a file of more than 50 samples each "
              "path's stand together: sort it by path");
}

TEST_F(Recorded, AFileThatChangesIsNoLongerRead) {
    const std::string text = grouped(40);
    const auto refusal = [&](const std::string& later, std::size_t kept, bool touch = true) {
        const auto path = write(text);
        const auto file =
            std::make_shared<const RecordedFile>(path, RecordedOptions{.largest_coordinate = 10, .most_kept = kept});
        RecordedPaths<double> recorded(file, 20);
        recorded.select(0, 100);
        recorded.positions(0, 10); // the reader stands within the file
        const auto written = std::filesystem::last_write_time(path);
        write(later);
        std::filesystem::last_write_time(path, touch ? written + std::chrono::seconds(1) : written);
        return forceshade::testing::message_of<IoError>([&] {
            for (std::size_t first = 0, count = 0; first < file->paths(); first += count) {
                count = recorded.select(first, 100);
                recorded.positions(0, 10);
            }
            file->require_unchanged();
        });
    };
    std::string renumbered = text, other = text;
    renumbered.replace(renumbered.rfind("\n61,") + 1, 2, "97");
    other.replace(other.rfind("0.001"), 5, "0.002");
    for (const std::size_t kept : {0u, 1000u}) {
        for (const std::string& later : {text.substr(0, text.size() / 2), text.substr(0, 14), renumbered, other})
            EXPECT_TRUE(says(refusal(later, kept), "paths.csv was changed while it was read")) << later.size();
        EXPECT_EQ(refusal(text, kept, false), "");
    }
}

TEST_F(Recorded, TimesIncreaseAndKeepToTheRate) {
    const std::string head = "path,t,x,y,z\n1,0,0,0,0\n1,0.001,0,0,0\n";
    EXPECT_EQ(error(head + "1,0.001,0,0,0\n", kLoose),
              "paths.csv:4:1: t: 0.001 s comes after 0.001 s on path 1: times of a path must increase");
    EXPECT_EQ(error(head + "2,5,0,0,0\n1,0,0,0,0\n", kLoose),
              "paths.csv:5:1: t: 0 s comes after 0.001 s on path 1: times of a path must increase");
    EXPECT_EQ(error(head + "1,0.003,0,0,0\n", kLoose), "(no error)");
    EXPECT_EQ(error(head + "1,0.003,0,0,0\n", {.largest_coordinate = 10, .period = 0.001}),
              "paths.csv:4:1: t: 0.003 s is 0.002 s after the sample before it on path 1; a hand moves the probe in "
              "steps of 0.001 s (paths.rate): give that rate, or resample");
    EXPECT_EQ(error("path,t,x,y,z\n1,0,0,0,nan\n", kLoose).substr(0, 16), "paths.csv:2:9: z");
}

TEST_F(Recorded, TheProbeGoesWhereTheFileSays) {
    const auto file = write(grouped(40));
    for (const char* surface : {"kind = \"bump\"\n", "kind = \"mesh\"\nfile = \"cube.obj\"\n"}) {
        folder_.write("cube.obj", kCubeObj);
        const auto prepared = prepared_scene(
            fmt::format("[surface]\n{}[paths]\nkind = \"recorded\"\nfile = \"paths.csv\"\n", surface), folder_.path());
        ScenePaths<double> source(prepared);
        const auto result = explored(source, {.threads = 2, .chunk_bytes = 2000});
        EXPECT_EQ(result.paths, 40u);
        for (std::size_t path = 0; path < 40; ++path)
            for (int i = 0; i < samples_of(static_cast<int>(path)); ++i) {
                const auto step = static_cast<std::size_t>(i);
                EXPECT_DOUBLE_EQ(result.place(step, path).x, 0.001 * static_cast<double>(path));
                EXPECT_NEAR(result.force[step * 40 + path].z, 1e-3 * static_cast<double>(path) * i, 1e-8);
            }
    }
}

TEST_F(Recorded, TheFileIsTheOneThatTheSceneMeans) {
    write(grouped(3));
    const std::string scene = "[paths]\nkind = \"recorded\"\nfile = \"paths.csv\"\n";
    PreparedCase prepared = prepared_scene(scene, folder_.path());
    add_recorded_digest(prepared);
    EXPECT_EQ(prepared.one.scene.paths->sha256.size(), 64u);
    EXPECT_TRUE(says(prepared.scene, "sha256 = \"" + prepared.one.scene.paths->sha256));
    PreparedCase again = prepared_scene(prepared.scene, folder_.path());
    add_recorded_digest(again);
    EXPECT_EQ(again.one.scene, prepared.one.scene);
    PreparedCase other = prepared_scene(scene + "sha256 = \"" + std::string(64, '0') + "\"\n", folder_.path());
    EXPECT_THROW(add_recorded_digest(other), UsageError);
}

} // namespace
} // namespace forceshade

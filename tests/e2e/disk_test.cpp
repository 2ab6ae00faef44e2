// Folders that cannot be written and disks that take no more: an error that says so, whole files only, and a sweep that
// goes on once there is room.
#include "tests/e2e/folder_watch.h"
#include "tests/e2e/small_disk.h"

namespace forceshade::testing {
namespace {

// Takes about 1.6 MB in its folder.
const char* const kFullDiskGrid = "size = [48, 8, 32]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\n"
                                  "spacing = [\"0.6 mm\", \"0.25 mm\", \"0.15 mm\"]\n";

class Disk : public Workplace {
protected:
    Disk() {
        write("paper.toml", small_study(kFullDiskGrid));
        write("scene.toml", kOneCase);
    }
    static std::vector<std::string> sweep(const std::string& out) {
        return {"sweep", "paper.toml", "--out", out, "--also", "npy", "--quiet"};
    }
    Tree whole() const {
        expect_success(sweep("whole"));
        return results_in(path("whole"));
    }
    void expect_only_whole_files(const std::string& out, const Tree& expected) const {
        FolderWatch watch(path(out), expected);
        watch.look();
        EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
    }
};

TEST_F(Disk, ThatIsFullIsAnIoErrorAndTheSweepGoesOnOnceThereIsRoom) {
    const SmallDisk disk(path("disk"), "size=256k");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted here";
    const std::vector<std::string> volumes{"sweep", "paper.toml", "--out", "disk/out", "--quiet"};
    expect_success({"sweep", "paper.toml", "--out", "whole", "--quiet"});
    const Tree expected = results_in(path("whole"));
    for (const char* size : {"size=64k", "size=128k", "size=256k"}) {
        ASSERT_TRUE(disk.change(0, size));
        expect_failure(4, volumes, {"No space left on device; free space there", "disk/out"});
        expect_only_whole_files("disk/out", expected);
    }
    ASSERT_TRUE(disk.change(0, "size=64m"));
    expect_success(volumes);
    EXPECT_EQ(differences(results_in(path("disk/out")), expected), std::set<std::string>{});
}

TEST_F(Disk, ThatIsTooSmallIsToldBeforeAnythingIsComputed) {
    const SmallDisk disk(path("disk"), "size=256k");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted here";
    expect_refused(sweep("disk/out"), {"even at the best compression the files take 7.53 MB", "262 kB"}, 4);
}

TEST_F(Disk, ThatIsFullKeepsAnEarlierField) {
    const SmallDisk disk(path("disk"), "size=64k");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted here";
    expect_success({"field", "scene.toml", "--out", "disk/field.exr"});
    write("large.toml", "[grid]\nsize = [64, 64, 64]\n[output]\ncompression = \"none\"\n");
    expect_refused({"field", "large.toml", "--out", "disk/field.exr"},
                   {"even at the best compression the files take 3.15 MB", "are free"}, 4);
    // What may fit is tried.
    write("zip.toml", "[grid]\nsize = [64, 64, 64]\n[output]\ncompression = \"zip\"\n[texture]\n"
                      "stiffness = \"0.1 N/mm\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n");
    expect_refused({"field", "zip.toml", "--out", "disk/field.exr"},
                   {"warning: the files will probably take", "No space left on device", "field.exr"}, 4);
}

TEST_F(Disk, WithALimitOnFileSizesIsAnIoErrorToo) {
    const Tree expected = whole();
    for (const std::uint64_t most : {0, 1000, 8192, 40000}) {
        Launch launch = this->launch(sweep("out"));
        launch.most_file_bytes = most;
        // Also stderr is a file here, and cannot be written where nothing can.
        expect_failure(4, launch, most > 0 ? std::vector<std::string>{"File too large"} : std::vector<std::string>{});
        expect_only_whole_files("out", expected);
    }
    expect_success(sweep("out"));
    EXPECT_EQ(differences(results_in(path("out")), expected), std::set<std::string>{});
}

TEST_F(Disk, ThatIsReadOnlyIsAnIoError) {
    const SmallDisk disk(path("disk"), "size=16m");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted here";
    std::filesystem::create_directory(path("disk/old"));
    ASSERT_TRUE(disk.change(MS_RDONLY, "size=16m"));
    expect_failure(4, sweep("disk/out"), {"disk/out", "Read-only file system"});
    expect_failure(4, sweep("disk/old"), {"disk/old", "Read-only file system"});
    expect_failure(4, {"field", "scene.toml", "--out", "disk/field.exr"},
                   {"field.exr: Read-only file system; choose a folder"});
}

TEST_F(Disk, FoldersOfOthersAreAnIoError) {
    Launch out = launch({"sweep", "paper.toml", "--out", "out", "--quiet"});
    Launch field = launch({"field", "scene.toml", "--out", "field.exr", "--quiet"});
    if (is_root())
        out.user = field.user = kNobody;
    else
        std::filesystem::permissions(folder_.path(), std::filesystem::perms(0555));
    expect_failure(4, out, {"out", "Permission denied"});
    expect_failure(4, field, {"field.exr", "Permission denied"});
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
}

TEST_F(Disk, PlacesThatAreNoFolderAreAnIoError) {
    write("file", "kept");
    expect_failure(4, sweep("file"), {"file", "Not a directory"});
    expect_failure(4, sweep("file/below"), {"file/below", "Not a directory"});
    expect_failure(4, {"field", "scene.toml", "--out", "file/field.exr"}, {"file/field.exr", "Not a directory"});
    expect_failure(4, {"field", "scene.toml", "--out", "no/such/field.exr"}, {"no/such/field.exr", "No such file"});
    std::filesystem::create_directory(path("folder.exr"));
    expect_failure(4, {"field", "scene.toml", "--out", "folder.exr"}, {"folder.exr", "directory"});
    EXPECT_EQ(read_text(path("file")), "kept");
    // A volume's name that is taken by a folder.
    std::filesystem::create_directories(path("out/bump_radius-600mil_facets-2_shading-none.exr"));
    expect_failure(4, sweep("out"), {"bump_radius-600mil_facets-2_shading-none.exr", "directory"});
    std::filesystem::remove(path("out/bump_radius-600mil_facets-2_shading-none.exr"));
    expect_success(sweep("out"));
}

TEST_F(Disk, KernelsKeptFromBeforeMayBeDamagedOrUnwritable) {
    Launch launch = this->launch({"field", "scene.toml", "--out", "field.exr", "--engine", "gpu"});
    const std::filesystem::path cache = path("cache");
    launch.environment["XDG_CACHE_HOME"] = cache.string();
    EXPECT_EQ(run(launch).code, 0);
    const Tree kept = tree_of(cache / "forceshade"); // the driver keeps its own beside it
    ASSERT_EQ(kept.size(), 1u);
    const std::string field = read_text(path("field.exr"));
    const std::filesystem::path file = cache / "forceshade" / kept.begin()->first;
    const std::string& sound = kept.begin()->second;
    for (const std::string& damaged : {std::string(), std::string("x"), sound.substr(0, sound.size() / 2),
                                       sound.substr(0, 64) + std::string(1000, '\xff'), "1" + sound}) {
        write_text(file, damaged);
        EXPECT_EQ(run(launch).code, 0);
        EXPECT_TRUE(read_text(path("field.exr")) == field);
    }
    EXPECT_TRUE(read_text(file).size() > 64) << "a damaged one is replaced";
    std::filesystem::remove_all(cache);
    write("cache", "a file where the folder should be");
    EXPECT_EQ(run(launch).code, 0);
    launch.environment.erase("XDG_CACHE_HOME");
    launch.environment["HOME"] = "/proc/nowhere";
    EXPECT_EQ(run(launch).code, 0);
}

} // namespace
} // namespace forceshade::testing

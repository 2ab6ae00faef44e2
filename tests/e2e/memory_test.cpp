// Peak memory: bounded for large fields, and independent of the number of cases.
#include <functional>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/e2e/workplace.h"
#include "tests/io/picture.h"

namespace forceshade::testing {
namespace {

class Memory : public Workplace {
protected:
    // Peak of a field of 512^3 voxels, 1.6 GB of force.
    std::uint64_t peak_of_large_field(const std::string& scene) const {
        write("scene.toml", scene + "[grid]\nsize = [512, 512, 512]\norigin = [\"-25 mm\", \"-25 mm\", \"-10 mm\"]\n"
                                    "spacing = \"0.1 mm\"\n");
        const Outcome outcome =
            expect_success({"field", "scene.toml", "--out", "field.exr", "--quiet", "--engine", "gpu"});
        EXPECT_GT(std::filesystem::file_size(path("field.exr")), kMebibyte);
        std::filesystem::remove(path("field.exr"));
        return outcome.peak_memory;
    }
    // 25 MB a case: what may wait between kernels and encoders (128 MB) is full after the fifth.
    std::uint64_t peak_of_sweep(int cases) const {
        const std::string out = fmt::format("out{}", cases);
        std::string facets = "1";
        for (int i = 2; i <= cases; ++i)
            facets += fmt::format(", {}", i);
        write(
            "study.toml",
            fmt::format(
                "[surface]\nfacets = [{}]\n[output]\ncompression = \"zip1\"\n[grid]\nsize = [256, 64, 128]\n[texture]\n"
                "stiffness = \"0.1 N/mm\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\n",
                facets));
        const Outcome outcome = expect_success({"sweep", "study.toml", "--out", out, "--quiet"});
        std::filesystem::remove_all(path(out));
        return outcome.peak_memory;
    }
};

TEST_F(Memory, OfALargeFieldIsBelow2Gib) {
    for (const char* scene : {"[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n",
                              "[texture]\nstiffness = \"0.1 N/mm\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\n"
                              "[output]\ncompression = \"none\"\n"}) // depends on y
        EXPECT_LT(peak_of_large_field(scene), 2048 * kMebibyte) << scene;
}

TEST_F(Memory, DoesNotGrowWithTheNumberOfCases) {
    const std::uint64_t few = peak_of_sweep(8), many = peak_of_sweep(24);
    EXPECT_LT(double(many), 1.15 * double(few) + 8 * kMebibyte)
        << few / kMebibyte << " MiB for 8 cases, " << many / kMebibyte << " MiB for 24";
}

TEST_F(Memory, DoesNotGrowWithTheNumberOfHeightMaps) {
    constexpr int kSide = 1000; // 8 MB in double precision
    const auto peak = [&](int maps) {
        std::string files;
        for (int i = 0; i < maps; ++i) {
            const std::string name = fmt::format("{}.png", i);
            if (!std::filesystem::exists(path(name)))
                write_png(path(name), kSide,
                          std::vector(kSide, std::vector<png_byte>(kSide, static_cast<png_byte>(i))));
            files += fmt::format("{}\"{}\"", i ? ", " : "", name);
        }
        write("maps.toml", fmt::format("[surface]\nkind = \"height_map\"\nfile = [{}]\nsize = [\"8 mm\", \"6 mm\"]\n"
                                       "[force]\nshading = \"height_map\"\n[grid]\nsize = [8, 8, 8]\n",
                                       files));
        return expect_success({"sweep", "maps.toml", "--out", fmt::format("maps{}", maps), "--quiet"}).peak_memory;
    };
    // How many wait between kernels and encoders is a matter of load: at most eight more than in the other run.
    const std::uint64_t few = peak(14), many = peak(42);
    EXPECT_LT(double(many), double(few) + 8 * 8 * kMebibyte)
        << few / kMebibyte << " MiB for 14 maps, " << many / kMebibyte << " MiB for 42";
}

// A path of ten times the steps takes no more memory, where no row of an image needs them all.
TEST_F(Memory, DoesNotGrowWithTheStepsOfAPath) {
    constexpr int kFew = 70000, kMany = 700000;
    for (const int steps : {kFew, kMany}) {
        const std::string name = std::to_string(steps), scene = "[surface]\nfacets = 3\n[paths]\n";
        fmt::memory_buffer rows;
        fmt::format_to(std::back_inserter(rows), "path,t,x,y,z\n");
        for (int i = 0; i < steps; ++i)
            fmt::format_to(std::back_inserter(rows), "0,{},{}e-5,0,0.003\n", i, i % 4000 - 2000);
        write(name + ".csv", fmt::to_string(rows));
        write(name + ".made.toml", scene + "count = 1\nsteps = " + name + "\n");
        write(name + ".recorded.toml", scene + "kind = \"recorded\"\nfile = \"" + name + ".csv\"\n");
    }
    const auto expect_flat = [&](const std::function<std::vector<std::string>(const std::string&)>& arguments) {
        const std::uint64_t few = expect_success(arguments(std::to_string(kFew))).peak_memory;
        const std::uint64_t many = expect_success(arguments(std::to_string(kMany))).peak_memory;
        EXPECT_LT(many, few + 12 * kMebibyte) << fmt::format("{}", fmt::join(arguments("*"), " ")) << ": "
                                              << few / kMebibyte << " MiB, then " << many / kMebibyte;
    };
    for (const std::string kind : {"made", "recorded"}) {
        for (const std::string engine : {"cpu", "gpu"})
            for (const std::vector<std::string>& way :
                 {std::vector<std::string>{"--metrics-only"}, {"--also", "npy"}, {}})
                expect_flat([&](const std::string& steps) {
                    return with(
                        {"explore", steps + "." + kind + ".toml", "--out", "out.csv", "--quiet", "--engine", engine},
                        way);
                });
        expect_flat([&](const std::string& steps) {
            return std::vector<std::string>{"validate", steps + "." + kind + ".toml", "--quiet"};
        });
    }
}

} // namespace
} // namespace forceshade::testing

// A device that is lost in the middle of a sweep, and the report of a machine's devices.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Gpu : public Workplace {
protected:
    Gpu() { write("three.toml", kThreeCases); }

    Outcome with_limits(const std::string& limits, const std::vector<std::string>& arguments) const {
        Launch launch = this->launch(arguments);
        launch.environment["FORCESHADE_DEVICE_LIMITS"] = limits;
        return run(launch);
    }
};

// What was done before stays whole, nothing is half there, and the next run goes on.
TEST_F(Gpu, ALostDeviceEndsASweepThatTheNextRunContinues) {
    const std::vector<std::string> sweep{"sweep", "three.toml", "--out",   "out",
                                         "--gpu", "llvmpipe",   "--quiet", "--json"};
    const Outcome lost = with_limits("lost-at=12", sweep);
    EXPECT_NE(lost.code, 0);
    EXPECT_TRUE(says(lost.error, "the device was lost"));
    EXPECT_EQ(temporaries_in(path("out")), std::vector<std::string>{});
    const json said = json_of(sweep);
    EXPECT_EQ(said["computed"].get<int>() + said["kept"].get<int>(), 3);
    EXPECT_EQ(said["voxels_differing_from_oracle"], 0);
    EXPECT_GT(said["computed"], 0);
}

TEST_F(Gpu, RunsUnderTheValidationLayers) {
    write("one.toml", kOneCase);
    expect_success({"field", "one.toml", "--out", "a.exr", "--gpu", "llvmpipe", "--vulkan-validation"});
    expect_success({"field", "one.toml", "--out", "b.exr", "--gpu", "llvmpipe"});
    EXPECT_EQ(read_text(path("a.exr")), read_text(path("b.exr")));
}

TEST_F(Gpu, LimitsAreReadOrRefused) {
    const Outcome wrong = with_limits("no-f16", {"gpus"});
    EXPECT_NE(wrong.code, 0);
    EXPECT_TRUE(says(wrong.error, "\"no-f16\" is none of no-f64"));
    EXPECT_TRUE(says(with_limits("no-f64", {"gpus"}).out, "no double precision"));
}

// Forces of 1e-39 N: most GPUs make them 0, which is within the bounds that hardware has for the oracle's bits.
TEST_F(Gpu, FlushedDenormalsAreWithinTheBounds) {
#if !defined(__SSE2__)
    GTEST_SKIP() << "the software device flushes on x86 alone";
#endif
    write("small.toml", "[surface]\nkind = \"bump\"\n[force]\nstiffness = \"1e-20 N/m\"\n"
                        "[grid]\norigin = [\"-20 mm\", \"-1e-22 mm\", \"-8e-16 mm\"]\n"
                        "spacing = [\"0.5 mm\", \"1e-22 mm\", \"1e-17 mm\"]\nsize = [81, 4, 100]\n");
    const std::vector<std::string> arguments{"validate", "small.toml", "--gpu", "llvmpipe", "--precision", "f32"};
    EXPECT_TRUE(says(expect_success(arguments).out, "32400 voxels, 0 differ"));
    const Outcome flushed = with_limits("flush", arguments);
    EXPECT_EQ(flushed.code, 0) << flushed.error;
    EXPECT_TRUE(says(flushed.out, "32400 voxels, 25920 differ"));
}

TEST_F(Gpu, AReportOfItIsAFolder) {
    const std::vector<std::string> arguments{"doctor",   "--gpu-report", "gpu", "--gpu",
                                             "llvmpipe", "--precision",  "f32", "--quiet"};
    expect_success(arguments);
    const json report = read_json("gpu/report.json");
    const json& device = report["devices"].at(0);
    EXPECT_GT(device["store_bytes_per_s"], 1e8);
    EXPECT_GT(device["copy_bytes_per_s"], 1e8);
    EXPECT_GT(device["read_back_bytes_per_s"], 1e8);
    EXPECT_EQ(device["rows"].size(), 14u);
    for (const json& row : device["rows"]) {
        EXPECT_EQ(row["passed"], true) << row;
        EXPECT_EQ(row["differing"], 0) << row;
        EXPECT_GT(row["compared"], 10000) << row;
        EXPECT_GT(row["kernel_s"], 0) << row;
        EXPECT_LE(row["kernel_s"], row["seconds"]) << row;
        EXPECT_GT(row["cpu_samples_per_s"], 0) << row;
        EXPECT_GE(row["group_invocations"], 32) << row;
    }
    EXPECT_TRUE(says(read_text(path("gpu/report.md")), "| shaded mesh | f32 |"));
    expect_failure(2, arguments, {"gpu", "is there already"});
}

} // namespace
} // namespace forceshade::testing

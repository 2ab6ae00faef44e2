// An engine that errs is caught, wherever it errs and however little; one that does not, is not.
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/cases/case_pipeline.h"
#include "host/cases/path_comparison.h"
#include "host/error.h"
#include "tests/io/folder.h"

namespace forceshade::testing {
namespace {

// The CPU engine, and what is done to its chunks and metrics on their way.
class Tampering final : public Engine {
public:
    std::function<void(layout::PathChunk<float>& chunk, std::vector<float>& force, std::vector<float>& position)>
        chunks;
    std::function<void(std::size_t first, std::vector<layout::PathMetrics<float>>& metrics)> metrics;
    bool software = true;

    EngineReport report() const override { return {"gpu", "tampered", "", "", software, true}; }
    EngineTimes run(const EngineWork& work) override {
        const auto& [input, take, take_metrics] = std::get<PathWork<float>>(work);
        EngineOptions options;
        options.cpu = true;
        options.chunk_bytes = 20000; // several windows a batch
        return make_engine(options)->explore(
            input,
            [&](const layout::PathChunk<float>& chunk) {
                layout::PathChunk<float> changed = chunk;
                std::vector<float> force(chunk.force.begin(), chunk.force.end()),
                    position(chunk.position.begin(), chunk.position.end());
                if (chunks)
                    chunks(changed, force, position);
                changed.force = force;
                changed.position = position;
                take(changed);
            },
            [&](std::size_t first, std::span<const layout::PathMetrics<float>> all) {
                std::vector<layout::PathMetrics<float>> changed(all.begin(), all.end());
                if (metrics)
                    metrics(first, changed);
                take_metrics(first, changed);
            });
    }
};

class PathRun : public ::testing::Test {
protected:
    PreparedCase prepared(const std::string& paths = "count = 50\nsteps = 200\ndepth = \"1 mm\"\n") const {
        return CasePreparation().prepare(
            parse_scene("[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[paths]\n" + paths, "scene"));
    }
    PathRecord run(Engine& engine, const PreparedCase& one) const {
        PathRunOptions options;
        options.samples = folder_ / "a.exr";
        options.stem = folder_ / "a";
        return run_paths(engine, one, options);
    }
    // Changes one force, x of (path, step), by a factor.
    static void change(Tampering& engine, std::size_t path, std::size_t step, float factor) {
        engine.chunks = [=](layout::PathChunk<float>& chunk, std::vector<float>& force, std::vector<float>&) {
            if (step >= chunk.step_first && step < chunk.step_first + chunk.step_count && path >= chunk.path_first &&
                path < chunk.path_first + chunk.path_count)
                for (std::size_t i = 0; i < 3; ++i)
                    force[3 * ((step - chunk.step_first) * chunk.pitch + path - chunk.path_first) + i] *= factor;
        };
    }
    // Of a recorded path.
    PathRunOptions recorded(bool samples) const {
        PathRunOptions options;
        options.stem = folder_ / "a";
        options.recorded = folder_ / "in.csv";
        if (samples)
            options.samples = folder_ / "a.csv";
        return options;
    }
    Folder folder_;
};

TEST_F(PathRun, OfATrueEngineAgreesWithTheOracle) {
    for (const bool software : {true, false})
        for (const char* paths : {"count = 50\nsteps = 200\n", "count = 7\nsteps = 300\npress = \"1 N\"\n",
                                  "kind = \"random_walk\"\ncount = 9\nsteps = 100\n", "count = 1\nsteps = 1\n"}) {
            Tampering engine;
            engine.software = software;
            const PathRecord record = run(engine, prepared(paths));
            EXPECT_EQ(record.error.differing, 0u) << paths;
            EXPECT_EQ(record.error.paths, record.paths);
            EXPECT_EQ(record.error.samples, record.samples);
            EXPECT_EQ(error_text(record, "a.exr", "device"), "");
        }
}

TEST_F(PathRun, CatchesASingleBit) {
    for (const std::size_t path : {0, 33, 49})
        for (const std::size_t step : {0, 71, 199}) {
            Tampering engine;
            change(engine, path, step, 1 + 0x1p-23f);
            const PathRecord record = run(engine, prepared());
            EXPECT_EQ(record.error.differing, 1u) << path << ' ' << step;
            EXPECT_EQ(record.error.beyond, 1u);
            EXPECT_TRUE(says(error_text(record, "a.exr", "device"),
                             "path " + std::to_string(path) + ", step " + std::to_string(step)));
        }
}

TEST_F(PathRun, AllowsHardwareItsRoundingsAndNoMore) {
    for (const char* paths : {"count = 50\nsteps = 200\n", "count = 50\nsteps = 200\npress = \"1 N\"\n"})
        for (const auto& [factor, beyond] : {std::pair{1 + 0x1p-22f, 0u}, {1.002f, 1u}, {0.f, 1u}}) {
            Tampering engine;
            engine.software = false;
            change(engine, 20, 100, factor);
            const PathRecord record = run(engine, prepared(paths));
            EXPECT_EQ(record.error.differing, 1u);
            EXPECT_EQ(record.error.beyond, beyond) << paths << factor;
        }
}

TEST_F(PathRun, AllowsHardwareAPlaceThatIsRoundedAndNoOther) {
    for (const char* paths : {"count = 50\nsteps = 200\ndepth = \"1 mm\"\n", "kind = \"minimum_jerk\"\nsteps = 200\n",
                              "kind = \"random_walk\"\nsteps = 200\nfollow = \"plane\"\n"})
        for (const auto& [off, beyond] : {std::pair{1e-9f, 0u}, {3e-5f, 1u}}) {
            Tampering engine;
            engine.software = false;
            engine.chunks = [off = off](layout::PathChunk<float>& chunk, std::vector<float>&,
                                        std::vector<float>& position) {
                if (chunk.path_first == 0 && 100 >= chunk.step_first && 100 < chunk.step_first + chunk.step_count)
                    position[3 * (100 - chunk.step_first) * chunk.pitch + 1] += off;
            };
            EXPECT_EQ(run(engine, prepared(paths)).error.beyond, beyond) << paths << off;
        }
}

TEST_F(PathRun, TakesHardwareThatLeftItsBoundForWhatItIs) {
    Tampering engine;
    engine.software = false;
    // So hard a wall that the loop is unstable.
    const PreparedCase one = CasePreparation().prepare(
        parse_scene("[surface]\nfacets = 3\n[force]\nstiffness = \"1e5 N/m\"\n[paths]\ncount = 5\nsteps = 3000\npress "
                    "= \"1 N\"\nbound = \"20 mm\"\n[hand]\nmax_force = \"1000 N\"\ndelay_samples = 1\n",
                    "scene"));
    PathRecord record = run(engine, one);
    EXPECT_GT(record.unstable, 0u);
    EXPECT_EQ(record.error.differing, 0u);
    // A device that feels nothing, but moves on, did not leave.
    engine.chunks = [](layout::PathChunk<float>&, std::vector<float>& force, std::vector<float>&) {
        std::fill(force.begin(), force.end(), 0.f);
    };
    record = run(engine, one);
    EXPECT_GT(record.error.beyond, record.error.differing / 2);
}

TEST_F(PathRun, CatchesPositionsAndMetrics) {
    Tampering engine;
    engine.chunks = [](layout::PathChunk<float>&, std::vector<float>&, std::vector<float>& position) {
        position[3] = std::nextafter(position[3], 1.f);
    };
    EXPECT_GE(run(engine, prepared()).error.beyond, 1u);
    Tampering other;
    other.metrics = [](std::size_t, std::vector<layout::PathMetrics<float>>& metrics) { ++metrics[3].rounds; };
    const PathRecord record = run(other, prepared());
    EXPECT_EQ(record.error.metrics, 1u);
    EXPECT_EQ(record.error.beyond, 0u);
    EXPECT_TRUE(says(error_text(record, "a.exr", "device"), "path 3: its metrics"));
}

TEST_F(PathRun, OfMetricsAloneIsHeldAgainstTheOracleToo) {
    PathRunOptions options;
    options.stem = folder_ / "a";
    Tampering engine;
    const PreparedCase one = prepared();
    EXPECT_EQ(error_text(run_paths(engine, one, options), "a", ""), "");
    engine.metrics = [](std::size_t first, std::vector<layout::PathMetrics<float>>& metrics) {
        metrics[40 - first].work = std::nextafter(metrics[40 - first].work, 1.f);
    };
    EXPECT_EQ(run_paths(engine, one, options).error.metrics, 1u);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.paths.csv"});
}

TEST_F(PathRun, RefusesForcesThatAreNoNumbersAndLeavesNothing) {
    Tampering engine;
    change(engine, 4, 5, NAN);
    const PreparedCase one = prepared();
    EXPECT_TRUE(says(message_of<Error>([&] { run(engine, one); }), "path 4 at step 5"));
    EXPECT_EQ(folder_.names(), std::vector<std::string>{});
}

TEST_F(PathRun, ComparesEvenlyChosenPathsOfMany) {
    Tampering engine;
    const PathRecord record =
        run(engine, prepared("count = 3000\nsteps = 1000\nspeed = { mean = \"100 mm/s\", sd = \"10 mm/s\" }\n"));
    EXPECT_EQ(record.error.paths, 1000u);
    EXPECT_EQ(record.error.samples, 1000000u);
    EXPECT_EQ(record.error.differing, 0u);
}

TEST_F(PathRun, OfRecordedPathsTakesHardlyMoreStepsThanTheyHave) {
    std::string rows = "path,t,x,y,z\n";
    std::uint64_t samples = 0;
    for (int path = 0; path < 500; ++path)
        for (int i = 0; i < (path == 250 ? 100000 : 2); ++i, ++samples)
            rows += fmt::format("{},{},0,0,0.003\n", path, i);
    folder_.write("in.csv", rows);
    for (const bool metrics_only : {false, true}) {
        Tampering engine;
        PathRunOptions options = recorded(!metrics_only);
        std::uint64_t taken = 0;
        engine.chunks = [&](layout::PathChunk<float>& chunk, std::vector<float>&, std::vector<float>&) {
            taken += chunk.path_count * chunk.step_count;
        };
        std::uint64_t last = 0;
        options.progress = [&](std::uint64_t done, std::uint64_t total) {
            EXPECT_GE(done, last);
            EXPECT_EQ(total, samples);
            last = done;
        };
        EXPECT_EQ(run_paths(engine, prepared(), options).samples, samples);
        EXPECT_LT(taken, 5 * samples) << "of 500 paths as long as the longest";
        EXPECT_EQ(last, samples);
    }
}

// Only where there is contact comes with the metrics, window after window.
TEST_F(PathRun, OfMetricsOfALongRecordedPathOnHardware) {
    constexpr int kSteps = 5000;
    std::string rows = "path,t,x,y,z\n";
    for (int i = 0; i < kSteps; ++i)
        rows += fmt::format("0,{},0,0,{}\n", i, i % 2 ? 0.003 : -0.001);
    folder_.write("in.csv", rows);
    Tampering engine;
    engine.software = false;
    std::size_t windows = 0;
    engine.chunks = [&](layout::PathChunk<float>&, std::vector<float>&, std::vector<float>&) { ++windows; };
    const PathRecord record = run_paths(engine, prepared(), recorded(false));
    EXPECT_GT(windows, 1u);
    EXPECT_EQ(record.error.samples, std::uint64_t(kSteps));
    EXPECT_EQ(error_text(record, "a", "device"), "");
}

TEST_F(PathRun, OfAFileThatChangesMeanwhileWritesNothing) {
    const auto write = [&](int rows) {
        std::string text = "path,t,x,y,z\n";
        for (int i = 0; i < rows; ++i)
            text += fmt::format("0,{},0,0,0.003\n", i);
        folder_.write("in.csv", text);
    };
    for (const int later : {150000, 1000, 0}) {
        write(200000);
        Tampering engine;
        engine.chunks = [&](layout::PathChunk<float>& chunk, std::vector<float>&, std::vector<float>&) {
            if (chunk.step_first == 0)
                write(later);
        };
        const PreparedCase one = prepared();
        EXPECT_TRUE(says(message_of<IoError>([&] { run_paths(engine, one, recorded(true)); }),
                         "in.csv was changed while it was read; no file was written"));
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"in.csv"});
    }
}

TEST_F(PathRun, ValidationCoversEveryPath) {
    Tampering engine;
    change(engine, 49, 199, 1 + 0x1p-23f);
    const PathComparison comparison = compare_paths(engine, prepared(), Precision::f32);
    EXPECT_FALSE(comparison.passed);
    EXPECT_EQ(comparison.error.samples, 10000u);
    EXPECT_EQ(comparison.error.differing, 1u);
    EXPECT_TRUE(says(path_comparison_table({comparison}), "FAILED: path 49, step 199"));
    EXPECT_EQ(totals_of(std::vector{comparison}).differing, 1u);
}

} // namespace
} // namespace forceshade::testing

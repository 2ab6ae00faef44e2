// Cases on their way from engine to encoders: whatever fails, nothing waits for ever and nothing is lost.
#include <future>

#include <gtest/gtest.h>

#include "host/cases/case_pipeline.h"
#include "host/cases/chunk_queue.h"
#include "host/program.h"
#include "host/sweep/sweep.h"
#include "tests/io/folder.h"

namespace forceshade::test {
namespace {

constexpr std::size_t kSide = 8; // samples along each axis of the chunks below

// Hands over `chunks` chunks of one layer each, whatever is asked for.
class LayerEngine final : public Engine {
public:
    EngineReport report() const override { return {"cpu", "layers", "", "", true, true}; }
    EngineTimes run(const EngineWork& work) override {
        const auto& [input, take] = std::get<FieldWork<float>>(work);
        const std::vector<float> force(3 * input.x.size() * input.y.size(), 1.0f);
        for (std::size_t z = 0; z < input.z.size(); ++z) {
            layout::FieldChunk<float> chunk{};
            chunk.x_count = chunk.x_pitch = input.x.size();
            chunk.y_count = input.y.size();
            chunk.z_first = z;
            chunk.z_count = 1;
            chunk.force = force;
            take(chunk);
        }
        return {};
    }
};

Study study_of(int cases, const std::string& surface) {
    std::string radii;
    for (int i = 0; i < cases; ++i)
        radii += (i ? ", \"" : "\"") + std::to_string(600 + i) + " mil\"";
    return parse_study(surface + "radius = [" + radii + "]\n[grid]\nsize = [8, 8, 64]\n", "test");
}

struct Ran {
    int done = 0, failed = 0;
    bool stopped = false;
};

// Runs the study into `folder` with room for a few chunks only, or gives up after a minute.
Ran run(const Study& study, const std::filesystem::path& folder) {
    const auto work = [&] {
        Ran ran;
        LayerEngine engine;
        CasePreparation preparation;
        std::size_t next = 0;
        PipelineOptions options;
        options.encoders = 2;
        options.waiting_bytes = 5 * 3 * kSide * kSide * sizeof(float);
        try {
            run_cases(
                engine,
                [&] {
                    if (next == study.cases.size())
                        return std::unique_ptr<CaseJob>();
                    const Case& one = study.cases[next++];
                    return std::make_unique<CaseJob>(
                        CaseJob{preparation.prepare(one), folder / (one.name + ".exr"), {}, {}});
                },
                study.cases.size(), options,
                [&](const CaseOutcome& outcome) { ++(outcome.error ? ran.failed : ran.done); });
        } catch (const Error&) {
            ran.stopped = true;
        }
        return ran;
    };
    std::packaged_task<Ran()> task(work);
    std::future<Ran> result = task.get_future();
    std::thread thread(std::move(task));
    if (result.wait_for(std::chrono::minutes(1)) != std::future_status::ready) {
        ADD_FAILURE() << "the pipeline waits for ever";
        std::abort(); // its threads cannot be ended
    }
    thread.join();
    return result.get();
}

class CasePipeline : public ::testing::Test {
protected:
    testing::Folder folder_;
};

TEST_F(CasePipeline, EveryCaseEnds) {
    const Ran ran = run(study_of(7, "[surface]\n"), folder_.path());
    EXPECT_EQ(ran.done, 7);
    EXPECT_FALSE(ran.stopped);
}

TEST_F(CasePipeline, AFolderThatCannotBeWrittenStopsTheRun) {
    const Ran ran = run(study_of(40, "[surface]\n"), folder_ / "missing");
    EXPECT_TRUE(ran.stopped);
    EXPECT_EQ(ran.done, 0);
}

// LayerEngine calls itself exact and is nothing like the oracle: what it leaves is not passed off as right, today or
// tomorrow.
TEST_F(CasePipeline, AFieldThatIsNotTheOraclesFailsTheSweep) {
    const Study study = study_of(2, "[surface]\n");
    SweepOptions options;
    options.folder = folder_ / "sweep";
    options.quiet = true;
    for (const std::size_t computed : {2u, 0u}) {
        const SweepResult result = run_sweep(
            study, [] { return std::make_unique<LayerEngine>(); }, true, options);
        EXPECT_EQ(result.computed, computed);
        EXPECT_EQ(result.failures.size(), 2u);
        EXPECT_EQ(result.exit_code, 1);
    }
}

// An encoder that throws while it holds a chunk must give the chunk's room back: many more chunks fail here than fit.
TEST_F(CasePipeline, RoomOfAFailingCaseIsGivenBack) {
    ChunkBudget budget(3 * 3 * sizeof(float));
    const std::vector<float> force(3, 1.0f);
    layout::FieldChunk<float> chunk{};
    chunk.force = force;
    for (int i = 0; i < 20; ++i) {
        ChunkQueue queue(budget);
        queue.push(chunk);
        queue.push(chunk);
        try {
            const auto waiting = queue.pop();
            throw std::runtime_error("encoder");
        } catch (const std::runtime_error&) {
            queue.abandon();
        }
        EXPECT_THROW(queue.push(chunk), EncoderFailed);
    }
}

TEST_F(CasePipeline, AChunkLargerThanAllRoomPasses) {
    ChunkBudget budget(1);
    const std::vector<float> force(300, 1.0f);
    layout::FieldChunk<float> chunk{};
    chunk.force = force;
    ChunkQueue queue(budget);
    for (int i = 0; i < 5; ++i) {
        queue.push(chunk);
        EXPECT_TRUE(queue.pop());
    }
}

} // namespace
} // namespace forceshade::test

// The default sweep's wall time against what bounds it: kernels and read-back alone, output alone, and all processor
// time spread over the cores.
#include <thread>

#include <benchmark/benchmark.h>

#include "host/cases/case_pipeline.h"
#include "host/cases/chunk_queue.h"
#include "host/cases/engine_choice.h"
#include "host/sweep/sweep.h"
#include "tests/bench/measure.h"
#include "tests/io/folder.h"

namespace forceshade::bench {
namespace {

// Hands out again what another engine evaluated, so that output can be timed alone.
class ReplayEngine final : public Engine {
public:
    explicit ReplayEngine(Engine& engine) : engine_(engine) {}
    EngineReport report() const override { return engine_.report(); }
    void rewind() { next_ = 0; }
    EngineTimes run(const EngineWork& work) override {
        const auto& [input, take] = std::get<FieldWork<float>>(work);
        if (next_ == fields_.size()) {
            fields_.emplace_back();
            engine_.evaluate(input,
                             [&](const layout::FieldChunk<float>& chunk) { fields_.back().emplace_back(chunk); });
        }
        for (const OwnedChunk<float>& chunk : fields_[next_])
            take(chunk.view);
        ++next_;
        return {};
    }

private:
    Engine& engine_;
    std::vector<std::vector<OwnedChunk<float>>> fields_;
    std::size_t next_ = 0;
};

double kernels_alone(Engine& engine, const Study& study) {
    return seconds([&] {
        for (const Case& one : study.cases) {
            const FieldTables<float> tables = make_tables<float>(one.scene, {}, Extent::what_varies);
            engine.evaluate(tables.input(), [](const layout::FieldChunk<float>&) {});
        }
    });
}

double output_alone(ReplayEngine& replay, const Study& study, const std::filesystem::path& folder) {
    replay.rewind();
    CasePreparation preparation;
    std::size_t next = 0;
    std::filesystem::create_directories(folder);
    return seconds([&] {
        run_cases(
            replay,
            [&] {
                if (next == study.cases.size())
                    return std::unique_ptr<CaseJob>();
                const Case& one = study.cases[next++];
                return std::make_unique<CaseJob>(
                    CaseJob{preparation.prepare(one), folder / (one.name + ".exr"), {}, {}});
            },
            study.cases.size(), {}, [](const CaseOutcome&) {});
    });
}

EngineOptions default_engine(const Study& study) {
    const EngineChoice choice = choose_engine(study_workload(study), false);
    EngineOptions options;
    options.cpu = choice.cpu;
    options.gpu = choice.gpu;
    return options;
}

void default_sweep(benchmark::State& state) {
    const testing::Folder folder;
    const Study study = default_study();
    const EngineOptions wanted = default_engine(study);
    const auto engine = make_engine(wanted);
    ReplayEngine replay(*engine);
    output_alone(replay, study, folder / "output"); // also evaluates every field once, and compiles
    const auto cores = static_cast<double>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<double> ratios, walls;
    double kernels = 0, output = 0, processors = 0;
    for (auto _ : state) {
        kernels = kernels_alone(*engine, study);
        output = output_alone(replay, study, folder / "output");
        SweepOptions options;
        options.folder = folder / "sweep";
        options.fresh = true;
        options.quiet = true;
        const double before = cpu_seconds();
        const double wall = seconds([&] {
            run_sweep(
                study, [&] { return make_engine(wanted); }, wanted.cpu, options);
        });
        processors = (cpu_seconds() - before) / cores;
        state.SetIterationTime(wall);
        walls.push_back(wall);
        ratios.push_back(wall / std::max({kernels, output, processors}));
    }
    state.SetLabel(cpu_name() + "; " + engine->report().device);
    state.counters["of_largest"] = median(ratios);
    state.counters["wall_s"] = median(walls);
    state.counters["kernels_s"] = kernels;
    state.counters["output_s"] = output;
    state.counters["cpu_over_cores_s"] = processors;
}

BENCHMARK(default_sweep)->UseManualTime()->Iterations(3)->Unit(benchmark::kSecond);

} // namespace
} // namespace forceshade::bench

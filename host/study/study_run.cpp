#include "host/study/study_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/error.h"
#include "host/limits/limits.h"
#include "host/long_run.h"
#include "host/norm.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/reference/chunks.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade::study {

namespace {

class SharedEngine final : public Engine {
public:
    explicit SharedEngine(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}
    EngineReport report() const override {
        const std::lock_guard lock(mutex_);
        return engine_->report();
    }
    EngineTimes run(const EngineWork& work) override {
        const std::lock_guard lock(mutex_);
        return engine_->run(work);
    }

private:
    mutable std::mutex mutex_;
    std::unique_ptr<Engine> engine_;
};

} // namespace

std::unique_ptr<Engine> shared_engine(std::unique_ptr<Engine> engine) {
    return std::make_unique<SharedEngine>(std::move(engine));
}

EngineTimes VisitingEngine::run(const EngineWork& work) {
    return std::visit(
        [&]<typename Work>(const Work& one) {
            if constexpr (requires { one.take_metrics; })
                return engine_.run(one);
            else {
                using T = typename Work::Real;
                layout::FieldInput<T> input = one.input;
                if (input.law.features.surface != layout::kSurfaceMesh)
                    return engine_.run(one);
                const Clock::time_point start = Clock::now();
                const BlockPlan plan = plan_blocks<T>(input.law.mesh, input.x, input.y, input.z,
                                                      input.law.features.inside, 0, FreeSpace::visited);
                const double planning = seconds_since(start);
                input.plan = plan.view();
                EngineTimes times = engine_.run(FieldWork<T>{input, one.take});
                times.plan = planning;
                times.voxels_evaluated = plan.voxels_evaluated;
                return times;
            }
        },
        work);
}

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work) {
    std::mutex mutex;
    std::exception_ptr failed;
    reference::share_out(std::min<std::size_t>(most_threads(), count), count, [&](std::size_t, std::size_t i) {
        {
            const std::lock_guard lock(mutex);
            if (failed)
                return;
        }
        try {
            work(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failed)
                failed = std::current_exception();
        }
    });
    if (failed)
        std::rethrow_exception(failed);
}

double crowding_of_cores() {
    constexpr double kWork = 0.02; // s: longer than a scheduler's turn
    const Clock::time_point start = Clock::now();
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 0; i < most_threads(); ++i)
            threads.emplace_back([] {
                while (thread_seconds() < kWork) { // since it began
                }
            });
    }
    return seconds_since(start) / kWork;
}

glm::dvec3 finite_force(const RendererAnswer& answer) {
    if (!is_force(answer.force))
        throw RendererError("gave a force that is not finite", std::nullopt);
    return answer.force;
}

std::unique_ptr<ProbeLaw> RubbingLaw::on(PreparedCase prepared, double period) const {
    Scene& scene = prepared.one.scene;
    scene.friction = friction;
    scene.vibration = vibration;
    scene.precision = Precision::f64;
    return make_probe_law(prepared, period);
}

std::string own_name(const std::string& compared) {
    return compared.starts_with("own law with") ? "without" : "the scene's own law";
}

std::vector<RubbingLaw> rubbing_laws(const Scene& scene) {
    std::vector<RubbingLaw> laws;
    if (scene.friction)
        laws.push_back({"own law with friction", scene.friction, {}});
    if (scene.vibration)
        laws.push_back({"own law with vibration", {}, scene.vibration});
    if (scene.friction && scene.vibration)
        laws.push_back({"own law with both", scene.friction, scene.vibration});
    return laws;
}

StudyRun::StudyRun(std::string study, const StudyOptions& options) : study_(std::move(study)), options_(options) {
    if (options_.scene)
        scene_ = CasePreparation().prepare(*options_.scene);
    if (scene_) {
        rubbing_ = rubbing_laws(scene_->one.scene);
        if (!rubbing_.empty() && !options_.rubs)
            print_note("note: study {} takes the scene without its friction and vibration\n", study_);
        scene_->one.scene.friction.reset();
        scene_->one.scene.vibration.reset();
    }
    if (::getloadavg(&load_, 1) != 1)
        load_ = NAN;
    scene_text_ = scene_ ? scene_->scene : "";
    for (const Case& one : options_.cases)
        scene_text_ += resolved_toml(one) + "\n";
    engine_ = shared_engine(make_engine(options_.engine));
    make_subfolder(options_.folder.parent_path(), options_.folder.filename().string());
    clear_stale_temporaries(options_.folder);
    const EngineReport report = engine_->report();
    std::string renderers;
    for (const RendererSource& one : options_.renderers)
        renderers += one.name + sha256_of_file(one.library);
    fingerprint_ = sha256_of(fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}{}", study_, version(), report.engine,
                                         report.device, report.uuid, report.driver, cpu_name(),
                                         options_.engine.validation, options_.quick, scene_text_, renderers));
}

void StudyRun::run(const std::vector<Part>& parts) {
    Stage stage("beginning", parts.size(), "parts");
    std::atomic<std::size_t> done = 0;
    const auto take = [&](const Part& part) {
        check_interrupt();
        stage.update(done, part.name);
        part.compute();
        stage.update(++done);
    };
    for (auto part = parts.begin(); part != parts.end();) {
        auto end = std::find_if(part, parts.end(), [](const Part& one) { return !one.shares_cores; });
        end = std::max(end, part + 1);
        on_all_cores(static_cast<std::size_t>(end - part),
                     [&](std::size_t i) { take(part[static_cast<std::ptrdiff_t>(i)]); });
        part = end;
    }
}

StudyData StudyRun::data() const {
    const EngineReport report = engine_->report();
    StudyData data;
    data.study = study_;
    data.program = version();
    data.engine = report.engine;
    data.device = report.device;
    data.driver = report.driver;
    data.software = report.software;
    data.cpu = cpu_name();
    data.cores = most_threads();
    data.quick = options_.quick;
    data.fingerprint = fingerprint_;
    data.seconds = seconds_since(start_);
    data.scene = scene_text_;
    try {
        data.weak_places = scene_ ? weak_places_text(weak_places("the scene of study " + study_, *scene_)) : "";
    } catch (const UsageError&) { // a scene without contact
    }
    if (!std::isnan(load_))
        data.notes.push_back(fmt::format(
            "When it began {:.2g} threads ran or waited on the machine (load, the mean of a minute).", load_));
    return data;
}

} // namespace forceshade::study

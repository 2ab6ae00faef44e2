// A study done part by part, with progress.
#pragma once

#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/clock.h"
#include "host/field/case_law.h"
#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/mesh/block_plan.h"
#include "host/renderer/renderer_process.h"
#include "host/study/study_data.h"

namespace forceshade::study {

struct StudyOptions {
    std::filesystem::path folder;            /* of this study: OUT/error-time */
    std::optional<Case> scene;               /* the user's; none: the study's own */
    std::vector<Case> cases;                 /* the user's, of a study of many scenes */
    bool quick = false;                      /* coarse, in about a minute */
    std::vector<RendererSource> renderers{}; /* of the user's own, on the user's scene */
    bool rubs = false;                       /* the study measures the scene's friction and vibration, too */
    EngineOptions engine;
};

/// N: the force of a renderer's answer. \throws RendererError for one that is not finite.
glm::dvec3 finite_force(const RendererAnswer& answer);

/// The scene's law with what the scene adds to it along a path.
struct RubbingLaw {
    std::string name; /* "own law with friction" */
    std::optional<FrictionSpec> friction;
    std::optional<VibrationSpec> vibration;

    /// A law of a scene without them, in f64, in a loop of `period`, s.
    std::unique_ptr<ProbeLaw> on(PreparedCase prepared, double period) const;
};

/// "without" of a RubbingLaw, of a renderer "the scene's own law".
std::string own_name(const std::string& compared);

/// With each of a scene's friction and vibration, and with both; none of a scene without.
std::vector<RubbingLaw> rubbing_laws(const Scene& scene);

/// A part of a study that is computed in one go, some seconds at most.
struct Part {
    std::string name; /* for the progress bar */
    std::function<void()> compute;
    bool shares_cores = false; /* measures no time, and runs while others do; adds to nothing that they add to */
};

/// work(i) for every i below `count`, at the same time on all cores. \throws the first exception of one, once all that
/// have begun have ended.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work);

/// How long work on every core at once takes over the processor time of a thread's part: 1 where no other program
/// wants the cores.
double crowding_of_cores();

/// The same engine, for one thread at a time: others wait.
std::unique_ptr<Engine> shared_engine(std::unique_ptr<Engine> engine);

/// An engine that visits a mesh's blocks of free space, too: then the plan of the whole grid is made first, and counts
/// as the others do.
class VisitingEngine final : public Engine {
public:
    explicit VisitingEngine(Engine& engine) : engine_(engine) {}
    EngineReport report() const override { return engine_.report(); }
    EngineTimes run(const EngineWork& work) override;

private:
    Engine& engine_;
};

/// A field by an engine, a mesh's with its blocks of free space skipped, or visited.
template <typename T>
EngineTimes evaluate(Engine& engine, const layout::FieldInput<T>& input, FreeSpace free,
                     const std::type_identity_t<std::function<void(const layout::FieldChunk<T>&)>>& take) {
    return free == FreeSpace::skipped ? engine.evaluate<T>(input, take)
                                      : VisitingEngine(engine).evaluate<T>(input, take);
}

class StudyRun {
public:
    /// Makes the folder and the engine, reads the files that the user's scene names. \throws IoError, UsageError,
    /// compute::DeviceError.
    StudyRun(std::string study, const StudyOptions& options);

    /// For any thread.
    Engine& engine() { return *engine_; }
    const StudyOptions& options() const { return options_; }
    /// The user's scene with its files, if given, but without friction and vibration: those have a history.
    const std::optional<PreparedCase>& scene() const { return scene_; }
    /// Of the user's scene, if given.
    const std::vector<RubbingLaw>& rubbing() const { return rubbing_; }
    /// The user's scenes as resolved TOML; empty: none.
    const std::string& scene_text() const { return scene_text_; }

    /// Takes the parts in their order, neighbours that share cores at the same time. An interrupt ends it between
    /// parts. \throws Interrupted, and the exceptions of parts.
    void run(const std::vector<Part>& parts);

    /// Equal where a run would do the same again: of the program, the device, the scene and the form.
    const std::string& fingerprint() const { return fingerprint_; }

    /// Data with all members filled in that do not depend on the study: program, device, scene, time.
    StudyData data() const;

private:
    std::string study_;
    StudyOptions options_;
    std::optional<PreparedCase> scene_;
    std::vector<RubbingLaw> rubbing_;
    std::unique_ptr<Engine> engine_;
    std::string scene_text_, fingerprint_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double load_ = NAN; // mean number of threads that ran or waited, in the minute before; NaN: not known
};

} // namespace forceshade::study

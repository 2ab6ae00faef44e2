// A study done step by step: what was finished stays, a second run goes on from there.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/engine/engine.h"
#include "host/prepare/prepared_case.h"
#include "host/study/data/study_data.h"

namespace forceshade::study {

struct StudyOptions {
    std::filesystem::path folder; /* of this study: OUT/error-time */
    std::optional<Case> scene;    /* the user's; none: the study's own */
    bool quick = false;           /* coarse, within a minute */
    bool fresh = false;           /* nothing of an earlier run is taken */
    bool quiet = false;
    EngineOptions engine;
};

/// A part of a study that is computed in one go, some seconds at most, and whose result is kept as JSON.
struct Step {
    std::string name; /* a file's stem: [A-Za-z0-9._+-], unique */
    std::function<nlohmann::ordered_json()> compute;
};

class StudyRun {
public:
    /// Makes the folder and the engine, reads the files that the user's scene names. \throws IoError, UsageError,
    /// compute::DeviceError.
    StudyRun(std::string study, const StudyOptions& options);

    Engine& engine() { return *engine_; }
    const StudyOptions& options() const { return options_; }
    /// The user's scene with its files; nothing without one.
    const std::optional<PreparedCase>& scene() const { return scene_; }

    /// The results of the steps, in their order, from FOLDER/steps.d (of a quick run quick-steps.d) where the same
    /// program, device and scene left them, else computed in the order given and left there. With progress. An
    /// interrupt ends it between steps. \throws Interrupted, IoError, and whatever a step throws.
    std::vector<nlohmann::ordered_json> run(const std::vector<Step>& steps);

    /// Data with everything filled in that does not depend on the study: program, device, scene, time.
    StudyData data() const;

private:
    std::filesystem::path step_path(const Step& step) const;
    std::optional<nlohmann::ordered_json> kept(const Step& step) const;
    void keep(const Step& step, const nlohmann::ordered_json& result, double seconds) const;

    std::string study_;
    StudyOptions options_;
    std::optional<PreparedCase> scene_;
    std::unique_ptr<Engine> engine_;
    std::string fingerprint_;
    double seconds_ = 0; /* of all steps, kept ones too */
};

} // namespace forceshade::study

#include "host/study/run/study_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade::study {

StudyRun::StudyRun(std::string study, const StudyOptions& options) : study_(std::move(study)), options_(options) {
    if (options_.scene)
        scene_ = CasePreparation().prepare(*options_.scene);
    scene_text_ = scene_ ? scene_->scene : "";
    for (const Case& one : options_.cases)
        scene_text_ += resolved_toml(one) + "\n";
    engine_ = make_engine(options_.engine);
    make_subfolder(options_.folder.parent_path(), options_.folder.filename().string());
    clear_stale_temporaries(options_.folder);
    const EngineReport report = engine_->report();
    fingerprint_ = sha256_of(fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", study_, version(), report.engine,
                                         report.device, report.uuid, report.driver, cpu_name(),
                                         options_.engine.validation, options_.quick, scene_text_));
}

void StudyRun::run(const std::vector<Part>& parts) {
    Stage stage("beginning", parts.size(), "parts");
    std::size_t done = 0;
    for (const Part& part : parts) {
        check_interrupt();
        stage.update(done++, part.name);
        part.compute();
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
    return data;
}

} // namespace forceshade::study

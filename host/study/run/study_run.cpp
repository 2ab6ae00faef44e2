#include "host/study/run/study_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/long_run.h"
#include "host/output/reading.h"
#include "host/program.h"
#include "host/study/run/sampling.h"
#include "host/sweep/manifest.h"
#include "host/threads.h"

namespace forceshade::study {
namespace {

double take_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1)
        return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

} // namespace

double Draw::operator()(double low, double high) {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    mixed ^= mixed >> 31;
    return low + (high - low) * (static_cast<double>(mixed >> 11) * 0x1p-53);
}

Interval bootstrap_median(const std::vector<double>& values) {
    constexpr std::size_t kResamples = 1000;
    if (values.empty())
        return {};
    std::vector<double> sample = values, medians;
    const double median = take_median(sample);
    Draw draw(7);
    for (std::size_t i = 0; i < kResamples; ++i) {
        for (double& one : sample)
            one = values[static_cast<std::size_t>(draw(0, static_cast<double>(values.size())))];
        medians.push_back(take_median(sample));
    }
    std::ranges::sort(medians);
    return {medians[kResamples / 40], median, medians[kResamples - 1 - kResamples / 40]};
}

double quantile(std::vector<double> values, double share) {
    if (values.empty())
        return 0;
    std::ranges::sort(values);
    const double rank = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], rank - static_cast<double>(below));
}

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

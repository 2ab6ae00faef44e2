#include "host/study/run/study_run.h"

#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/files.h"
#include "host/output/reading.h"
#include "host/program.h"
#include "host/study/data/data_files.h"
#include "host/sweep/manifest.h"
#include "host/sweep/sweep.h"

namespace forceshade::study {
namespace {

using Clock = std::chrono::steady_clock;

std::filesystem::path steps_folder(const StudyOptions& options) {
    return options.folder / (options.quick ? kQuickSteps : kSteps);
}

void make_folders(const StudyOptions& options) {
    const std::filesystem::path steps = steps_folder(options);
    make_subfolder(options.folder.parent_path(), options.folder.filename().string());
    make_subfolder(options.folder, steps.filename().string());
    clear_stale_temporaries(options.folder);
    clear_stale_temporaries(steps);
}

} // namespace

StudyRun::StudyRun(std::string study, const StudyOptions& options) : study_(std::move(study)), options_(options) {
    if (options_.scene)
        scene_ = CasePreparation().prepare(*options_.scene);
    engine_ = make_engine(options_.engine);
    make_folders(options_);
    const EngineReport report = engine_->report();
    fingerprint_ = sha256_of(fmt::format(
        "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", study_, version(), report.engine, report.device, report.uuid,
        report.driver, cpu_name(), options_.engine.validation, options_.quick, scene_ ? scene_->scene : std::string()));
}

std::filesystem::path StudyRun::step_path(const Step& step) const {
    return steps_folder(options_) / (step.name + ".json");
}

// Nothing where the file is missing, damaged or of another run.
std::optional<Json> StudyRun::kept(const Step& step) const {
    Json json;
    try {
        json = read_json(step_path(step));
    } catch (const Error&) {
        return std::nullopt;
    }
    if (!json.is_object() || !json.contains("result") || !json.contains("seconds") || !json["seconds"].is_number())
        return std::nullopt;
    const auto says = [&](const char* key, const std::string& expected) {
        return json.contains(key) && json[key] == expected;
    };
    if (!says("fingerprint", fingerprint_) || !says("sha256", sha256_of(json["result"].dump())))
        return std::nullopt;
    return json;
}

void StudyRun::keep(const Step& step, const Json& result, double seconds) const {
    const Json json{
        {"fingerprint", fingerprint_}, {"seconds", seconds}, {"sha256", sha256_of(result.dump())}, {"result", result}};
    write_file_atomically(step_path(step), json.dump() + "\n");
}

std::vector<Json> StudyRun::run(const std::vector<Step>& steps) {
    std::vector<Json> results(steps.size());
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (auto known = options_.fresh ? std::nullopt : kept(steps[i])) {
            seconds_ += known->at("seconds").get<double>();
            results[i] = std::move(known->at("result"));
        } else {
            missing.push_back(i);
        }
    }
    Progress progress("steps", missing.size(), options_.quiet);
    for (std::size_t done = 0; done < missing.size(); ++done) {
        check_interrupt();
        const Step& step = steps[missing[done]];
        progress.update(done, step.name);
        const Clock::time_point start = Clock::now();
        // As a later run will read it.
        results[missing[done]] = Json::parse(step.compute().dump());
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        keep(step, results[missing[done]], seconds);
        seconds_ += seconds;
    }
    if (!missing.empty())
        progress.update(missing.size(), "");
    return results;
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
    data.cores = std::thread::hardware_concurrency();
    data.quick = options_.quick;
    data.seconds = seconds_;
    if (scene_)
        data.scene = scene_->scene;
    return data;
}

} // namespace forceshade::study

#include "host/sweep/sweep.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/scene/cases.h"
#include "host/sweep/manifest.h"

namespace forceshade {

namespace {

// Of everything that decides the bytes of a case.
std::string fingerprint(const PreparedCase& prepared, bool cpu_engine) {
    return sha256_of(fmt::format("{}\n{}\n{}", version(), cpu_engine ? "cpu" : "gpu", prepared.scene));
}

// True if a record says that the case was done just so, and its files are still what they were.
bool is_done(const CaseJob& job, const SweepOptions& options, std::optional<CaseRecord>& record) {
    record = read_record(options.folder, job.prepared.one.name);
    if (!record || record->fingerprint != job.fingerprint)
        return false;
    const EngineReport& engine = record->engine;
    // By name, not by UUID: the equal devices of a cluster finish each other's sweeps.
    if (options.device && (engine.device != options.device->name || engine.driver != options.device->driver))
        return false;
    for (const std::string& name : file_names(job.prepared.one.name, job.prepared.one.scene, options.also)) {
        const auto file = std::find_if(record->files.begin(), record->files.end(),
                                       [&](const FileRecord& known) { return known.name == name; });
        if (file == record->files.end() || !file_is_intact(options.folder / name, file->sha256))
            return false;
    }
    return true;
}

// What lies beside a volume is made again with it, so that nothing of an earlier scene stays under the case's name.
AlsoFormats with_present(AlsoFormats also, const std::filesystem::path& folder, const std::string& stem) {
    const auto any = [&](AlsoFormats one) {
        const std::vector<std::string> plain = possible_file_names(stem, {}), names = possible_file_names(stem, one);
        return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return std::find(plain.begin(), plain.end(), name) == plain.end() && std::filesystem::exists(folder / name);
        });
    };
    return {also.vti || any({.vti = true}),
            also.vtp || any({.vtp = true}),
            also.npy || any({.npy = true}),
            {also.pictures.png || any({.pictures = {.png = true}}),
             also.pictures.svg || any({.pictures = {.svg = true}}),
             also.pictures.pdf || any({.pictures = {.pdf = true}})}};
}

// Removes the record, which must not outlive the files that it vouches for, and files that the case no longer has.
void forget(const std::filesystem::path& folder, const Case& one, AlsoFormats also) {
    std::error_code ignored;
    std::filesystem::remove(record_path(folder, one.name), ignored);
    const std::vector<std::string> keep = file_names(one.name, one.scene, also);
    for (const std::string& name : possible_file_names(one.name, {true, true, true, {true, true, true}}))
        if (std::find(keep.begin(), keep.end(), name) == keep.end())
            std::filesystem::remove(folder / name, ignored);
}

// The study with the SHA-256 of its images, by which study.toml names them, and what each case's record must say to
// count. Images of cases that nobody wants now may be missing; such cases count as not done.
struct Prepared {
    Study study;
    Fingerprints fingerprints;
    std::set<std::string> warnings; // of the files of the cases chosen
};

PreparedCase prepared_case(CasePreparation& preparation, const Case& one) {
    PreparedCase prepared = preparation.prepare(one);
    add_recorded_digest(prepared);
    return prepared;
}

Prepared prepare(const Study& study, const std::vector<const Case*>& chosen, CasePreparation& preparation) {
    Prepared result{study, {}, {}};
    Stage stage("preparing", study.cases.size(), "cases");
    const std::set<const Case*> wanted(chosen.begin(), chosen.end());
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
        check_interrupt();
        stage.update(i, study.cases[i].name);
        try {
            const PreparedCase prepared = prepared_case(preparation, study.cases[i]);
            result.study.cases[i].scene = prepared.one.scene;
            if (wanted.count(&study.cases[i]))
                result.warnings.insert(prepared.warnings.begin(), prepared.warnings.end());
            for (const bool cpu_engine : {false, true})
                result.fingerprints[study.cases[i].name].insert(fingerprint(prepared, cpu_engine));
        } catch (const Error&) {
            if (wanted.count(&study.cases[i]))
                throw;
        }
    }
    return result;
}

void prepare_folder(const Study& study, const std::filesystem::path& folder) {
    make_subfolder(folder, "manifest.d");
    clear_stale_temporaries(folder);
    clear_stale_temporaries(folder / "manifest.d");
    write_file_atomically(folder / "study.toml", resolved_toml(study));
}

void note_failure(SweepResult& result, const CaseOutcome& outcome) {
    try {
        std::rethrow_exception(outcome.error);
    } catch (const Error& error) {
        result.failures.push_back(fmt::format("{}: {}", outcome.job->prepared.one.name, error.what()));
        result.exit_code = std::max(result.exit_code, static_cast<int>(error.code()));
    }
}

void count(SweepResult& result, const CaseRecord& record) {
    result.largest_relative_error = std::max(result.largest_relative_error, record.error.relative());
    result.differing += record.error.differing;
    if (record.paths)
        result.differing_samples += record.paths->error.differing;
    if (const std::string wrong = complaint(record); !wrong.empty()) {
        result.failures.push_back(wrong);
        result.exit_code = std::max(result.exit_code, static_cast<int>(ExitCode::failed));
    }
}

void count(RunAccount& account, const CaseRecord& record) {
    account.engine += record.engine_times.sum();
    account.output += record.volume_times.sum();
    if (record.paths) {
        account.engine += record.paths->engine_times.sum();
        account.output += record.paths->volume_times.sum();
    }
}

void compute_missing(Engine& engine, const std::vector<const Case*>& missing,
                     const std::function<CaseJob(const Case&)>& job_of, const SweepOptions& options,
                     SweepResult& result) {
    Stage stage("computing", missing.size(), "cases");
    std::size_t next_job = 0, ended = 0;
    const auto next = [&] {
        return next_job < missing.size() ? std::make_unique<CaseJob>(job_of(*missing[next_job++])) : nullptr;
    };
    const auto done = [&](const CaseOutcome& outcome) {
        if (outcome.error) {
            note_failure(result, outcome);
            if (!options.quiet)
                remark("failed: {}\n", result.failures.back());
        } else {
            write_record(options.folder, outcome.record);
            ++result.computed;
            count(result, outcome.record);
            count(result.account, outcome.record);
        }
        stage.update(++ended, outcome.job->prepared.one.name);
    };
    run_cases(engine, next, missing.size(), {options.encoders}, done);
}

} // namespace

std::vector<const Case*> chosen_cases(const Study& study, const SweepOptions& options) {
    std::vector<const Case*> chosen = cases_named(study, options.only);
    if (const auto shard = options.shard) {
        std::vector<const Case*> part;
        for (std::size_t i = shard->index - 1; i < chosen.size(); i += shard->count)
            part.push_back(chosen[i]);
        chosen = part;
    }
    return chosen;
}

SweepResult run_sweep(const Study& study, const std::function<std::unique_ptr<Engine>()>& make, bool cpu_engine,
                      const SweepOptions& options) {
    const Clock::time_point start = Clock::now();
    const double cpu_start = cpu_seconds();
    const std::vector<const Case*> chosen = chosen_cases(study, options);
    if (!options.replace)
        require_same_study(options.folder, study);
    SweepResult result;
    result.chosen = chosen.size();
    CasePreparation preparation;
    const Prepared prepared = prepare(study, chosen, preparation);
    for (const std::string& warning : prepared.warnings)
        if (!options.quiet)
            remark("warning: {}\n", warning);

    const auto job_of = [&](const Case& one) {
        CaseJob job{prepared_case(preparation, one), options.folder / (one.name + ".exr"), {}, {}};
        job.fingerprint = fingerprint(job.prepared, cpu_engine);
        job.also = with_present(options.also, options.folder, one.name);
        return job;
    };
    std::vector<const Case*> missing;
    std::optional<Stage> checking(std::in_place, "checking what is there", chosen.size(), "cases");
    for (const Case* one : chosen) {
        check_interrupt();
        checking->update(missing.size() + result.kept);
        std::optional<CaseRecord> record;
        if (options.fresh || !is_done(job_of(*one), options, record)) {
            missing.push_back(one);
            continue;
        }
        ++result.kept;
        count(result, *record);
    }

    checking.reset();
    for (const Case* one : missing)
        result.forecast += forecast(prepared.study.cases[static_cast<std::size_t>(one - study.cases.data())].scene,
                                    with_present(options.also, options.folder, one->name));
    if (options.dry) {
        if (!missing.empty())
            measure(*make(), missing, job_of, result.forecast);
        return result;
    }
    require_space(options.folder, result.forecast);
    prepare_folder(prepared.study, options.folder);

    const auto finish = [&] {
        const Stage stage("writing the account");
        result.account.computed = result.computed;
        result.account.kept = result.kept;
        result.account.wall = seconds_since(start);
        result.account.cpu = cpu_seconds() - cpu_start;
        result.account.peak_memory = peak_memory();
        write_manifest(options.folder, study, prepared.fingerprints, missing.empty() ? nullptr : &result.account);
    };
    if (missing.empty()) {
        finish();
        return result;
    }
    // The engine comes first: where there is none, nothing is forgotten.
    const std::unique_ptr<Engine> engine = make();
    result.account.engine_device = engine->report().device;
    result.account.engine_driver = engine->report().driver;
    if (is_space_doubtful(options.folder, result.forecast)) {
        measure(*engine, missing, job_of, result.forecast);
        if (const std::string warning = space_warning(options.folder, result.forecast);
            !options.quiet && !warning.empty())
            remark("warning: {}\n", warning);
    }
    for (const Case* one : missing)
        forget(options.folder, *one, with_present(options.also, options.folder, one->name));
    try {
        compute_missing(*engine, missing, job_of, options, result);
    } catch (...) {
        try {
            finish(); // what was done stands in the manifest
        } catch (const IoError&) {
            // The error that stopped the run says more.
        }
        throw;
    }
    finish();
    return result;
}

} // namespace forceshade

#include "host/sweep/sweep.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <set>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"
#include "host/interrupt.h"
#include "host/io/exr_volume.h"
#include "host/io/hash.h"
#include "host/io/temporary_file.h"
#include "host/sweep/case_pipeline.h"
#include "host/sweep/machine.h"
#include "host/sweep/progress.h"
#include "host/version.h"

namespace forceshade {
namespace {

std::optional<std::size_t> whole_number(std::string_view text) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

std::size_t slurm_number(const char* name, std::optional<std::size_t> otherwise = std::nullopt) {
    const char* text = std::getenv(name);
    const std::optional<std::size_t> value = text ? whole_number(text) : otherwise;
    if (!value)
        throw UsageError(fmt::format("this is a task of a Slurm array, and {} is {}: say --shard I/N (1/1: everything)",
                                     name, text ? fmt::format("\"{}\"", text) : "not set"));
    return *value;
}

// Of everything that decides the bytes of a case.
std::string fingerprint(const PreparedCase& prepared, bool cpu_engine) {
    return sha256_of(fmt::format("{}\n{}\n{}", version(), cpu_engine ? "cpu" : "gpu", prepared.scene));
}

// True if a record says that the case was done just so, and its files are still what they were.
bool is_done(const CaseJob& job, const SweepOptions& options, std::optional<CaseRecord>& record) {
    record = read_record(options.folder, job.prepared.one.name);
    if (!record || record->fingerprint != job.fingerprint)
        return false;
    if (!options.device.empty() && record->engine.device != options.device)
        return false;
    for (const std::string& name : file_names(
             job.prepared.one.name, job.prepared.one.scene.output.channels | layout::kChannelForce, options.also)) {
        const auto file = std::find_if(record->files.begin(), record->files.end(),
                                       [&](const FileRecord& known) { return known.name == name; });
        if (file == record->files.end() || !volume_is_intact(options.folder / name, file->sha256))
            return false;
    }
    return true;
}

std::vector<const Case*> choose(const Study& study, const SweepOptions& options) {
    std::vector<const Case*> chosen;
    for (const Case& one : study.cases)
        if (fnmatch(options.only.c_str(), one.name.c_str(), 0) == 0)
            chosen.push_back(&one);
    if (chosen.empty())
        throw UsageError(fmt::format("--only \"{}\" chooses none of {} cases; the first is {}", options.only,
                                     study.cases.size(), study.cases.empty() ? "" : study.cases.front().name));
    if (const auto shard = options.shard) {
        std::vector<const Case*> part;
        for (std::size_t i = shard->index - 1; i < chosen.size(); i += shard->count)
            part.push_back(chosen[i]);
        chosen = part;
    }
    return chosen;
}

bool names_a_file(const Scene& scene) {
    return scene.surface.map.function == MapFunction::file ||
           (scene.texture && scene.texture->map.function == MapFunction::file);
}

// The study with the SHA-256 of its images, by which study.toml names them. Those of cases that nobody wants now may be
// missing.
Study with_digests(Study study, const std::vector<const Case*>& chosen, CasePreparation& preparation) {
    std::set<std::string_view> wanted;
    for (const Case* one : chosen)
        wanted.insert(one->name);
    for (Case& one : study.cases)
        if (names_a_file(one.scene))
            try {
                one.scene = preparation.prepare(one).one.scene;
            } catch (const Error&) {
                if (wanted.count(one.name))
                    throw;
            }
    return study;
}

void prepare_folder(const Study& study, const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder / "manifest.d", error);
    if (error)
        throw IoError(fmt::format("cannot make the folder {}: {}", (folder / "manifest.d").string(), error.message()));
    clear_stale_temporaries(folder);
    clear_stale_temporaries(folder / "manifest.d");
    write_file_atomically(folder / "study.toml", resolved_toml(study));
}

void forget(const std::filesystem::path& folder, const std::string& name) {
    std::error_code ignored;
    std::filesystem::remove(record_path(folder, name), ignored);
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
}

void count(RunAccount& account, const CaseRecord& record) {
    account.engine += record.engine_times.upload + record.engine_times.kernel + record.engine_times.read_back;
    account.output += record.volume_times.encode + record.volume_times.flush + record.volume_times.read_back +
                      record.volume_times.hash;
}

} // namespace

Shard parse_shard(const std::string& text) {
    const std::size_t slash = text.find('/');
    if (slash != std::string::npos) {
        const auto index = whole_number(std::string_view(text).substr(0, slash));
        const auto total = whole_number(std::string_view(text).substr(slash + 1));
        if (index && total && *index >= 1 && *index <= *total)
            return {*index, *total};
    }
    throw UsageError(fmt::format("--shard {}: it is I/N with 1 <= I <= N, for example 3/8", text));
}

std::optional<Shard> slurm_shard() {
    if (!std::getenv("SLURM_ARRAY_TASK_ID"))
        return std::nullopt;
    const std::size_t id = slurm_number("SLURM_ARRAY_TASK_ID"), total = slurm_number("SLURM_ARRAY_TASK_COUNT");
    const std::size_t first = slurm_number("SLURM_ARRAY_TASK_MIN", 0), step = slurm_number("SLURM_ARRAY_TASK_STEP", 1);
    if (id < first || step == 0 || (id - first) / step >= total)
        throw UsageError(fmt::format("this is task {} of a Slurm array of {} tasks from {} by {}, which cannot be: say "
                                     "--shard I/N (1/1: everything)",
                                     id, total, first, step));
    return Shard{(id - first) / step + 1, total};
}

SweepResult run_sweep(const Study& study, const std::function<std::unique_ptr<Engine>()>& make, bool cpu_engine,
                      const SweepOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_seconds();
    const std::vector<const Case*> chosen = choose(study, options);
    SweepResult result;
    result.chosen = chosen.size();
    CasePreparation preparation;
    prepare_folder(with_digests(study, chosen, preparation), options.folder);

    const auto job_of = [&](const Case& one) {
        CaseJob job{preparation.prepare(one), options.folder / (one.name + ".exr"), {}};
        job.fingerprint = fingerprint(job.prepared, cpu_engine);
        return job;
    };
    std::vector<const Case*> missing;
    for (const Case* one : chosen) {
        check_interrupt();
        const CaseJob job = job_of(*one);
        std::optional<CaseRecord> record;
        if (!options.fresh && is_done(job, options, record)) {
            ++result.kept;
            count(result, *record);
            continue;
        }
        // A record must not outlive the files that it vouches for.
        forget(options.folder, one->name);
        missing.push_back(one);
    }

    Progress progress("cases", missing.size(), options.quiet);
    const auto finish = [&] {
        result.account.computed = result.computed;
        result.account.kept = result.kept;
        result.account.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        result.account.cpu = cpu_seconds() - cpu_start;
        result.account.peak_memory = peak_memory();
        write_manifest(options.folder, study, missing.empty() ? nullptr : &result.account);
    };
    if (!missing.empty()) {
        const std::unique_ptr<Engine> engine = make();
        result.account.engine_device = engine->report().device;
        result.account.engine_driver = engine->report().driver;
        std::size_t next_job = 0, ended = 0;
        const auto next = [&] {
            return next_job < missing.size() ? std::make_unique<CaseJob>(job_of(*missing[next_job++])) : nullptr;
        };
        const auto done = [&](const CaseOutcome& outcome) {
            if (outcome.error) {
                note_failure(result, outcome);
                progress.say("failed: " + result.failures.back());
            } else {
                write_record(options.folder, outcome.record);
                ++result.computed;
                count(result, outcome.record);
                count(result.account, outcome.record);
            }
            progress.update(++ended, outcome.job->prepared.one.name);
        };
        try {
            run_cases(*engine, next, missing.size(), {options.also, options.encoders}, done);
        } catch (...) {
            try {
                finish(); // what was done stands in the manifest
            } catch (const IoError&) {
                // The error that stopped the run says more.
            }
            throw;
        }
    }
    finish();
    return result;
}

} // namespace forceshade

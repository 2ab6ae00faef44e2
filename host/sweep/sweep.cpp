#include "host/sweep/sweep.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "host/cases/case_files.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/scene/cases.h"

namespace forceshade {

namespace {

// True if a record says that the case was done just so, and its files are still what they were.
bool is_done(const CaseJob& job, const SweepOptions& options, std::optional<CaseRecord>& record) {
    record = read_record(options.folder, job.prepared.one.name);
    const auto is_of = [&](bool cpu_engine) {
        return record->fingerprint == fingerprint(job.prepared.scene, cpu_engine);
    };
    if (!record || (record->fingerprint != job.fingerprint && !(options.any_engine && (is_of(true) || is_of(false)))))
        return false;
    const EngineReport& engine = record->engine;
    // By name, not by UUID: the equal devices of a cluster finish each other's sweeps.
    if (options.device && (engine.device != options.device->name || engine.driver != options.device->driver))
        return false;
    for (const std::string& name : file_names(job.prepared.one.name, job.prepared.one, options.also)) {
        const auto file = std::find_if(record->files.begin(), record->files.end(),
                                       [&](const FileRecord& known) { return known.name == name; });
        if (file == record->files.end() || !file_is_intact(options.folder / name, file->sha256))
            return false;
    }
    return true;
}

// Files that belong to a volume are made again with it, so that none of an earlier scene stays under the case's name.
AlsoFormats with_present(AlsoFormats also, const std::filesystem::path& folder, const std::string& stem) {
    const std::vector<std::string> plain = possible_file_names(stem, {});
    for (const char* const format : AlsoFormats::kNames) {
        AlsoFormats one;
        one.add(format);
        for (const std::string& name : possible_file_names(stem, one))
            if (std::ranges::find(plain, name) == plain.end() && std::filesystem::exists(folder / name))
                also.add(format);
    }
    return also;
}

// Removes the record, which must not outlive the files that it vouches for, and files that the case no longer has.
void forget(const std::filesystem::path& folder, const Case& one, AlsoFormats also) {
    std::error_code ignored;
    std::filesystem::remove(record_path(folder, one.name), ignored);
    AlsoFormats every;
    for (const char* const format : AlsoFormats::kNames)
        every.add(format);
    const std::vector<std::string> keep = file_names(one.name, one, also);
    for (const std::string& name : possible_file_names(one.name, every))
        if (std::ranges::find(keep, name) == keep.end())
            std::filesystem::remove(folder / name, ignored);
}

PreparedCase prepared_case(CasePreparation& preparation, const Case& one) {
    PreparedCase prepared = preparation.prepare(one);
    add_recorded_digest(prepared);
    return prepared;
}

void prepare_folder(const std::filesystem::path& folder) {
    make_subfolder(folder, "manifest.d");
    for (const std::filesystem::path& one : {folder, folder / "manifest.d"})
        clear_stale_temporaries(one);
}

void count(SweepResult& result, const CaseRecord& record) {
    result.voxels += record.voxels;
    result.evaluated += record.evaluated;
    result.free_space |= std::ranges::count(record.omitted, kFreeSpace) > 0;
    result.largest_relative_error = std::max(result.largest_relative_error, record.error.relative());
    result.differing += record.error.differing;
    if (record.voxels > 0 && record.largest_force == 0 && record.error.largest_force == 0) // else it underflows
        result.untouched.insert(record.name);
    if (record.paths) {
        result.differing_samples += record.paths->error.differing;
        result.warnings.insert(record.paths->warnings.begin(), record.paths->warnings.end());
    }
    if (const std::string wrong = error_text(record); !wrong.empty()) {
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

// Writes the status of a shard every few seconds: a shard without updates has died.
class NoteWriter {
public:
    NoteWriter(const std::filesystem::path& folder, const Shard& shard, const std::string& only, std::size_t cases)
        : folder_(folder) {
        note_.shard = shard;
        note_.only = only;
        note_.cases = cases;
        std::array<char, 256> host{};
        ::gethostname(host.data(), host.size() - 1);
        note_.host = host.data();
        note_.process = ::getpid();
        note_.started = seconds_since_1970();
        write(note_);
        thread_ = std::jthread([this](const std::stop_token& stop) { go_on(stop); });
    }
    void kept() {
        const std::lock_guard lock(mutex_);
        ++note_.kept;
    }
    void computed() {
        const std::lock_guard lock(mutex_);
        ++note_.computed;
    }
    /// `name`: of a case; empty: what stopped all that were left.
    void failed(const std::string& name, const std::string& message) {
        const std::lock_guard lock(mutex_);
        note_.failures.push_back({name, message});
    }
    /// \throws IoError
    void end() {
        thread_ = {};
        note_.ended = true;
        write(note_);
    }

private:
    static double seconds_since_1970() {
        return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    }
    void go_on(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!end_.wait_for(lock, stop, std::chrono::seconds(5), [] { return false; }) && !stop.stop_requested()) {
            ShardNote note = note_;
            lock.unlock();
            try {
                write(std::move(note));
            } catch (const Error&) {
                // The next file that cannot be written reports it.
            }
            lock.lock();
        }
    }
    void write(ShardNote note) const {
        note.updated = seconds_since_1970();
        write_note(folder_, note);
    }

    std::filesystem::path folder_;
    ShardNote note_;
    std::mutex mutex_;
    std::condition_variable_any end_;
    std::jthread thread_;
};

void note_failure(SweepResult& result, const std::string& name, const Error& error, const SweepOptions& options,
                  NoteWriter* note_writer) {
    result.failures.push_back(fmt::format("{}: {}", name, error.what()));
    result.exit_code = std::max(result.exit_code, static_cast<int>(error.code()));
    if (note_writer)
        note_writer->failed(name, error.what());
    if (!options.quiet)
        print_note("failed: {}\n", result.failures.back());
}

void compute_missing(Engine& engine, const std::vector<const Case*>& missing,
                     const std::function<CaseJob(const Case&)>& job_of, const SweepOptions& options,
                     NoteWriter* note_writer, SweepResult& result) {
    Stage stage("computing", missing.size(), "cases");
    std::size_t next_job = 0, ended = 0;
    const auto next = [&] {
        return next_job < missing.size() ? std::make_unique<CaseJob>(job_of(*missing[next_job++])) : nullptr;
    };
    const auto done = [&](const CaseOutcome& outcome) {
        const std::string& name = outcome.job->prepared.one.name;
        if (outcome.error) {
            try {
                std::rethrow_exception(outcome.error);
            } catch (const Error& error) {
                note_failure(result, name, error, options, note_writer);
            }
        } else {
            write_record(options.folder, outcome.record);
            ++result.computed;
            if (note_writer)
                note_writer->computed();
            count(result, outcome.record);
            count(result.account, outcome.record);
        }
        stage.update(++ended, name);
    };
    run_cases(engine, next, missing.size(), {options.encoders}, done);
}

SweepResult sweep(Study study, const std::function<std::unique_ptr<Engine>()>& make, bool cpu_engine,
                  const SweepOptions& options, NoteWriter* note_writer) {
    const Clock::time_point start = Clock::now();
    const double cpu_start = cpu_seconds();
    std::vector<const Case*> chosen;
    if (options.shard) // the study has no other cases
        std::ranges::transform(study.cases, std::back_inserter(chosen), [](const Case& one) { return &one; });
    else
        chosen = cases_named(study, options.only);
    if (!options.replace && !options.shard)
        require_same_study(options.folder, study);
    SweepResult result;
    result.chosen = chosen.size();
    const Fingerprints fingerprints = options.shard ? Fingerprints() : identify(study);
    CasePreparation preparation;
    const auto job_of = [&](const Case& one) {
        CaseJob job{prepared_case(preparation, one), options.folder / (one.name + ".exr"), {}, {}};
        job.fingerprint = fingerprint(job.prepared.scene, cpu_engine);
        job.also = with_present(options.also, options.folder, one.name);
        return job;
    };
    std::vector<const Case*> missing;
    std::set<std::string> warnings;
    std::optional<Stage> checking(std::in_place, "checking what is there", chosen.size(), "cases");
    for (const Case* one : chosen) {
        check_interrupt();
        checking->update(missing.size() + result.kept, one->name);
        std::optional<CaseRecord> record;
        try {
            const CaseJob job = job_of(*one);
            warnings.insert(job.prepared.warnings.begin(), job.prepared.warnings.end());
            if (const std::string why = one->scene.paths ? too_thin_for_single(job.prepared) : ""; !why.empty())
                warnings.insert(why + ": a proxy has no room there; use --precision f64, as explore does by itself");
            if (options.fresh || !is_done(job, options, record)) {
                missing.push_back(one);
                result.forecast += forecast(job.prepared.one.scene, job.also);
                continue;
            }
        } catch (const Error& error) {
            if (!note_writer || dynamic_cast<const Interrupted*>(&error))
                throw;                                                    // before anything is computed
            note_failure(result, one->name, error, options, note_writer); // a part goes on with its other cases
            continue;
        }
        ++result.kept;
        if (note_writer)
            note_writer->kept();
        count(result, *record);
    }
    checking.reset();
    for (const std::string& warning : warnings)
        if (!options.quiet)
            print_note("warning: {}\n", warning);
    if (options.dry) {
        if (!missing.empty())
            measure(*make(), missing, job_of, result.forecast);
        return result;
    }
    require_space(options.folder, result.forecast);
    if (!options.shard) {
        prepare_folder(options.folder);
        write_file_atomically(options.folder / "study.toml", resolved_toml(study));
    }

    const auto finish = [&] {
        const Stage stage("writing the account");
        result.account.computed = result.computed;
        result.account.kept = result.kept;
        result.account.wall = seconds_since(start);
        result.account.cpu = cpu_seconds() - cpu_start;
        result.account.peak_memory = peak_memory();
        if (options.shard)
            return;
        const RunAccount* const account = missing.empty() ? nullptr : &result.account;
        std::optional<std::ptrdiff_t> before;
        for (;;) { // another process may have ended a case and written the manifest meanwhile
            const auto records = records_of(options.folder, study, fingerprints);
            const std::ptrdiff_t recorded = std::ranges::count_if(records, [](const auto& one) { return !!one; });
            if (before == recorded)
                return;
            write_manifest(options.folder, study, records, account);
            before = recorded;
        }
    };
    if (missing.empty()) {
        finish();
        return result;
    }
    // The engine comes first: without one, no earlier result is removed.
    const std::unique_ptr<Engine> engine = make();
    result.account.engine_device = engine->report().device;
    result.account.engine_driver = engine->report().driver;
    if (is_space_doubtful(options.folder, result.forecast)) {
        measure(*engine, missing, job_of, result.forecast);
        if (const std::string warning = space_warning(options.folder, result.forecast);
            !options.quiet && !warning.empty())
            print_note("warning: {}\n", warning);
    }
    for (const Case* one : missing)
        forget(options.folder, *one, with_present(options.also, options.folder, one->name));
    try {
        compute_missing(*engine, missing, job_of, options, note_writer, result);
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

} // namespace

SweepResult run_sweep(Study study, const std::function<std::unique_ptr<Engine>()>& make, bool cpu_engine,
                      const SweepOptions& options) {
    if (!options.shard || options.dry)
        return sweep(std::move(study), make, cpu_engine, options, nullptr);
    prepare_folder(options.folder);
    make_subfolder(options.folder / "manifest.d", "shards");
    clear_stale_temporaries(options.folder / "manifest.d" / "shards");
    NoteWriter note_writer(options.folder, *options.shard, options.only, study.cases.size());
    try {
        SweepResult result = sweep(std::move(study), make, cpu_engine, options, &note_writer);
        note_writer.end();
        return result;
    } catch (const std::exception& error) {
        try {
            note_writer.failed("", error.what());
            note_writer.end();
        } catch (const IoError&) {
            // The error that stopped the run says more.
        }
        throw;
    }
}

} // namespace forceshade

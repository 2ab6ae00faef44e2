#include "host/sweep/sweep.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <span>
#include <string_view>
#include <sys/resource.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/output/raw_formats.h"
#include "host/output/record.h"
#include "host/paths/path_reader.h"
#include "host/program.h"
#include "host/reference/chunks.h"
#include "host/scene/document.h"
#include "host/threads.h"

namespace forceshade {

std::string cpu_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.rfind("model name", 0) == 0)
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "unknown";
}

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

namespace {

Json account(const RunAccount& run) {
    return {{"program", version()},
            {"compressor", deflate_name()},
            {"device", run.engine_device},
            {"driver", run.engine_driver},
            {"cpu", cpu_name()},
            {"cores", most_threads()},
            {"cases_computed", run.computed},
            {"cases_kept", run.kept},
            {"wall_s", run.wall},
            {"cpu_s", run.cpu},
            {"engine_s", run.engine},
            {"output_s", run.output},
            {"peak_memory_bytes", run.peak_memory}};
}

// The cases come last, and of many of them a manifest may be larger than what memory is allowed.
constexpr std::string_view kCases = ",\n  \"cases\": [";

Json last_account(const std::filesystem::path& path) {
    try {
        std::string head(1 << 16, '\0');
        head.resize(ReadableFile(path).read_some(0, std::as_writable_bytes(std::span(head))));
        const Json json = parse_json(head.substr(0, head.find(kCases)) + "}");
        return json.is_object() && json.contains("last_run") ? json["last_run"] : Json(nullptr);
    } catch (const Error&) {
        return nullptr; // unreadable
    }
}

constexpr const char* kPathColumns[] = {"paths",
                                        "path_steps",
                                        "path_samples",
                                        "path_contact_share",
                                        "unstable_paths",
                                        "path_largest_force_N",
                                        "path_work_J",
                                        "path_mean_depth_m",
                                        "path_depth_deviation_m",
                                        "path_samples_compared",
                                        "path_samples_differing",
                                        "paths_exr_sha256"};

constexpr const char* kDeviationColumns[] = {
    "compare_angles",     "compare_rms_angle_deg",         "compare_largest_angle_deg",
    "compare_magnitudes", "compare_rms_magnitude_error_N", "compare_largest_magnitude_error_N"};

void add_deviation(const std::optional<DeviationRecord>& deviation, CsvText& csv) {
    if (deviation && deviation->magnitudes > 0)
        csv.add(deviation->angles)
            .add(deviation->rms_angle)
            .add(deviation->largest_angle)
            .add(deviation->magnitudes)
            .add(deviation->rms_magnitude_error)
            .add(deviation->largest_magnitude_error);
    else
        for ([[maybe_unused]] const char* column : kDeviationColumns)
            csv.add("");
}

void add_touch(const CaseRecord& record, CsvText& csv) {
    const TouchRecord touch = record.touch.value_or(TouchRecord());
    for (const double number :
         {touch.direction.value, touch.direction.low, touch.direction.high, touch.median_error.value,
          touch.median_error.low, touch.median_error.high, touch.missed.value})
        if (std::isnan(number))
            csv.add("");
        else
            csv.add(number);
}

// Nothing of the CPU engine: it is the oracle.
void add_differing(const CaseRecord& record, std::uint64_t differing, CsvText& csv) {
    if (record.engine.engine == "cpu")
        csv.add("");
    else
        csv.add(differing);
}

void add_paths(const CaseRecord& record, CsvText& csv) {
    if (!record.paths) {
        for ([[maybe_unused]] const char* column : kPathColumns)
            csv.add("");
        return;
    }
    const PathRecord& paths = *record.paths;
    const auto exr = std::find_if(record.files.begin(), record.files.end(),
                                  [](const FileRecord& file) { return file.name.ends_with(".paths.exr"); });
    csv.add(paths.paths).add(paths.steps).add(paths.samples);
    csv.add(paths.samples ? double(paths.in_contact) / double(paths.samples) : 0.0);
    csv.add(paths.unstable).add(paths.largest_force).add(paths.work).add(paths.mean_depth).add(paths.depth_deviation);
    csv.add(paths.error.samples);
    add_differing(record, paths.error.differing, csv);
    csv.add(exr == record.files.end() ? std::string() : exr->sha256);
}

// Columns: the case, every key that varies in the study, then figures that do not change from run to run; those of
// paths and of comparisons only where a case of the study has some.
std::string summary(const Study& study, const std::vector<std::optional<CaseRecord>>& records) {
    std::vector<std::string> keys;
    for (const Case& one : study.cases)
        for (const auto& [key, value] : one.varied)
            add_once(key, keys);
    CsvText csv;
    csv.add("case");
    for (const std::string& key : keys)
        csv.add(key);
    for (const char* column :
         {"precision", "voxels", "voxels_evaluated", "left_out", "largest_force_N", "oracle_voxels", "oracle_differing",
          "oracle_largest_error_N", "oracle_relative_error", "touch_direction_deg", "touch_direction_low_deg",
          "touch_direction_high_deg", "touch_force_error", "touch_force_error_low", "touch_force_error_high",
          "touch_missed", "evaluations_saved", "exr_bytes", "exr_sha256"})
        csv.add(column);
    const auto any = [&](auto has) { return std::ranges::any_of(study.cases, has, &Case::scene); };
    const bool paths = any([](const Scene& scene) { return scene.paths.has_value(); });
    const bool compared = any([](const Scene& scene) { return scene.compare && scene.field; });
    const bool compared_paths = any([](const Scene& scene) { return scene.compare && scene.paths; });
    if (compared)
        for (const char* column : kDeviationColumns)
            csv.add(column);
    if (paths)
        for (const char* column : kPathColumns)
            csv.add(column);
    if (compared_paths)
        for (const char* column : kDeviationColumns)
            csv.add(fmt::format("path_{}", column));
    csv.end();
    for (const std::optional<CaseRecord>& found : records) {
        if (!found)
            continue;
        const CaseRecord& record = *found;
        csv.add(record.name);
        for (const std::string& key : keys) {
            const auto parameter = std::find_if(record.parameters.begin(), record.parameters.end(),
                                                [&](const auto& one) { return one.first == key; });
            csv.add(parameter == record.parameters.end() ? std::string() : parameter->second);
        }
        csv.add(record.precision).add(record.voxels).add(record.evaluated);
        csv.add(fmt::format("{}", fmt::join(record.omitted, "; "))).add(record.largest_force);
        csv.add(record.error.compared);
        add_differing(record, record.error.differing, csv);
        csv.add(record.error.largest);
        csv.add(record.error.relative());
        add_touch(record, csv);
        csv.add(record.voxels ? 1 - double(record.evaluated) / double(record.voxels) : 0.0);
        csv.add(record.files.front().bytes).add(record.files.front().sha256);
        if (compared)
            add_deviation(record.deviation, csv);
        if (paths)
            add_paths(record, csv);
        if (compared_paths)
            add_deviation(record.paths ? record.paths->deviation : std::nullopt, csv);
        csv.end();
    }
    return csv.text();
}

class FileDigests {
public:
    /// False if the file cannot be read or is another than the one that is meant.
    bool add_to(FileSpec& spec) {
        auto known = digests_.find(spec.path);
        if (known == digests_.end())
            known = digests_.emplace(spec.path, digest_of(spec.path)).first;
        if (!known->second || (!spec.sha256.empty() && spec.sha256 != *known->second))
            return false;
        spec.sha256 = *known->second;
        return true;
    }

    bool add_to(Scene& scene) {
        return std::ranges::all_of(files_of(scene),
                                   [&](const auto& one) { return one.second->file.empty() || add_to(*one.second); });
    }

private:
    static std::optional<std::string> digest_of(const std::string& path) {
        try {
            return sha256_of_file(path);
        } catch (const IoError&) {
            return std::nullopt;
        }
    }

    std::map<std::string, std::optional<std::string>> digests_; // by path
};

} // namespace

std::string fingerprint(const std::string& scene, bool cpu_engine) {
    return sha256_of(fmt::format("{}\n{}\n{}", version(), cpu_engine ? "cpu" : "gpu", scene));
}

Fingerprints identify(Study& study) {
    Fingerprints result;
    FileDigests digests;
    for (Case& one : study.cases) {
        check_interrupt();
        if (!digests.add_to(one.scene))
            continue;
        // Which of the two inside = "auto" takes depends on the file, whose digest is in the text.
        std::vector<std::string> scenes{resolved_toml(one)};
        if (one.scene.surface.kind == SurfaceKind::mesh && one.scene.surface.mesh.inside == InsideTest::automatic) {
            scenes.clear();
            for (const InsideTest inside : {InsideTest::pseudonormal, InsideTest::winding}) {
                Case resolved = one;
                set_inside(resolved, inside);
                scenes.push_back(resolved_toml(resolved));
            }
        }
        for (const std::string& scene : scenes)
            for (const bool cpu_engine : {false, true})
                result[one.name].insert(fingerprint(scene, cpu_engine));
    }
    return result;
}

std::vector<std::optional<CaseRecord>> records_of(const std::filesystem::path& folder, const Study& study,
                                                  const Fingerprints& fingerprints) {
    std::vector<std::optional<CaseRecord>> records(study.cases.size());
    reference::share_out(most_threads(), records.size(), [&](std::size_t, std::size_t i) {
        const auto expected = fingerprints.find(study.cases[i].name);
        if (expected == fingerprints.end())
            return;
        auto record = read_record(folder, study.cases[i].name);
        if (record && expected->second.contains(record->fingerprint))
            records[i] = std::move(record);
    });
    return records;
}

void write_manifest(const std::filesystem::path& folder, const Study& study,
                    const std::vector<std::optional<CaseRecord>>& records, const RunAccount* run) {
    const std::filesystem::path path = folder / "manifest.json";
    const auto recorded =
        static_cast<std::size_t>(std::ranges::count_if(records, [](const auto& record) { return record.has_value(); }));
    const std::string head = Json{
        {"format", kManifestFormat},
        {"program", version()},
        {"cases_of_study", study.all},
        {"cases_recorded", recorded},
        {"complete", recorded == study.all},
        {"last_run", run ? account(*run) : last_account(path)},
        {"cases", Json::array()}}.dump(2);
    // The records of many cases, as one JSON value, would take ten times the memory of their text.
    const std::string_view end = "]\n}";
    TemporaryFile file(path);
    file.write(std::string_view(head).substr(0, head.size() - end.size()));
    std::string_view before = "\n";
    for (const std::optional<CaseRecord>& record : records) {
        if (!record)
            continue;
        std::string text = record_json(*record);
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at)
            text.insert(at + 1, "    ");
        file.write(before);
        file.write("    " + text);
        before = ",\n";
    }
    file.write(recorded > 0 ? "\n  ]\n}\n" : "]\n}\n");
    file.publish();
    write_file_atomically(folder / "summary.csv", summary(study, records));
}

void require_same_study(const std::filesystem::path& folder, const Study& study) {
    std::set<std::string> lost;
    try {
        CsvReader summary(folder / "summary.csv");
        if (!summary.next() || summary.text(0) != "case")
            return;
        while (summary.next())
            lost.emplace(summary.text(0));
    } catch (const Error&) {
        return; // unreadable
    }
    const std::size_t all = lost.size();
    for (const Case& one : study.cases)
        lost.erase(one.name);
    if (!lost.empty())
        throw UsageError("{} holds another study: this one lacks {} of its {}, for example {}. To keep "
                         "its summary.csv, manifest.json and report.html name another folder with --out; to replace "
                         "them add --replace (volumes stay)",
                         folder.string(), lost.size(), numbers::counted(all, "finished case"), *lost.begin());
}

} // namespace forceshade

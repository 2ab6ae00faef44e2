#include "host/sweep/sweep.h"

#include <algorithm>
#include <fstream>
#include <functional>
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

// A column of summary.csv.
struct Column {
    std::string name;
    std::function<std::string(const CaseRecord&)> text; /* empty where it does not apply */
};
using Columns = std::vector<Column>;

// Of members and functions of a part of the record, null where the record lacks it.
template <typename Part> auto adder_to(Columns& columns, const Part& part) {
    return [&columns, part](const std::string& name, auto value) {
        columns.push_back({name, [part, value](const CaseRecord& record) {
                               const auto* const of = part(record);
                               const std::string text = of ? fmt::format("{}", std::invoke(value, *of)) : "";
                               return text == "nan" ? "" : text; // nothing was measured
                           }});
    };
}

const DeviationRecord* counted(const std::optional<DeviationRecord>& deviation) {
    return deviation && deviation->magnitudes > 0 ? &*deviation : nullptr;
}

template <typename Part> void add_deviation(Columns& columns, const std::string& prefix, const Part& part) {
    const auto add = adder_to(columns, part);
    using D = DeviationRecord;
    add(prefix + "compare_angles", &D::angles);
    add(prefix + "compare_rms_angle_deg", &D::rms_angle);
    add(prefix + "compare_largest_angle_deg", &D::largest_angle);
    add(prefix + "compare_magnitudes", &D::magnitudes);
    add(prefix + "compare_rms_magnitude_error_N", &D::rms_magnitude_error);
    add(prefix + "compare_largest_magnitude_error_N", &D::largest_magnitude_error);
}

// Nothing of the CPU engine: it is the oracle.
std::string differing_text(const CaseRecord& record, std::uint64_t differing) {
    return record.engine.engine == "cpu" ? "" : std::to_string(differing);
}

void add_paths(Columns& columns) {
    const auto add =
        adder_to(columns, [](const CaseRecord& record) { return record.paths ? &*record.paths : nullptr; });
    using P = PathRecord;
    add("paths", &P::paths);
    add("path_steps", &P::steps);
    add("path_samples", &P::samples);
    add("path_contact_share", [](const P& p) { return p.samples ? double(p.in_contact) / double(p.samples) : 0.0; });
    add("unstable_paths", &P::unstable);
    add("path_largest_force_N", &P::largest_force);
    add("path_work_J", &P::work);
    add("path_mean_depth_m", &P::mean_depth);
    add("path_depth_deviation_m", &P::depth_deviation);
    add("path_samples_compared", [](const P& p) { return p.error.samples; });
    columns.push_back({"path_samples_differing", [](const CaseRecord& record) {
                           return record.paths ? differing_text(record, record.paths->error.differing) : "";
                       }});
    columns.push_back({"paths_exr_sha256", [](const CaseRecord& record) {
                           const auto exr = std::ranges::find_if(
                               record.files, [](const std::string& name) { return name.ends_with(".paths.exr"); },
                               &FileRecord::name);
                           return record.paths && exr != record.files.end() ? exr->sha256 : std::string();
                       }});
}

// The case, every key that varies in the study, then figures that do not change from run to run; those of paths and of
// comparisons only where a case of the study has some.
Columns columns_of(const Study& study) {
    Columns columns;
    const auto add = adder_to(columns, [](const CaseRecord& record) { return &record; });
    using R = CaseRecord;
    add("case", &R::name);
    std::vector<std::string> keys;
    for (const Case& one : study.cases)
        for (const auto& [key, value] : one.varied)
            add_once(key, keys);
    for (const std::string& key : keys)
        add(key, [key](const R& r) { return r.parameter(key); });
    add("precision", &R::precision);
    add("voxels", &R::voxels);
    add("voxels_evaluated", &R::evaluated);
    add("left_out", [](const R& r) { return fmt::format("{}", fmt::join(r.omitted, "; ")); });
    add("largest_force_N", &R::largest_force);
    add("oracle_voxels", [](const R& r) { return r.error.compared; });
    add("oracle_differing", [](const R& r) { return differing_text(r, r.error.differing); });
    add("oracle_largest_error_N", [](const R& r) { return r.error.largest; });
    add("oracle_relative_error", [](const R& r) { return r.error.relative(); });
    const auto add_touch = adder_to(columns, [](const R& r) { return r.touch ? &*r.touch : nullptr; });
    using T = TouchRecord;
    add_touch("touch_direction_deg", [](const T& t) { return t.direction.value; });
    add_touch("touch_direction_low_deg", [](const T& t) { return t.direction.low; });
    add_touch("touch_direction_high_deg", [](const T& t) { return t.direction.high; });
    add_touch("touch_force_error", [](const T& t) { return t.median_error.value; });
    add_touch("touch_force_error_low", [](const T& t) { return t.median_error.low; });
    add_touch("touch_force_error_high", [](const T& t) { return t.median_error.high; });
    add_touch("touch_missed", [](const T& t) { return t.missed.value; });
    add("evaluations_saved", &R::share_saved);
    add("exr_bytes", [](const R& r) { return r.files.front().bytes; });
    add("exr_sha256", [](const R& r) { return r.files.front().sha256; });
    const auto any = [&](auto has) { return std::ranges::any_of(study.cases, has, &Case::scene); };
    if (any([](const Scene& scene) { return scene.compare && scene.field; }))
        add_deviation(columns, "", [](const R& r) { return counted(r.deviation); });
    if (any([](const Scene& scene) { return scene.paths.has_value(); }))
        add_paths(columns);
    if (any([](const Scene& scene) { return scene.compare && scene.paths; }))
        add_deviation(columns, "path_", [](const R& r) { return r.paths ? counted(r.paths->deviation) : nullptr; });
    return columns;
}

std::string summary(const Study& study, const std::vector<std::optional<CaseRecord>>& records) {
    const Columns columns = columns_of(study);
    CsvText csv;
    for (const Column& column : columns)
        csv.add(column.name);
    csv.end();
    for (const std::optional<CaseRecord>& record : records) {
        if (!record)
            continue;
        for (const Column& column : columns)
            csv.add(column.text(*record));
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

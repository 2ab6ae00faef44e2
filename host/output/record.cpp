#include "host/output/record.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/files.h"
#include "host/output/reading.h"

namespace forceshade {

double PathRecord::steps_per_second() const {
    const double seconds = engine_times.upload + engine_times.kernel + engine_times.read_back;
    return seconds > 0 ? double(samples) / seconds : 0;
}

std::string complaint(const PathRecord& record, const std::string& name, const std::string& device) {
    if (!record.error.passed())
        return fmt::format("{}: {} of {} samples and the metrics of {} of {} paths compared are further from the CPU "
                           "oracle than rounding allows on {} ({}); it is not to be trusted (forceshade validate tells "
                           "more)",
                           name, record.error.beyond, record.error.samples, record.error.metrics, record.error.paths,
                           device, record.error.first);
    if (record.unfinished > 0)
        return fmt::format("{}: at {} of {} samples the proxy did not come to rest within its limit of steps; their "
                           "forces are not to be trusted",
                           name, record.unfinished, record.samples);
    return {};
}

namespace {

Json times_of(const EngineTimes& engine, const VolumeTimings& volume) {
    return {{"plan", engine.plan},     {"compile", engine.compile},     {"upload", engine.upload},
            {"kernel", engine.kernel}, {"read_back", engine.read_back}, {"encode", volume.encode},
            {"flush", volume.flush},   {"verify", volume.read_back},    {"hash", volume.hash}};
}

EngineTimes engine_times_of(const Json& seconds) {
    return {seconds.at("compile"), seconds.at("upload"), seconds.at("kernel"), seconds.at("read_back"),
            seconds.at("plan")};
}

VolumeTimings volume_times_of(const Json& seconds) {
    return {seconds.at("encode"), seconds.at("flush"), seconds.at("verify"), seconds.at("hash")};
}

Json paths_json(const PathRecord& paths) {
    return {{"paths", paths.paths},
            {"steps", paths.steps},
            {"samples", paths.samples},
            {"samples_in_contact", paths.in_contact},
            {"unstable", paths.unstable},
            {"fell", paths.fell},
            {"began_inside", paths.began_inside},
            {"unfinished", paths.unfinished},
            {"stretch_m", paths.stretch},
            {"largest_force_N", paths.largest_force},
            {"work_J", paths.work},
            {"effort_J", paths.effort},
            {"mean_depth_m", paths.mean_depth},
            {"depth_deviation_m", paths.depth_deviation},
            {"oracle",
             {{"paths_compared", paths.error.paths},
              {"samples_compared", paths.error.samples},
              {"samples_differing", paths.error.differing},
              {"samples_beyond_bound", paths.error.beyond},
              {"metrics_differing", paths.error.metrics},
              {"largest_error_N", paths.error.largest},
              {"largest_force_N", paths.error.largest_force},
              {"first_difference", paths.error.first}}},
            {"seconds", times_of(paths.engine_times, paths.volume_times)}};
}

PathRecord paths_of(const Json& json) {
    PathRecord paths;
    paths.paths = json.at("paths");
    paths.steps = json.at("steps");
    paths.samples = json.at("samples");
    paths.in_contact = json.at("samples_in_contact");
    paths.unstable = json.at("unstable");
    paths.fell = json.at("fell");
    paths.began_inside = json.at("began_inside");
    paths.unfinished = json.at("unfinished");
    paths.stretch = json.at("stretch_m");
    paths.largest_force = json.at("largest_force_N");
    paths.work = json.at("work_J");
    paths.effort = json.at("effort_J");
    paths.mean_depth = json.at("mean_depth_m");
    paths.depth_deviation = json.at("depth_deviation_m");
    const Json& oracle = json.at("oracle");
    paths.error = {oracle.at("paths_compared"),       oracle.at("samples_compared"),  oracle.at("samples_differing"),
                   oracle.at("samples_beyond_bound"), oracle.at("metrics_differing"), oracle.at("largest_error_N"),
                   oracle.at("largest_force_N"),      oracle.at("first_difference")};
    paths.engine_times = engine_times_of(json.at("seconds"));
    paths.volume_times = volume_times_of(json.at("seconds"));
    return paths;
}

Json to_json(const CaseRecord& record) {
    Json json;
    json["case"] = record.name;
    json["fingerprint"] = record.fingerprint;
    json["parameters"] = Json::object();
    for (const auto& [key, value] : record.parameters)
        json["parameters"][key] = value;
    json["inputs"] = Json::array();
    for (const FileRecord& file : record.inputs)
        json["inputs"].push_back({{"name", file.name}, {"sha256", file.sha256}});
    json["precision"] = record.precision;
    json["engine"] = {{"kind", record.engine.engine},
                      {"device", record.engine.device},
                      {"uuid", record.engine.uuid},
                      {"driver", record.engine.driver}};
    json["files"] = Json::array();
    for (const FileRecord& file : record.files)
        json["files"].push_back({{"name", file.name}, {"sha256", file.sha256}, {"bytes", file.bytes}});
    json["omitted"] = record.omitted;
    json["voxels"] = record.voxels;
    json["voxels_evaluated"] = record.evaluated;
    json["largest_force_N"] = record.largest_force;
    json["largest_force_voxel"] = record.largest_voxel;
    json["oracle"] = {{"voxels_compared", record.error.compared},   {"voxels_differing", record.error.differing},
                      {"voxels_beyond_bound", record.error.beyond}, {"voxels_on_edge", record.error.on_edge},
                      {"largest_error_N", record.error.largest},    {"largest_force_N", record.error.largest_force},
                      {"relative_error", record.error.relative()}};
    json["seconds"] = times_of(record.engine_times, record.volume_times);
    if (record.paths)
        json["paths"] = paths_json(*record.paths);
    return json;
}

CaseRecord from_json(const Json& json) {
    CaseRecord record;
    record.name = json.at("case");
    record.fingerprint = json.at("fingerprint");
    for (const auto& [key, value] : json.at("parameters").items())
        record.parameters.emplace_back(key, value);
    for (const Json& file : json.at("inputs"))
        record.inputs.push_back({file.at("name"), file.at("sha256"), 0});
    record.precision = json.at("precision");
    const Json& engine = json.at("engine");
    record.engine = {engine.at("kind"), engine.at("device"), engine.at("uuid"), engine.at("driver")};
    for (const Json& file : json.at("files"))
        record.files.push_back({file.at("name"), file.at("sha256"), file.at("bytes")});
    record.omitted = json.at("omitted").get<std::vector<std::string>>();
    record.voxels = json.at("voxels");
    record.evaluated = json.at("voxels_evaluated");
    record.largest_force = json.at("largest_force_N");
    record.largest_voxel = json.at("largest_force_voxel");
    const Json& oracle = json.at("oracle");
    record.error = {oracle.at("voxels_compared"), oracle.at("voxels_differing"), oracle.at("voxels_beyond_bound"),
                    oracle.at("voxels_on_edge"),  oracle.at("largest_error_N"),  oracle.at("largest_force_N")};
    record.engine_times = engine_times_of(json.at("seconds"));
    record.volume_times = volume_times_of(json.at("seconds"));
    if (json.contains("paths"))
        record.paths = paths_of(json.at("paths"));
    return record;
}

} // namespace

std::string complaint(const CaseRecord& record) {
    if (record.error.beyond == 0)
        return record.paths ? complaint(*record.paths, record.name, record.engine.device) : std::string();
    return fmt::format("{}: {} of {} voxels compared are further from the CPU oracle than rounding allows on {}; its "
                       "volume is not to be trusted (forceshade validate tells more)",
                       record.name, record.error.beyond, record.error.compared, record.engine.device);
}

std::filesystem::path record_path(const std::filesystem::path& folder, const std::string& name) {
    return folder / "manifest.d" / (name + ".json");
}

std::string record_json(const CaseRecord& record) {
    return to_json(record).dump(2);
}

void write_record(const std::filesystem::path& folder, const CaseRecord& record) {
    write_file_atomically(record_path(folder, record.name), record_json(record) + "\n");
}

std::optional<CaseRecord> read_record(const std::filesystem::path& folder, const std::string& name) {
    try {
        std::optional<CaseRecord> record = record_of(read_json(record_path(folder, name)));
        return record && record->name == name ? record : std::nullopt;
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::optional<CaseRecord> record_of(const nlohmann::ordered_json& json) {
    try {
        CaseRecord record = from_json(json);
        if (!record.files.empty())
            return record;
    } catch (const Json::exception&) {
        // Damaged: as if it were not there, so that the case is done again.
    }
    return std::nullopt;
}

} // namespace forceshade

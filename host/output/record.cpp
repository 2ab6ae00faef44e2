#include "host/output/record.h"

#include <algorithm>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/output/files.h"
#include "host/output/json.h"

namespace forceshade {

double PathRecord::steps_per_second() const {
    const double seconds = engine_times.upload + engine_times.kernel + engine_times.read_back;
    return seconds > 0 ? double(samples) / seconds : 0;
}

std::string CaseRecord::parameter(std::string_view key) const {
    const auto found = std::ranges::find(parameters, key, [](const auto& one) { return one.first; });
    return found == parameters.end() ? "" : found->second;
}

std::string error_text(const PathRecord& record, const std::string& name, const std::string& device) {
    if (!record.error.passed())
        return fmt::format("{}: {} of {} samples and the metrics of {} of {} paths compared are further from the CPU "
                           "oracle than rounding allows on {} ({}); do not trust it (details: forceshade validate)",
                           name, record.error.beyond, record.error.samples, record.error.metrics, record.error.paths,
                           device, record.error.first);
    if (record.unfinished > 0)
        return fmt::format("{}: at {} of {} samples the proxy did not come to rest within its limit of steps; do not "
                           "trust their forces",
                           name, record.unfinished, record.samples);
    return {};
}

namespace {

// A list of fields serves both directions: `field(name, member)` writes a member into JSON, or reads it.

struct JsonWriter {
    Json& json;
    template <typename T> void operator()(const char* name, const T& value) const { json[name] = value; }
    JsonWriter part(const char* name) const { return {json[name]}; }
};
struct JsonReader {
    const Json& json;
    template <typename T> void operator()(const char* name, T& value) const {
        if constexpr (Whole<T>)
            read_whole(json.at(name), value);
        else if constexpr (std::is_floating_point_v<T>)
            value = json.at(name).is_null() ? NAN : json.at(name).get<T>(); // JSON has no other word for it
        else
            json.at(name).get_to(value);
    }
    JsonReader part(const char* name) const { return {json.at(name)}; }
};

template <typename Field, typename Engine, typename Volume>
void list_times(const Field& field, Engine& engine, Volume& volume) {
    field("prepare", engine.prepare);
    field("plan", engine.plan);
    field("compile", engine.compile);
    field("upload", engine.upload);
    field("kernel", engine.kernel);
    field("read_back", engine.read_back);
    field("encode", volume.encode);
    field("flush", volume.flush);
    field("verify", volume.read_back);
    field("hash", volume.hash);
    field("check", volume.check);
}

template <typename Field, typename Deviation> void list_deviation(const Field& field, Deviation& deviation) {
    field("angles", deviation.angles);
    field("rms_angle_deg", deviation.rms_angle);
    field("largest_angle_deg", deviation.largest_angle);
    field("magnitudes", deviation.magnitudes);
    field("rms_magnitude_error_N", deviation.rms_magnitude_error);
    field("largest_magnitude_error_N", deviation.largest_magnitude_error);
}

template <typename Field, typename Number> void list_drawn(const Field& field, Number& number) {
    field("value", number.value);
    field("low", number.low);
    field("high", number.high);
}

template <typename Field, typename Touch> void list_touch(const Field& field, Touch& touch) {
    field("against", touch.against);
    field("places", touch.places);
    field("draws", touch.draws);
    field("deepest_m", touch.deepest);
    list_drawn(field.part("direction_rms_deg"), touch.direction);
    list_drawn(field.part("force_error_median"), touch.median_error);
    list_drawn(field.part("force_error_p95"), touch.p95_error);
    list_drawn(field.part("missed_share"), touch.missed);
}

template <typename Field, typename Paths> void list_paths(const Field& field, Paths& paths) {
    field("paths", paths.paths);
    field("steps", paths.steps);
    field("samples", paths.samples);
    field("samples_in_contact", paths.in_contact);
    field("unstable", paths.unstable);
    field("fell", paths.fell);
    field("began_inside", paths.began_inside);
    field("unfinished", paths.unfinished);
    field("stretch_m", paths.stretch);
    field("largest_force_N", paths.largest_force);
    field("work_J", paths.work);
    field("effort_J", paths.effort);
    field("mean_depth_m", paths.mean_depth);
    field("depth_deviation_m", paths.depth_deviation);
    const Field oracle = field.part("oracle");
    oracle("paths_compared", paths.error.paths);
    oracle("samples_compared", paths.error.samples);
    oracle("samples_differing", paths.error.differing);
    oracle("samples_beyond_bound", paths.error.beyond);
    oracle("metrics_differing", paths.error.metrics);
    oracle("largest_error_N", paths.error.largest);
    oracle("largest_force_N", paths.error.largest_force);
    oracle("first_difference", paths.error.first);
    list_times(field.part("seconds"), paths.engine_times, paths.volume_times);
}

// Of a case, all that stands in its record under one name: without parameters, files and inputs.
template <typename Field, typename Record> void list_case(const Field& field, Record& record) {
    field("omitted", record.omitted);
    field("voxels", record.voxels);
    field("voxels_evaluated", record.evaluated);
    field("largest_force_N", record.largest_force);
    field("largest_force_voxel", record.largest_voxel);
    const Field oracle = field.part("oracle");
    oracle("voxels_compared", record.error.compared);
    oracle("voxels_differing", record.error.differing);
    oracle("voxels_beyond_bound", record.error.beyond);
    oracle("voxels_on_edge", record.error.on_edge);
    oracle("largest_error_N", record.error.largest);
    oracle("largest_force_N", record.error.largest_force);
    list_times(field.part("seconds"), record.engine_times, record.volume_times);
}

template <typename Field, typename Engine> void list_engine(const Field& field, Engine& engine) {
    field("kind", engine.engine);
    field("device", engine.device);
    field("uuid", engine.uuid);
    field("driver", engine.driver);
}

Json deviation_json(const DeviationRecord& deviation) {
    Json json{{"from", deviation.from}, {"depth_m", deviation.depth}};
    list_deviation(JsonWriter{json}, deviation);
    return json;
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
    list_engine(JsonWriter{json["engine"]}, record.engine);
    json["files"] = record.files;
    list_case(JsonWriter{json}, record);
    json["oracle"]["relative_error"] = record.error.relative();
    if (record.deviation)
        json["compare"] = deviation_json(*record.deviation);
    if (record.touch)
        list_touch(JsonWriter{json["touch"]}, *record.touch);
    json["evaluations_saved"] = record.share_saved();
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
    list_engine(JsonReader{json.at("engine")}, record.engine);
    json.at("files").get_to(record.files);
    list_case(JsonReader{json}, record);
    const auto read_deviation = [](const Json& from, std::optional<DeviationRecord>& deviation) {
        if (!from.contains("compare"))
            return;
        list_deviation(JsonReader{from.at("compare")}, deviation.emplace());
        deviation->from = from.at("compare").value("from", deviation->from); // older records do not say
        deviation->depth = from.at("compare").value("depth_m", deviation->depth);
    };
    read_deviation(json, record.deviation);
    if (json.contains("touch") && json.at("touch").contains("draws")) // without them it is an older record's
        list_touch(JsonReader{json.at("touch")}, record.touch.emplace());
    if (json.contains("paths")) {
        list_paths(JsonReader{json.at("paths")}, record.paths.emplace());
        read_deviation(json.at("paths"), record.paths->deviation);
    }
    return record;
}

} // namespace

nlohmann::ordered_json paths_json(const PathRecord& paths) {
    Json json;
    list_paths(JsonWriter{json}, paths);
    if (paths.deviation)
        json["compare"] = deviation_json(*paths.deviation);
    return json;
}

std::string deviation_text(const DeviationRecord& deviation) {
    if (deviation.magnitudes == 0)
        return fmt::format("compared with the shape of [compare]: contact is nowhere as little as {:.3g} mm deep "
                           "(compare.depth)\n",
                           1e3 * deviation.depth);
    return fmt::format("compared with {}, where contact is at most {:.3g} mm deep (compare.depth): direction "
                       "{:.3g} deg (RMS), {:.3g} at most, at {} places; magnitude {:.3g} N (RMS), {:.3g} at most, at "
                       "{}, including where the shape alone has contact\n",
                       deviation.from, 1e3 * deviation.depth, deviation.rms_angle, deviation.largest_angle,
                       deviation.angles, deviation.rms_magnitude_error, deviation.largest_magnitude_error,
                       deviation.magnitudes);
}

std::string error_text(const CaseRecord& record) {
    if (record.error.beyond == 0)
        return record.paths ? error_text(*record.paths, record.name, record.engine.device) : std::string();
    return fmt::format("{}: {} of {} voxels compared are further from the CPU oracle than rounding allows on {}; do "
                       "not trust its volume (details: forceshade validate)",
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

#include "host/sweep/record.h"

#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/io/temporary_file.h"

namespace forceshade {
namespace {

using Json = nlohmann::ordered_json;

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
    json["seconds"] = {{"plan", record.engine_times.plan},
                       {"compile", record.engine_times.compile},
                       {"upload", record.engine_times.upload},
                       {"kernel", record.engine_times.kernel},
                       {"read_back", record.engine_times.read_back},
                       {"encode", record.volume_times.encode},
                       {"flush", record.volume_times.flush},
                       {"verify", record.volume_times.read_back},
                       {"hash", record.volume_times.hash}};
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
    const Json& seconds = json.at("seconds");
    record.engine_times = {seconds.at("compile"), seconds.at("upload"), seconds.at("kernel"), seconds.at("read_back"),
                           seconds.at("plan")};
    record.volume_times = {seconds.at("encode"), seconds.at("flush"), seconds.at("verify"), seconds.at("hash")};
    return record;
}

} // namespace

std::string complaint(const CaseRecord& record) {
    if (record.error.beyond == 0)
        return {};
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
    std::ifstream file(record_path(folder, name), std::ios::binary);
    if (!file)
        return std::nullopt;
    std::ostringstream text;
    text << file.rdbuf();
    try {
        CaseRecord record = from_json(Json::parse(text.str()));
        if (record.name == name && !record.files.empty())
            return record;
    } catch (const Json::exception&) {
        // Damaged: as if it were not there, so that the case is done again.
    }
    return std::nullopt;
}

} // namespace forceshade

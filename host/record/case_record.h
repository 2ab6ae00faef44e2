// What is known of a finished case: kept beside the volumes, one small JSON file a case, and merged into the manifest.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/record/path_record.h"

namespace forceshade {

/// Of the layout of manifest.json.
inline constexpr int kManifestFormat = 1;

struct CaseRecord {
    std::string name;
    std::string fingerprint; /* of everything that decides the bytes: scene, images, program, engine */
    std::vector<std::pair<std::string, std::string>> parameters; /* what varies */
    std::vector<FileRecord> inputs;                              /* files that the scene names; bytes are not told */
    std::string precision;
    EngineReport engine;
    std::vector<FileRecord> files; /* the volume first, the paths' last */
    std::vector<std::string> omitted;
    std::uint64_t voxels = 0;    /* of the grid */
    std::uint64_t evaluated = 0; /* by the engine */
    double largest_force = 0;    /* N */
    std::array<std::uint64_t, 3> largest_voxel{};
    OracleError error;               /* against the oracle */
    std::optional<PathRecord> paths; /* without files, which stand above, and warnings */
    EngineTimes engine_times;
    VolumeTimings volume_times;
};

/// What is wrong with a case whose field or paths are further from the oracle than rounding allows; empty where nothing
/// is.
std::string complaint(const CaseRecord& record);

/// `FOLDER/manifest.d/CASE.json`
std::filesystem::path record_path(const std::filesystem::path& folder, const std::string& name);

/// \throws IoError.
void write_record(const std::filesystem::path& folder, const CaseRecord& record);

/// Nothing if there is none or it cannot be understood.
std::optional<CaseRecord> read_record(const std::filesystem::path& folder, const std::string& name);

/// Of one record. Nothing if it cannot be understood.
std::optional<CaseRecord> record_of(const nlohmann::ordered_json& json);

/// The record as JSON text, one object.
std::string record_json(const CaseRecord& record);

} // namespace forceshade

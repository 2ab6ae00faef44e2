// What an engine reports of itself and of its work.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/output/files.h"
#include "host/output/rows.h"

namespace forceshade {

/// Where the time of a field went, s.
struct EngineTimes {
    double compile = 0, upload = 0, kernel = 0, read_back = 0;
    double prepare = 0;                 /* reading images and meshes, and putting a mesh into its tree */
    double plan = 0;                    /* of a mesh: where there is force, and what is near */
    std::uint64_t voxels_evaluated = 0; /* of a mesh; the others were found free as whole blocks */
    std::uint64_t host_updates = 0;     /* of proxies on a mesh, which a kernel of paths left to the host */
    std::uint64_t uploaded = 0;         /* bytes copied to a device: tables, plans, recorded positions */
    std::uint32_t group = 0;            /* invocations of a work group of the last dispatch */

    double sum() const { return prepare + plan + compile + upload + kernel + read_back; } /* s */
};

struct EngineReport {
    std::string engine; /* "gpu" or "cpu" */
    std::string device; /* name */
    std::string uuid;   /* of a Vulkan device */
    std::string driver;
    bool software = true; /* results must equal the oracle's bit for bit */
    bool f64 = true;      /* evaluates in double precision */
};

// How far what was evaluated lies from the oracle.

/// Of a field.
struct OracleError {
    std::uint64_t compared = 0;  /* voxels */
    std::uint64_t differing = 0; /* voxels whose bits are not the oracle's in the same precision */
    std::uint64_t beyond = 0;    /* of them, those further from it than rounding allows: on a software device all */
    std::uint64_t on_edge = 0; /* voxels as near to another facet of a mesh, or to its surface, as rounding reaches, or
                                  rounded to the other side of an edge: their error is meaningless and not counted */
    double largest = 0;        /* N: largest |F - F_oracle|, the oracle in double */
    double largest_force = 0;  /* N: largest |F_oracle| among the voxels compared */

    /// The largest error over the largest force; 0 for a field without force.
    double relative() const { return largest_force > 0 ? largest / largest_force : 0; }
};

/// Of paths.
struct PathError {
    std::uint64_t paths = 0;     /* compared */
    std::uint64_t samples = 0;   /* compared */
    std::uint64_t differing = 0; /* samples any of whose channels differs in a bit */
    std::uint64_t beyond = 0;    /* samples further from the oracle than rounding allows: on a software device all that
                                    differ */
    std::uint64_t metrics = 0;   /* paths whose metrics differ: on a software device in a bit, else beyond rounding */
    double largest = 0;          /* N: largest |F - F_oracle| */
    double largest_force = 0;    /* N: of the oracle */
    std::string first;           /* where and what, for the first sample or path that is beyond */

    bool passed() const { return beyond == 0 && metrics == 0; }
};

/// Of the forces of a field or of paths from those of the shape of [compare], where contact is at most compare.depth
/// deep: root mean squares and largest sizes.
struct DeviationRecord {
    std::string from = "the shape of [compare]";                 /* and which normal and depth of it are meant */
    double depth = 0.002;                                        /* m: of contact, at most */
    std::uint64_t angles = 0;                                    /* samples with a force */
    double rms_angle = 0, largest_angle = 0;                     /* deg: between force and normal */
    std::uint64_t magnitudes = 0;                                /* samples in contact with surface or shape */
    double rms_magnitude_error = 0, largest_magnitude_error = 0; /* N */
};

/// As a line for people.
std::string deviation_text(const DeviationRecord& deviation);

/// A number of all drawn places, and the least and the largest of the draws; not a number without any.
struct DrawnNumber {
    double value = NAN, low = NAN, high = NAN;
};

/// The reference of errors where it is known; only then is less error closer to the truth.
inline constexpr const char* kSmoothShape = "the smooth shape";

/// How far the forces of a case are from those of the shape that its surface stands for, where a hand touches it.
struct TouchRecord {
    std::string against;      /* kSmoothShape, or the law that comes closest to it */
    std::uint64_t places = 0; /* of all draws: under points anywhere on the surface, depths log-uniform */
    std::uint64_t draws = 1;
    double deepest = 0;       /* m */
    DrawnNumber direction;    /* deg, root mean square; none where no place has a force */
    DrawnNumber median_error; /* 1: |F - F_true| / |F_true|, 1 where a force is missing */
    DrawnNumber p95_error;    /* 1: the same */
    DrawnNumber missed;       /* 1: of the places, those without the force that should be there */
};

// What is known of paths that were taken through an engine.

/// What became of paths.
struct PathRecord {
    std::uint64_t paths = 0;
    std::uint64_t steps = 0; /* of the longest */
    std::uint64_t samples = 0, in_contact = 0;
    double stretch = 0;                           /* m: the least distance over which turns of the force are counted */
    std::uint64_t unstable = 0, began_inside = 0; /* paths */
    std::uint64_t fell = 0;                       /* of the unstable ones */
    std::uint64_t unfinished = 0;                 /* samples */
    double largest_force = 0;                     /* N */
    double work = 0, effort = 0;                  /* J: sums over the paths */
    double depth_deviation = 0;                   /* m: root mean square of depth about its mean, in contact */
    double mean_depth = 0;                        /* m */
    std::optional<DeviationRecord> deviation;     /* with [compare], where samples are written */
    PathError error;
    std::vector<FileRecord> files; /* the samples first, unless metrics only */
    EngineTimes engine_times;
    VolumeTimings volume_times;
    std::vector<std::string> warnings;

    double steps_per_second() const; /* of the engine */
};

/// As an object, without its files.
nlohmann::ordered_json paths_json(const PathRecord& paths);

/// What is wrong with a run whose paths are further from the oracle than rounding allows, or hold samples whose proxy
/// never rested; else empty.
std::string error_text(const PathRecord& record, const std::string& name, const std::string& device);

// What is known of a finished case: kept next to the volumes, one small JSON file a case, and merged into the manifest.

/// Of the layout of manifest.json.
inline constexpr int kManifestFormat = 1;

/// Among what a mesh's field leaves out; in its record if any voxel was skipped for it.
inline constexpr const char* kFreeSpace = "blocks of free space";

struct CaseRecord {
    std::string name;
    std::string fingerprint; /* of everything that decides the bytes: scene, images, program, engine */
    std::vector<std::pair<std::string, std::string>> parameters; /* what varies */
    std::vector<FileRecord> inputs;                              /* files that the scene names; without bytes */
    std::string precision;
    EngineReport engine;
    std::vector<FileRecord> files; /* the volume first, the paths' last */
    std::vector<std::string> omitted;
    std::uint64_t voxels = 0;    /* of the grid */
    std::uint64_t evaluated = 0; /* by the engine */
    double largest_force = 0;    /* N */
    std::array<std::uint64_t, 3> largest_voxel{};
    OracleError error;                        /* against the oracle */
    std::optional<DeviationRecord> deviation; /* with [compare] */
    std::optional<TouchRecord> touch;         /* of a field whose box has a surface */
    std::optional<PathRecord> paths;          /* without files, which stand above; its warnings are in no file */
    EngineTimes engine_times;
    VolumeTimings volume_times;

    /// The value of one that varies, by its key; empty: it has none.
    std::string parameter(std::string_view key) const;
    /// Of the voxels, and modelled of their time, if each took as long as the others.
    double share_saved() const { return voxels == 0 ? 0 : 1 - double(evaluated) / double(voxels); }
};

/// What is wrong with a case whose field or paths are further from the oracle than rounding allows; else empty.
std::string error_text(const CaseRecord& record);

/// `FOLDER/manifest.d/CASE.json`
std::filesystem::path record_path(const std::filesystem::path& folder, const std::string& name);

/// \throws IoError.
void write_record(const std::filesystem::path& folder, const CaseRecord& record);

/// Empty if it is missing or cannot be understood.
std::optional<CaseRecord> read_record(const std::filesystem::path& folder, const std::string& name);

/// Of one record. Empty if it cannot be understood.
std::optional<CaseRecord> record_of(const nlohmann::ordered_json& json);

/// The record as JSON text, one object.
std::string record_json(const CaseRecord& record);

} // namespace forceshade

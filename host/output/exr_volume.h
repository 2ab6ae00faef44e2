// A field over a grid as an OpenEXR file: written in a stream, read back before it gets its name, and read in a stream.
// Width nx, height ny * nz, row = z * ny + y; parts `force` (R, G, B), `depth` (Z), `facet` (id), `proxy`, `unshaded`.
// Where places are not of the world, `forceshade.place_origin` (m) says what to add to them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "host/output/rows.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// How the file of a field or of paths is written, and what it states about the run.
struct ExrOptions {
    Compression compression = Compression::zip;
    PixelType pixel = PixelType::float32; /* of a field all but the facet ids; of paths force and depth: others float */
    std::string scene;                    /* the resolved TOML */
    std::string version;                  /* of the program */
    std::string omitted;                  /* what the scene did not need */
    int threads = 0;                      /* that compress this file; 0: it asks for no parallel work */
    glm::dvec3 place_origin{0};           /* m, in the world: what positions and proxies are measured from */
};

struct VolumeHeader : ExrOptions {
    std::array<std::uint64_t, 3> size{};            /* samples along x, y, z */
    std::array<double, 3> origin{};                 /* m: voxel (i, j, k) samples origin + spacing * (i, j, k) */
    std::array<double, 3> spacing{};                /* m */
    std::uint32_t channels = layout::kChannelForce; /* layout::kChannel... bits; force is always among them */
};

/// Peak memory is about 20 MiB plus a few rows, whatever the grid. The bytes of the file depend on the header and the
/// values alone: not on how the rows are cut into chunks, nor on the number of threads.
class VolumeWriter final : public ChunkSink {
public:
    /// Throws UsageError for a grid that an EXR cannot hold, IoError if the folder cannot be written.
    VolumeWriter(const std::filesystem::path& path, const VolumeHeader& header);
    ~VolumeWriter() override;

    /// Values are rounded to float.
    void write(const AnyFieldChunk& chunk, std::size_t repeat_y) override;

    /// Flushes to disk, reads back and compares, hashes, renames. A file of that name is not touched before the last
    /// step. Throws Error (exit 1) for NaN or infinite values, UsageError for values that a half cannot hold (both name
    /// the voxel), IoError if the disk is full or holds something else than was written.
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Reads what VolumeWriter wrote. Every method throws IoError for a file that is missing, truncated, corrupted or
/// foreign.
class VolumeReader {
public:
    explicit VolumeReader(const std::filesystem::path& path);
    ~VolumeReader();

    /// As it was written.
    const VolumeHeader& header() const noexcept;
    std::uint64_t rows() const noexcept; /* ny * nz */

    /// Rows [first, first + count) of a real channel into `values`: count x nx x components (3 for vectors, 1 for
    /// depth).
    void read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::vector<float>& values);
    /// The same for the facet ids, count x nx.
    void read_ids(std::uint64_t first, std::uint64_t count, std::vector<std::uint32_t>& ids);

private:
    struct State;
    std::unique_ptr<State> state_;
};

// Explored paths as an OpenEXR file: width = steps of the longest path, height = paths; parts `force` (R, G, B),
// `position`, `depth` (Z), `facet` (id), `proxy`. Written in a stream, read back before it gets its name.

struct PathVolumeHeader : ExrOptions {
    std::uint64_t steps = 0;    /* of the longest path */
    std::uint64_t paths = 0;    /* in the file */
    double rate = 0;            /* 1/s: samples a second; 0: they come at times of their own */
    std::uint32_t channels = 0; /* layout::kChannel... bits; force and position are always among them */
};

/// Behind a path's end reals are NaN, facets layout::kNoFacet; elsewhere NaN and infinity are refused. Peak memory is
/// about 20 MiB plus a few rows. The bytes depend on the header and the values alone.
class PathVolumeWriter final : public PathSink {
public:
    /// Throws UsageError for paths that an EXR cannot hold, IoError if the folder cannot be written.
    PathVolumeWriter(const std::filesystem::path& path, const PathVolumeHeader& header);
    ~PathVolumeWriter() override;
    /// Values are rounded to float.
    void write(const AnyPathRows& rows) override;
    /// As VolumeWriter::finish; `largest_voxel` is (step, path, 0).
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Whether a file has paths' positions, and so no grid. \throws IoError for a file that is missing or no EXR.
bool holds_paths(const std::filesystem::path& path);

/// Some of a file's paths, evenly chosen, and of each some samples, evenly. Behind a path's end stands NaN.
struct PathSamples {
    std::uint64_t paths = 0, steps = 0; /* here */
    std::uint64_t paths_in_file = 0;
    std::uint64_t every_path = 1, every_step = 1; /* of the file's, every which one is here */
    std::vector<float> force, position, proxy; /* N, m, m: three a sample, path after path; proxy empty if not stored */
    glm::dvec3 origin{0};                      /* m, in the world: what position and proxy are measured from */
    std::vector<float> depth;                  /* m: one a sample; empty if not stored, or not asked for */
    std::vector<float> angle, magnitude_error; /* deg, N: as depth */
    std::vector<std::uint32_t> facet;          /* as depth; layout::kNoFacet out of contact and behind a path's end */
    std::string scene;                         /* the resolved TOML */
};

/// At most `most_paths` paths of `most_steps` samples. `scalars`: also depth, facet, angle and magnitude_error. \throws
/// IoError for a file that is missing, damaged or foreign.
PathSamples read_paths(const std::filesystem::path& path, std::uint64_t most_paths, std::uint64_t most_steps,
                       bool scalars = false);

} // namespace forceshade

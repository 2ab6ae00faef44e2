// Explored paths as an OpenEXR file: width = steps of the longest path, height = paths; parts `force` (R, G, B),
// `position`, `depth` (Z), `facet` (id), `proxy`. Written in a stream, read back before it gets its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "host/output/path_rows.h"
#include "host/scene/scene.h"

namespace forceshade {

struct PathVolumeHeader {
    std::uint64_t steps = 0;    /* of the longest path */
    std::uint64_t paths = 0;    /* in the file */
    double rate = 0;            /* 1/s: samples a second; 0: they come at times of their own */
    std::uint32_t channels = 0; /* layout::kChannel... bits; force and position are always among them */
    Compression compression = Compression::zip;
    PixelType pixel = PixelType::float32; /* of force and depth; positions and proxies are always float */
    std::string scene;                    /* the resolved TOML */
    std::string version;                  /* of the program */
    std::string omitted;                  /* what the scene did not need */
    int threads = 0;                      /* that compress this file; 0: it asks for no parallel work */
};

/// Behind a path's end reals are NaN, facets layout::kNoFacet; elsewhere NaN and infinity are refused. Peak memory is
/// about 20 MiB plus a few rows. The bytes depend on the header and the values alone.
class PathVolumeWriter final : public PathSink {
public:
    /// Throws UsageError for paths that an EXR cannot hold, IoError if the folder cannot be written.
    PathVolumeWriter(const std::filesystem::path& path, const PathVolumeHeader& header);
    ~PathVolumeWriter() override;
    void write(const PathRows<float>& rows) override;
    /// Values are rounded to float.
    void write(const PathRows<double>& rows) override;
    /// As VolumeWriter::finish; `largest_voxel` is (step, path, 0).
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade

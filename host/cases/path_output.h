// What explored paths leave: the samples, a line for each path, what `--also` asks for, the record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cases/case_output.h"
#include "host/output/exr_volume.h"
#include "host/paths/path_files.h"

namespace forceshade {

struct PathRunOptions {
    std::filesystem::path samples;                 /* .exr or .csv; empty: metrics alone */
    std::filesystem::path stem;                    /* STEM.paths.csv and what else is asked for */
    std::string label;                             /* between stem and kind of further files: "" or ".paths" */
    std::optional<std::filesystem::path> recorded; /* in place of the scene's paths */
    AlsoFormats also;   /* not with metrics alone, and no VTI; VTP are polylines for ParaView */
    picture::Look look; /* of the picture; without a title: the case in words */
    int threads = 0;    /* that compress */
    std::function<void(std::uint64_t done, std::uint64_t total)> progress; /* samples; may be empty */
};

/// What the files of a run hold; `asked`: the scene's channels.
layout::uint path_channels(const PathRunOptions& options, layout::uint asked);

/// The names of the files of a run, the samples first.
std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels);

/// What files say of all paths.
struct WrittenPaths {
    std::uint64_t paths, steps; /* of the longest */
    std::uint64_t samples;      /* in all */
    double rate;                /* 1/s; 0: samples come at times of their own */
    PathLabels labels;
    std::string title; /* what paths they are, for a picture */
};

template <typename T> class PathOutput {
public:
    PathOutput(const PreparedCase& prepared, const PathRunOptions& options, const WrittenPaths& written);

    /// Rows as a RowGatherer hands them on; and what each path was like, when it has ended.
    void write(const PathRows<T>& rows);
    void add(std::uint64_t id, const PathFigures& figures) { summary_.add(id, figures); }

    /// Publishes every file, and adds them and what [compare] says to the record. \throws as FieldOutput::finish().
    void finish(PathRecord& record);

private:
    PathVolumeHeader header(layout::uint channels) const;

    PathRunOptions options_;
    WrittenPaths written_;
    glm::dvec3 origin_;           /* m, in the world: of the places of rows */
    CaseOutput<PathSink> output_; // the samples first, if they are asked for
    PathSummary summary_;
    std::optional<PathCollector> collector_;
};

extern template class PathOutput<float>;
extern template class PathOutput<double>;

} // namespace forceshade

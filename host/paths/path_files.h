// Explored paths as a CSV file, path after path.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/output/files.h"
#include "host/output/path_rows.h"
#include "host/output/rows.h"
#include "host/paths/path_figures.h"
#include "host/scene/scene.h"

namespace forceshade {

/// What a sample is called by.
struct PathLabels {
    std::function<std::uint64_t(std::uint64_t path)> id;
    std::function<double(std::uint64_t path, std::uint64_t step)> time; /* s; asked path after path, step after step */
};

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet (s, m, N); g is the proxy, facet -1 out of contact. Every number
/// is the shortest that reads back as the same float or double. Needs all five channels.
class PathCsvWriter final : public PathSink {
public:
    /// Throws IoError, as do the others.
    PathCsvWriter(const std::filesystem::path& path, const PathLabels& labels);
    void write(const PathRows<float>& rows) override { add(rows); }
    void write(const PathRows<double>& rows) override { add(rows); }
    VolumeResult finish() override;

private:
    template <typename T> void add(const PathRows<T>& rows);
    template <typename T> void add_sample(const PathRows<T>& rows, std::size_t path, std::size_t step);
    template <typename T> void number(T value, char after);

    TemporaryFile file_;
    PathLabels labels_;
    std::string text_;
};

// One channel of explored paths as a NumPy array, shape (paths, steps, 3) for vectors and (paths, steps) for scalars.

/// Reals as '<f4' or '<f8', facets as '<u4'; behind a path's end NaN and layout::kNoFacet.
class PathNpyWriter final : public PathSink {
public:
    /// `channel` is one layout::kChannel... bit. Throws IoError, as do the others.
    PathNpyWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps, std::uint32_t channel,
                  Precision precision);
    void write(const PathRows<float>& rows) override { add(rows); }
    void write(const PathRows<double>& rows) override { add(rows); }
    VolumeResult finish() override;

private:
    template <typename T> void add(const PathRows<T>& rows);

    TemporaryFile file_;
    std::uint64_t steps_;
    std::uint32_t channel_;
};

// STEM.paths.csv: a row for each path, what it was like.

/// Columns carry their unit in their name; a cell is empty where a number has no meaning. Numbers are the shortest that
/// read back as the same float or double.
class PathSummary {
public:
    /// `precision` of the run. \throws IoError, as do the others.
    PathSummary(const std::filesystem::path& path, Precision precision);
    void add(std::uint64_t path, const PathFigures& figures);
    /// Publishes.
    VolumeResult finish();

private:
    void number(double value);
    void number(const std::optional<double>& value);
    void time(const std::optional<double>& value);
    void whole(std::uint64_t value);

    TemporaryFile file_;
    Precision precision_;
    std::string text_;
};

/// The file's header line.
const char* path_summary_header();

} // namespace forceshade

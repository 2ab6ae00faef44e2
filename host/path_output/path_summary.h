// STEM.paths.csv: a row for each path, what it was like.
#pragma once

#include <filesystem>
#include <string>

#include "host/io/chunk_sink.h"
#include "host/io/temporary_file.h"
#include "host/path_output/path_figures.h"
#include "host/scene/scene.h"

namespace forceshade {

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

// Explored paths as a CSV file, path after path.
#pragma once

#include <functional>
#include <string>

#include "host/io/path_rows.h"
#include "host/io/temporary_file.h"

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

} // namespace forceshade

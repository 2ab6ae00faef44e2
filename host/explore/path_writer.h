// Explored paths as a CSV file: where the probe was, and what it felt there.
#pragma once

#include <filesystem>
#include <string>

#include "host/explore/path_law.h"
#include "host/explore/path_reader.h"
#include "host/io/temporary_file.h"

namespace forceshade {

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet (s, m, N); g is the proxy, facet -1 out of contact. Every number
/// is the shortest that reads back as the same double (t) or T; x, y, z are where the law was evaluated. Nothing stands
/// under the final name until publish().
class PathWriter {
public:
    /// \throws IoError, as do the others.
    explicit PathWriter(const std::filesystem::path& path);

    template <typename T> void add(const PathSample& sample, const reference::Contact<T>& contact);
    void publish();

private:
    template <typename T> void number(T value, char after);
    void flush();

    TemporaryFile file_;
    std::string text_;
};

extern template void PathWriter::add<float>(const PathSample&, const reference::Contact<float>&);
extern template void PathWriter::add<double>(const PathSample&, const reference::Contact<double>&);

} // namespace forceshade

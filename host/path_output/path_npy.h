// One channel of explored paths as a NumPy array, shape (paths, steps, 3) for vectors and (paths, steps) for scalars.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host/io/path_rows.h"
#include "host/io/temporary_file.h"
#include "host/scene/scene.h"

namespace forceshade {

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

} // namespace forceshade

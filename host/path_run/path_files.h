// Which channels and files a run of paths has.
#pragma once

#include <array>
#include <filesystem>

#include "host/path_run/path_run.h"

namespace forceshade {

/// What samples may hold, in the order of their files.
inline constexpr std::array kPathChannels{layout::kChannelForce, layout::kChannelPosition, layout::kChannelDepth,
                                          layout::kChannelFacet, layout::kChannelProxy};

bool is_csv(const std::filesystem::path& path);

/// What must be computed for the files; `asked`: the scene's channels.
layout::uint channels_for(const PathRunOptions& options, layout::uint asked);

/// Of positions; empty: the paths are generated.
std::filesystem::path recorded_file(const Scene& scene, const PathRunOptions& options);

} // namespace forceshade

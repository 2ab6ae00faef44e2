#include "host/path_run/path_files.h"

#include <fmt/format.h>

#include "host/io/chunk_rows.h"

namespace forceshade {
namespace {

constexpr layout::uint kSampled = layout::kChannelForce | layout::kChannelPosition | layout::kChannelDepth |
                                  layout::kChannelFacet | layout::kChannelProxy;
constexpr layout::uint kAlways = layout::kChannelForce | layout::kChannelPosition;

} // namespace

bool is_csv(const std::filesystem::path& path) {
    return path.extension() == ".csv";
}

layout::uint channels_for(const PathRunOptions& options, layout::uint asked) {
    if (options.samples.empty())
        return 0;
    return is_csv(options.samples) ? kSampled : (asked & kSampled) | kAlways;
}

std::filesystem::path recorded_file(const Scene& scene, const PathRunOptions& options) {
    if (options.recorded)
        return *options.recorded;
    if (scene.paths && scene.paths->kind == PathKind::recorded)
        return scene.paths->path;
    return {};
}

std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels) {
    std::vector<std::string> names;
    const std::string stem = options.stem.filename().string();
    if (!options.samples.empty())
        names.push_back(options.samples.filename().string());
    names.push_back(stem + ".paths.csv");
    if (options.npy)
        for (const layout::uint channel : kPathChannels)
            if (channels_for(options, channels) & channel)
                names.push_back(fmt::format("{}{}.{}.npy", stem, options.label, name_of_channel(channel)));
    if (options.png)
        names.push_back(stem + ".paths.png");
    return names;
}

} // namespace forceshade

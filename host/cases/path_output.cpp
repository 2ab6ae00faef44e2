#include "host/cases/path_output.h"

#include <algorithm>
#include <iterator>

#include "host/cases/case_files.h"
#include "host/cases/path_comparison.h"

namespace forceshade {
namespace {

constexpr layout::uint kAlways = layout::kChannelForce | layout::kChannelPosition;

bool is_csv(const std::filesystem::path& path) {
    return path.extension() == ".csv";
}

} // namespace

layout::uint path_channels(const PathRunOptions& options, layout::uint asked) {
    if (options.samples.empty())
        return 0;
    return is_csv(options.samples) ? kSampled | (asked & kComparedChannels)
                                   : (asked & (kSampled | kComparedChannels)) | kAlways;
}

std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels) {
    std::vector<std::string> names;
    const std::string stem = options.stem.filename().string();
    if (!options.samples.empty())
        names.push_back(options.samples.filename().string());
    names.push_back(stem + ".paths.csv");
    if (options.also.npy)
        for (const layout::uint channel : kPathChannels)
            if (path_channels(options, channels) & channel)
                names.push_back(stem + options.label + npy_kind(channel));
    if (options.also.vtp)
        names.push_back(stem + options.label + ".vtp");
    std::ranges::move(picture::names_with(stem + ".paths", options.also.pictures), std::back_inserter(names));
    return names;
}

template <typename T>
PathOutput<T>::PathOutput(const PreparedCase& prepared, const PathRunOptions& options, const WrittenPaths& written)
    : options_(options), written_(written), origin_(scene_origin(prepared)),
      output_(prepared, options.stem, options.also.pictures, options.look, static_cast<unsigned>(options.threads),
              !options.samples.empty()),
      summary_(output_.path_of(".paths.csv"), prepared.one.scene.precision) {
    const Scene& scene = prepared.one.scene;
    const bool compared = scene.compare.has_value();
    const layout::uint channels = path_channels(options, written_channels(scene));
    if (is_csv(options.samples))
        output_.template open<PathCsvWriter>(options.samples, written_.labels, origin_, compared);
    else if (!options.samples.empty())
        output_.template open<PathVolumeWriter>(options.samples, header(channels));
    if (options.also.npy)
        for (const layout::uint channel : kPathChannels)
            if (channels & channel)
                output_.template open<PathNpyWriter>(output_.path_of(options.label + npy_kind(channel)), written_.paths,
                                                     written_.steps, channel, scene.precision, origin_);
    if (options.also.vtp)
        output_.template open<PathVtpWriter>(output_.path_of(options.label + ".vtp"),
                                             PathVtpHeader{written_.paths, written_.samples,
                                                           (channels & layout::kChannelProxy) != 0, scene.precision,
                                                           compared, origin_},
                                             written_.labels);
    if (options.also.pictures.any())
        collector_.emplace(written_.paths, written_.steps, origin_);
}

template <typename T> PathVolumeHeader PathOutput<T>::header(layout::uint channels) const {
    PathVolumeHeader header;
    header.steps = written_.steps;
    header.paths = written_.paths;
    header.rate = written_.rate;
    header.channels = channels;
    Scene of_paths = output_.scene();
    of_paths.field = false;
    set_options(header, output_.prepared(), of_paths, options_.threads);
    return header;
}

template <typename T> void PathOutput<T>::write(const PathRows<T>& rows) {
    Compared* const compared = output_.compared();
    output_.write(compared ? compared->paths(rows) : rows);
    if (collector_)
        collector_->add(rows);
}

template <typename T> void PathOutput<T>::finish(PathRecord& record) {
    if (!options_.samples.empty())
        output_.finish_first(record);
    add_file(record, output_.path_of(".paths.csv").filename().string(), summary_.finish());
    output_.finish_others(record);
    if (!collector_)
        return;
    const PathCollector::Reach reach = collector_->reach();
    const double border = std::max(0.05 * (reach.to - reach.from), 1e-9);
    const PreparedCase& prepared = output_.prepared();
    const picture::Look look = output_.look(fmt::format("{}, {}", picture::title_of(prepared.one), written_.title));
    const picture::SurfaceLines lines = surface_lines(prepared, {reach.from - border, reach.to + border, reach.y});
    output_.draw(".paths", collector_->draw(look, lines), record);
}

template class PathOutput<float>;
template class PathOutput<double>;

} // namespace forceshade

#include "host/cases/field_output.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "host/cases/surface_file.h"
#include "host/clock.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/output/raw_formats.h"
#include "host/picture/scene_picture.h"
#include "host/picture/ticks.h"

namespace forceshade {
namespace {

VolumeHeader volume_header(const PreparedCase& prepared, int threads) {
    const Scene& scene = prepared.one.scene;
    VolumeHeader header;
    header.size = scene.grid.size;
    header.origin = scene.grid.origin;
    header.spacing = scene.grid.spacing;
    header.channels = written_channels(scene);
    set_options(header, prepared, scene, threads);
    return header;
}

// m: the middle sample, rounded down.
double middle_y(const GridSpec& grid) {
    return grid.origin[1] + grid.spacing[1] * static_cast<double>((grid.size[1] - 1) / 2);
}

bool stands_for_all_y(const Scene& scene) {
    return !depends_on_y(features_of(scene));
}

} // namespace

FieldOutput::FieldOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also,
                         const PictureChoice& pictures, int threads, bool exact_bits)
    : prepared_(prepared), volume_(volume), also_(also), pictures_(pictures), threads_(std::max(1, threads)),
      check_(prepared, exact_bits) {
    const Scene& scene = prepared.one.scene;
    const bool repeats = stands_for_all_y(scene);
    repeat_y_ = repeats ? scene.grid.size[1] : 1;
    evaluated_ = scene.grid.size[0] * scene.grid.size[2] * (repeats ? 1 : scene.grid.size[1]);
    const VolumeHeader header = volume_header(prepared, threads);
    const std::filesystem::path folder = volume.parent_path();
    const std::string stem = volume.stem().string();
    sinks_.add(volume, std::make_unique<VolumeWriter>(volume, header));
    if (also.vti) {
        const std::filesystem::path file = folder / (stem + ".vti");
        sinks_.add(file,
                   std::make_unique<VtiWriter>(file, VtiHeader{header.size, header.origin, header.spacing,
                                                               header.channels, scene.precision, header.place_origin}));
    }
    if (also.npy)
        for (const layout::uint channel : kFieldChannels)
            if (header.channels & channel) {
                const std::filesystem::path file = folder / fmt::format("{}.{}.npy", stem, name_of_channel(channel));
                sinks_.add(file, std::make_unique<NpyWriter>(file, header.size, channel, scene.precision,
                                                             header.place_origin));
            }
    if (scene.compare)
        compared_.emplace(prepared, static_cast<unsigned>(threads_));
    if (also.pictures.any())
        slices_ = std::make_unique<picture::SliceCollector>(scene.grid, repeats, pictures.slice);
}

template <typename T> void FieldOutput::write(const layout::FieldChunk<T>& chunk) {
    const auto write = [&](const layout::FieldChunk<T>& rows, std::size_t repeat_y) { sinks_.write(rows, repeat_y); };
    if (compared_)
        compared_->field<T>(chunk, repeat_y_, write);
    else
        write(chunk, repeat_y_);
    if (slices_)
        slices_->add(chunk);
    timed(checking_, [&] { check_.add(chunk); });
}

template void FieldOutput::write<float>(const layout::FieldChunk<float>&);
template void FieldOutput::write<double>(const layout::FieldChunk<double>&);

CaseRecord FieldOutput::finish() {
    const Scene& scene = prepared_.one.scene;
    CaseRecord record = empty_record(prepared_);
    record.voxels = scene.grid.size[0] * scene.grid.size[1] * scene.grid.size[2];
    record.evaluated = evaluated_;
    timed(checking_, [&] { record.error = check_.compare(static_cast<unsigned>(threads_)); });
    const VolumeResult volume = sinks_.finish_first(record);
    record.largest_force = volume.largest_force;
    record.largest_voxel = volume.largest_voxel;
    sinks_.finish_others(record);
    if (compared_)
        record.deviation = compared_->record();
    record.volume_times.check = checking_;
    if (also_.vtp)
        add_surface(record);
    if (slices_)
        add_pictures(record);
    return record;
}

void FieldOutput::add_surface(CaseRecord& record) {
    const Stage stage("writing the surface of " + prepared_.one.name);
    const std::string name = volume_.stem().string() + ".vtp";
    const VolumeResult result = write_surface(volume_.parent_path() / name, prepared_);
    record.files.push_back({name, result.sha256, result.bytes});
}

void FieldOutput::add_pictures(CaseRecord& record) {
    const Stage stage("drawing " + prepared_.one.name);
    const picture::FieldSlice &slice = slices_->slice(), &unshaded = slices_->unshaded();
    const picture::Quantity quantity = pictures_.slice.quantity;
    const picture::SurfaceLines lines =
        pictures_.slice.axis == 1 ? surface_lines(prepared_, slice.axes.at) : picture::SurfaceLines{};
    const auto look = [&](bool with_shading, const char* more) {
        picture::Look titled = pictures_.look;
        if (titled.title.empty())
            titled.title = picture::title_of(prepared_.one, with_shading) + more;
        return titled;
    };
    const auto add = [&](const char* kind, const picture::Picture& drawn) {
        const std::filesystem::path stem = volume_.parent_path() / (volume_.stem().string() + kind);
        std::ranges::move(picture::write_picture(stem, also_.pictures, drawn), std::back_inserter(record.files));
    };
    add(".mosaic", picture::draw_mosaic(look(true, ""), slices_->tiles(), quantity));
    add(".arrows", picture::draw_arrows(look(true, ""), slice, lines, quantity, unshaded));
    const double y = pictures_.slice.axis == 1 ? slice.axes.at : middle_y(prepared_.one.scene.grid);
    const SceneStroke stroke = stroke_of(prepared_, y);
    const std::string depth = numbers::quantity_text(stroke.depth, "m");
    const std::string at_y =
        picture::position_labels("y", {y}, slice.axes.at_spacing, numbers::choose_unit(stroke.depth, "m")).front();
    add(".stroke", picture::draw_stroke(look(true, ", stroked along x"),
                                        {fmt::format("probe {} below the surface, {}", depth, at_y)}, stroke.forces,
                                        prepared_.one.scene.force.shading != Shading::none));
    if (!unshaded.force.empty())
        add(".shading", picture::draw_shading(look(false, ": what shading changes"), unshaded, slice, lines));
}

} // namespace forceshade

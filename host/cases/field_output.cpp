#include "host/cases/field_output.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/cases/case_files.h"
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
    const std::size_t middle = (grid.size[1] - 1) / 2;
    return grid.origin[1] + grid.spacing[1] * static_cast<double>(middle);
}

bool stands_for_all_y(const Scene& scene) {
    return !depends_on_y(features_of(scene));
}

} // namespace

FieldOutput::FieldOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also,
                         const PictureChoice& pictures, int threads, bool exact_bits)
    : output_(prepared, volume.parent_path() / volume.stem(), also.pictures, pictures.look,
              static_cast<unsigned>(std::max(1, threads))),
      also_vtp_(also.vtp), slice_(pictures.slice), threads_(std::max(1, threads)), check_(prepared, exact_bits) {
    const Scene& scene = prepared.one.scene;
    const bool repeats = stands_for_all_y(scene);
    repeat_y_ = repeats ? scene.grid.size[1] : 1;
    evaluated_ = scene.grid.size[0] * scene.grid.size[2] * (repeats ? 1 : scene.grid.size[1]);
    const VolumeHeader header = volume_header(prepared, threads);
    output_.open<VolumeWriter>(volume, header);
    if (also.vti)
        output_.open<VtiWriter>(output_.path_of(".vti"),
                                VtiHeader{header.size, header.origin, header.spacing, header.channels, scene.precision,
                                          header.place_origin});
    if (also.npy)
        for (const layout::uint channel : kFieldChannels)
            if (header.channels & channel)
                output_.open<NpyWriter>(output_.path_of(npy_kind(channel)), header.size, channel, scene.precision,
                                        header.place_origin);
    if (also.pictures.any())
        slices_ = std::make_unique<picture::SliceCollector>(scene.grid, repeats, pictures.slice);
}

template <typename T> void FieldOutput::write(const layout::FieldChunk<T>& chunk) {
    const auto write = [&](const layout::FieldChunk<T>& rows, std::size_t repeat_y) { output_.write(rows, repeat_y); };
    if (Compared* const compared = output_.compared())
        compared->field<T>(chunk, repeat_y_, write);
    else
        write(chunk, repeat_y_);
    if (slices_)
        slices_->add(chunk);
    timed(checking_, [&] { check_.add(chunk); });
}

template void FieldOutput::write<float>(const layout::FieldChunk<float>&);
template void FieldOutput::write<double>(const layout::FieldChunk<double>&);

CaseRecord FieldOutput::finish() {
    const Scene& scene = output_.scene();
    CaseRecord record = empty_record(output_.prepared());
    record.voxels = scene.grid.size[0] * scene.grid.size[1] * scene.grid.size[2];
    record.evaluated = evaluated_;
    timed(checking_, [&] { record.error = check_.compare(static_cast<unsigned>(threads_)); });
    const VolumeResult volume = output_.finish_first(record);
    record.largest_force = volume.largest_force;
    record.largest_voxel = volume.largest_voxel;
    output_.finish_others(record);
    record.volume_times.check = checking_;
    if (also_vtp_)
        add_surface(record);
    if (slices_)
        add_pictures(record);
    return record;
}

void FieldOutput::add_surface(CaseRecord& record) {
    const Stage stage("writing the surface of " + output_.prepared().one.name);
    const std::filesystem::path file = output_.path_of(".vtp");
    const VolumeResult result = write_surface(file, output_.prepared());
    record.files.push_back({file.filename().string(), result.sha256, result.bytes});
}

void FieldOutput::add_pictures(CaseRecord& record) {
    const PreparedCase& prepared = output_.prepared();
    const Stage stage("drawing " + prepared.one.name);
    const picture::FieldSlice &slice = slices_->slice(), &unshaded = slices_->unshaded();
    const picture::SurfaceLines lines =
        slice_.axis == 1 ? surface_lines(prepared, slice.axes.at) : picture::SurfaceLines{};
    const auto look = [&](bool with_shading, const char* more = "") {
        return output_.look(picture::title_of(prepared.one, with_shading) + more);
    };
    output_.draw(".mosaic", picture::draw_mosaic(look(true), slices_->tiles(), slice_.quantity), record);
    output_.draw(".arrows", picture::draw_arrows(look(true), slice, lines, slice_.quantity, unshaded), record);
    const double y = slice_.axis == 1 ? slice.axes.at : middle_y(output_.scene().grid);
    const SceneStroke stroke = stroke_of(prepared, y);
    const std::string depth = numbers::quantity_text(stroke.depth, "m");
    const std::string at_y =
        picture::position_labels("y", {y}, slice.axes.at_spacing, numbers::choose_unit(stroke.depth, "m")).front();
    output_.draw(".stroke",
                 picture::draw_stroke(look(true, ", stroked along x"),
                                      {fmt::format("probe {} below the surface, {}", depth, at_y)}, stroke.forces,
                                      output_.scene().force.shading != Shading::none),
                 record);
    if (!unshaded.force.empty())
        output_.draw(".shading", picture::draw_shading(look(false, ": what shading changes"), unshaded, slice, lines),
                     record);
}

} // namespace forceshade

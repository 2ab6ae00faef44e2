#include "host/sweep/case_output.h"

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/hash.h"
#include "host/output/raw_formats.h"
#include "host/picture/picture.h"
#include "host/picture/surface_lines.h"
#include "host/program.h"

namespace forceshade {
namespace {

struct NamedChannel {
    std::uint32_t bit;
    const char* name;
};
constexpr NamedChannel kNames[] = {{layout::kChannelForce, "force"},
                                   {layout::kChannelDepth, "depth"},
                                   {layout::kChannelFacet, "facet"},
                                   {layout::kChannelProxy, "proxy"},
                                   {layout::kChannelUnshaded, "unshaded"}};

VolumeHeader volume_header(const PreparedCase& prepared, int threads) {
    const Scene& scene = prepared.one.scene;
    VolumeHeader header;
    header.size = scene.grid.size;
    header.origin = scene.grid.origin;
    header.spacing = scene.grid.spacing;
    header.channels = scene.output.channels | layout::kChannelForce;
    header.compression = scene.output.compression;
    header.pixel = scene.output.pixel;
    header.scene = prepared.scene;
    header.version = version();
    header.omitted = fmt::format("{}", fmt::join(omissions(scene), "; "));
    header.threads = threads;
    return header;
}

// By base name: no path of the machine goes into results.
std::vector<FileRecord> inputs_of(const Scene& scene) {
    std::vector<FileRecord> inputs;
    const auto add = [&](const std::string& file, const std::string& sha256) {
        if (!sha256.empty())
            inputs.push_back({std::filesystem::path(file).filename().string(), sha256, 0});
    };
    if (scene.paths)
        add(scene.paths->file, scene.paths->sha256);
    add(scene.surface.mesh.file, scene.surface.mesh.sha256);
    add(scene.surface.map.file, scene.surface.map.sha256);
    if (scene.texture)
        add(scene.texture->map.file, scene.texture->map.sha256);
    return inputs;
}

bool stands_for_all_y(const Scene& scene) {
    return !depends_on_y(features_of(scene));
}

FileRecord write_picture(const std::filesystem::path& path, const picture::Picture& drawn) {
    const auto bytes = std::as_bytes(std::span(drawn.png));
    write_file_atomically(path, bytes);
    return {path.filename().string(), sha256_of(bytes), bytes.size()};
}

} // namespace

AlsoFormats parse_also(const std::vector<std::string>& names) {
    AlsoFormats also;
    for (const std::string& name : names) {
        if (name == "vti")
            also.vti = true;
        else if (name == "npy")
            also.npy = true;
        else if (name == "png")
            also.png = true;
        else
            throw UsageError(fmt::format("--also {}: there are vti, npy and png, with commas between them", name));
    }
    return also;
}

namespace {

// Of a field; force is always among the channels.
void add_field_files(const std::string& stem, std::uint32_t channels, AlsoFormats also,
                     std::vector<std::string>& names) {
    names.push_back(stem + ".exr");
    if (also.vti)
        names.push_back(stem + ".vti");
    if (also.npy)
        for (const NamedChannel& channel : kNames)
            if ((channels | layout::kChannelForce) & channel.bit)
                names.push_back(fmt::format("{}.{}.npy", stem, channel.name));
    if (also.png)
        names.insert(names.end(), {stem + ".mosaic.png", stem + ".arrows.png"});
    if (also.png && (channels & layout::kChannelUnshaded))
        names.push_back(stem + ".shading.png");
}

void add_path_files(const std::string& stem, std::uint32_t channels, AlsoFormats also,
                    std::vector<std::string>& names) {
    for (std::string& name : path_file_names(path_options(stem + ".exr", also, 0), channels))
        names.push_back(std::move(name));
}

} // namespace

std::vector<std::string> file_names(const std::string& stem, const Scene& scene, AlsoFormats also) {
    std::vector<std::string> names;
    if (scene.field)
        add_field_files(stem, scene.output.channels, also, names);
    if (scene.paths)
        add_path_files(stem, scene.output.channels, also, names);
    return names;
}

std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also) {
    std::vector<std::string> names;
    add_field_files(stem, kAllChannels, also, names);
    add_path_files(stem, kAllChannels, also, names);
    return names;
}

PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads) {
    const std::string stem = volume.stem().string();
    PathRunOptions options;
    options.samples = volume.parent_path() / (stem + ".paths.exr");
    options.stem = volume.parent_path() / stem;
    options.label = ".paths";
    options.npy = also.npy;
    options.png = also.png;
    options.threads = threads;
    return options;
}

CaseRecord empty_record(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    CaseRecord record;
    record.name = prepared.one.name;
    record.parameters = prepared.one.varied;
    record.inputs = inputs_of(scene);
    record.precision = scene.precision == Precision::f32 ? "f32" : "f64";
    record.omitted = omissions(scene);
    return record;
}

CaseOutput::CaseOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also, int threads,
                       bool exact_bits)
    : prepared_(prepared), volume_(volume), also_(also), check_(prepared, exact_bits) {
    const Scene& scene = prepared.one.scene;
    const bool repeats = stands_for_all_y(scene);
    repeat_y_ = repeats ? scene.grid.size[1] : 1;
    evaluated_ = scene.grid.size[0] * scene.grid.size[2] * (repeats ? 1 : scene.grid.size[1]);
    const VolumeHeader header = volume_header(prepared, threads);
    const std::filesystem::path folder = volume.parent_path();
    const std::string stem = volume.stem().string();
    sinks_.emplace_back(stem + ".exr", std::make_unique<VolumeWriter>(volume, header));
    if (also.vti)
        sinks_.emplace_back(
            stem + ".vti",
            std::make_unique<VtiWriter>(folder / (stem + ".vti"), VtiHeader{header.size, header.origin, header.spacing,
                                                                            header.channels, scene.precision}));
    if (also.npy)
        for (const NamedChannel& channel : kNames)
            if (header.channels & channel.bit) {
                const std::string name = fmt::format("{}.{}.npy", stem, channel.name);
                sinks_.emplace_back(
                    name, std::make_unique<NpyWriter>(folder / name, header.size, channel.bit, scene.precision));
            }
    if (also.png)
        slices_ = std::make_unique<picture::SliceCollector>(scene.grid, repeats);
}

template <typename T> void CaseOutput::write(const layout::FieldChunk<T>& chunk) {
    for (auto& [name, sink] : sinks_)
        sink->write(chunk, repeat_y_);
    if (slices_)
        slices_->add(chunk);
    check_.add(chunk);
}

template void CaseOutput::write<float>(const layout::FieldChunk<float>&);
template void CaseOutput::write<double>(const layout::FieldChunk<double>&);

CaseRecord CaseOutput::finish() {
    const Scene& scene = prepared_.one.scene;
    CaseRecord record = empty_record(prepared_);
    record.voxels = scene.grid.size[0] * scene.grid.size[1] * scene.grid.size[2];
    record.evaluated = evaluated_;
    record.error = check_.error();
    // The volume comes first: it refuses what must not be published.
    for (auto& [name, sink] : sinks_) {
        const VolumeResult result = sink->finish();
        if (record.files.empty()) {
            record.volume_times = result.timings;
            record.largest_force = result.largest_force;
            record.largest_voxel = result.largest_voxel;
        }
        record.files.push_back({name, result.sha256, result.bytes});
    }
    if (slices_)
        add_pictures(record);
    return record;
}

void CaseOutput::add_pictures(CaseRecord& record) {
    const std::filesystem::path folder = volume_.parent_path();
    const std::string stem = volume_.stem().string();
    const std::string& title = prepared_.one.name;
    const picture::SurfaceLines lines = surface_lines(prepared_);
    const auto add = [&](const char* kind, const picture::Picture& drawn) {
        record.files.push_back(write_picture(folder / fmt::format("{}.{}.png", stem, kind), drawn));
    };
    add("mosaic", picture::draw_mosaic(title, slices_->tiles()));
    add("arrows", picture::draw_arrows(title, slices_->xz(), lines));
    if (!slices_->unshaded_xz().force.empty())
        add("shading",
            picture::draw_side_by_side({title + ", unshaded", slices_->unshaded_xz()}, {title, slices_->xz()}, lines));
}

} // namespace forceshade

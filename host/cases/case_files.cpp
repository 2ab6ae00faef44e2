#include "host/cases/case_files.h"

#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/cases/case_pipeline.h"
#include "host/error.h"
#include "host/numbers.h"

namespace forceshade {
namespace {

// By base name: no path of the machine goes into results.
std::vector<FileRecord> inputs_of(const Scene& scene) {
    std::vector<FileRecord> inputs;
    for (const auto& [key, file] : files_of(scene))
        if (!file->sha256.empty())
            inputs.push_back({std::filesystem::path(file->file).filename().string(), file->sha256, 0});
    return inputs;
}

} // namespace

void set_options(ExrOptions& options, const PreparedCase& prepared, const Scene& written, int threads) {
    options.compression = written.output.compression;
    options.pixel = written.output.pixel;
    options.scene = prepared.scene;
    options.place_origin = scene_origin(prepared);
    options.version = version();
    std::vector<std::string> omitted = omissions(written);
    std::erase(omitted, kFreeSpace); // known only when all is evaluated
    options.omitted = fmt::format("{}", fmt::join(omitted, "; "));
    options.threads = threads;
}

AlsoFormats parse_also(const std::vector<std::string>& names) {
    AlsoFormats also;
    for (const std::string& name : names) {
        if (!also.add(name))
            throw UsageError("--also {}: there are vti, vtp, npy, png, svg and pdf, with commas between them", name);
    }
    return also;
}

namespace {

// Of a field; force is always among the channels. `turns`: draws_turns; `along_y`: it depends on y.
struct FieldKind {
    std::uint32_t channels;
    bool turns, along_y;
};
void add_field_files(const std::string& stem, const FieldKind& field, AlsoFormats also,
                     std::vector<std::string>& names) {
    names.push_back(stem + ".exr");
    if (also.vti)
        names.push_back(stem + ".vti");
    if (also.npy)
        for (const layout::uint channel : kFieldChannels)
            if ((field.channels | layout::kChannelForce) & channel)
                names.push_back(stem + npy_kind(channel));
    if (also.vtp)
        names.push_back(stem + ".vtp");
    const std::pair<const char*, bool> pictures[] = {{".mosaic", field.along_y},
                                                     {".arrows", true},
                                                     {".stroke", true},
                                                     {".turns", field.turns},
                                                     {".shading", field.channels & layout::kChannelUnshaded}};
    for (const auto& [kind, made] : pictures)
        if (made)
            std::ranges::move(picture::names_with(stem + kind, also.pictures), std::back_inserter(names));
}

void add_path_files(const std::string& stem, std::uint32_t channels, AlsoFormats also,
                    std::vector<std::string>& names) {
    for (std::string& name : path_file_names(path_options(stem + ".exr", also, 0), channels))
        names.push_back(std::move(name));
}

} // namespace

std::vector<std::string> file_names(const std::string& stem, const Case& one, AlsoFormats also) {
    const Scene& scene = one.scene;
    std::vector<std::string> names;
    if (scene.field)
        add_field_files(stem, {written_channels(scene), draws_turns(one), depends_on_y(scene)}, also, names);
    if (scene.paths)
        add_path_files(stem, written_channels(scene), also, names);
    return names;
}

std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also) {
    std::vector<std::string> names;
    constexpr std::uint32_t kAll = ~0u;
    add_field_files(stem, {kAll, true, true}, also, names);
    add_path_files(stem, kAll, also, names);
    return names;
}

CaseRecord empty_record(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    CaseRecord record;
    record.name = prepared.one.name;
    record.parameters = prepared.one.varied;
    record.inputs = inputs_of(scene);
    record.precision = name_of(scene.precision);
    record.omitted = omissions(scene);
    return record;
}

namespace {

// `share`: what is said of voxels, before the names of those. `sample`: "voxel".
std::string left_out_text(const std::vector<std::string>& omitted, const std::string& share, const char* sample) {
    std::vector<std::string> voxels, features, channels;
    std::size_t numbers = 0; // of the channels
    for (const std::string& one : omitted)
        if (one == kFreeSpace || one.ends_with("alike"))
            voxels.push_back(one);
        else if (const std::size_t at = one.find(" channel"); at != std::string::npos) {
            channels.push_back(one.substr(0, at));
            for (const std::uint32_t channel : kFieldChannels)
                numbers += channels.back() == name_of_channel(channel) ? components_of(channel) : 0;
        } else
            features.push_back(one);
    std::vector<std::string> parts;
    if (!share.empty())
        parts.push_back(fmt::format("{} ({})", share, fmt::join(voxels, ", ")));
    if (!features.empty())
        parts.push_back(fmt::format("{}", fmt::join(features, ", ")));
    if (!channels.empty())
        parts.push_back(fmt::format("channels {} ({} a {})", fmt::join(channels, ", "),
                                    numbers::counted(numbers, "number"), sample));
    return parts.empty() ? "left out: nothing" : fmt::format("left out: {}", fmt::join(parts, "; "));
}

} // namespace

std::string left_out_text(const CaseRecord& record) {
    return left_out_text(record.omitted,
                         record.evaluated == record.voxels
                             ? ""
                             : fmt::format("{0:.3g} % of the voxels, which modelled saves {0:.3g} % of computing",
                                           record.share_saved() * 100),
                         "voxel");
}

std::string left_out_text(const Scene& paths) {
    std::vector<std::string> omitted = omissions(paths);
    const bool metrics_alone = !(paths.output.channels & layout::kChannelForce);
    if (metrics_alone)
        std::erase_if(omitted, [](const std::string& one) { return one.ends_with(" channel"); });
    return left_out_text(omitted, "", "sample") +
           (metrics_alone ? "; every sample: metrics of the paths alone are written" : "");
}

} // namespace forceshade

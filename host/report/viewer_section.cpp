#include "host/report/viewer_section.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "host/report/base64.h"
#include "host/report/sampled_volume.h"
#include "host/report/space_data.h"
#include "host/report/words.h"
#include "report_assets.h"

namespace forceshade::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostVolumes = 256;
constexpr std::uint64_t kMostSamples = 1u << 19; /* of a volume, however few volumes there are */
constexpr std::uint64_t kLeastSamples = 512;

struct Wanted {
    std::string name, path; /* path below the report's folder */
    std::string paths{};    /* likewise the file of its paths; empty where there is none */
};

struct Packed {
    Json about;
    std::string data; /* base64 */
    Json surface;     /* null where the scene does not tell */
    bool thinned = false;
};

std::string volume_name(const CaseRecord& record) {
    for (const FileRecord& file : record.files)
        if (file.name == record.name + ".exr" && is_plain_name(file.name))
            return file.name;
    return "";
}

bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

void add_volume(std::vector<Wanted>& all, const std::filesystem::path& root, const std::string& name,
                const std::string& path) {
    const std::string paths = path.substr(0, path.size() - 4) + ".paths.exr";
    if (is_there(root / path))
        all.push_back({name, path, is_there(root / paths) ? paths : ""});
}

// A study's maps of curl are no forces.
bool is_force(const FileRecord& file) {
    return is_plain_name(file.name) && file.name.ends_with(".exr") && !file.name.ends_with(".curl.exr");
}

std::vector<Wanted> wanted_volumes(const std::filesystem::path& root, const Contents& contents) {
    std::vector<Wanted> all;
    for (const Sweep& sweep : contents.sweeps)
        for (const CaseRecord& record : sweep.cases)
            if (record.voxels > 0 && !volume_name(record).empty())
                add_volume(all, root, below(sweep.folder, record.name), below(sweep.folder, volume_name(record)));
    for (const StudyPart& part : contents.studies)
        for (const FileRecord& file : part.data.volumes)
            if (is_force(file))
                add_volume(all, root, below(part.folder, file.name.substr(0, file.name.size() - 4)),
                           below(part.folder, file.name));
    return all;
}

Packed packed_volume(const std::filesystem::path& root, const Wanted& wanted, std::uint64_t most) {
    const SampledVolume volume = sample_volume(root / wanted.path, most);
    const PackedForce force = pack_force(volume);
    Packed packed;
    packed.data = base64(force.bytes);
    packed.surface = surface_data(volume);
    packed.thinned = volume.stride[0] > 1 || volume.stride[2] > 1 || (volume.stride[1] > 1 && !volume.alike_in_y);
    packed.about = {{"name", wanted.name},         {"address", address(wanted.path)},
                    {"full", volume.full},         {"stride", volume.stride},
                    {"size", volume.size},         {"origin_m", volume.origin},
                    {"spacing_m", volume.spacing}, {"alike_in_y", volume.alike_in_y},
                    {"scale_N", force.scale},      {"loop", loop_data(volume.scene)}};
    return packed;
}

// Volumes that cannot be read are taken from the list, with a trouble.
std::vector<Packed> pack_all(const std::filesystem::path& root, std::vector<Wanted>& wanted, std::uint64_t most,
                             std::vector<std::string>& troubles) {
    std::vector<Packed> packed;
    std::erase_if(wanted, [&](const Wanted& one) {
        try {
            packed.push_back(packed_volume(root, one, most));
            return false;
        } catch (const Error& error) {
            troubles.push_back(fmt::format("{}: the viewer cannot show it: {}", one.path, error.what()));
            return true;
        }
    });
    return packed;
}

std::size_t characters(const std::vector<Packed>& packed) {
    std::size_t sum = 0;
    for (const Packed& one : packed)
        sum += one.data.size() + 400;
    return sum;
}

std::vector<Packed> pack_within(const std::filesystem::path& root, std::vector<Wanted>& wanted, std::size_t budget,
                                std::vector<std::string>& troubles) {
    std::uint64_t most = kMostSamples;
    for (;;) {
        std::vector<Packed> packed = pack_all(root, wanted, most, troubles);
        const std::size_t size = characters(packed);
        if (size <= budget || most <= kLeastSamples)
            return packed;
        const double share = 0.9 * static_cast<double>(budget) / static_cast<double>(size);
        // What is larger than the volumes themselves was no limit.
        std::uint64_t largest = 0;
        for (const Packed& one : packed)
            largest = std::max(largest, one.about["size"][0].get<std::uint64_t>() *
                                            one.about["size"][1].get<std::uint64_t>() *
                                            one.about["size"][2].get<std::uint64_t>());
        most =
            std::max(kLeastSamples, static_cast<std::uint64_t>(share * static_cast<double>(std::min(most, largest))));
    }
}

// Cases of one surface share it.
std::size_t place_in(Json& all, const Json& one) {
    const auto found = std::ranges::find(all, one);
    const auto place = static_cast<std::size_t>(found - all.begin());
    if (found == all.end())
        all.push_back(one);
    return place;
}

template <typename Add>
void add_paths(const std::filesystem::path& root, const std::string& path, std::size_t budget, Json& about,
               const Add& add, std::vector<std::string>& troubles) {
    try {
        const PackedPaths packed = pack_paths(root / path, budget);
        about["paths"] = packed.about;
        for (const auto& [name, bytes] : packed.vectors)
            add("path-" + name, base64(bytes));
    } catch (const Error& error) {
        troubles.push_back(fmt::format("{}: the viewer cannot show it: {}", path, error.what()));
    }
}

std::string about_data(const std::vector<Packed>& packed, std::size_t left_out) {
    const auto thinned = std::ranges::count_if(packed, &Packed::thinned);
    std::string text = "Forces here are rounded to 11 significant bits, directions thereby to 0.06 degrees";
    if (thinned == 0)
        text += "; every sample of the files is here, or one y for all where a field does not depend on y.";
    else
        text += fmt::format(". To keep this page small, {} of {} volumes {} thinned: what is shown is every second or "
                            "further sample, as the heading of each picture says.",
                            thinned, packed.size(), thinned == 1 ? "is" : "are");
    if (left_out > 0)
        text += fmt::format(" {} further cases are not here.", count_text(left_out));
    return text + " The whole volumes are the EXR files beside this page.";
}

} // namespace

std::string viewer_section(const std::filesystem::path& root, const Contents& contents,
                           std::vector<std::string>& troubles, std::size_t budget) {
    std::vector<Wanted> wanted = wanted_volumes(root, contents);
    const std::size_t left_out = wanted.size() - std::min(wanted.size(), kMostVolumes);
    wanted.resize(wanted.size() - left_out);
    const auto with_paths = std::ranges::count_if(wanted, [](const Wanted& one) { return !one.paths.empty(); });
    const std::size_t for_paths = with_paths ? budget / 4 : 0;
    const std::vector<Packed> packed = pack_within(root, wanted, budget - for_paths, troubles);
    if (packed.empty())
        return "";
    Json about{{"cases", Json::array()}, {"surfaces", Json::array()}};
    std::string data;
    for (std::size_t i = 0; i < packed.size(); ++i) {
        const auto add = [&](const std::string& id, const std::string& text) {
            data += fmt::format("<script type=\"text/plain\" id=\"{}-{}\">{}</script>\n", id, i, text);
        };
        add("volume", packed[i].data);
        Json one = packed[i].about;
        if (!packed[i].surface.is_null())
            one["surface"] = place_in(about["surfaces"], packed[i].surface);
        if (!wanted[i].paths.empty())
            add_paths(root, wanted[i].paths, for_paths / static_cast<std::size_t>(with_paths), one, add, troubles);
        about["cases"].push_back(std::move(one));
    }
    return fmt::format("<section id=\"viewer\">\n<h2>Viewer</h2>\n{}<p class=\"note\">{}</p>\n"
                       "<script type=\"application/json\" id=\"volumes\">{}</script>\n{}</section>\n",
                       assets::viewer_html, escaped(about_data(packed, left_out)), script_text(about), data);
}

} // namespace forceshade::report

// The viewer's place in the page, and the volumes, surfaces and paths that it shows.
#include <Imath/half.h>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/comparison.h"
#include "host/field/prepared_case.h"
#include "host/long_run.h"
#include "host/output/exr_volume.h"
#include "host/output/json.h"
#include "host/output/raw_formats.h"
#include "host/picture/picture.h"
#include "host/program.h"
#include "host/report/sections.h"
#include "host/scene/study.h"
#include "report_assets.h"

namespace forceshade::report {
namespace {

std::uint64_t samples(const SampledVolume& volume) {
    return volume.size[0] * volume.size[1] * volume.size[2];
}

// Rows are packed several together, so that nearly all of a plane of constant z must be unpacked for some rows of it:
// of large volumes fewer such planes are read.
constexpr std::uint64_t kMostUnpacked = 256u << 20; /* bytes */

std::uint64_t unpacked(const SampledVolume& volume) {
    const std::uint64_t row = volume.full[0] * 5 * sizeof(float), rows = volume.alike_in_y ? 1 : volume.full[1];
    return row * rows * volume.size[2];
}

// Thins along the longest side until few enough are left.
void choose_strides(SampledVolume& volume, std::uint64_t most) {
    volume.stride = {1, volume.alike_in_y ? volume.full[1] : 1, 1};
    for (;;) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            volume.size[axis] = (volume.full[axis] + volume.stride[axis] - 1) / volume.stride[axis];
        if (unpacked(volume) > kMostUnpacked && volume.size[2] > 1) {
            ++volume.stride[2];
            continue;
        }
        if (samples(volume) <= std::max<std::uint64_t>(most, 1))
            return;
        const auto longest = std::ranges::max_element(volume.size) - volume.size.begin();
        ++volume.stride[static_cast<std::size_t>(longest)];
    }
}

// One y stands for all: of those in the file the others were left out as alike, or it has but one, of a scene that does
// not depend on y. So must the shape of [compare].
bool is_alike_in_y(const VolumeHeader& header) {
    const std::optional<Case> one = stated_scene(header.scene); // unknown without it
    if (one && one->scene.compare && depends_on_y(*one->scene.compare))
        return false;
    if (header.size[1] > 1)
        return header.omitted.find(" y samples, alike") != std::string::npos;
    return one && !depends_on_y(features_of(one->scene));
}

double power_of_two_above(std::span<const float> values) {
    float largest = 0;
    for (const float value : values)
        if (std::isfinite(value))
            largest = std::max(largest, std::fabs(value));
    int exponent = 0;
    std::frexp(static_cast<double>(largest), &exponent);
    return largest > 0 ? std::ldexp(1.0, exponent) : 1.0;
}

std::string compressed(const std::string& bytes) {
    constexpr int kBest = 9;
    std::vector<std::byte> packed;
    deflate(std::as_bytes(std::span(bytes)), packed, kBest);
    return {reinterpret_cast<const char*>(packed.data()), packed.size()};
}

constexpr std::size_t kMostPoints = 130; /* of a row; beyond that facets do not show */
constexpr std::size_t kRows = 33;
constexpr double kUnits = 20000; /* of the volume's width */
constexpr std::uint64_t kMostPaths = 8, kLeastSteps = 50, kMostSteps = 600;
constexpr std::size_t kCharactersASample = 24; /* of three vectors of three halves, compressed */

// Keeps the ends, and every n-th point between them.
void add_row(Json& sheet, const std::vector<picture::LinePoint>& line, double unit) {
    Json x = Json::array(), z = Json::array();
    const std::size_t every = (line.size() + kMostPoints - 1) / kMostPoints;
    for (std::size_t i = 0; i < line.size(); ++i)
        if (i % every == 0 || i + 1 == line.size()) {
            x.push_back(std::llround(line[i].x / unit));
            z.push_back(std::llround(line[i].z / unit));
        }
    sheet["x"] = std::move(x);
    sheet["z"].push_back(std::move(z));
}

constexpr std::size_t kMostVolumes = 256;
constexpr std::uint64_t kMostSamples = 1u << 19; /* of a volume, however few volumes there are */
constexpr std::uint64_t kLeastSamples = 512;

struct Wanted {
    std::string name, path; /* path below the report's folder */
    std::string paths{};    /* the same for the file of its paths; may be empty */
    Json error_deg{};       /* RMS error of the direction; null: not known */
    std::string from{};     /* what [compare] compares with; may be empty */
    double depth_mm = 0;    /* of contact, up to which it does */
};

struct Packed {
    Json about;
    std::vector<std::pair<std::string, std::string>> data; /* its name on the page, base64 */
    Json surface;                                          /* null where the scene does not say */
    std::string scene{};
    std::uint64_t samples = 0;
    bool thinned = false;
};

std::string volume_name(const CaseRecord& record) {
    for (const FileRecord& file : record.files)
        if (file.name == record.name + ".exr" && is_plain_name(file.name))
            return file.name;
    return "";
}

bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

// Of the direction: from the shape of [compare], else from what should be there where a hand touches.
Json error_of(const CaseRecord& record) {
    if (record.deviation && record.deviation->angles > 0)
        return record.deviation->rms_angle;
    return record.touch ? Json(record.touch->direction.value) : Json(); // null without a force anywhere
}

void add_volume(std::vector<Wanted>& all, const std::filesystem::path& root, const std::string& name,
                const std::string& path, const Json& error = {}, const DeviationRecord& compared = {.from = ""}) {
    const std::string paths = path.substr(0, path.size() - 4) + ".paths.exr";
    if (is_file(root / path))
        all.push_back({name, path, is_file(root / paths) ? paths : "", error, compared.from, 1e3 * compared.depth});
}

std::vector<Wanted> wanted_volumes(const std::filesystem::path& root, const Contents& contents) {
    std::vector<Wanted> all;
    for (const Sweep& sweep : contents.sweeps)
        for (const CaseRecord& record : sweep.cases)
            if (record.voxels > 0 && !volume_name(record).empty())
                add_volume(all, root, below(sweep.folder, record.name), below(sweep.folder, volume_name(record)),
                           error_of(record), record.deviation.value_or(DeviationRecord{.from = ""}));
    for (const StudyPart& part : contents.studies)
        for (const FileRecord& file : part.data.volumes)
            if (is_plain_name(file.name) && file.name.ends_with(".exr"))
                add_volume(all, root, below(part.folder, file.name.substr(0, file.name.size() - 4)),
                           below(part.folder, file.name));
    return all;
}

// Errors of contacts deeper than compare.depth, which a case's errors do not count either, are no longer there.
void keep_counted(SampledVolume& volume) {
    const std::optional<Case> one = stated_scene(volume.scene);
    if (volume.angle.empty() || !one || !one->scene.compare)
        return;
    const double most = one->scene.compare->depth * one->scene.force.stiffness; /* N */
    for (std::size_t i = 0; i < volume.angle.size(); ++i) {
        const auto part = [&](std::size_t component) { return static_cast<double>(volume.force[3 * i + component]); };
        const double force = std::hypot(part(0), part(1), part(2));
        if ((force > 0 ? force : std::abs(static_cast<double>(volume.error[i]))) > most)
            volume.angle[i] = volume.error[i] = NAN;
    }
}

// N: at most where a hand touches, and where errors of [compare] count; null of a scene of another version.
Json touched_force(const SampledVolume& volume) {
    constexpr double kTouched = 2e-3; // m
    const std::optional<Case> one = stated_scene(volume.scene);
    if (!one)
        return nullptr;
    const Scene& scene = one->scene;
    return scene.force.stiffness * (scene.compare ? std::min(kTouched, scene.compare->depth) : kTouched);
}

Packed packed_volume(const std::filesystem::path& root, const Wanted& wanted, std::uint64_t most) {
    const SampledVolume volume = sample_volume(root / wanted.path, most);
    Packed packed;
    const auto add = [&](const char* name, const std::vector<float>& values, std::size_t components) {
        const PackedValues one = pack_values(values, components, volume.size[0]);
        packed.data.emplace_back(name, base64(one.bytes));
        return one.scale;
    };
    const double scale = add("volume", volume.force, 3);
    packed.surface = surface_data(volume);
    packed.scene = volume.scene;
    packed.samples = samples(volume);
    packed.thinned = volume.stride[0] > 1 || volume.stride[2] > 1 || (volume.stride[1] > 1 && !volume.alike_in_y);
    packed.about = {{"name", wanted.name},
                    {"address", address(wanted.path)},
                    {"full", volume.full},
                    {"stride", volume.stride},
                    {"size", volume.size},
                    {"origin_m", volume.origin},
                    {"spacing_m", volume.spacing},
                    {"alike_in_y", volume.alike_in_y},
                    {"scale_N", scale},
                    {"loop", loop_data(volume.scene)},
                    {"touched_N", touched_force(volume)},
                    {"error_deg", wanted.error_deg}};
    if (!volume.angle.empty())
        packed.about["compared"] = {{"angle", add("angle", volume.angle, 1)},
                                    {"error", add("error", volume.error, 1)},
                                    {"from", wanted.from},
                                    {"depth_mm", wanted.depth_mm}};
    return packed;
}

std::size_t characters(const std::vector<Packed>& packed) {
    std::size_t sum = 0;
    for (const Packed& one : packed) {
        sum += 400;
        for (const auto& [name, text] : one.data)
            sum += text.size();
    }
    return sum;
}

// A lower limit of samples for volumes that took `size` characters. A limit above the size of the volumes had no
// effect.
std::uint64_t fewer_samples(std::uint64_t most, const std::vector<Packed>& packed, std::size_t size,
                            std::size_t budget) {
    std::uint64_t largest = 0;
    for (const Packed& one : packed)
        largest = std::max(largest, one.samples);
    const double share = 0.9 * static_cast<double>(budget) / static_cast<double>(size);
    return std::max(kLeastSamples, static_cast<std::uint64_t>(share * static_cast<double>(std::min(most, largest))));
}

// The limit of samples at which a few of many volumes would let all fit.
std::uint64_t limit_of_few(const std::filesystem::path& root, const std::vector<Wanted>& wanted, std::size_t budget) {
    constexpr std::size_t kFew = 4, kSamplesACharacter = 8; // hardly more can be packed
    if (wanted.size() <= 2 * kFew)
        return kMostSamples;
    std::uint64_t most =
        std::clamp<std::uint64_t>(kSamplesACharacter * budget / wanted.size(), kLeastSamples, kMostSamples);
    for (bool fits = false; !fits && most > kLeastSamples;) {
        std::vector<Packed> few;
        for (std::size_t i = 0; i < kFew; ++i) {
            check_interrupt();
            try {
                few.push_back(packed_volume(root, wanted[(2 * i + 1) * wanted.size() / (2 * kFew)], most));
            } catch (const Error&) { // reported when all are packed
            }
        }
        const std::size_t size = few.empty() ? 0 : characters(few) * wanted.size() / few.size();
        fits = size <= budget;
        if (!fits)
            most = fewer_samples(most, few, size, budget);
    }
    return most;
}

// Volumes that cannot be read are taken from the list, with a trouble.
std::vector<Packed> pack_within(const std::filesystem::path& root, std::vector<Wanted>& wanted, std::size_t budget,
                                std::vector<std::string>& troubles) {
    Stage stage("packing volumes", wanted.size(), "volumes");
    std::uint64_t most = limit_of_few(root, wanted, budget), done = 0; // counted once, however often they are packed
    for (;;) {
        std::vector<Packed> packed;
        std::erase_if(wanted, [&](const Wanted& one) {
            stage.update(done++, one.name);
            try {
                packed.push_back(packed_volume(root, one, most));
                return false;
            } catch (const Error& error) {
                troubles.push_back(fmt::format("{}: the viewer cannot show it: {}", one.path, error.what()));
                return true;
            }
        });
        const std::size_t size = characters(packed);
        if (size <= budget || most <= kLeastSamples)
            return packed;
        most = fewer_samples(most, packed, size, budget);
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
    return text + " The whole volumes are the EXR files next to this page.";
}

} // namespace

SampledVolume sample_volume(const std::filesystem::path& path, std::uint64_t most) {
    VolumeReader reader(path);
    const VolumeHeader& header = reader.header();
    SampledVolume volume;
    volume.full = header.size;
    volume.origin = header.origin;
    volume.spacing = header.spacing;
    volume.alike_in_y = is_alike_in_y(header);
    volume.scene = header.scene;
    choose_strides(volume, most);
    volume.force.reserve(3 * samples(volume));
    std::vector<float> row;
    const bool compared = (header.channels & kComparedChannels) == kComparedChannels;
    for (std::uint64_t z = 0; z < volume.full[2]; z += volume.stride[2])
        for (std::uint64_t y = 0; y < volume.full[1]; y += volume.stride[1]) {
            reader.read(layout::kChannelForce, z * volume.full[1] + y, 1, row);
            for (std::uint64_t x = 0; x < volume.full[0]; x += volume.stride[0])
                for (std::size_t component = 0; component < 3; ++component)
                    volume.force.push_back(row[3 * x + component]);
            if (compared)
                for (const auto& [channel, values] :
                     {std::pair(kChannelAngle, &volume.angle), {kChannelMagnitudeError, &volume.error}}) {
                    reader.read(channel, z * volume.full[1] + y, 1, row);
                    for (std::uint64_t x = 0; x < volume.full[0]; x += volume.stride[0])
                        values->push_back(row[x]);
                }
        }
    keep_counted(volume);
    return volume;
}

PackedValues pack_values(std::span<const float> values, std::size_t components, std::uint64_t width) {
    PackedValues packed;
    packed.scale = power_of_two_above(values);
    std::string planes, low;
    for (std::size_t component = 0; component < components; ++component) {
        low.clear();
        std::uint16_t before = 0;
        for (std::size_t i = component, x = 0; i < values.size(); i += components, ++x) {
            if (x % width == 0)
                before = 0;
            const std::uint16_t half =
                Imath::half(static_cast<float>(static_cast<double>(values[i]) / packed.scale)).bits();
            const auto step = static_cast<std::uint16_t>(half - before);
            planes += static_cast<char>(step >> 8);
            low += static_cast<char>(step & 0xFF);
            before = half;
        }
        planes += low; // high bytes first
    }
    packed.bytes = compressed(planes);
    return packed;
}

Json surface_data(const SampledVolume& volume) {
    const std::optional<Case> one = stated_scene(volume.scene);
    if (!one || one->scene.surface.kind == SurfaceKind::mesh ||
        (one->scene.surface.kind == SurfaceKind::height_map && one->scene.surface.map.function == MapFunction::file))
        return {};
    PreparedCase prepared;
    prepared.one = *one;
    const auto end = [&](std::size_t axis) {
        return volume.origin[axis] + volume.spacing[axis] * static_cast<double>(volume.full[axis] - 1);
    };
    const double unit = (end(0) - volume.origin[0]) / kUnits;
    if (!(unit > 0))
        return {};
    const bool by_y = one->scene.surface.kind == SurfaceKind::height_map &&
                      one->scene.surface.map.function == MapFunction::gaussian && volume.full[1] > 1;
    Json nominal{{"unit_m", unit}}, smooth = nominal;
    for (std::size_t row = 0; row < (by_y ? kRows : 1); ++row) {
        const double y = std::lerp(volume.origin[1], end(1), static_cast<double>(row) / (kRows - 1));
        const picture::SurfaceLines lines = surface_lines(prepared, {volume.origin[0], end(0), y});
        if (row == 0)
            add_row(nominal, lines.nominal, unit);
        if (!lines.smooth.empty())
            add_row(smooth, lines.smooth, unit);
    }
    Json surface{{"nominal", std::move(nominal)}};
    if (smooth.contains("x"))
        surface["smooth"] = std::move(smooth);
    return surface;
}

double path_period(const std::string& scene) {
    const std::optional<Case> one = stated_scene(scene);
    return one && one->scene.paths && one->scene.paths->kind != PathKind::recorded ? 1 / one->scene.paths->rate : NAN;
}

PackedPaths pack_paths(const std::filesystem::path& path, std::size_t budget) {
    const std::uint64_t samples = budget / kCharactersASample;
    const PathSamples read = read_paths(path, kMostPaths, std::clamp(samples / kMostPaths, kLeastSteps, kMostSteps));
    PackedPaths packed{{{"size", {read.steps, read.paths, 1}}}, {}};
    if (const double period = path_period(read.scene); period > 0)
        packed.about["rate_Hz"] = 1 / (period * static_cast<double>(read.every_step));
    if (read.origin != glm::dvec3(0))
        packed.about["origin_m"] = {read.origin.x, read.origin.y, read.origin.z};
    for (const auto& [name, values] :
         {std::pair("force", &read.force), {"position", &read.position}, {"proxy", &read.proxy}}) {
        if (values->empty())
            continue;
        PackedValues one = pack_values(*values, 3, read.steps);
        packed.about["scale"][name] = one.scale;
        packed.vectors.emplace_back(name, std::move(one.bytes));
    }
    return packed;
}

std::string viewer_section(const std::filesystem::path& root, const Contents& contents,
                           std::vector<std::string>& troubles, std::size_t budget, std::vector<NamedScene>& shown) {
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
        for (const auto& [name, text] : packed[i].data)
            add(name, text);
        Json one = packed[i].about;
        if (!packed[i].surface.is_null())
            one["surface"] = place_in(about["surfaces"], packed[i].surface);
        if (!wanted[i].paths.empty())
            add_paths(root, wanted[i].paths, for_paths / static_cast<std::size_t>(with_paths), one, add, troubles);
        shown.push_back({wanted[i].name, packed[i].scene});
        about["cases"].push_back(std::move(one));
    }
    return fmt::format("<section id=\"viewer\">\n<h2>Viewer</h2>\n{}<p class=\"note\">{}</p>\n"
                       "<script type=\"application/json\" id=\"volumes\">{}</script>\n{}</section>\n",
                       assets::viewer_html, escaped(about_data(packed, left_out)), script_text(about), data);
}

} // namespace forceshade::report

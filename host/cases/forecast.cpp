#include "host/cases/case_pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

#include "host/cases/case_files.h"
#include "host/cases/engine_choice.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/numbers.h"

namespace forceshade {
namespace {

constexpr double kMostDeflate = 1032;    // bytes that zlib's format can hold in one
constexpr double kSmallCopy = 200000;    // voxels or samples: a tenth of a second
constexpr std::size_t kSmallCopies = 6;  // that are computed
constexpr double kPictureSeconds = 0.12; // of a case's pictures in one format
constexpr double kHeaderBytes = 4096;    // of a file: the scene as text
constexpr double kSummaryBytes = 200;    // of a path in STEM.paths.csv

double reals(std::uint32_t channels, std::initializer_list<std::uint32_t> always) {
    for (const std::uint32_t channel : always)
        channels |= channel;
    double sum = 0;
    for (const std::uint32_t channel :
         {layout::kChannelForce, layout::kChannelDepth, layout::kChannelProxy, layout::kChannelUnshaded,
          layout::kChannelPosition, kChannelAngle, kChannelMagnitudeError})
        if (channels & channel)
            sum += static_cast<double>(components_of(channel));
    return sum;
}

void add_volume(double count, double bytes, Compression compression, Forecast& sum) {
    sum.most_bytes += count * bytes + kHeaderBytes;
    sum.least_bytes += count * bytes / (compression == Compression::none ? 1 : kMostDeflate);
}

// Of fields or paths: `count` samples, each of `reals` and `ids`.
void add_files(const Scene& scene, double count, double reals, double ids, bool vti, bool npy, Forecast& sum) {
    const double pixel = scene.output.pixel == PixelType::half ? 2 : 4;
    const double real = scene.precision == Precision::f64 ? 8 : 4;
    add_volume(count, reals * pixel + ids * 4, scene.output.compression, sum);
    if (vti)
        add_volume(count, reals * real + ids * 4, Compression::zip, sum);
    if (npy)
        add_volume(count, reals * real + ids * 4, Compression::none, sum);
}

// Of paths: place, force, depth and perhaps the proxy; facet, time and number of each sample.
void add_polylines(const Scene& scene, double samples, Forecast& sum) {
    const double real = scene.precision == Precision::f64 ? 8 : 4;
    const double stored = scene.output.channels & layout::kChannelProxy ? 3 + 3 + 1 + 3 : 3 + 3 + 1;
    add_volume(samples, stored * real + 4 + 8 + 8, Compression::zip, sum);
}

// The same extent, coarser; the first paths.
void make_small(Scene& scene) {
    GridSpec& grid = scene.grid;
    double voxels = 1;
    for (const std::uint64_t size : grid.size)
        voxels *= static_cast<double>(size);
    const double shrink = std::cbrt(std::min(1.0, kSmallCopy / voxels));
    for (std::size_t axis = 0; axis < 3 && shrink < 1; ++axis) {
        const std::uint64_t size = grid.size[axis];
        const auto small = std::max<std::uint64_t>(2, static_cast<std::uint64_t>(static_cast<double>(size) * shrink));
        if (small >= size)
            continue;
        grid.spacing[axis] *= static_cast<double>(size - 1) / static_cast<double>(small - 1);
        grid.size[axis] = small;
    }
    if (scene.paths && scene.paths->kind != PathKind::recorded) {
        PathsSpec& paths = *scene.paths;
        paths.count = std::clamp<std::uint64_t>(
            static_cast<std::uint64_t>(kSmallCopy / static_cast<double>(std::max<std::uint64_t>(1, paths.steps))), 1,
            paths.count);
    }
}

class ScratchFolder {
public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "forceshade-XXXXXX").string();
        const auto hold = hold_end();
        if (!::mkdtemp(name.data()))
            throw IoError("cannot make a folder in {}", std::filesystem::temp_directory_path().string());
        path_ = name;
        remove_at_end(path_);
    }
    ~ScratchFolder() {
        const auto hold = hold_end();
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
        keep_at_end(path_);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::size_t picture_formats(AlsoFormats also) {
    return also.pictures.png + also.pictures.svg + also.pictures.pdf;
}

} // namespace

Forecast& Forecast::operator+=(const Forecast& other) {
    voxels += other.voxels;
    samples += other.samples;
    most_bytes += other.most_bytes;
    surface_bytes += other.surface_bytes;
    least_bytes += other.least_bytes;
    return *this;
}

Forecast forecast(const Scene& scene, AlsoFormats also) {
    Forecast sum;
    const std::uint32_t channels = written_channels(scene);
    const double ids = channels & layout::kChannelFacet ? 1 : 0;
    if (scene.field) {
        const auto& size = scene.grid.size;
        sum.voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
        add_files(scene, sum.voxels, reals(channels, {layout::kChannelForce}), ids, also.vti, also.npy, sum);
        if (also.vtp)
            sum.most_bytes += sum.surface_bytes = most_surface_bytes(scene) + kHeaderBytes;
    }
    if (scene.paths) {
        const Workload work = path_workload(scene);
        sum.samples = work.steps + work.mesh_steps;
        add_files(scene, sum.samples, reals(channels, {layout::kChannelForce, layout::kChannelPosition}), ids, false,
                  also.npy, sum);
        sum.most_bytes += kSummaryBytes * static_cast<double>(scene.paths->count);
        if (also.npy) // times
            add_volume(scene.paths->kind == PathKind::recorded ? sum.samples : static_cast<double>(scene.paths->steps),
                       sizeof(double), Compression::none, sum);
        if (also.vtp)
            add_polylines(scene, sum.samples, sum);
    }
    return sum;
}

void measure(Engine& engine, const std::vector<const Case*>& cases, const std::function<CaseJob(const Case&)>& job_of,
             Forecast& forecast) {
    const std::size_t copies = std::min(cases.size(), kSmallCopies);
    Stage stage("computing small copies", copies, "cases");
    Forecast small;
    double bytes = 0, surfaces = 0, seconds = 0;
    std::size_t formats = 0;
    for (std::size_t i = 0; i < copies; ++i) {
        const ScratchFolder folder;
        CaseJob job = job_of(*cases[i * cases.size() / copies]);
        Scene& scene = job.prepared.one.scene;
        make_small(scene);
        job.volume = folder.path() / "small.exr";
        formats = picture_formats(job.also);
        job.also.pictures = {};
        small += forceshade::forecast(scene, job.also);
        const Clock::time_point start = Clock::now();
        for (const FileRecord& file : run_case(engine, std::move(job)).files)
            (file.name == "small.vtp" ? surfaces : bytes) += static_cast<double>(file.bytes);
        seconds += seconds_since(start);
        stage.update(i + 1);
    }
    const double times = (forecast.most_bytes - forecast.surface_bytes) / (small.most_bytes - small.surface_bytes);
    if (small.surface_bytes > 0)
        surfaces *= forecast.surface_bytes / small.surface_bytes;
    forecast.bytes = std::clamp(times * bytes + surfaces, forecast.least_bytes, forecast.most_bytes);
    forecast.seconds = times * seconds + kPictureSeconds * static_cast<double>(formats * cases.size());
}

double free_bytes(const std::filesystem::path& folder) {
    std::error_code error;
    for (std::filesystem::path there = std::filesystem::absolute(folder);; there = there.parent_path()) {
        const std::filesystem::space_info space = std::filesystem::space(there, error);
        if (!error)
            return static_cast<double>(space.available);
        if (there == there.parent_path())
            return HUGE_VAL; // nobody knows: writing will tell
    }
}

void require_space(const std::filesystem::path& folder, const Forecast& forecast) {
    if (const double free = free_bytes(folder); forecast.least_bytes > free)
        throw IoError("cannot write into {}: even at the best compression the files take {} ({:.0f} bytes), and {} "
                      "({:.0f} bytes) are free; free space there, choose another folder, or compute fewer voxels",
                      folder.string(), numbers::size_text(forecast.least_bytes), forecast.least_bytes,
                      numbers::size_text(free), free);
}

bool is_space_doubtful(const std::filesystem::path& folder, const Forecast& forecast) {
    return forecast.most_bytes > free_bytes(folder);
}

std::string space_warning(const std::filesystem::path& folder, const Forecast& forecast) {
    const double free = free_bytes(folder);
    if (forecast.bytes.value_or(0) <= free)
        return {};
    return fmt::format("the files will probably take {}, and {} are free in {}", numbers::size_text(*forecast.bytes),
                       numbers::size_text(free), folder.string());
}

} // namespace forceshade

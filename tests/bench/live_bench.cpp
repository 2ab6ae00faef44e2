// The live loop on a sphere of 100 820 triangles, force shaded: what a sample costs as fast as possible, beside the law
// alone in the same run; and by the clock, with a log, how many samples were late through the loop's own computing.
//   live_bench [SECONDS]    by the clock, at each rate; 60 if left out
#include <charconv>
#include <cstring>

#include <fmt/format.h>

#include "device/backends/devices.h"
#include "device/loop/live_loop.h"
#include "device/loop/sample.h"
#include "device/session/session.h"
#include "host/scene/study.h"
#include "tests/bench/geodesic.h"
#include "tests/io/folder.h"
#include "tests/mesh/written_files.h"

namespace forceshade::bench {
namespace {

constexpr unsigned kFrequency = 71;
constexpr double kRadius = 0.025; /* m */

// Strokes over the top that press 1 N, where the hand's tremor never comes to the same triangles twice.
std::filesystem::path write_scene(const testing::Folder& folder, const std::string& shading) {
    return folder.write(shading + ".toml",
                        "[surface]\nkind = \"mesh\"\nfile = \"sphere.obj\"\n[force]\nshading = \"" + shading +
                            "\"\n[paths]\npress = \"1 N\"\nlength = \"25 mm\"\nstart_depth = \"-1 mm\"\n"
                            "tremor = { amplitude = \"0.2 mm\" }\n");
}

device::SessionOptions options_for(const std::filesystem::path& scene, CasePreparation& preparation) {
    device::SessionOptions options;
    options.scene = scene;
    options.read = [scene, &preparation] {
        const std::vector<Override> replaced{{"run.precision", "f64"}};
        return preparation.prepare(read_scene(scene, replaced));
    };
    options.quiet = true;
    return options;
}

std::string times(const device::Histogram& histogram) {
    return fmt::format("p50 {:7.3f} us  p99 {:7.3f} us  p99.9 {:7.3f} us  largest {:9.3f} us",
                       1e-3 * histogram.quantile(0.5), 1e-3 * histogram.quantile(0.99),
                       1e-3 * histogram.quantile(0.999), 1e-3 * static_cast<double>(histogram.largest()));
}

// The law of the same positions, one after the other, and nothing else. /* ns a sample */
double law_alone(const PreparedCase& prepared, double rate, std::size_t samples) {
    const auto hand = device::make_sim(prepared, rate);
    const auto law = make_probe_law(prepared);
    std::vector<glm::dvec3> probes;
    for (std::size_t i = 0; i < samples; ++i) {
        probes.push_back(hand->read().position);
        hand->write(law->at(probes.back()).force);
    }
    law->begin_path();
    double sum = 0;
    const std::int64_t begin = device::now();
    for (const glm::dvec3& probe : probes)
        sum += law->at(probe).force.z;
    const auto passed = static_cast<double>(device::now() - begin);
    return sum != 0 ? passed / static_cast<double>(samples) : 0;
}

void as_fast_as_possible(const std::filesystem::path& scene, CasePreparation& preparation) {
    constexpr double kSeconds = 1000;
    device::SessionOptions options = options_for(scene, preparation);
    options.real_time = false;
    options.duration = kSeconds;
    const device::LoopCounts counts = device::run_session(options).outcome.counts;
    const double alone = law_alone(options.read(), 1000, 1000000);
    fmt::print("{:<13} as fast as possible, {} samples, {:.1f} % in contact\n  compute  {}\n  mean     {:.0f} ns = "
               "{:.2f} x the law alone ({:.0f} ns); whole loop {:.2f} M samples/s\n",
               scene.stem().string(), counts.samples,
               100 * static_cast<double>(counts.in_contact) / static_cast<double>(counts.samples),
               times(counts.computing), counts.computing.mean(), counts.computing.mean() / alone, alone,
               1e-6 * static_cast<double>(counts.samples) / counts.seconds);
}

void by_the_clock(const std::filesystem::path& scene, CasePreparation& preparation, double rate, double seconds) {
    device::SessionOptions options = options_for(scene, preparation);
    options.asked_rate = rate;
    options.duration = seconds;
    options.log = scene.parent_path() / "log.csv";
    options.replace_log = true;
    const device::SessionResult result = device::run_session(options);
    const device::LoopCounts& counts = result.outcome.counts;
    fmt::print("{:<13} {:g} Hz, {} samples, {} in the log, {} lost; late {}, of these by own computing {}\n  compute  "
               "{}\n  woken    {}\n",
               scene.stem().string(), rate, counts.samples, result.outcome.logged, counts.lost, counts.flags[12],
               counts.flags[13], times(counts.computing), times(counts.late));
    for (const auto& one : result.outcome.permissions.all)
        fmt::print("  {}: {} ({})\n", one.what, one.granted ? "yes" : "no", one.detail);
}

int run(double seconds) {
    const testing::Folder folder;
    folder.write("sphere.obj", testing::as_obj(shapes::moved(geodesic(kFrequency), glm::dvec3(kRadius), {})));
    CasePreparation preparation;
    for (const char* const shading : {"none", "morgenbesser", "mean_value"})
        as_fast_as_possible(write_scene(folder, shading), preparation);
    for (const double rate : {1000.0, 4000.0})
        by_the_clock(write_scene(folder, "morgenbesser"), preparation, rate, seconds);
    return 0;
}

} // namespace
} // namespace forceshade::bench

int main(int argc, char** argv) {
    double seconds = 60;
    if (argc > 1)
        std::from_chars(argv[1], argv[1] + std::strlen(argv[1]), seconds);
    return forceshade::bench::run(seconds);
}

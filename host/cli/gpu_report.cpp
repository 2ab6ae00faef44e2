#include "host/cli/gpu_report.h"

#include <algorithm>
#include <future>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/bandwidth.h"
#include "host/cases/path_comparison.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/scene/cases.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"
#include "host/touch/own_surfaces.h"

namespace forceshade {
namespace {

// A law of the report: a field, or paths.
struct Law {
    std::string name;
    StudiedSurface surface;
    const char* paths = nullptr; /* of a scene */
};

constexpr const char* kOpen = "[paths]\ncount = 200\nsteps = 500\n";
constexpr const char* kClosed = "[paths]\nloop = \"closed\"\ncount = 200\nsteps = 500\n";

std::vector<Law> all_laws() {
    std::vector<Law> laws;
    for (const StudiedSurface& one : studied_surfaces(kDevices))
        laws.push_back({one.name, one});
    for (const auto& [surface, loop, paths] : {std::tuple("shaded bump of 8 facets", "open", kOpen),
                                               {"shaded bump of 8 facets", "closed", kClosed},
                                               {"shaded mesh", "closed", kClosed}})
        laws.push_back({fmt::format("paths on the {}, {} loop", surface, loop), studied_surface(surface), paths});
    return laws;
}

const std::vector<Law>& laws() {
    static const std::vector<Law> all = all_laws();
    return all;
}

// Of the run on all devices at once.
const Law& law_of_all() {
    return *std::ranges::find(laws(), "shaded bump of 8 facets", &Law::name);
}

// `side`: samples along x and z, and half of it along y.
PreparedCase case_of(const Law& law, std::uint64_t side) {
    PreparedCase prepared = own_case(law.surface.own);
    Scene& scene = prepared.one.scene;
    prepared.one.name = law.name;
    scene.field = law.paths == nullptr;
    if (law.paths) {
        scene.paths = parse_scene(law.paths, law.name).scene.paths;
        scene.output.channels = layout::kChannelForce;
    } else {
        scene.grid = grid_over(law.surface.box, {side, side / 2, side});
    }
    return prepared;
}

struct Row {
    const Law* law;
    Precision precision;
    std::uint64_t compared = 0, differing = 0;
    std::optional<double> rounding{}; /* of the largest force, from the oracle in double; of fields */
    bool passed = false;
    std::string first_difference{};
    std::uint64_t samples = 0;             /* of the run that was timed */
    double seconds = INFINITY, kernel = 0; /* s: of it, and in kernels; not finite: it failed */
    std::uint32_t group = 0;               /* invocations of its work groups */
    double cpu = 0;                        /* samples/s of the CPU's engine */
    std::uint64_t bytes = 0;               /* of its results */
};

struct DeviceRows {
    compute::DeviceReport device;
    compute::Bandwidth bandwidth;
    std::vector<Row> rows;
};

template <typename T> EngineTimes run_once(Engine& engine, const PreparedCase& prepared, Row& row) {
    row.bytes = 0;
    if (!prepared.one.scene.paths) {
        const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::everything);
        row.samples = tables.x.size() * tables.y.size() * tables.z.size();
        return engine.evaluate<T>(tables.input(),
                                  [&](const layout::FieldChunk<T>& chunk) { row.bytes += chunk.force.size_bytes(); });
    }
    ScenePaths<T> paths(prepared);
    const layout::PathInput<T> input = paths.input();
    row.samples = std::uint64_t(input.paths) * input.steps;
    return engine.explore<T>(
        input, [&](const layout::PathChunk<T>& chunk) { row.bytes += chunk.force.size_bytes(); },
        [](std::size_t, std::span<const layout::PathMetrics<T>>) {});
}

EngineTimes run_once(Engine& engine, const PreparedCase& prepared, Row& row) {
    return row.precision == Precision::f64 ? run_once<double>(engine, prepared, row)
                                           : run_once<float>(engine, prepared, row);
}

// The fastest of three, after one in which kernels are compiled.
void time_runs(Engine& engine, const PreparedCase& prepared, Row& row) {
    run_once(engine, prepared, row);
    for (int i = 0; i < 3; ++i) {
        const Clock::time_point start = Clock::now();
        const EngineTimes times = run_once(engine, prepared, row);
        if (const double seconds = seconds_since(start); seconds < row.seconds) {
            row.seconds = seconds;
            row.kernel = times.kernel;
            row.group = times.group;
        }
    }
}

void compare(Engine& engine, const PreparedCase& prepared, Row& row) {
    if (prepared.one.scene.paths) {
        const PathComparison found = compare_paths(engine, prepared, row.precision);
        row.compared = found.error.samples;
        row.differing = found.error.differing;
        row.passed = found.passed;
        row.first_difference = found.error.first;
        return;
    }
    const Comparison found = compare_case(engine, prepared, row.precision);
    row.compared = found.voxels;
    row.differing = found.differing;
    row.passed = found.passed;
    row.first_difference = found.first_difference;
    row.rounding = found.relative(found.oracle);
}

// Samples along a side: 0.1 and 28 million in all.
constexpr std::uint64_t kSoftwareSide = 64, kHardwareSide = 384;
std::uint64_t side_of(const compute::DeviceReport& device) {
    return device.software ? kSoftwareSide : kHardwareSide;
}

DeviceRows examine(const compute::DeviceReport& device, const std::vector<Precision>& precisions, EngineOptions options,
                   Stage& stage) {
    options.gpu = std::to_string(device.index);
    EngineOptions twice = options, oracle = options;
    twice.twice = oracle.cpu = options.try_groups = true;
    oracle.gpu.clear();
    const auto timed = make_engine(options), compared = make_engine(twice), cpu = make_engine(oracle);
    DeviceRows found{device, {}, {}};
    {
        compute::DeviceOptions one;
        one.wanted = options.gpu;
        compute::Device opened(one);
        found.bandwidth = compute::measure_bandwidth(opened);
    }
    // What a device cannot do is in its row.
    const auto attempt = [](Row& row, const auto& work) {
        try {
            work();
        } catch (const compute::DeviceError& error) {
            row.passed = false;
            row.first_difference = error.what();
        }
    };
    for (const Law& law : laws())
        for (const Precision precision : precisions) {
            Row& row = found.rows.emplace_back(Row{&law, precision});
            stage.update(found.rows.size() - 1, law.name);
            attempt(row, [&] { compare(*compared, case_of(law, 40), row); });
            Row on_cpu{&law, precision};
            time_runs(*cpu, case_of(law, kSoftwareSide), on_cpu);
            row.cpu = static_cast<double>(on_cpu.samples) / on_cpu.seconds;
            attempt(row, [&] { time_runs(*timed, case_of(law, side_of(device)), row); });
        }
    return found;
}

// Samples a second of all devices at work at once, each on the same field. \throws compute::DeviceError.
double rate_of_all(const std::vector<DeviceRows>& devices, const EngineOptions& options) {
    std::vector<std::unique_ptr<Engine>> engines;
    for (const DeviceRows& one : devices) {
        EngineOptions own = options;
        own.gpu = std::to_string(one.device.index);
        engines.push_back(make_engine(own));
    }
    std::vector<Row> rows(devices.size(), {&law_of_all(), Precision::f32});
    const auto run_all = [&] {
        std::vector<std::future<void>> done; // each waits for its thread
        for (std::size_t i = 0; i < engines.size(); ++i)
            done.push_back(std::async(std::launch::async, [&, i] {
                const PreparedCase prepared = case_of(*rows[i].law, side_of(devices[i].device));
                run_once(*engines[i], prepared, rows[i]);
            }));
        for (std::future<void>& one : done)
            one.get();
    };
    run_all();
    const Clock::time_point start = Clock::now();
    run_all();
    double samples = 0;
    for (const Row& row : rows)
        samples += static_cast<double>(row.samples);
    return samples / seconds_since(start);
}

std::string gigabytes(double bytes_per_second) {
    return fmt::format("{:.3g} GB/s", 1e-9 * bytes_per_second);
}

std::string table_of(const DeviceRows& device) {
    std::string text =
        fmt::format("## {}\n\n{}, {}, Vulkan {}, {:.1f} GiB, subgroups of {}, {} invocations a group, {}, {}\n\n"
                    "Bandwidth: {} stored, {} copied, {} read back.\n\n"
                    "| law | precision | values compared | differ | f32 from f64, of the largest force | verdict | "
                    "million samples/s | in kernels alone | work group | results written, of the store bandwidth | the "
                    "CPU's million samples/s |\n"
                    "|---|---|---|---|---|---|---|---|---|---|---|\n",
                    device.device.name, device.device.type, device.device.driver, device.device.api,
                    static_cast<double>(device.device.memory) / (1 << 30), device.device.subgroup,
                    device.device.group_invocations, device.device.f64 ? "double precision" : "no double precision",
                    device.device.int64 ? "64-bit integers" : "no 64-bit integers", gigabytes(device.bandwidth.store),
                    gigabytes(device.bandwidth.copy), gigabytes(device.bandwidth.read_back));
    for (const Row& row : device.rows)
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} | {:.3g} | {:.3g} | {} | {:.2g} % | {:.3g} |\n", row.law->name,
                        name_of(row.precision), row.compared, row.differing,
                        row.rounding ? fmt::format("{:.2g}", *row.rounding) : "", row.passed ? "ok" : "**FAILED**",
                        1e-6 * static_cast<double>(row.samples) / row.seconds,
                        row.kernel > 0 ? 1e-6 * static_cast<double>(row.samples) / row.kernel : 0, row.group,
                        row.kernel > 0 ? 100 * static_cast<double>(row.bytes) / row.kernel / device.bandwidth.store : 0,
                        1e-6 * row.cpu);
    for (const Row& row : device.rows)
        if (!row.passed)
            text += fmt::format("\n{}, {}: {}\n", row.law->name, name_of(row.precision), row.first_difference);
    return text + "\n";
}

Json with_rows(const DeviceRows& device) {
    Json rows = Json::array();
    for (const Row& row : device.rows)
        rows.push_back({{"law", row.law->name},
                        {"precision", name_of(row.precision)},
                        {"compared", row.compared},
                        {"differing", row.differing},
                        {"rounding_1", row.rounding ? Json(*row.rounding) : Json()},
                        {"passed", row.passed},
                        {"first_difference", row.first_difference},
                        {"samples", row.samples},
                        {"seconds", row.seconds},
                        {"kernel_s", row.kernel},
                        {"group_invocations", row.group},
                        {"cpu_samples_per_s", row.cpu},
                        {"result_bytes", row.bytes}});
    Json json = json_of(device.device);
    json.update({{"store_bytes_per_s", device.bandwidth.store},
                 {"copy_bytes_per_s", device.bandwidth.copy},
                 {"read_back_bytes_per_s", device.bandwidth.read_back},
                 {"rows", rows}});
    return json;
}

} // namespace

nlohmann::ordered_json json_of(const compute::DeviceReport& device) {
    return {{"index", device.index},
            {"name", device.name},
            {"uuid", device.uuid},
            {"type", device.type},
            {"driver", device.driver},
            {"vulkan", device.api},
            {"f64", device.f64},
            {"int64", device.int64},
            {"floats", compute::text_of(device.single)},
            {"doubles", compute::text_of(device.twice)},
            {"memory_bytes", device.memory},
            {"storage_buffer_bytes", device.buffer_range},
            {"group_invocations", device.group_invocations},
            {"subgroup", device.subgroup},
            {"refused", device.refusals}};
}

bool write_gpu_report(const std::filesystem::path& folder, const CommonOptions& common) {
    std::error_code none;
    if (std::filesystem::exists(folder, none))
        throw UsageError("{} is there already: name a new folder for the report", folder.string());
    if (common.engine == "cpu")
        throw UsageError("--gpu-report is of Vulkan devices: leave --engine cpu out");
    std::filesystem::create_directories(folder); // an error comes before the work
    const bool needs_f64 = common.precision == "f64";
    const std::vector<compute::DeviceReport> listed = compute::list_devices();
    std::vector<compute::DeviceReport> usable;
    if (!common.gpu.empty() && common.gpu != "all")
        usable.push_back(compute::choose_device(listed, common.gpu, needs_f64));
    else
        std::ranges::copy_if(listed, std::back_inserter(usable), [&](const compute::DeviceReport& one) {
            return one.refusals.empty() && (one.f64 || !needs_f64);
        });
    if (usable.empty())
        compute::choose_device(listed, "", needs_f64); // throws, with all reasons
    const EngineOptions options = device_options(common, needs_f64);
    std::vector<DeviceRows> found;
    std::string failures; // of whole devices
    for (const compute::DeviceReport& device : usable) {
        const std::vector<Precision> tried = precisions_of(common, device.f64);
        Stage stage(device.name, laws().size() * tried.size(), "laws");
        try {
            found.push_back(examine(device, tried, options, stage));
        } catch (const compute::DeviceError& error) {
            failures += fmt::format("\n{} failed: {}.\n", device.name, error.what());
        }
    }
    const auto samples = [](std::uint64_t side) { return side * (side / 2) * side; };
    std::string text = fmt::format(
        "# GPU report\n\nforceshade {} on {}, {} cores. Fields of {} samples on software and {} on hardware, 100000 of "
        "paths, are timed with their way to the host; the CPU's, as those on software. Every value of smaller fields "
        "is compared with the CPU oracle's: software must have its bits, hardware be within what rounding allows.\n\n",
        version(), cpu_name(), allowed_cores(), samples(kSoftwareSide), samples(kHardwareSide));
    Json json{{"forceshade", version()}, {"cpu", cpu_name()}, {"devices", Json::array()}};
    bool passed = failures.empty();
    text += failures;
    for (const DeviceRows& device : found) {
        text += table_of(device);
        json["devices"].push_back(with_rows(device));
        for (const Row& row : device.rows)
            passed = passed && row.passed;
    }
    if (found.size() > 1) {
        text += fmt::format("All {} devices at once, {}: ", found.size(), law_of_all().name);
        try {
            const double rate = rate_of_all(found, options);
            text += fmt::format("{:.3g} million samples/s.\n", 1e-6 * rate);
            json["samples_per_s_of_all"] = rate;
        } catch (const compute::DeviceError& error) {
            text += fmt::format("failed: {}.\n", error.what());
            passed = false;
        }
    }
    for (const compute::DeviceReport& device : listed)
        if (!device.refusals.empty())
            text += fmt::format("Not usable: {}: {}.\n", device.name, fmt::join(device.refusals, "; "));
    write_file_atomically(folder / "report.md", text);
    write_file_atomically(folder / "report.json", json.dump(2) + "\n");
    return passed;
}

} // namespace forceshade

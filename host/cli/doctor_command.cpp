#include <fstream>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "device/backends/devices.h"
#include "device/loop/permissions.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/scene/schema.h"
#include "host/sweep/manifest.h"

namespace forceshade {

namespace {

struct Finding {
    bool good;
    std::string what, advice;
    bool needed = true; // else its absence is worth a word, but no problem
};

// One try: what works, or what to do.
template <typename Try> Finding examine(const std::string& what, const std::string& advice, Try&& attempt) {
    try {
        return {true, fmt::format("{}: {}", what, attempt()), {}};
    } catch (const std::exception& error) {
        return {false, fmt::format("{}: {}", what, error.what()), advice};
    }
}

std::string list_usable_devices() {
    std::vector<std::string> usable;
    for (const compute::DeviceReport& device : compute::list_devices())
        if (device.refusals.empty())
            usable.push_back(device.name);
    if (usable.empty())
        throw std::runtime_error("none that is usable");
    return fmt::format("{}", fmt::join(usable, ", "));
}

// A small field in each precision, every voxel compared.
std::string try_kernels(const CommonOptions& common, bool validation) {
    EngineOptions options = engine_options(common, false);
    options.validation = validation;
    const auto engine = make_engine(options);
    CasePreparation preparation;
    const PreparedCase prepared = preparation.prepare(parse_scene(
        "[surface]\nkind = \"bump\"\nfacets = 3\n[force]\nshading = \"reference\"\n[grid]\nsize = [64, 4, 32]\n"
        "spacing = \"0.8 mm\"\n",
        "doctor"));
    std::vector<Precision> precisions{Precision::f32};
    if (engine->report().f64)
        precisions.push_back(Precision::f64);
    std::uint64_t voxels = 0;
    for (const Precision precision : precisions) {
        const Comparison comparison = compare_case(*engine, prepared, precision);
        if (!comparison.passed)
            throw std::runtime_error(comparison.first_difference);
        voxels += comparison.voxels;
    }
    return fmt::format("{} voxels on {} agree with the oracle", voxels, engine->report().device);
}

std::string find_font() {
    const std::filesystem::path font = "truetype/dejavu/DejaVuSans.ttf";
    const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "share/fonts";
    if (std::filesystem::exists("/usr/share/fonts" / font) || std::filesystem::exists(own / font.filename()))
        return "DejaVu Sans";
    throw std::runtime_error(("/usr/share/fonts" / font).string() + " is not there");
}

// The files of Vulkan that this process has loaded, by their names: the loader's and, while an engine lives, the
// drivers'.
std::string vulkan_files() {
    std::set<std::string> files;
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        const std::size_t begin = line.find('/');
        const std::string file = begin == std::string::npos ? "" : line.substr(begin);
        const std::string name = std::filesystem::path(file).filename();
        if (name.find(".so") != std::string::npos && (name.find("vulkan") != std::string::npos ||
                                                      name.starts_with("libGLX_nvidia") || name.starts_with("amdvlk")))
            files.insert(file);
    }
    return fmt::format("{}", fmt::join(files, ", "));
}

std::string find_driver(const CommonOptions& common) {
    const auto engine = make_engine(engine_options(common, false));
    const EngineReport report = engine->report();
    return report.engine == "cpu" ? "none, with --engine cpu"
                                  : fmt::format("{} for {}; loaded: {}", report.driver, report.device, vulkan_files());
}

std::string try_cache() {
    const std::filesystem::path folder = default_cache_folder();
    if (folder.empty())
        throw std::runtime_error("neither HOME nor XDG_CACHE_HOME is set");
    std::filesystem::create_directories(folder);
    const TemporaryFile probe(folder / "doctor");
    return folder.string();
}

// What the live loop would be granted; tried in a thread that is gone afterwards.
void examine_real_time(std::vector<Finding>& findings) {
    device::Permissions permissions;
    std::thread([&] { permissions = device::ask_for_real_time(std::nullopt); }).join();
    for (const auto& [what, granted, detail] : permissions.all)
        findings.push_back({granted, fmt::format("live loop, {}: {}", what, detail),
                            "forceshade live works without, but samples may be late", false});
}

std::vector<Finding> examine_all(const CommonOptions& common) {
    std::vector<Finding> findings;
    findings.push_back({true,
                        fmt::format("program: forceshade {} on {}, {} cores", version(), cpu_name(),
                                    std::thread::hardware_concurrency()),
                        {}});
    findings.push_back(examine("font of the pictures",
                               "install the package fonts-dejavu-core; without it --also png uses another font",
                               find_font));
    findings.push_back(examine("Vulkan devices",
                               "install a driver: package mesa-vulkan-drivers has the software one; ./host/run does it",
                               list_usable_devices));
    findings.push_back(examine("Vulkan driver", "forceshade gpus says why each device was refused",
                               [&] { return find_driver(common); }));
    findings.push_back(examine("kernels", "try another device (forceshade gpus), or work with --engine cpu",
                               [&] { return try_kernels(common, false); }));
    findings.push_back(examine(
        "validation layers", "only development needs them: package vulkan-validationlayers, which ./tests/run installs",
        [&] { return try_kernels(common, true); }));
    findings.back().needed = false;
    findings.push_back(examine(
        "compiled kernels are kept in",
        "make the folder writable, or set XDG_CACHE_HOME; without it kernels are compiled at every start", try_cache));
    examine_real_time(findings);
    return findings;
}

int diagnose(const CommonOptions& common) {
    const std::vector<Finding> findings = examine_all(common);
    bool good = true;
    std::string text;
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const Finding& finding : findings) {
        good = good && (finding.good || !finding.needed);
        text += fmt::format("{}  {}\n",
                            finding.good     ? "ok     "
                            : finding.needed ? "problem"
                                             : "absent ",
                            finding.what);
        if (!finding.good)
            text += fmt::format("         {}\n", finding.advice);
        json.push_back(
            {{"ok", finding.good}, {"needed", finding.needed}, {"what", finding.what}, {"advice", finding.advice}});
    }
    print_data(common.json ? json.dump(2) + "\n" : text);
    return good ? 0 : 1;
}

std::string as_json(const std::vector<compute::DeviceReport>& devices) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const compute::DeviceReport& device : devices)
        json.push_back({{"index", device.index},
                        {"name", device.name},
                        {"uuid", device.uuid},
                        {"type", device.type},
                        {"driver", device.driver},
                        {"vulkan", device.api},
                        {"f64", device.f64},
                        {"int64", device.int64},
                        {"memory_bytes", device.memory},
                        {"storage_buffer_bytes", device.buffer_range},
                        {"subgroup", device.subgroup},
                        {"refused", device.refusals}});
    return json.dump(2) + "\n";
}

std::string as_text(const std::vector<compute::DeviceReport>& devices) {
    std::string text;
    for (const compute::DeviceReport& device : devices) {
        text += fmt::format(
            "{}  {}\n   {}, {}, Vulkan {}\n   UUID {}\n   {:.1f} GiB, storage buffers to {:.0f} MiB, {}\n",
            device.index, device.name, device.type, device.driver, device.api, device.uuid,
            static_cast<double>(device.memory) / (1 << 30), static_cast<double>(device.buffer_range) / (1 << 20),
            device.f64 ? "double precision" : "no double precision");
        text +=
            device.refusals.empty() ? "   usable\n" : fmt::format("   refused: {}\n", fmt::join(device.refusals, "; "));
    }
    return text;
}

int list_gpus(const CommonOptions& common) {
    const auto devices = compute::list_devices();
    print_data(common.json ? as_json(devices) : as_text(devices));
    // Without any flag this is the device that a run would take; it throws where there is none.
    const compute::DeviceReport& chosen = compute::choose_device(devices, common.gpu, common.precision == "f64");
    if (!common.quiet)
        remark("a run {} takes {} ({})\n", common.gpu.empty() ? "without --gpu" : "with this --gpu", chosen.index,
               chosen.name);
    return 0;
}

using device::DeviceKind;

std::string as_json(const std::vector<DeviceKind>& kinds) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const DeviceKind& kind : kinds)
        json.push_back({{"option", kind.option},
                        {"what", kind.what},
                        {"devices", kind.devices},
                        {"name", kind.name},
                        {"software", kind.software},
                        {"place", kind.place},
                        {"problem", kind.problem}});
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"; // names are the vendors'
}

std::string as_text(const std::vector<DeviceKind>& kinds) {
    std::string text;
    for (const DeviceKind& kind : kinds) {
        text += fmt::format("{:<12} {}\n", kind.option, kind.what);
        if (!kind.place.empty())
            text += fmt::format("   {}{}{}\n", kind.software, kind.software.empty() ? "" : ", ", kind.place);
        if (!kind.devices.empty())
            text += fmt::format("   there: --device {}{}\n", fmt::join(kind.devices, ", "),
                                kind.name.empty() ? "" : ", " + kind.name);
        if (!kind.problem.empty())
            text += fmt::format("   not there: {}\n", kind.problem);
    }
    return text;
}

int list_devices(const CommonOptions& common) {
    const std::vector<DeviceKind> kinds = device::list_devices();
    print_data(common.json ? as_json(kinds) : as_text(kinds));
    return 0;
}

struct SchemaArguments {
    bool paper = false; // the built-in study instead
};

int print_schema(const SchemaArguments& arguments, const CommonOptions& common) {
    if (arguments.paper && common.json)
        throw UsageError("--default-study prints TOML: leave out --json");
    print_data(arguments.paper ? std::string(default_study_toml()) : common.json ? schema_json() : schema_text());
    return 0;
}

void describe(Options& options, SchemaArguments& arguments) {
    options.flag("--default-study", arguments.paper, "print the built-in study of the paper instead, to start from");
}

} // namespace

void add_doctor_command(CommandLine& program) {
    program.add("doctor", "Say what is installed, what works, and what to do about the rest", diagnose);
}

void add_gpus_command(CommandLine& program) {
    program.add("gpus", "List the Vulkan devices and why one would be refused", list_gpus);
}

void add_devices_command(CommandLine& program) {
    program.add("devices", "List the haptic devices that live could drive here, and why not the others", list_devices)
        .footer("FORCESHADE_DHD_LIBRARY and FORCESHADE_HD_LIBRARY name the file of Force Dimension's and of 3D "
                "Systems' library where the dynamic linker would not find it.");
}

void add_schema_command(CommandLine& program) {
    program.add<SchemaArguments>("schema", "Print every key of a scene or study, its unit, default and meaning",
                                 print_schema, describe);
}

} // namespace forceshade

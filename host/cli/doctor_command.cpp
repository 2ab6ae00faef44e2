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
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/paths/recorded.h"
#include "host/referee/validate.h"
#include "host/scene/cases.h"
#include "host/sweep/manifest.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade {

namespace {

struct Finding {
    bool good;
    std::string what, advice;
    bool needed = true; // else its absence is worth a word, but no problem
};

// One try: what works, or what to do.
template <typename Try> Finding examine(const char* what, const char* advice, Try&& attempt, bool needed = true) {
    try {
        return {true, fmt::format("{}: {}", what, attempt()), {}, needed};
    } catch (const std::exception& error) {
        return {false, fmt::format("{}: {}", what, error.what()), advice, needed};
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

std::vector<Precision> precisions_of(const EngineReport& engine) {
    return engine.f64 ? std::vector{Precision::f32, Precision::f64} : std::vector{Precision::f32};
}

// A small field in each precision, every voxel compared.
std::string try_kernels(const CommonOptions& common, bool validation) {
    EngineOptions options = device_options(common, false);
    options.validation = validation;
    const auto engine = make_engine(options);
    const PreparedCase prepared = CasePreparation().prepare(parse_scene(
        "[surface]\nkind = \"bump\"\nfacets = 3\n[force]\nshading = \"reference\"\n[grid]\nsize = [64, 4, 32]\n"
        "spacing = \"0.8 mm\"\n",
        "doctor"));
    std::uint64_t voxels = 0;
    for (const Precision precision : precisions_of(engine->report())) {
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
    const auto engine = make_engine(device_options(common, false));
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

std::vector<Finding> examine_all(const CommonOptions& common) {
    std::vector<Finding> findings{
        {true, fmt::format("program: forceshade {} on {}, {} cores", version(), cpu_name(), allowed_cores()), {}},
        examine("font of the pictures",
                "install the package fonts-dejavu-core; without it --also png uses another font", find_font),
        examine("Vulkan devices",
                "install a driver: package mesa-vulkan-drivers has the software one; ./host/run does it",
                list_usable_devices),
        examine("Vulkan driver", "forceshade gpus says why each device was refused",
                [&] { return find_driver(common); }),
        examine("kernels", "try another device (forceshade gpus), or work with --engine cpu",
                [&] { return try_kernels(common, false); }),
        examine(
            "validation layers",
            "only development needs them: package vulkan-validationlayers, which ./tests/run installs",
            [&] { return try_kernels(common, true); }, false),
        examine("compiled kernels are kept in",
                "make the folder writable, or set XDG_CACHE_HOME; without it kernels are compiled at every start",
                try_cache)};
    // What the live loop would be granted; tried in a thread that is gone afterwards.
    device::Permissions permissions;
    std::thread([&] { permissions = device::ask_for_real_time(std::nullopt); }).join();
    for (const auto& [what, granted, detail] : permissions.all)
        findings.push_back({granted, fmt::format("live loop, {}: {}", what, detail),
                            "forceshade live works without, but samples may be late", false});
    return findings;
}

int diagnose(const CommonOptions& common) {
    const LongRun long_run(common.quiet);
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
    // It throws where there is none.
    const compute::DeviceReport& chosen = compute::choose_device(devices, common.gpu, common.precision == "f64");
    if (!common.quiet)
        remark("--{} takes {} ({})\n", common.gpu.empty() ? "engine gpu" : "gpu " + common.gpu, chosen.index,
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

struct ValidateArguments {
    std::string study, only = "*";
};

// Single and double precision where the user asks for neither and the device has both.
std::vector<Precision> precisions(const CommonOptions& common, const EngineReport& engine) {
    if (!common.precision.empty())
        return {common.precision == "f64" ? Precision::f64 : Precision::f32};
    if (!engine.f64 && !common.quiet)
        remark("{} has no double precision: only f32 is validated\n", engine.device);
    return precisions_of(engine);
}

// Prints what was compared; true if all of it passed.
bool print(const std::vector<Comparison>& fields, const std::vector<PathComparison>& paths, const CommonOptions& common,
           const EngineReport& engine) {
    const Totals voxels = totals_of(fields);
    const PathTotals samples = totals_of(paths);
    const bool passed = voxels.passed && samples.passed;
    if (common.json) {
        nlohmann::ordered_json json = nlohmann::ordered_json::parse(comparison_json(fields, engine));
        if (!paths.empty()) {
            json["paths"] = nlohmann::ordered_json::parse(path_comparison_json(paths));
            json["samples"] = samples.samples;
            json["samples_differing"] = samples.differing;
            json["passed"] = passed;
        }
        print_data(json.dump(2) + "\n");
        return passed;
    }
    std::string text;
    if (!fields.empty())
        text += comparison_table(fields) + fmt::format("{} voxels, {} differ\n", voxels.voxels, voxels.differing);
    if (!paths.empty())
        text +=
            path_comparison_table(paths) + fmt::format("{} samples, {} differ\n", samples.samples, samples.differing);
    print_data(text);
    return passed;
}

int run(const ValidateArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const Study study = load_study(arguments.study, common);
    const std::vector<const Case*> cases = cases_named(study, arguments.only);
    const auto engine = make_engine(device_options(common, common.precision == "f64"));
    const std::vector<Precision> wanted = precisions(common, engine->report());
    CasePreparation preparation;
    std::vector<Comparison> fields;
    std::vector<PathComparison> paths;
    std::set<std::string> warned;
    std::size_t all = 0;
    for (const Case* one : cases)
        all += wanted.size() * ((one->scene.field ? 1 : 0) + (one->scene.paths ? 1 : 0));
    Stage stage("preparing", all, "comparisons");
    for (const Case* one : cases) {
        stage.update(fields.size() + paths.size(), one->name);
        PreparedCase prepared = preparation.prepare(*one);
        add_recorded_digest(prepared);
        for (const std::string& warning : prepared.warnings)
            if (warned.insert(warning).second)
                print_warnings({warning}, common);
        for (const Precision precision : wanted) {
            if (one->scene.field)
                fields.push_back(compare_case(*engine, prepared, precision));
            if (one->scene.paths)
                paths.push_back(compare_paths(*engine, prepared, precision));
            stage.update(fields.size() + paths.size());
        }
    }
    const bool passed = print(fields, paths, common, engine->report());
    if (!passed && !common.quiet)
        remark("a bound was exceeded on {}\n", engine->report().device);
    return passed ? 0 : 1;
}

} // namespace

void add_check_commands(CommandLine& program) {
    program.add<ValidateArguments>(
        "validate", "Hold the device against the CPU oracle and the closed forms, on every voxel and every path", run,
        [](Options& options, ValidateArguments& arguments) {
            options.optional("SCENE-or-STUDY", arguments.study,
                             "TOML file; without it the paper's study, which is built in");
            options.optional("--only CASES", arguments.only, "shell pattern of case names").names(case_names);
            options.example("validate bump.toml", "a scene in both precisions")
                .example("validate --only '*600mil_facets-3_*' --gpu 0", "cases of the paper on a device");
        });
    program.add("gpus", "List the Vulkan devices and why one would be refused", list_gpus)
        .example("gpus", "the devices, and which one would be taken")
        .example("gpus --json", "the same for a script");
    program.add("devices", "List the haptic devices that live could drive here, and why not the others", list_devices)
        .footer("FORCESHADE_DHD_LIBRARY and FORCESHADE_HD_LIBRARY name the file of Force Dimension's and of 3D "
                "Systems' library where the dynamic linker would not find it.")
        .example("devices", "what --device takes here")
        .example("devices --json", "the same for a script");
    program.add("doctor", "Say what is installed, what works, and what to do about the rest", diagnose)
        .example("doctor", "this machine")
        .example("doctor --engine cpu", "likewise, where no Vulkan device is wanted");
}

} // namespace forceshade

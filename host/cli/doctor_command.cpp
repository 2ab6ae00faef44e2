// forceshade doctor.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "device/backends/devices.h"
#include "device/loop/real_time.h"
#include "host/cli/command.h"
#include "host/cli/gpu_report.h"
#include "host/error.h"
#include "host/field/engine.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/output/kept.h"
#include "host/referee/validate.h"
#include "host/scene/cases.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade {

namespace {

struct Finding {
    bool good;
    std::string what, advice;
    bool needed = true; // else its absence is reported, but no problem
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
    for (const Precision precision : precisions_of({}, engine->report().f64)) {
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

// The module next to this program, or where python3 finds it, the user's own or else Debian's.
std::string try_python() {
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    ::setenv("FORCESHADE_MODULE", (program / "python").c_str(), 1);
    std::FILE* output =
        ::popen("export PYTHONPATH=\"$FORCESHADE_MODULE${PYTHONPATH:+:$PYTHONPATH}\"; for python in python3 "
                "/usr/bin/python3; do $python -c 'import sys, forceshade; print(forceshade.__version__, \"in\", "
                "forceshade.__path__[0], \"for\", sys.executable, sys.version.split()[0])' 2>&1 && exit; done; exit 1",
                "r");
    if (!output)
        throw std::runtime_error("cannot start python3");
    std::string text, last;
    for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output))
        text += static_cast<char>(c);
    const bool failed = ::pclose(output) != 0;
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    last = text.substr(text.rfind('\n') + 1);
    if (failed)
        throw std::runtime_error(last.empty() ? "python3 fails" : last);
    if (!last.starts_with(version() + " "))
        throw std::runtime_error(last + ", and the program is " + version());
    return last;
}

struct DoctorArguments {
    bool live = false;
    std::string gpu_report; /* folder */
};

// A second at each rate, in a thread that has what the live loop is granted.
void examine_wake_ups(std::vector<Finding>& findings) {
    for (const double rate : {1000.0, 4000.0}) {
        const device::WakeUps found = device::measure_wake_ups(rate, 1);
        const auto text = [&](double ns) { return fmt::format("{:.0f} us", 1e-3 * ns); };
        findings.push_back(
            {found.punctual(),
             fmt::format("live loop at {:.0f} kHz: wakes {} late (p50), {} (p99.9), {} at worst; {} of {} periods lost",
                         rate / 1e3, text(found.late.quantile(0.5)), text(found.late.quantile(0.999)),
                         text(static_cast<double>(found.late.largest())), found.lost, found.late.count()),
             "a loop at this rate would be late: end other programs, or try a slower --rate; a kernel with PREEMPT_RT, "
             "a core of its own (--cpu, isolcpus) and the governor performance help"});
    }
}

std::vector<Finding> examine_all(const DoctorArguments& arguments, const CommonOptions& common) {
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
    findings.push_back(examine("Python module",
                               "for Debian's python3, package python3-numpy; ./host/run builds the module: export "
                               "PYTHONPATH=$PWD/build/python",
                               try_python, false));
    // What the live loop would be granted; tried in a thread that is gone afterwards.
    device::Permissions permissions;
    std::vector<Finding> wake_ups;
    std::thread([&] {
        permissions = device::ask_for_real_time(std::nullopt);
        if (arguments.live)
            examine_wake_ups(wake_ups);
    }).join();
    for (const auto& [what, granted, detail] : permissions.all)
        findings.push_back({granted, fmt::format("live loop, {}: {}", what, detail),
                            "forceshade live works without, but samples may be late", false});
    if (arguments.live)
        for (const auto& [what, good, detail] : device::real_time_settings())
            findings.push_back({good, fmt::format("live loop, {}: {}", what, detail),
                                "the times below decide whether it matters", false});
    std::ranges::move(wake_ups, std::back_inserter(findings));
    return findings;
}

int diagnose(const DoctorArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    if (!arguments.gpu_report.empty()) {
        const bool passed = write_gpu_report(arguments.gpu_report, common);
        note(common, "{}/report.md, report.json: {}\n", arguments.gpu_report,
             passed ? "every value agrees with the oracle" : "a device is wrong: see the rows that failed");
        return passed ? 0 : 1;
    }
    const std::vector<Finding> findings = examine_all(arguments, common);
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

} // namespace

void add_doctor_command(CommandLine& program) {
    program.add<DoctorArguments>(
        "doctor", "Say what is installed, what works, and what to do about the rest", diagnose,
        [](Options& options, DoctorArguments& arguments) {
            options.flag("--live", arguments.live,
                         "measure for two seconds how punctually a live loop would wake, at 1 and 4 kHz");
            options.optional("--gpu-report FOLDER", arguments.gpu_report,
                             "hold every law on every usable Vulkan device (or --gpu's) against the oracle, time it "
                             "against the device's bandwidth, and write it into a new folder, to be sent");
            options.example("doctor", "this machine")
                .example("doctor --engine cpu", "the same without a Vulkan device")
                .example("doctor --live", "before a device is connected")
                .example("doctor --gpu-report gpu", "on a machine with a GPU that was not tried yet");
        });
}

} // namespace forceshade

#include "host/cli/command.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host/error.h"
#include "host/output/reading.h"
#include "host/scene/value.h"

namespace forceshade {

namespace {

constexpr const char* kFooter =
    "Every command takes --gpu NAME|UUID|INDEX, --engine auto|gpu|cpu, --precision f32|f64, --max-memory SIZE, --json, "
    "--quiet and --vulkan-validation.\nExit codes: 0 ok, 1 a case failed or a bound was exceeded, 2 usage or "
    "configuration, 3 no such device, 4 files, 130 interrupted.\nStart with: forceshade sweep --out results/paper";

void add_common_options(CLI::App& app, CommonOptions& common) {
    app.add_option(
           "--gpu", common.gpu,
           "Vulkan device: part of its name, UUID or index (forceshade gpus); default: a hardware GPU where there is "
           "one, else the software device")
        ->check(
            [](const std::string& name) { return std::string(name.empty() ? "an empty name is no device's" : ""); });
    app.add_option(
           "--engine", common.engine,
           "auto (default): a hardware GPU where there is one, else the software device or the CPU, whichever was "
           "measured faster at such work (study, validate and doctor, which measure or check a device, take a "
           "device); gpu: a Vulkan device; cpu: the oracle on all cores")
        ->check(CLI::IsMember({"auto", "gpu", "cpu"}));
    app.add_option("--precision", common.precision, "f32 or f64; default: as the scene says")
        ->check(CLI::IsMember({"f32", "f64"}));
    app.add_option_function<std::string>(
        "--max-memory", [](const std::string& text) { set_memory_limit(parse_memory(text)); },
        "most that a file's contents may take, from what its header announces; default: 4 GiB");
    app.add_flag("--json", common.json, "machine-readable results on stdout");
    app.add_flag("--quiet", common.quiet, "no progress and no remarks on stderr, errors only");
    app.add_flag("--vulkan-validation", common.validation_layers,
                 "run under Vulkan's validation layers; any complaint is an error");
}

// CLI11 would only say that a command is required.
void refuse_unknown_command(const CLI::App& program, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands(nullptr))
        names.push_back(command->get_name());
    if (word.empty() || word.front() == '-' || std::find(names.begin(), names.end(), word) != names.end())
        return;
    refuse_unknown("command", word, names);
}

} // namespace

template <typename T> void Options::add(const char* name, T& value, const std::string& help, bool required) {
    CLI::Option* const option = app_.add_option(name, value, help)->required(required);
    if (heading_)
        option->group(heading_);
}
template void Options::add(const char*, std::string&, const std::string&, bool);
template void Options::add(const char*, std::optional<std::string>&, const std::string&, bool);
template void Options::add(const char*, std::optional<int>&, const std::string&, bool);

void Options::flag(const char* name, bool& value, const std::string& help) {
    CLI::Option* const option = app_.add_flag(name, value, help);
    if (heading_)
        option->group(heading_);
}

void Options::list(const char* name, std::vector<std::string>& values, const std::string& help) {
    app_.add_option(name, values, help)->delimiter(',');
}

void Options::read(const char* name, std::function<void(const std::string&)> read, const std::string& help) {
    const auto read_some = [read = std::move(read)](const std::string& text) {
        if (!text.empty())
            read(text);
    };
    CLI::Option* const option = app_.add_option_function<std::string>(name, read_some, help);
    if (heading_)
        option->group(heading_);
}

void Options::footer(const std::string& text) {
    app_.footer(text + "\n" + app_.get_footer());
}

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>("Offline study of haptic force fields, with and without force shading",
                                      "forceshade")) {
    app_->set_version_flag("--version", "forceshade " + version());
    app_->require_subcommand(1);
    app_->fallthrough();
    app_->footer(kFooter);
    add_common_options(*app_, common);
}

CommandLine::~CommandLine() = default;

Options CommandLine::add_command(const char* name, const std::string& help, Command command) {
    CLI::App* const added = app_->add_subcommand(name, help);
    added->callback([this, command = std::move(command)] { chosen_ = command; });
    return Options(*added);
}

Command CommandLine::parse(int argc, char** argv) {
    if (argc > 1)
        refuse_unknown_command(*app_, argv[1]);
    try {
        app_->parse(argc, argv);
        return chosen_;
    } catch (const CLI::ParseError& error) {
        std::ostringstream data, complaint;
        const ExitCode code = app_->exit(error, data, complaint) == 0 ? ExitCode::ok : ExitCode::usage;
        return [data = data.str(), complaint = complaint.str(), code] {
            remark("{}", complaint);
            print_data(data);
            return static_cast<int>(code);
        };
    }
}

EngineOptions device_options(const CommonOptions& common, bool needs_f64) {
    if (common.engine == "cpu" && !common.gpu.empty())
        throw UsageError("--gpu and --engine cpu exclude each other");
    EngineOptions options;
    options.cpu = common.engine == "cpu";
    options.gpu = common.gpu;
    options.needs_f64 = needs_f64;
    options.validation = common.validation_layers;
    options.cache = default_cache_folder();
    return options;
}

SettledEngine settle_engine(const CommonOptions& common, bool needs_f64, const Workload& work) {
    SettledEngine settled{device_options(common, needs_f64), ""};
    if (common.engine != "auto" || !common.gpu.empty() || common.validation_layers)
        return settled;
    EngineChoice choice = choose_engine(work, needs_f64);
    settled.options.cpu = choice.cpu;
    settled.options.gpu = std::move(choice.gpu);
    settled.why = std::move(choice.why);
    return settled;
}

std::unique_ptr<Engine> make_engine(const SettledEngine& settled, const CommonOptions& common) {
    if (!settled.why.empty() && !common.quiet)
        remark("engine: {}\n", settled.why);
    return make_engine(settled.options);
}

std::vector<Override> overrides(const CommonOptions& common) {
    if (common.precision.empty())
        return {};
    return {{"run.precision", common.precision}};
}

void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common) {
    if (!common.quiet)
        for (const std::string& warning : warnings)
            remark("warning: {}\n", warning);
}

Case load_scene(const std::string& path, const CommonOptions& common) {
    std::vector<std::string> warnings;
    Case one = read_scene(path, overrides(common), &warnings);
    print_warnings(warnings, common);
    return one;
}

Study load_study(const std::string& path, const CommonOptions& common) {
    const std::vector<Override> replaced = overrides(common);
    Study study = path.empty() ? default_study(replaced) : read_study(path, replaced);
    print_warnings(study.warnings, common);
    return study;
}

void refuse_unknown(const char* what, const std::string& word, const std::vector<std::string>& names) {
    const std::string_view meant = nearest(word, names);
    throw UsageError(fmt::format("no {} \"{}\"{}; there are {}", what, word,
                                 meant.empty() ? "" : fmt::format(", did you mean {}?", meant),
                                 fmt::join(names, ", ")));
}

std::string plural(std::uint64_t count, const char* noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void print_data(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
        return;
    if (errno != EPIPE) // a reader that has seen enough, such as head, is no error
        throw IoError("cannot write to standard output");
}

} // namespace forceshade

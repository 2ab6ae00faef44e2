#include "host/cli/options.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/reading.h"
#include "host/program.h"
#include "host/scene/value.h"

namespace forceshade {

namespace {

constexpr const char* kFooter =
    "Every command takes --gpu NAME|UUID|INDEX, --engine gpu|cpu, --precision f32|f64, --max-memory SIZE, --json, "
    "--quiet and --vulkan-validation.\nExit codes: 0 ok, 1 a case failed or a bound was exceeded, 2 usage or "
    "configuration, 3 no such device, 4 files, 130 interrupted.\nStart with: forceshade sweep --out results/paper";

void add_common_options(Options options, CommonOptions& common) {
    options.checked(
        "--gpu", common.gpu,
        [](const std::string& name) -> std::string { return name.empty() ? "an empty name is no device's" : ""; },
        "Vulkan device: part of its name, UUID or index (forceshade gpus); default: the software device");
    options.one_of({"gpu", "cpu"}, "--engine", common.engine, "gpu, or cpu: the oracle on all cores");
    options.one_of({"f32", "f64"}, "--precision", common.precision, "f32 or f64; default: as the scene says");
    options.call(
        "--max-memory", [](const std::string& text) { set_memory_limit(parse_memory(text)); },
        "most that a file's contents may take, from what its header announces; default: 4 GiB");
    options.flag("--json", common.json, "machine-readable results on stdout");
    options.flag("--quiet", common.quiet, "no progress and no remarks on stderr, errors only");
    options.flag("--vulkan-validation", common.validation_layers,
                 "run under Vulkan's validation layers; any complaint is an error");
}

// CLI11 would only say that a command is required.
void refuse_unknown_command(const CLI::App& program, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands(nullptr))
        names.push_back(command->get_name());
    if (word.empty() || word.front() == '-' || std::find(names.begin(), names.end(), word) != names.end())
        return;
    const std::string_view meant = nearest(word, names);
    throw UsageError(fmt::format("no command \"{}\"{}; there are {}", word,
                                 meant.empty() ? "" : fmt::format(", did you mean {}?", meant),
                                 fmt::join(names, ", ")));
}

} // namespace

template <typename T> void Options::value_option(const char* name, T& value, const std::string& help, bool required) {
    CLI::Option* const option = app_.add_option(name, value, help)->required(required);
    if (heading_)
        option->group(heading_);
}
template void Options::value_option(const char*, std::string&, const std::string&, bool);
template void Options::value_option(const char*, std::optional<std::string>&, const std::string&, bool);
template void Options::value_option(const char*, std::optional<int>&, const std::string&, bool);

void Options::flag(const char* name, bool& value, const std::string& help) {
    CLI::Option* const option = app_.add_flag(name, value, help);
    if (heading_)
        option->group(heading_);
}

void Options::list(const char* name, std::vector<std::string>& values, const std::string& help) {
    app_.add_option(name, values, help)->delimiter(',');
}

void Options::one_of(const std::vector<std::string>& words, const char* name, std::string& value,
                     const std::string& help) {
    app_.add_option(name, value, help)->check(CLI::IsMember(words));
}

void Options::checked(const char* name, std::string& value, std::string (*wrong)(const std::string&),
                      const std::string& help) {
    app_.add_option(name, value, help)->check(wrong);
}

void Options::call(const char* name, void (*use)(const std::string&), const std::string& help) {
    app_.add_option_function<std::string>(name, use, help);
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
    add_common_options(Options(*app_), common);
}

CommandLine::~CommandLine() = default;

Options CommandLine::add_command(const char* name, const std::string& help, Command command) {
    CLI::App* const added = app_->add_subcommand(name, help);
    added->callback([this, command = std::move(command)] { chosen_ = command; });
    return Options(*added);
}

Options CommandLine::add(const char* name, const std::string& help, int (*run)(const CommonOptions&)) {
    return add_command(name, help, [this, run] { return run(common); });
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

} // namespace forceshade

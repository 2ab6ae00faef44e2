// The command line's grammar, and what its commands have in common: flags, scenes, the engine, where text goes. Only
// command.cpp sees CLI11, which takes 6 s to compile.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/program.h"
#include "host/scene/study.h"
#include "host/sweep/engine_choice.h"

namespace CLI {
class App;
}

namespace forceshade {

/// Options that every command accepts.
struct CommonOptions {
    std::string gpu;             /* name, UUID or index; empty: hardware, or else the software device */
    std::string engine = "auto"; /* "auto", "gpu" or "cpu" */
    std::string precision;       /* "f32", "f64" or empty: as the scene says */
    bool json = false;
    bool quiet = false;
    bool validation_layers = false;
};

/// The options of one command. A name that starts with `--` is an option's, another a positional argument's. Each
/// function adds one and keeps the reference, which parsing fills.
class Options {
public:
    explicit Options(CLI::App& app) : app_(app) {}

    /// T: std::string, or std::optional of std::string or int.
    template <typename T> void required(const char* name, T& value, const std::string& help) {
        add(name, value, help, true);
    }
    template <typename T> void optional(const char* name, T& value, const std::string& help) {
        add(name, value, help, false);
    }
    void flag(const char* name, bool& value, const std::string& help);
    /// Words between commas.
    void list(const char* name, std::vector<std::string>& values, const std::string& help);
    /// `read` gets the text unless it is empty; it may throw UsageError.
    void read(const char* name, std::function<void(const std::string&)> read, const std::string& help);

    /// The heading, in the help, of the options added from now on.
    void heading(const char* title) { heading_ = title; }
    /// A line of the help before the program's own last lines.
    void footer(const std::string& text);

private:
    template <typename T> void add(const char* name, T& value, const std::string& help, bool required);

    CLI::App& app_;
    const char* heading_ = nullptr;
};

/// A command, ready to run: its exit code, or an exception.
using Command = std::function<int()>;

class CommandLine {
public:
    CommandLine();
    ~CommandLine();

    /// A command with arguments of its own: `describe` adds its options, `run` gets their values.
    template <typename Arguments>
    void add(const char* name, const std::string& help, int (*run)(const Arguments&, const CommonOptions&),
             void (*describe)(Options&, Arguments&)) {
        const auto arguments = std::make_shared<Arguments>();
        Options options = add_command(name, help, [this, run, arguments] { return run(*arguments, common); });
        describe(options, *arguments);
    }
    /// A command without.
    Options add(const char* name, const std::string& help, int (*run)(const CommonOptions&)) {
        return add_command(name, help, [this, run] { return run(common); });
    }

    /// The command that the user named; one that prints what --help and --version ask for, or what is wrong.
    /// \throws UsageError for a command that does not exist.
    Command parse(int argc, char** argv);

    CommonOptions common;

private:
    Options add_command(const char* name, const std::string& help, Command command);

    std::unique_ptr<CLI::App> app_;
    Command chosen_;
};

/// Each adds commands to the program.
void add_evaluation_commands(CommandLine& program); // sweep, field
void add_explore_command(CommandLine& program);
void add_mesh_command(CommandLine& program);
void add_study_commands(CommandLine& program); // study, report
void add_experiment_command(CommandLine& program);
void add_live_command(CommandLine& program);
void add_device_command(CommandLine& program);
void add_check_commands(CommandLine& program); // validate, gpus, devices, doctor, schema

/// What the flags say about the engine, for what measures or tries a device: without flags a Vulkan device.
/// `needs_f64`: some case runs in double precision.
EngineOptions device_options(const CommonOptions& common, bool needs_f64);
/// An engine, settled and not yet there.
struct SettledEngine {
    EngineOptions options;
    std::string why; /* in words; empty: the user asked for it */
};
/// Likewise for what computes: without flags the engine that choose_engine takes for this work.
SettledEngine settle_engine(const CommonOptions& common, bool needs_f64, const Workload& work);
/// Tells on stderr which it is, unless quiet or asked for.
std::unique_ptr<Engine> make_engine(const SettledEngine& settled, const CommonOptions& common);

/// Flags that replace keys of the scene.
std::vector<Override> overrides(const CommonOptions& common);

/// The scene in a file; its warnings go to stderr unless quiet. \throws UsageError for what is no single scene.
Case load_scene(const std::string& path, const CommonOptions& common);

/// The study in a file, or the paper's if `path` is empty; its warnings likewise.
Study load_study(const std::string& path, const CommonOptions& common);

/// To stderr unless quiet.
void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common);

/// `no study "omision", did you mean omission?; there are ...`. \throws UsageError.
[[noreturn]] void refuse_unknown(const char* what, const std::string& word, const std::vector<std::string>& names);

/// "1 path", "2 paths".
std::string plural(std::uint64_t count, const char* noun);

/// Data for stdout. \throws IoError if it cannot be written.
void print_data(const std::string& text);

} // namespace forceshade

// The commands of the program, and their common parts: flags, scenes, the engine, where text goes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "device/session/session.h"
#include "host/cases/engine_choice.h"
#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/picture/picture.h"
#include "host/program.h"
#include "host/scene/study.h"
#include "host/scene/value.h"
#include "host/text.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace forceshade {

struct Grammar;
namespace study {
struct StudyData;
}

/// Options that every command accepts.
struct CommonOptions {
    std::string gpu;             /* name, UUID or index; empty: hardware, or else the software device */
    std::string engine = "auto"; /* "auto", "gpu" or "cpu" */
    std::string precision;       /* "f32", "f64" or empty: as the scene says */
    bool json = false;
    bool quiet = false;
    bool verbose = false;
    bool silent = false;     /* quiet, but what would be said goes to the log; then quiet is false */
    std::string log_file;    /* empty: none */
    bool overwrite = false;  /* files that are there are replaced */
    bool no_clobber = false; /* they stay, and are not an error */
    bool no_cache = false;   /* neither compiled kernels nor prepared meshes of earlier runs */
    bool validation_layers = false;
};

/// The options of one command. A name that starts with `--` is an option's, another a positional argument's; a word
/// after it says what the value is: "--out FILE". Values between `|` are the only ones, and others are refused:
/// "--engine auto|gpu|cpu". --out has the short form -o. Each function adds one and keeps the reference, which parsing
/// fills.
class Options {
public:
    Options(Grammar& grammar, CLI::App& app) : grammar_(grammar), app_(app) {}

    /// T: std::string, or std::optional of std::string or int.
    template <typename T> Options& required(const std::string& name, T& value, const std::string& help) {
        return add(name, value, help, true);
    }
    template <typename T> Options& optional(const std::string& name, T& value, const std::string& help) {
        return add(name, value, help, false);
    }
    Options& flag(const std::string& name, bool& value, const std::string& help);
    /// Words between commas; of a positional argument also several.
    Options& list(const std::string& name, std::vector<std::string>& values, const std::string& help,
                  bool required = false);
    /// Of any text, commas too; the option is said once for each value.
    Options& repeated(const std::string& name, std::vector<std::string>& values, const std::string& help);
    /// `read` gets the text unless it is empty; it may throw UsageError.
    Options& read(const std::string& name, std::function<void(const std::string&)> read, const std::string& help);

    /// Of the one that was added last: its only values.
    Options& one_of(std::vector<std::string> values);
    /// The names that the shell completes for it; `names` gets the command's first argument.
    Options& names(std::function<std::vector<std::string>(const std::string&)> names);

    /// The heading, in the help, of the options added from now on.
    void heading(const char* title) { heading_ = title; }
    /// A command as the user types it, without the program's name, that does something useful, and what.
    Options& example(const std::string& command, const std::string& about);
    /// Another spelling of the command.
    Options& alias(const std::string& name);
    /// A paragraph of the help before the program's own last ones.
    Options& footer(const std::string& text);

private:
    template <typename T> Options& add(const std::string& name, T& value, const std::string& help, bool required);
    Options& keep(CLI::Option* option, const std::string& value_name);

    Grammar& grammar_;
    CLI::App& app_;
    CLI::Option* last_ = nullptr;
    const char* heading_ = nullptr;
};

/// A command, ready to run: its exit code, or an exception.
using Command = std::function<int()>;

class CommandLine {
public:
    CommandLine();
    ~CommandLine();

    /// A group of commands, whose names begin with the group's: "experiment run".
    Options add_group(const char* name, const std::string& help);
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

    /// The command that the user named, or one that prints what help, --help, --version or a shell asks for.
    /// \throws UsageError with the error in the command line, and where to read on.
    Command parse(int argc, char** argv);

    CommonOptions common;

private:
    Options add_command(const char* name, const std::string& help, Command command);

    void add_help_commands();
    std::optional<Command> hidden_command(const std::vector<std::string>& words) const;

    std::unique_ptr<Grammar> grammar_;
    Command chosen_;
};

/// Each adds a command to the program.
void add_sweep_command(CommandLine& program);
void add_field_command(CommandLine& program);
void add_explore_command(CommandLine& program);
void add_mesh_command(CommandLine& program);
void add_study_command(CommandLine& program);
void add_report_command(CommandLine& program);
void add_score_command(CommandLine& program);
void add_experiment_command(CommandLine& program);
void add_live_command(CommandLine& program);
void add_device_command(CommandLine& program);
void add_init_command(CommandLine& program);
void add_schema_command(CommandLine& program);
void add_validate_command(CommandLine& program);
void add_gpus_command(CommandLine& program);
void add_devices_command(CommandLine& program);
void add_doctor_command(CommandLine& program);

/// A scene, prepared. If neither flag nor scene states a precision, a mesh with parts too thin for single gets
/// double; a note says so.
PreparedCase prepare_scene(CasePreparation& preparation, Case one, const CommonOptions& common);

/// The engine that the flags choose, for commands that measure or check a device: without flags a Vulkan device.
/// `needs_f64`: some case runs in double precision.
EngineOptions device_options(const CommonOptions& common, bool needs_f64);
/// An engine that is selected but not made yet.
struct SelectedEngine {
    EngineOptions options;
    std::string why; /* in words; empty: the user asked for it */
};
/// For commands that compute: without flags the engine that choose_engine takes for this work.
SelectedEngine select_engine(const CommonOptions& common, bool needs_f64, const Workload& work);
/// Prints on stderr which it is, unless quiet or asked for.
std::unique_ptr<Engine> make_engine(const SelectedEngine& selected, const CommonOptions& common);

/// Single and double precision, where the device has both.
std::vector<Precision> precisions_of(const CommonOptions& common, bool f64);

/// A renderer of the user's own in place of an engine, if one is named; else select_engine's. `prepared` outlives it.
std::unique_ptr<Engine> make_engine(const std::string& renderer, const PreparedCase& prepared,
                                    const CommonOptions& common, const Workload& work);
/// \throws UsageError with options of an engine, whose place --renderer takes.
void refuse_engine(const CommonOptions& common);
/// --renderer.
void describe_renderer(Options& options, std::string& renderer);

/// Flags that replace keys of the scene.
std::vector<Override> overrides(const CommonOptions& common);

/// The scene in a file; its warnings go to stderr unless quiet. \throws UsageError unless it is a single scene.
Case load_scene(const std::string& path, const CommonOptions& common);

/// The study in a file, or the paper's if `path` is empty; its warnings go to stderr unless quiet.
Study load_study(const std::string& path, const CommonOptions& common, const CaseChoice& choice = {});

/// For --verbose: where the time of a case or of paths went.
void print_stage_times(const EngineTimes& engine, const VolumeTimings& files);

/// To stderr unless quiet.
template <typename... Parts>
void note(const CommonOptions& common, fmt::format_string<Parts...> text, Parts&&... parts) {
    if (!common.quiet)
        print_note(text, std::forward<Parts>(parts)...);
}
void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common);

/// The names of the cases of the study in a file, or of the paper's if `path` is empty.
std::vector<std::string> case_names(const std::string& path);

/// The one rule for files that are there already: --overwrite replaces them, --no-clobber leaves them and writes what
/// is missing, and without either they are an error. False if all are there (it says so unless quiet). \throws
/// UsageError.
bool may_write(const std::vector<std::filesystem::path>& files, const CommonOptions& common);

/// --title and --size of pictures.
void describe_look(Options& options, picture::Look& look);

/// The value of an option, in SI units. \throws UsageError that names the option.
double option_quantity(const std::string& flag, const std::string& text, Dimension dimension);

/// \throws UsageError if options of pictures are given without --also.
void refuse_unused(const picture::Endings& endings, bool as_by_default);

/// Writes the report of a folder; prints the findings of a study in it, how it was `made` ("energy in 2:01; "), where
/// the report is, and `what` else is there. Always 0.
int show_findings(const study::StudyData& data, const std::filesystem::path& folder, const std::string& made,
                  const char* what, const CommonOptions& common);

/// \throws UsageError if one of the files to be written, each by what an error calls it ("--log felt.csv"), is one that
/// is read.
void refuse_replacing(const std::vector<std::pair<std::string, std::filesystem::path>>& written,
                      const std::vector<std::filesystem::path>& read);

/// The whole path of a file, as notes give it.
std::string full_path(const std::filesystem::path& file);

/// `no study "omision", did you mean omission?; there are ...`. \throws UsageError.
[[noreturn]] void refuse_unknown(const char* what, const std::string& word, const std::vector<std::string>& names);

/// Data for stdout. \throws IoError if it cannot be written.
void print_data(const std::string& text);

// The options of a device, its loop and its safety: those of live and of experiment.

struct DeviceArguments {
    device::SessionOptions session; /* what the options say directly */
    bool passivity = false, without_fade = false;
    std::optional<double> damping; /* N s/m: with passivity */
};

void describe_device(Options& options, DeviceArguments& arguments);
void describe_safety(Options& options, DeviceArguments& arguments);

/// A quantity that must be positive; `flag` as "--duration TIME", in SI units.
void read_positive(Options& options, const char* flag, std::optional<double>& value, Dimension dimension,
                   const char* help);

/// A button's number. \throws UsageError.
unsigned read_button(const char* flag, const std::string& text);

/// What --port says: of a page on this machine; 0: any that is free. \throws UsageError.
std::uint16_t page_port(const std::optional<int>& port);

/// \throws UsageError for what does not fit together.
device::SessionOptions checked_options(const DeviceArguments& arguments);

/// Who guides a check: a person at the terminal; no one for a simulated hand, or where the device is `held` in any
/// case.
device::CheckGuide check_guide(const DeviceArguments& arguments, bool held, const CommonOptions& common);

} // namespace forceshade

// The command line's grammar: commands with their options. Only options.cpp sees CLI11, which takes 6 s to compile.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace forceshade {

/// Options that every command takes.
struct CommonOptions {
    std::string gpu;            /* name, UUID or index; empty: the software device */
    std::string engine = "gpu"; /* "gpu" or "cpu" */
    std::string precision;      /* "f32", "f64" or empty: as the scene says */
    bool json = false;
    bool quiet = false;
    bool validation_layers = false;
};

/// What one command takes, or every command. A name that starts with `--` is an option's, another a positional
/// argument's. Each function adds one and keeps the reference, which parsing fills.
class Options {
public:
    explicit Options(CLI::App& app) : app_(app) {}

    /// T: std::string, or std::optional of std::string or int.
    template <typename T> void required(const char* name, T& value, const std::string& help) {
        value_option(name, value, help, true);
    }
    template <typename T> void optional(const char* name, T& value, const std::string& help) {
        value_option(name, value, help, false);
    }
    void flag(const char* name, bool& value, const std::string& help);
    /// Words between commas.
    void list(const char* name, std::vector<std::string>& values, const std::string& help);
    void one_of(const std::vector<std::string>& words, const char* name, std::string& value, const std::string& help);
    /// `wrong` says what is wrong with a value; empty: nothing.
    void checked(const char* name, std::string& value, std::string (*wrong)(const std::string&),
                 const std::string& help);
    /// `use` gets the value; it may throw UsageError.
    void call(const char* name, void (*use)(const std::string&), const std::string& help);

    /// The heading, in the help, of the options added from now on.
    void heading(const char* title) { heading_ = title; }
    /// A line of the help before the program's own last lines.
    void footer(const std::string& text);

private:
    template <typename T> void value_option(const char* name, T& value, const std::string& help, bool required);

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
    Options add(const char* name, const std::string& help, int (*run)(const CommonOptions&));

    /// The command that the user named; one that prints what --help and --version ask for, or what is wrong.
    /// \throws UsageError for a command that does not exist.
    Command parse(int argc, char** argv);

    CommonOptions common;

private:
    Options add_command(const char* name, const std::string& help, Command command);

    std::unique_ptr<CLI::App> app_;
    Command chosen_;
};

} // namespace forceshade

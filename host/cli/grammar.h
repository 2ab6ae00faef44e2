// The tables from which the command line is parsed, explained (help, manual) and completed: CLI11's, and data that it
// does not keep. Only the sources of the grammar include this: CLI11 takes 6 s to compile.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace forceshade {

struct Example {
    std::string command, about; /* "forceshade gpus --json", what it does */
};

struct Grammar {
    CLI::App program{"Offline study of haptic force fields, with and without force shading", "forceshade"};
    /// The values that an option or argument may have, where they are few.
    std::map<const CLI::Option*, std::vector<std::string>> choices;
    /// Names that an option or argument may have, found in the file that the first argument names (or is not there:
    /// "").
    std::map<const CLI::Option*, std::function<std::vector<std::string>(const std::string&)>> names;
    std::map<const CLI::App*, std::vector<Example>> examples;
};

inline bool is_flag(const CLI::Option& option) {
    return option.get_items_expected_max() == 0;
}
/// Several values between commas, or several arguments.
inline bool is_list(const CLI::Option& option) {
    return option.get_delimiter() != '\0';
}
/// May be given several times, with a value each.
inline bool is_repeated(const CLI::Option& option) {
    return option.get_items_expected_max() > 1;
}

/// "forceshade experiment run"
std::string full_name(const CLI::App& command);
/// "--out", "-x" where there is no long name, "SCENE".
std::string name_of(const CLI::Option& option);
/// "--out FILE", "SCENE", "[STUDY]", "FILE...".
std::string usage_of(const CLI::Option& option);
/// A command's own options or arguments, in the order of the help.
std::vector<const CLI::Option*> options_of(const CLI::App& command);
std::vector<const CLI::Option*> arguments_of(const CLI::App& command);
/// The options that a command accepts: its own, then those of its groups.
std::vector<const CLI::Option*> accepted_options(const CLI::App& command);
/// The command of that name below `group`, or null.
const CLI::App* find_command(const CLI::App& group, const std::string& name);
/// All commands below the program, groups before their commands.
std::vector<const CLI::App*> all_commands(const CLI::App& program);

/// What --help prints, no line longer than `width`.
std::string help_text(const Grammar& grammar, const CLI::App& command, std::size_t width);
/// COLUMNS or the terminal's width, 80 where both are unknown; from 40 to 100.
std::size_t help_width();

struct ManualPage {
    std::string file; /* "forceshade-field.1" */
    std::string text; /* roff, of the package man */
};
/// The same for man(1).
ManualPage manual_page(const Grammar& grammar, const CLI::App& command);

/// The script that bash, zsh or fish reads. \throws UsageError for another shell.
std::string completion_script(const std::string& shell);
/// What can stand in place of words[at]: a line each, a tab before what it means; ":files" where a file can.
std::string completions(const Grammar& grammar, const std::vector<std::string>& words, std::size_t at);

} // namespace forceshade

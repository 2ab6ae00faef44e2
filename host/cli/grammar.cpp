// Parsing: from words to the command that runs, or to the error and where to read on.
#include "host/cli/grammar.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/renderer/renderer_process.h"
#include "host/spelling.h"
#include "host/threads.h"

namespace forceshade {

namespace {

void limit_jobs(const std::string& text) {
    constexpr unsigned kMost = 1024;
    const auto count = number_in(text, 1u, kMost);
    if (!count)
        throw UsageError("--jobs {}: expected a number of threads from 1 to {}", text, kMost);
    limit_threads(*count);
    ::setenv("LP_NUM_THREADS", text.c_str(), 0); // of Mesa's software device, which is not loaded yet
}

void add_common_options(Options options, CommonOptions& common) {
    options.optional("--gpu NAME|UUID|INDEX", common.gpu,
                     "Vulkan device: part of its name, UUID or index (forceshade gpus); default: a hardware GPU if "
                     "available, else the software device, where --engine takes a device");
    options.optional("--engine auto|gpu|cpu", common.engine,
                     "auto (default): a hardware GPU, the software device or the CPU, whichever was measured faster at "
                     "such work, its start included (study, validate and doctor, which measure or check a device, take "
                     "a device); gpu: a Vulkan device; cpu: the oracle");
    options.optional("--precision f32|f64", common.precision,
                     "of the computation; default: as the scene says, else f32, but f64 for explore, field, score of a "
                     "mesh with parts too thin for f32");
    options.read("-j,--jobs N", limit_jobs,
                 "most threads for each stage (engine, plan of a mesh, compression); default: one for each CPU that "
                 "this process may use; results are the same");
    options.read(
        "--max-memory SIZE", [](const std::string& text) { set_memory_limit(parse_memory(text)); },
        "most that a file's contents may take, from what its header announces; default: 4 GiB");
    options.flag("--json", common.json, "machine-readable results on stdout");
    options.flag("-q,--quiet", common.quiet, "no progress and no notes on stderr, errors only");
    options.flag("-v,--verbose", common.verbose, "also print on stderr what was chosen, and how long each stage took");
    options.optional("--log-file FILE", common.log_file,
                     "what goes to stderr, also at the end of this file, with times; all of it even with --quiet");
    options.flag("--overwrite", common.overwrite, "replace files that are there already");
    options.flag("--no-clobber", common.no_clobber, "leave files that are there already, and write what is missing");
    options.flag("--no-cache", common.no_cache,
                 "neither use nor keep what saves time in later runs: compiled kernels, and prepared meshes of 50 000 "
                 "triangles and more (2 GiB in ~/.cache/forceshade)");
    options.flag("--vulkan-validation", common.validation_layers,
                 "run under Vulkan's validation layers; any message of theirs is an error");
}

[[noreturn]] void refuse(const std::string& wrong, const CLI::App& command) {
    const std::string name = full_name(command);
    const std::size_t space = std::min(name.find(' '), name.size());
    throw UsageError("{}\nsee {} help{}", wrong, name.substr(0, space), name.substr(space));
}

// The deepest command that the user named.
const CLI::App& chosen_command(const CLI::App& program) {
    const std::vector<CLI::App*> parsed = program.get_subcommands();
    return parsed.empty() ? program : chosen_command(*parsed.front());
}

std::vector<std::string> long_names(const std::vector<const CLI::Option*>& options) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options)
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

// The nearest one, or one that is shorter or longer: --output for --out, --prec for --precision.
std::string meant_option(const std::string& name, const std::vector<std::string>& known) {
    if (const std::string_view near = nearest(name, known); !near.empty() || name.size() < 4)
        return near == "--help" && edit_distance(name, near) > 1 ? "" : std::string(near); // as --weld is from it
    const auto found = std::ranges::find_if(known, [&](const std::string& one) {
        return one.starts_with(name) || (one.size() > 4 && name.starts_with(one));
    });
    return found == known.end() ? "" : *found;
}

[[noreturn]] void refuse_option(const std::string& word, const CLI::App& program, const CLI::App& command) {
    const std::string name = word.substr(0, word.find('='));
    const std::vector<std::string> known = long_names(accepted_options(command));
    if (has(known, name))
        refuse(fmt::format("{} belongs to {}: write it after that word", name, full_name(command)), command);
    if (const std::string meant = meant_option(name, known); !meant.empty())
        refuse(fmt::format("no option {}, did you mean {}?", name, meant), command);
    std::vector<std::string> others;
    for (const CLI::App* other : all_commands(program))
        if (has(long_names(options_of(*other)), name))
            others.push_back(full_name(*other));
    if (!others.empty() && &command != &program)
        refuse(fmt::format("{} is not an option of {}, but of {}", name, full_name(command), fmt::join(others, ", ")),
               command);
    refuse(fmt::format("no option {}{}", name, &command == &program ? "" : " of " + full_name(command)), command);
}

[[noreturn]] void refuse_command(const std::string& word, const CLI::App& group) {
    std::vector<std::string> names;
    for (const CLI::App* command : group.get_subcommands(nullptr))
        names.push_back(command->get_name());
    if (names.empty())
        refuse(fmt::format("{} has no commands of its own, such as \"{}\"", full_name(group), word), group);
    const std::string_view meant = nearest(word, names);
    const std::string there = fmt::format("; there are {}", fmt::join(names, ", "));
    if (word.empty())
        refuse(fmt::format("a command is missing after {}{}", full_name(group), there), group);
    refuse(fmt::format("no command \"{}\"{}", word,
                       meant.empty() ? there : fmt::format(", did you mean {} {}?", full_name(group), meant)),
           group);
}

// What CLI11 could not place.
void refuse_extras(const CLI::App& program, const CLI::App& command) {
    std::vector<std::string> extras = program.remaining(true);
    std::erase(extras, "--");
    if (extras.empty())
        return;
    const auto option =
        std::ranges::find_if(extras, [](const std::string& word) { return word.size() > 1 && word.front() == '-'; });
    const bool is_group = !command.get_subcommands(nullptr).empty();
    if (is_group && option != extras.begin())
        refuse_command(extras.front(), command);
    if (option != extras.end())
        refuse_option(*option, program, command);
    std::vector<std::string> arguments;
    for (const CLI::Option* argument : arguments_of(command))
        arguments.push_back(usage_of(*argument));
    refuse(fmt::format("\"{}\" is one argument too many: {} takes {}", extras.front(), full_name(command),
                       arguments.empty() ? "none" : fmt::format("{}", fmt::join(arguments, " "))),
           command);
}

// Words that the parser would take, but not as they were meant: `-out FILE` is -o with "ut", and `--out --also` names a
// file "--also".
void refuse_slips(const std::vector<std::string>& words, const CLI::App& program) {
    std::set<std::string> known;
    for (const std::string& name : long_names(options_of(program)))
        known.insert(name);
    for (const CLI::App* command : all_commands(program))
        for (const std::string& name : long_names(options_of(*command)))
            known.insert(name);
    for (const std::string& word : words) {
        if (word == "--")
            return;
        if (word.size() > 2 && word[0] == '-' && word[1] != '-')
            if (const std::string meant = "-" + word.substr(0, word.find('=')); known.contains(meant))
                refuse(fmt::format("no option {}, did you mean {}?", meant.substr(1), meant), program);
    }
}

void refuse_missing(const CLI::App& command) {
    std::vector<std::string> missing;
    for (const auto& options : {arguments_of(command), options_of(command)})
        for (const CLI::Option* option : options)
            if (option->get_required() && option->count() == 0)
                missing.push_back(usage_of(*option));
    if (!missing.empty())
        refuse(fmt::format("{} needs {}", full_name(command), fmt::join(missing, " and ")), command);
}

void refuse_values(const CLI::App& command, const std::vector<std::string>& words) {
    const std::vector<const CLI::Option*> options = accepted_options(command);
    const std::vector<std::string> names = long_names(options);
    for (const CLI::Option* option : options) {
        if (is_flag(*option)) {
            if (std::ranges::any_of(option->results(), [](const std::string& value) { return value != "true"; }))
                refuse(fmt::format("{} takes no value, got {}", name_of(*option), option->results().back()), command);
            continue;
        }
        const bool is_last =
            !words.empty() && (words.back() == name_of(*option) ||
                               (!option->get_snames().empty() && words.back() == "-" + option->get_snames()[0]));
        if (option->count() == 0 && is_last)
            refuse(fmt::format("{} needs a value: {}", name_of(*option), usage_of(*option)), command);
        for (const std::string& value : option->results())
            if (has(names, value.substr(0, value.find('='))))
                refuse(fmt::format("{} needs a value before {}: {}", name_of(*option), value, usage_of(*option)),
                       command);
        if (!is_repeated(*option) && option->count() > 1)
            refuse(fmt::format("{} is given {} times: once is enough", name_of(*option), option->count()), command);
    }
}

// The errors in the words, the likeliest cause first.
void refuse_wrong(const CLI::App& program, const std::vector<std::string>& words) {
    const CLI::App& command = chosen_command(program);
    refuse_values(command, words);
    refuse_extras(program, command);
    if (!command.get_subcommands(nullptr).empty())
        refuse_command("", command);
    refuse_missing(command);
}

// The manual and the completions, each where shells and man look for it below /usr/share.
void write_share(const Grammar& grammar, const std::filesystem::path& folder) {
    const auto write = [&](const std::filesystem::path& file, const std::string& text) {
        std::filesystem::create_directories((folder / file).parent_path());
        write_file_atomically(folder / file, text);
    };
    std::vector<const CLI::App*> commands = all_commands(grammar.program);
    commands.push_back(&grammar.program);
    for (const CLI::App* command : commands) {
        const ManualPage page = manual_page(grammar, *command);
        write("man/man1/" + page.file, page.text);
    }
    write("bash-completion/completions/forceshade", completion_script("bash"));
    for (const char* kind : {"site-functions", "vendor-completions"}) // below /usr/local, and below Debian's /usr
        write(fmt::format("zsh/{}/_forceshade", kind), completion_script("zsh"));
    write("fish/vendor_completions.d/forceshade.fish", completion_script("fish"));
}

bool asks_for_help(const CLI::App& command) {
    return command.get_help_ptr()->count() > 0 || (command.get_parent() && asks_for_help(*command.get_parent()));
}

const CLI::App& command_named(const CLI::App& program, const std::vector<std::string>& words) {
    const CLI::App* command = &program;
    for (const std::string& word : words) {
        const CLI::App* const next = find_command(*command, word);
        if (!next)
            refuse_command(word, *command);
        command = next;
    }
    return *command;
}

} // namespace

Options& Options::keep(CLI::Option* option, const std::string& value_name) {
    last_ = option;
    if (heading_)
        option->group(heading_);
    if (!value_name.empty())
        option->type_name(value_name);
    std::vector<std::string> values = split(value_name, '|');
    const bool only_names = std::ranges::none_of(value_name, [](char c) { return c >= 'a' && c <= 'z'; });
    return values.size() < 2 || only_names ? *this : one_of(std::move(values)); // NAME|UUID are kinds of values
}

namespace {

// "--out FILE" to what CLI11 calls it and what its value is.
std::pair<std::string, std::string> parts(const std::string& name) {
    const std::size_t space = name.find(' ');
    std::string option = name.substr(0, space);
    if (option == "--out")
        option = "-o,--out";
    return {option, space == std::string::npos ? "" : name.substr(space + 1)};
}

} // namespace

template <typename T> Options& Options::add(const std::string& name, T& value, const std::string& help, bool required) {
    const auto [option, value_name] = parts(name);
    return keep(app_.add_option(option, value, help)->required(required), value_name);
}
template Options& Options::add(const std::string&, std::string&, const std::string&, bool);
template Options& Options::add(const std::string&, std::optional<std::string>&, const std::string&, bool);
template Options& Options::add(const std::string&, std::optional<int>&, const std::string&, bool);

Options& Options::flag(const std::string& name, bool& value, const std::string& help) {
    return keep(app_.add_flag(name, value, help), "");
}

Options& Options::list(const std::string& name, std::vector<std::string>& values, const std::string& help,
                       bool required) {
    const auto [option, value_name] = parts(name);
    CLI::Option* const added = app_.add_option(option, values, help)->delimiter(',')->required(required);
    if (!added->get_positional())
        added->allow_extra_args(false); // --also png SCENE: the scene is not a format
    return keep(added, value_name);
}

Options& Options::repeated(const std::string& name, std::vector<std::string>& values, const std::string& help) {
    const auto [option, value_name] = parts(name);
    return keep(app_.add_option(option, values, help)->allow_extra_args(false), value_name);
}

Options& Options::read(const std::string& name, std::function<void(const std::string&)> read, const std::string& help) {
    const auto [option, value_name] = parts(name);
    const auto read_some = [read = std::move(read)](const std::string& text) {
        if (!text.empty())
            read(text);
    };
    return keep(app_.add_option_function<std::string>(option, read_some, help), value_name);
}

Options& Options::one_of(std::vector<std::string> values) {
    const std::string what = last_->get_positional() ? lower_case(last_->get_name(true)) : name_of(*last_);
    last_->check([what, values](const std::string& word) {
        if (!has(values, word))
            refuse_unknown(what.c_str(), word, values);
        return std::string();
    });
    grammar_.choices[last_] = std::move(values);
    return *this;
}

Options& Options::names(std::function<std::vector<std::string>(const std::string&)> names) {
    grammar_.names[last_] = std::move(names);
    return *this;
}

Options& Options::alias(const std::string& name) {
    app_.alias(name);
    return *this;
}

Options& Options::example(const std::string& command, const std::string& about) {
    grammar_.examples[&app_].push_back({"forceshade " + command, about});
    return *this;
}

Options& Options::footer(const std::string& text) {
    app_.footer(text);
    return *this;
}

CommandLine::CommandLine() : grammar_(std::make_unique<Grammar>()) {
    CLI::App& program = grammar_->program;
    program.set_help_flag("-h,--help", "print this text");
    program.set_version_flag("-V,--version", "forceshade " + version(), "print release and commit");
    program.require_subcommand(1);
    program.fallthrough();
    Options options(*grammar_, program);
    add_common_options(options, common);
    program.get_option("--gpu")->check(
        [](const std::string& name) { return std::string(name.empty() ? "a device's name cannot be empty" : ""); });
    options.example("sweep --out results/paper", "the paper's study, with a report")
        .example("field bump.toml --out bump.exr --also png", "a scene of your own, and pictures of its forces");
}

CommandLine::~CommandLine() = default;

namespace {

Command printing(const std::function<std::string()>& text) {
    return [text] {
        print_data(text());
        return 0;
    };
}

} // namespace

void CommandLine::add_help_commands() {
    const auto topic = std::make_shared<std::vector<std::string>>();
    const auto shell = std::make_shared<std::string>();
    add_command("help", "Explain a command, or list them all", printing([this, topic] {
                    return help_text(*grammar_, command_named(grammar_->program, *topic), help_width());
                }))
        .list("COMMAND", *topic, "which, as field or experiment run; without it the program")
        .example("help field", "what field takes")
        .example("help experiment run", "what a command of a group takes");
    add_command("completion", "Print a script that completes commands, options and cases in a shell",
                printing([shell] { return completion_script(*shell); }))
        .required("SHELL", *shell, "bash, zsh or fish")
        .one_of({"bash", "zsh", "fish"})
        .example("completion bash > forceshade.bash", "a script to source, as ~/.bashrc may do")
        .example("completion fish > forceshade.fish", "for ~/.config/fish/completions");
}

Options CommandLine::add_group(const char* name, const std::string& help) {
    CLI::App* const added = grammar_->program.add_subcommand(name, help);
    added->require_subcommand(1);
    return Options(*grammar_, *added);
}

Options CommandLine::add_command(const char* name, const std::string& help, Command command) {
    CLI::App* group = &grammar_->program;
    std::string_view last = name;
    if (const std::size_t space = last.find(' '); space != std::string_view::npos) {
        group = group->get_subcommand(std::string(last.substr(0, space)));
        last.remove_prefix(space + 1);
    }
    CLI::App* const added = group->add_subcommand(std::string(last), help);
    added->callback([this, command = std::move(command)] { chosen_ = command; });
    return Options(*grammar_, *added);
}

namespace {

// Errors about options that a command finds later read on at the same place.
Command with_hint(const Command& command, const CLI::App& chosen) {
    return [&chosen, command] {
        try {
            return command();
        } catch (const UsageError& error) {
            if (!std::string_view(error.what()).starts_with("--"))
                throw;
            refuse(error.what(), chosen);
        }
    };
}

} // namespace

// What programs call: __share DIR of the build, __complete AT WORD... of a shell, __renderer LIBRARY of this program.
std::optional<Command> CommandLine::hidden_command(const std::vector<std::string>& words) const {
    if (words.size() == 2 && words[0] == "__share")
        return [this, folder = std::filesystem::path(words[1])] {
            write_share(*grammar_, folder);
            return 0;
        };
    if (words.size() == 2 && words[0] == kRendererCommand)
        return [library = words[1]] { return serve_renderer(library); };
    std::size_t at = 0;
    if (words.size() < 3 || words[0] != "__complete" ||
        std::from_chars(words[1].data(), words[1].data() + words[1].size(), at).ec != std::errc())
        return std::nullopt;
    return printing([this, at, line = std::vector<std::string>(words.begin() + 2, words.end())] {
        return completions(*grammar_, line, at);
    });
}

Command CommandLine::parse(int argc, char** argv) {
    add_help_commands(); // the last ones of the list
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    CLI::App& program = grammar_->program;
    if (const std::optional<Command> hidden = hidden_command(words))
        return *hidden;
    refuse_slips(words, program);
    try {
        program.parse(argc, argv);
    } catch (const CLI::CallForVersion& error) {
        return printing([text = std::string(error.what()) + "\n"] { return text; });
    } catch (const CLI::ParseError& error) {
        const CLI::App& command = chosen_command(program);
        if (asks_for_help(command))
            return printing([this, &command] { return help_text(*grammar_, command, help_width()); });
        refuse_wrong(program, words);
        const std::string wrong = error.what(); // "Could not convert: --cpu = two"
        const std::size_t colon = error.get_name() == "ConversionError" ? wrong.find(": ") : std::string::npos;
        refuse(colon == std::string::npos ? wrong : wrong.substr(colon + 2) + ": expected a whole number", command);
    } catch (const UsageError& error) { // of a value
        const CLI::App& command = chosen_command(program);
        refuse_values(command, words);
        refuse_extras(program, command);
        refuse(error.what(), command);
    }
    const CLI::App& command = chosen_command(program);
    refuse_values(command, words);
    if (common.quiet && common.verbose)
        refuse("--quiet and --verbose exclude each other", command);
    return with_hint(chosen_, command);
}

} // namespace forceshade

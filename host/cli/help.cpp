// --help and the manual, of the same tables.
#include "host/cli/grammar.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/program.h"

namespace forceshade {

namespace {

constexpr const char* kExitCodes = "0 ok, 1 a case failed or a bound was exceeded, 2 usage or configuration, 3 no such "
                                   "device, 4 files missing, damaged or not writable, 130 interrupted.";

// Characters of UTF-8.
std::size_t letters(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

// A word that fits nowhere is cut; what is cut is ASCII.
void append_word(std::string& text, std::size_t& column, std::string_view word, std::size_t indent, std::size_t width) {
    const bool first = column == indent;
    if (!first && column + 1 + letters(word) > width) {
        text += "\n" + std::string(indent, ' ');
        column = indent;
    } else if (!first) {
        text += ' ';
        ++column;
    }
    while (column + letters(word) > width) {
        const std::size_t fits = width - column;
        text += std::string(word.substr(0, fits)) + "\n" + std::string(indent, ' ');
        word.remove_prefix(fits);
        column = indent;
    }
    text += word;
    column += letters(word);
}

// The text from column `indent` on, where the first line already stands.
std::string wrapped(std::string_view words, std::size_t indent, std::size_t width) {
    std::string text;
    std::size_t column = indent;
    for (std::size_t begin = 0; begin < words.size();) {
        const std::size_t end = std::min(words.find_first_of(" \n", begin), words.size());
        if (end > begin)
            append_word(text, column, words.substr(begin, end - begin), indent, width);
        if (end < words.size() && words[end] == '\n') {
            text += "\n" + std::string(indent, ' ');
            column = indent;
        }
        begin = end + 1;
    }
    return text;
}

std::string indented(std::string_view words, std::size_t indent, std::size_t width) {
    return std::string(indent, ' ') + wrapped(words, indent, width) + "\n";
}

// A name at the left, its help from `column` on.
std::string row(const std::string& name, const std::string& about, std::size_t column, std::size_t width) {
    std::string text = "  " + wrapped(name, 2, width);
    const std::size_t used = letters(std::string_view(text).substr(text.rfind('\n') + 1));
    text += used + 2 > column ? "\n" + std::string(column, ' ') : std::string(column - used, ' ');
    return text + wrapped(about, column, width) + "\n";
}

// As the shell takes it, on several lines where it is long.
std::string wrapped_command(const std::string& command, std::size_t indent, std::size_t width) {
    std::string text(indent, ' ');
    std::size_t column = indent;
    char quote = '\0';
    for (std::size_t begin = 0; begin < command.size();) {
        std::size_t end = begin;
        for (; end < command.size() && (quote || command[end] != ' '); ++end)
            if (command[end] == '\'' || command[end] == '"')
                quote = !quote ? command[end] : quote == command[end] ? '\0' : quote;
        const std::string word = command.substr(begin, end - begin);
        if (column > indent && column + 1 + letters(word) + 2 > width) {
            text += " \\\n" + std::string(indent + 4, ' ') + word;
            column = indent + 4 + letters(word);
        } else {
            text += (column > indent ? " " : "") + word;
            column += letters(word) + (column > indent ? 1 : 0);
        }
        begin = end + 1;
    }
    return text + "\n";
}

std::string value_name(const CLI::Option& option) {
    const std::string name = option.get_positional() ? option.get_name(true) : option.get_type_name();
    return is_list(option) ? name + (option.get_positional() ? "..." : ",...") : name;
}

// "-o, --out FILE"
std::string left_column(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames())
        names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
        names.push_back("--" + name);
    const std::string text = fmt::format("{}{}", option.get_snames().empty() ? "    " : "", fmt::join(names, ", "));
    return is_flag(option) ? text : text + " " + value_name(option);
}

std::string usage_line(const CLI::App& command) {
    std::string usage = full_name(command);
    if (!command.get_subcommands(nullptr).empty())
        return usage + " COMMAND ...";
    usage += " [options]";
    for (const CLI::Option* argument : arguments_of(command))
        usage += " " + usage_of(*argument);
    for (const CLI::Option* option : options_of(command))
        if (option->get_required())
            usage += " " + usage_of(*option);
    return usage;
}

const CLI::App& program_of(const CLI::App& command) {
    return command.get_parent() ? program_of(*command.get_parent()) : command;
}

// Those of the program: every command takes them.
std::string common_options(const CLI::App& program) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options_of(program)) {
        const std::string name = option->get_snames().empty() ? "" : "-" + option->get_snames()[0] + ", ";
        if (option != program.get_help_ptr() && option != program.get_version_ptr())
            names.push_back(name + usage_of(*option));
    }
    return fmt::format("Every command takes {}: forceshade help explains them.", fmt::join(names, "; "));
}

std::string about(const CLI::Option& option) {
    return option.get_description() + (option.get_required() && !option.get_positional() ? " (required)" : "");
}

struct Section {
    std::string title;
    std::vector<std::pair<std::string, std::string>> rows; /* names, and what they mean */
};

// "Commands", "Arguments", "Options", and the other headings that a command has.
std::vector<Section> sections_of(const CLI::App& command) {
    std::vector<Section> sections;
    const auto add = [&](const std::string& title, const std::string& name, const std::string& meaning) {
        auto found = std::ranges::find(sections, title, &Section::title);
        if (found == sections.end())
            found = sections.insert(found, {title, {}});
        found->rows.emplace_back(name, meaning);
    };
    for (const CLI::App* one : command.get_subcommands(nullptr))
        add("Commands", one->get_name(), one->get_description());
    for (const CLI::Option* argument : arguments_of(command))
        add("Arguments", usage_of(*argument), about(*argument));
    for (const CLI::Option* option : options_of(command))
        add(option->get_group(), left_column(*option), about(*option));
    return sections;
}

// Words of the program itself: hyphens that can be copied.
std::string literal(std::string_view text) {
    std::string escaped;
    for (const char c : text)
        escaped += c == '-' ? "\\-" : c == '\\' ? "\\e" : std::string(1, c);
    return escaped;
}

// Words as lines of a manual, none of which is taken for a request.
std::string paragraph(std::string_view text) {
    std::string escaped;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins_option = text[i] == '-' && (i == 0 || text[i - 1] == ' ' || text[i - 1] == '-');
        escaped += begins_option ? "\\-" : text[i] == '\\' ? "\\e" : std::string(1, text[i]);
    }
    std::string lines = wrapped(escaped, 0, 78);
    for (std::size_t begin = 0; begin < lines.size(); begin = std::min(lines.find('\n', begin), lines.size() - 1) + 1)
        if (lines[begin] == '.' || lines[begin] == '\'')
            lines.insert(begin, "\\&");
    return lines + "\n";
}

std::string upper_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

std::string entry(const std::string& name, const std::string& text) {
    return ".TP\n.B " + literal(name) + "\n" + paragraph(text);
}

std::string page_name(const CLI::App& command) {
    std::string name = full_name(command);
    std::ranges::replace(name, ' ', '-');
    return name;
}

// ".BR forceshade\-field (1)," for the group that a command is in, and those below it.
std::string see_also(const CLI::App& command) {
    std::vector<const CLI::App*> pages;
    for (const CLI::App* group = command.get_parent(); group; group = group->get_parent())
        pages.insert(pages.begin(), group);
    for (const CLI::App* below : all_commands(command))
        pages.push_back(below);
    std::string text;
    for (const CLI::App* page : pages)
        text += fmt::format(".BR {} (1){}\n", literal(page_name(*page)), page == pages.back() ? "" : ",");
    return text;
}

} // namespace

std::string full_name(const CLI::App& command) {
    return command.get_parent() ? full_name(*command.get_parent()) + " " + command.get_name() : command.get_name();
}

std::string name_of(const CLI::Option& option) {
    if (option.get_positional())
        return option.get_name(true);
    return option.get_lnames().empty() ? "-" + option.get_snames().at(0) : "--" + option.get_lnames()[0];
}

std::string usage_of(const CLI::Option& option) {
    if (!option.get_positional())
        return is_flag(option) ? name_of(option) : name_of(option) + " " + value_name(option);
    return option.get_required() ? value_name(option) : "[" + value_name(option) + "]";
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
    std::vector<const CLI::Option*> options =
        command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
    std::ranges::stable_partition(options, [&](const CLI::Option* option) { // those at the end
        return option != command.get_help_ptr() && option != command.get_version_ptr();
    });
    return options;
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& command) {
    return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<const CLI::Option*> accepted_options(const CLI::App& command) {
    std::vector<const CLI::Option*> options = options_of(command);
    if (const CLI::App* group = command.get_parent())
        for (const CLI::Option* option : accepted_options(*group))
            if (option != group->get_help_ptr()) // a command has its own
                options.push_back(option);
    return options;
}

const CLI::App* find_command(const CLI::App& group, const std::string& name) {
    const auto found = group.get_subcommands([&](const CLI::App* command) { return command->check_name(name); });
    return found.empty() ? nullptr : found.front();
}

std::vector<const CLI::App*> all_commands(const CLI::App& program) {
    std::vector<const CLI::App*> all;
    for (const CLI::App* command : program.get_subcommands(nullptr)) {
        all.push_back(command);
        const std::vector<const CLI::App*> below = all_commands(*command);
        all.insert(all.end(), below.begin(), below.end());
    }
    return all;
}

std::string help_text(const Grammar& grammar, const CLI::App& command, std::size_t width) {
    const std::size_t column = std::min<std::size_t>(26, width / 3);
    const bool is_program = command.get_parent() == nullptr;
    std::string text = wrapped(command.get_description(), 0, width) + "\n\n";
    text += "Usage: " + wrapped(usage_line(command), 7, width) + "\n";
    for (const auto& [title, rows] : sections_of(command)) {
        const bool common = is_program && title != "Commands";
        text += "\n" + wrapped((common ? "Options of every command" : title) + ":", 0, width) + "\n";
        for (const auto& [name, meaning] : rows)
            text += row(name, meaning, column, width);
    }
    if (const auto found = grammar.examples.find(&command); found != grammar.examples.end()) {
        text += "\nExamples:\n";
        for (const Example& example : found->second)
            text += indented(example.about, 2, width) + wrapped_command(example.command, 6, width);
    }
    if (const std::string footer = command.get_footer(); !footer.empty())
        text += "\n" + wrapped(footer, 0, width) + "\n";
    if (!is_program)
        text += "\n" + wrapped(common_options(program_of(command)), 0, width) + "\n";
    text += "\n" + wrapped(std::string("Exit codes: ") + kExitCodes, 0, width) + "\n";
    if (is_program)
        text += "\n" + wrapped("forceshade help COMMAND explains a command.", 0, width) + "\n";
    return text;
}

ManualPage manual_page(const Grammar& grammar, const CLI::App& command) {
    const std::string release = version().substr(0, version().find('+')), name = page_name(command);
    std::string usage = usage_line(command).substr(full_name(command).size());
    std::string text =
        fmt::format(".TH {} 1 \"\" \"forceshade {}\"\n.nh\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n{}\n",
                    literal(upper_case(name)), release, literal(name), command.get_description(),
                    literal(full_name(command)), literal(usage.substr(1)));
    for (const auto& [title, rows] : sections_of(command)) {
        std::string upper = upper_case(title);
        std::erase(upper, '"');
        text += ".SH " + upper + "\n";
        for (const auto& [left, meaning] : rows)
            text += entry(left.substr(left.find_first_not_of(' ')), meaning);
    }
    if (command.get_parent())
        text += ".PP\n" + paragraph(common_options(program_of(command)));
    if (const auto found = grammar.examples.find(&command); found != grammar.examples.end()) {
        text += ".SH EXAMPLES\n";
        for (const Example& example : found->second)
            text += ".TP\n" + paragraph(example.about) + ".nf\n" + literal(wrapped_command(example.command, 0, 72)) +
                    ".fi\n";
    }
    if (const std::string footer = command.get_footer(); !footer.empty())
        text += ".SH NOTES\n" + paragraph(footer);
    text += ".SH EXIT STATUS\n" + paragraph(kExitCodes) + ".SH SEE ALSO\n" + see_also(command);
    return {name + ".1", text};
}

std::size_t help_width() {
    constexpr std::size_t kLeast = 40, kDefault = 80, kMost = 100;
    std::size_t width = kDefault;
    winsize terminal{};
    if (const char* const columns = std::getenv("COLUMNS"); columns && std::atoi(columns) > 0)
        width = static_cast<std::size_t>(std::atoi(columns));
    else if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &terminal) == 0 && terminal.ws_col > 0)
        width = terminal.ws_col;
    return std::clamp(width, kLeast, kMost);
}

} // namespace forceshade

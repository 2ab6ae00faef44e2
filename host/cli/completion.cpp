// Completion when Tab is pressed in a shell. The scripts only carry words to the program and its answer back.
#include "host/cli/grammar.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {

namespace {

constexpr const char* kFiles = ":files\n";

// COMP_WORDS has "--engine=cpu" as three words, and quotes as they were typed. Without descriptions: bash shows none.
constexpr const char* kBash =
    R"(# bash completion for forceshade: source it, or install it as .../bash-completion/completions/forceshade
_forceshade() {
    local line
    COMPREPLY=()
    while IFS= read -r line; do
        if [[ $line == :files ]]; then
            compopt -o default 2>/dev/null || :
        else
            COMPREPLY+=("${line%%$'\t'*}")
        fi
    done < <("${COMP_WORDS[0]/#\~/$HOME}" __complete "$COMP_CWORD" "${COMP_WORDS[@]}" 2>/dev/null)
}
complete -F _forceshade forceshade
)";

constexpr const char* kZsh = R"(#compdef forceshade
# zsh completion for forceshade: as _forceshade in a folder of $fpath, or source it after compinit
_forceshade() {
    local line
    local -a found shown
    while IFS= read -r line; do
        if [[ $line == :files ]]; then
            _files
        else
            found+=("${line%%$'\t'*}")
            shown+=("${line/$'\t'/  -- }")
        fi
    done < <("${(Q)words[1]/#\~/$HOME}" __complete $((CURRENT - 1)) "${words[@]}" 2>/dev/null)
    (( ${#found} )) && compadd -l -d shown -a found
}
if [[ $funcstack[1] == _forceshade ]]; then
    _forceshade "$@"
else
    compdef _forceshade forceshade
fi
)";

constexpr const char* kFish = R"(# fish completion for forceshade: as forceshade.fish in a folder of $fish_complete_path
function __forceshade_complete
    set -l before (commandline -opc)
    set -l current (commandline -ct)
    for line in ($before[1] __complete (count $before) $before $current 2>/dev/null)
        if test "$line" = ":files"
            __fish_complete_path $current
        else
            echo $line
        end
    end
end
complete -c forceshade -f -a '(__forceshade_complete)'
)";

// "--out", "-o"; null: none.
const CLI::Option* option_named(const CLI::App& command, const std::string& word) {
    for (const CLI::Option* option : accepted_options(command))
        if (word.starts_with("--") ? option->check_lname(word.substr(2))
                                   : word.size() > 1 && option->check_sname(word.substr(word.size() - 1)))
            return option;
    return nullptr;
}

// What the words before a place mean for it.
struct Place {
    const CLI::App* command = nullptr;
    const CLI::App* topic = nullptr;       /* of help */
    const CLI::Option* value_of = nullptr; /* the option whose value stands here */
    std::size_t argument = 0;              /* arguments of the command before it */
    bool arguments_only = false;           /* after -- */
    std::vector<const CLI::Option*> given{};
    std::string first_argument{};
};

void step(Place& place, const std::string& word) {
    if (place.value_of) {
        place.value_of = nullptr;
    } else if (word == "--") {
        place.arguments_only = true;
    } else if (word.starts_with("-") && word.size() > 1 && !place.arguments_only) {
        const std::size_t equals = word.find('=');
        const CLI::Option* const option = option_named(*place.command, word.substr(0, equals));
        if (!option)
            return;
        place.given.push_back(option);
        if (!is_flag(*option) && equals == std::string::npos)
            place.value_of = option;
    } else if (place.topic) {
        if (const CLI::App* below = find_command(*place.topic, word))
            place.topic = below;
    } else if (const CLI::App* below = find_command(*place.command, word)) {
        if (word == "help")
            place.topic = place.command;
        place.command = below;
    } else {
        if (place.argument++ == 0)
            place.first_argument = word;
    }
}

// As far as it is typed, without the quote that it may begin with.
std::string typed(std::string word) {
    if (!word.empty() && (word.front() == '\'' || word.front() == '"'))
        word.erase(0, 1);
    std::erase(word, '\\');
    return word;
}

std::string short_of(std::string about) {
    constexpr std::size_t kMost = 60;
    about = about.substr(0, about.find_first_of(";:("));
    return about.size() > kMost ? about.substr(0, about.rfind(' ', kMost)) + " ..." : about;
}

class Answer {
public:
    explicit Answer(std::string word) : word_(std::move(word)) {}
    void add(const std::string& candidate, const std::string& about = "") {
        if (candidate.starts_with(word_))
            lines_ += about.empty() ? candidate + "\n" : fmt::format("{}\t{}\n", candidate, short_of(about));
    }
    void add_files() { lines_ += kFiles; }
    const std::string& lines() const { return lines_; }

private:
    std::string word_, lines_;
};

// `before`: the part of the word before the value.
void add_values(const Grammar& grammar, const CLI::Option& option, const std::string& before, const std::string& first,
                Answer& answer) {
    if (const auto found = grammar.choices.find(&option); found != grammar.choices.end()) {
        for (const std::string& value : found->second)
            if (("," + before).find("," + value + ",") == std::string::npos) // each once in a list
                answer.add(before + value);
    } else if (const auto finder = grammar.names.find(&option); finder != grammar.names.end()) {
        for (const std::string& name : finder->second(first))
            answer.add(before + name);
    } else if (before.empty()) {
        answer.add_files();
    }
}

void add_options(const CLI::App& command, const Place& place, Answer& answer) {
    for (const CLI::Option* option : accepted_options(command))
        if (is_repeated(*option) || std::ranges::find(place.given, option) == place.given.end())
            for (const std::string& name : option->get_lnames())
                answer.add("--" + name, option->get_description());
}

void add_arguments(const Grammar& grammar, const Place& place, Answer& answer) {
    const std::vector<const CLI::Option*> arguments = arguments_of(*place.command);
    if (arguments.empty())
        return;
    if (place.argument < arguments.size())
        add_values(grammar, *arguments[place.argument], "", place.first_argument, answer);
    else if (is_list(*arguments.back()))
        add_values(grammar, *arguments.back(), "", place.first_argument, answer);
}

// "a.toml" of what stands after the place, if the first argument does.
std::string first_argument_after(Place place, const std::vector<std::string>& words, std::size_t from) {
    for (std::size_t i = from; i < words.size() && place.argument == 0; ++i)
        step(place, words[i]);
    return place.first_argument;
}

} // namespace

std::string completion_script(const std::string& shell) {
    if (shell == "bash")
        return kBash;
    if (shell == "zsh")
        return kZsh;
    if (shell == "fish")
        return kFish;
    throw UsageError("there is no completion for \"{}\", only for bash, zsh and fish", shell);
}

std::string completions(const Grammar& grammar, const std::vector<std::string>& words, std::size_t at) {
    Place place{&grammar.program};
    for (std::size_t i = 1; i < at && i < words.size(); ++i)
        if (words[i] != "=") // of bash
            step(place, typed(words[i]));
    std::string word = at < words.size() ? typed(words[at]) : "";
    if (word == "=" && place.value_of)
        word.clear();
    std::string before; // the part of the word before the value
    if (const std::size_t equals = word.find('='); word.starts_with("--") && equals != std::string::npos) {
        before = word.substr(0, equals + 1);
        place.value_of = option_named(*place.command, word.substr(0, equals));
        if (!place.value_of)
            return "";
    }
    Answer answer(word);
    if (place.value_of) {
        if (const std::size_t comma = word.rfind(','); is_list(*place.value_of) && comma != std::string::npos)
            before = word.substr(0, comma + 1);
        Place after = place;
        after.value_of = nullptr;
        add_values(grammar, *place.value_of, before, first_argument_after(after, words, at + 1), answer);
    } else if (word.starts_with("-") && !place.arguments_only) {
        add_options(*place.command, place, answer);
    } else {
        const CLI::App& group = place.topic ? *place.topic : *place.command;
        for (const CLI::App* command : group.get_subcommands(nullptr))
            if (place.argument == 0) // only commands stand before it
                answer.add(command->get_name(), command->get_description());
        if (!place.topic)
            add_arguments(grammar, place, answer);
    }
    return answer.lines();
}

} // namespace forceshade

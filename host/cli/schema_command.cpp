// forceshade schema: what a scene may say.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/experiment/experiment.h"
#include "host/scene/schema_json.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

struct SchemaArguments {
    bool paper = false; // the built-in study instead
    std::string name;
};

std::vector<nlohmann::ordered_json> all_rows() {
    std::vector<nlohmann::ordered_json> rows;
    for (const nlohmann::ordered_json& schema : {schema_json()["keys"], experiment::experiment_schema_json()})
        rows.insert(rows.end(), schema.begin(), schema.end());
    return rows;
}

std::string text_in(const nlohmann::ordered_json& row, const char* member) {
    const auto found = row.find(member);
    return found == row.end() || found->is_null() ? "" : found->is_string() ? found->get<std::string>() : found->dump();
}

// A quantity's or any other value as one writes it in its table.
std::string written(const nlohmann::ordered_json& row) {
    const std::string key = text_in(row, "key"), example = text_in(row, "example"), given = text_in(row, "default");
    const std::string table = key.substr(0, key.find('.')), name = key.substr(table.size() + 1);
    const std::string literal = example.empty() ? given : example;
    return literal.empty() ? fmt::format("[{}]", table) : fmt::format("[{}]\n{} = {}", table, name, literal);
}

std::string wrapped(std::string text, const char* label) {
    constexpr std::size_t kWidth = 84;
    std::string result;
    for (bool first = true; !text.empty(); first = false) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::size_t blank = end > kWidth ? text.rfind(' ', kWidth) : end;
        const std::size_t cut = blank == text.npos || blank == 0 ? end : blank;
        result += fmt::format("    {:<12}{}\n", first ? label : "", text.substr(0, cut));
        text.erase(0, std::min(cut + 1, text.size()));
    }
    return result;
}

std::string in_words(const nlohmann::ordered_json& row) {
    const std::string given = text_in(row, "default"), applies = text_in(row, "applies_to");
    return fmt::format("{}\n", text_in(row, "key")) + wrapped(text_in(row, "doc"), "meaning") +
           wrapped(text_in(row, "values"), "value") + wrapped(text_in(row, "unit"), "SI unit") +
           wrapped(given.empty() ? "none" : given, "default") + wrapped(applies, "applies to") +
           wrapped(written(row), "example");
}

// Rows of a key ("surface.radius"), of a table ("surface"), or of all keys of a name ("radius").
std::vector<nlohmann::ordered_json> rows_named(const std::string& word) {
    std::string name = word;
    std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
    std::vector<nlohmann::ordered_json> rows;
    std::set<std::string> known;
    for (const nlohmann::ordered_json& row : all_rows()) {
        const std::string key = text_in(row, "key");
        const std::size_t dot = key.find('.');
        const std::string table = key.substr(0, dot), own = key.substr(dot + 1);
        known.insert({table, own, key});
        if (name == key)
            return {row};
        if (name == table || name == own || key.starts_with(name + '.'))
            rows.push_back(row);
    }
    if (rows.empty()) {
        const std::vector<std::string> names(known.begin(), known.end());
        const std::string_view meant = nearest(name, names);
        throw UsageError("no key or table \"{}\"{}; forceshade schema prints all", word,
                         meant.empty() ? "" : fmt::format(", did you mean {}?", meant));
    }
    return rows;
}

int print_schema(const SchemaArguments& arguments, const CommonOptions& common) {
    if (arguments.paper && common.json)
        throw UsageError("--default-study prints TOML: leave out --json");
    if (arguments.paper && !arguments.name.empty())
        throw UsageError("--default-study prints the whole study: leave out the key");
    if (arguments.paper) {
        print_data(std::string(default_study_toml()));
        return 0;
    }
    const auto rows = arguments.name.empty() ? all_rows() : rows_named(arguments.name);
    std::string text;
    for (const nlohmann::ordered_json& row : rows)
        text += (text.empty() ? "" : "\n") + in_words(row);
    if (common.json)
        text = nlohmann::ordered_json{{"keys", rows}}.dump(2) + "\n";
    else if (arguments.name.empty())
        text = schema_text() + "\n" + experiment::experiment_schema();
    print_data(text);
    return 0;
}

} // namespace

void add_schema_command(CommandLine& program) {
    program.add<SchemaArguments>("schema", "Print every key of a scene or study, its unit, default and meaning",
                                 print_schema, [](Options& options, SchemaArguments& arguments) {
                                     options.optional("KEY", arguments.name,
                                                      "only this key or table, as surface.radius, radius or surface");
                                     options.flag("--default-study", arguments.paper,
                                                  "print the built-in study of the paper instead, to start from");
                                     options.example("schema surface.radius", "one key")
                                         .example("schema --default-study > study.toml", "a study to start from");
                                 });
}

} // namespace forceshade

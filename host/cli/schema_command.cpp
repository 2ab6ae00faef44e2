// forceshade init, schema: what a scene may say.
#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/experiment/experiment.h"
#include "host/long_run.h"
#include "host/mesh/mesh.h"
#include "host/mesh/mesh_file.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/scene/schema_json.h"
#include "host/scene/value.h"
#include "host/score/course.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

constexpr std::string_view kCourse = "course";

struct InitArguments {
    std::string what, mesh, out;
};

// The mesh as a scene in another folder names it. \throws IoError if it is not there.
std::string mesh_as_named(const InitArguments& arguments) {
    const std::filesystem::path mesh = arguments.mesh;
    std::error_code error;
    if (mesh.empty())
        return "mesh.obj";
    if (!std::filesystem::is_regular_file(mesh, error))
        throw file_error("read", mesh, error ? error.value() : EISDIR);
    if (mesh.is_absolute() || arguments.out.empty())
        return mesh.string();
    const std::filesystem::path folder = std::filesystem::absolute(arguments.out).parent_path();
    return std::filesystem::absolute(mesh).lexically_relative(folder.lexically_normal()).lexically_normal().string();
}

double longest_side(const std::filesystem::path& mesh) {
    const MeshBox box = bounding_box(read_polygons(mesh).polygons);
    const glm::dvec3 sides = box.high - box.low;
    return std::max({sides.x, sides.y, sides.z, 0.0});
}

// The standard course, into a folder.
int init_course(const std::filesystem::path& folder, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    if (folder.empty() || folder == "-")
        throw UsageError("init course writes a folder: name it with --out DIR");
    if (!may_write(score::course_files(folder), common))
        return 0;
    const score::CourseWritten written = score::write_course(folder);
    note(common, "wrote {} files into {}; its README.md says what to do with them\n", written.files, full_path(folder));
    if (!written.standard())
        print_warnings({fmt::format("these files are not those of version {} of the standard course, so scores on them "
                                    "are not scores of that version: the SHA-256 of SHA256SUMS is {}, not {}. The law, "
                                    "the processor's arithmetic or its mathematical library differs",
                                    score::kCourseVersion, written.digest, score::kCourseDigest)},
                       common);
    return 0;
}

int init(const InitArguments& arguments, const CommonOptions& common) {
    if (common.json)
        throw UsageError("init writes TOML: leave out --json");
    if (!arguments.mesh.empty() && arguments.what != "mesh")
        throw UsageError("init {} takes no file; got {}", arguments.what, arguments.mesh);
    if (arguments.what == kCourse)
        return init_course(arguments.out, common);
    const bool to_file = !arguments.out.empty() && arguments.out != "-";
    const std::string scene = to_file ? arguments.out : arguments.what + ".toml";
    const double across = arguments.mesh.empty() ? 0 : longest_side(arguments.mesh);
    const std::string_view unit = unit_for_a_hand(across);
    std::string text = starter_scene(arguments.what, mesh_as_named(arguments), unit, scene);
    if (arguments.what == "experiment")
        text += "\n" + experiment::experiment_schema();
    if (!to_file) {
        print_data(text);
    } else {
        if (!may_write({arguments.out}, common))
            return 0;
        write_file_atomically(arguments.out, text);
        note(common, "wrote {}; its first lines say what to do with it\n", arguments.out);
    }
    const double metres = across * parse_quantity(fmt::format("1 {}", unit), Dimension::length);
    if (metres >= 1e-3 && metres <= 10)
        note(common, "unit = \"{0}\" is a guess: the mesh is {1} across, and {1} {0} is nearest to what a hand holds\n",
             unit, numbers::three_digits(across));
    else if (across > 0)
        note(common, "unit = \"{}\" is a guess: the mesh is {} across, which no unit makes as large as a hand holds\n",
             unit, numbers::three_digits(across));
    return 0;
}

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

void add_init_command(CommandLine& program) {
    program.add<InitArguments>(
        "init", "Write a scene to start from, with comments, that works as it stands", init,
        [](Options& options, InitArguments& arguments) {
            std::vector<std::string> kinds{kStarters.begin(), kStarters.end()};
            kinds.emplace_back(kCourse);
            options
                .required("KIND", arguments.what,
                          "what the scene is for: bump, mesh, paths, live or experiment; course: the folder of scenes "
                          "and strokes on which renderers are scored, which needs --out DIR")
                .one_of(kinds);
            options.optional("MESH", arguments.mesh, "of kind mesh: the mesh's file; left out: mesh.obj");
            options.optional("--out FILE", arguments.out, "the scene's file, of course a folder; default: stdout");
            options.example("init bump --out bump.toml", "a bump to change")
                .example("init course --out course", "the standard course for renderers")
                .example("init paths", "a scene with paths, to read");
        });
}

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

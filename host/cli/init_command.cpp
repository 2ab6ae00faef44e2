// forceshade init: a scene to start from, or the standard course.
#include <algorithm>
#include <system_error>

#include <fmt/format.h>

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

} // namespace forceshade

// forceshade init.
#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/experiment/experiment.h"
#include "host/mesh/mesh.h"
#include "host/mesh/mesh_file.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/scene/schema.h"
#include "host/scene/starter.h"
#include "host/scene/value.h"

namespace forceshade {

namespace {

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

int init(const InitArguments& arguments, const CommonOptions& common) {
    if (common.json)
        throw UsageError("init writes TOML: leave out --json");
    if (!arguments.mesh.empty() && arguments.what != "mesh")
        throw UsageError(fmt::format("init {} takes no file; got {}", arguments.what, arguments.mesh));
    const bool to_file = !arguments.out.empty() && arguments.out != "-";
    const std::string scene = to_file ? arguments.out : arguments.what + ".toml";
    const double across = arguments.mesh.empty() ? 0 : longest_side(arguments.mesh);
    const std::string_view unit = unit_for_a_hand(across);
    std::string text = starter_scene(arguments.what, mesh_as_named(arguments), unit, scene);
    if (arguments.what == "experiment")
        text += "\n" + experiment::experiment_schema();
    if (!to_file) {
        print_data(text);
        return 0;
    }
    if (!may_write({arguments.out}, common))
        return 0;
    write_file_atomically(arguments.out, text);
    if (!common.quiet)
        print_note("wrote {}; its first lines say what to do with it\n", arguments.out);
    if (!common.quiet && across > 0)
        print_note("unit = \"{0}\" is a guess: the mesh is {1:.3g} across, and {1:.3g} {0} is what a hand can hold\n",
                   unit, across);
    return 0;
}

} // namespace

void add_init_command(CommandLine& program) {
    program.add<InitArguments>(
        "init", "Write a scene to start from, with comments, that works as it stands", init,
        [](Options& options, InitArguments& arguments) {
            options.required("KIND", arguments.what, "what the scene is for: bump, mesh, paths, live or experiment")
                .one_of({kStarters.begin(), kStarters.end()});
            options.optional("MESH", arguments.mesh, "of kind mesh: the mesh's file; left out: mesh.obj");
            options.optional("--out FILE", arguments.out, "the scene's file; default: stdout");
            options.example("init bump --out bump.toml", "a bump to change")
                .example("init paths", "a scene with paths, to read");
        });
}

} // namespace forceshade

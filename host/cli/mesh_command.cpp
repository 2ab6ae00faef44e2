#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/long_run.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh_file.h"
#include "host/program.h"
#include "host/scene/quantity.h"

namespace forceshade {
namespace {

struct Inspected {
    PolygonFile file;
    MeshFindings findings;
    std::vector<std::string> warnings;
    std::string unit;  // empty: the file's
    double metres = 1; // what a coordinate of 1 means
};

nlohmann::ordered_json as_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

std::string as_json(const std::string& path, const Inspected& mesh) {
    const MeshFindings& found = mesh.findings;
    const double m = mesh.metres;
    nlohmann::ordered_json json{{"file", path},
                                {"format", mesh.file.format},
                                {"sha256", mesh.file.sha256},
                                {"unit", mesh.unit.empty() ? "file" : "m"},
                                {"vertices", found.vertices},
                                {"unused_vertices", found.unused_vertices},
                                {"joined_vertices", found.joined_vertices},
                                {"facets", found.facets},
                                {"triangles", found.triangles},
                                {"quadrilaterals", found.quadrilaterals},
                                {"other_facets", found.others},
                                {"most_corners", found.most_corners},
                                {"components", found.components},
                                {"boundary_edges", found.boundary_edges},
                                {"holes", found.holes},
                                {"non_manifold_edges", found.non_manifold_edges},
                                {"non_manifold_vertices", found.non_manifold_vertices},
                                {"misoriented_edges", found.misoriented_edges},
                                {"degenerate_facets", found.degenerate_facets},
                                {"redundant_facets", found.redundant_facets},
                                {"opposed_facets", found.opposed_facets},
                                {"repeated_corner_facets", found.repeated_corner_facets},
                                {"self_intersections", nullptr},
                                {"more_self_intersections", found.more_self_intersections},
                                {"closed", found.closed},
                                {"area", found.area * m * m},
                                {"volume", found.volume * m * m * m},
                                {"low", as_json(found.low * m)},
                                {"high", as_json(found.high * m)},
                                {"warnings", mesh.warnings}};
    if (found.self_intersections)
        json["self_intersections"] = *found.self_intersections;
    return json.dump(2) + "\n";
}

// "5856 (5856 triangles)", "500 (32 triangles, 468 quadrilaterals)"
std::string facet_kinds(const MeshFindings& found) {
    std::vector<std::string> kinds;
    if (found.triangles > 0)
        kinds.push_back(plural(found.triangles, "triangle"));
    if (found.quadrilaterals > 0)
        kinds.push_back(plural(found.quadrilaterals, "quadrilateral"));
    if (found.others > 0)
        kinds.push_back(fmt::format("{} of up to {} corners", found.others, found.most_corners));
    return fmt::format("{} ({})", found.facets, fmt::join(kinds, ", "));
}

std::string topology(const MeshFindings& found) {
    return fmt::format("{}, {}{}", found.closed ? "closed" : "open", plural(found.components, "piece"),
                       !found.closed      ? ""
                       : found.volume > 0 ? ", oriented outward"
                       : found.volume < 0 ? ", oriented inward"
                                          : "");
}

std::string triple(const glm::dvec3& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

std::string as_text(const Inspected& mesh) {
    const MeshFindings& found = mesh.findings;
    const double m = mesh.metres;
    const std::string unit = mesh.unit.empty() ? "file units" : "m";
    const glm::dvec3 size = (found.high - found.low) * m;
    const std::string intersections =
        !found.self_intersections
            ? "not looked for in a mesh of this size"
            : fmt::format("{}{}", found.more_self_intersections ? "at least " : "", *found.self_intersections);
    std::vector<std::pair<std::string, std::string>> rows{
        {"format", mesh.file.format},
        {"vertices", found.joined_vertices == 0 ? fmt::format("{}", found.vertices)
                                                : fmt::format("{}, and {} more at the same places, joined",
                                                              found.vertices, found.joined_vertices)},
        {"facets", facet_kinds(found)},
        {"surface", topology(found)},
        {"bounding box", fmt::format("{} to {} {}", triple(found.low * m), triple(found.high * m), unit)},
        {"size", fmt::format("{:.6g} x {:.6g} x {:.6g} {}", size.x, size.y, size.z, unit)},
        {"area", fmt::format("{:.6g} {}^2", found.area * m * m, unit)},
        {"volume", fmt::format("{:.6g} {}^3{}", found.volume * m * m * m, unit,
                               found.closed ? "" : " (of an open surface: no meaning of its own)")},
        {"intersections", intersections}};
    for (const std::string& warning : mesh.warnings)
        rows.emplace_back("warning", warning);
    if (mesh.warnings.empty())
        rows.emplace_back("warnings", "none");
    std::string text;
    for (const auto& [name, value] : rows)
        text += fmt::format("{:<15}{}\n", name, value);
    return text;
}

struct Arguments {
    std::string file, unit;
};

int run(const Arguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const auto& [path, unit] = arguments;
    Inspected mesh;
    mesh.unit = unit;
    if (!unit.empty())
        mesh.metres =
            parse_quantity(std::isdigit(static_cast<unsigned char>(unit[0])) ? unit : "1 " + unit, Dimension::length);
    mesh.file = read_polygons(path);
    mesh.findings = inspect(mesh.file.polygons);
    mesh.findings.joined_vertices = mesh.file.joined_vertices;
    mesh.warnings = warnings(mesh.findings, MeshUse::any, unit.empty() ? "of the file's unit" : "m", mesh.metres);
    mesh.warnings.insert(mesh.warnings.begin(), mesh.file.warnings.begin(), mesh.file.warnings.end());
    refuse_if_meaningless(mesh.findings, path);
    print_data(common.json ? as_json(path, mesh) : as_text(mesh));
    if (!common.quiet && unit.empty())
        remark("lengths are in the file's unit, which no mesh file tells; for metres say what a coordinate of 1 is, as "
               "--unit mm\n");
    return 0;
}

} // namespace

void add_mesh_command(CommandLine& program) {
    program.add<Arguments>("mesh", "Say what is in a mesh file and what is wrong with it", run,
                           [](Options& options, Arguments& arguments) {
                               options.required("FILE", arguments.file, "OBJ, OFF, PLY or STL");
                               options
                                   .optional("--unit UNIT", arguments.unit,
                                             "what a coordinate of 1 means, as mm or in; sizes are then in m")
                                   .example("mesh bone.ply --unit mm", "its size in metres, holes, crossings")
                                   .example("mesh bone.ply --json", "the same for a script");
                           });
}

} // namespace forceshade

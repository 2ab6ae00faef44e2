#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/long_run.h"
#include "host/mesh/findings.h"
#include "host/numbers.h"
#include "host/picture/picture.h"
#include "host/scene/toml.h"
#include "host/scene/value.h"

namespace forceshade {
namespace {

constexpr std::size_t kFewPieces = 6; // that the page lists; --json has all

struct Arguments {
    std::string file, unit, out;
    std::vector<std::string> also;
    picture::Look look;
};

struct Inspected {
    MeshSpec spec; // its path, unit and keys
    std::shared_ptr<const SceneMesh> mesh;
    std::string unit;              // of lengths in texts
    std::vector<MeshFault> faults; // what was skipped of the file among them
    MeshMarks marks;               // empty until they are looked for
};

Inspected look_at(CasePreparation& preparation, MeshSpec spec, const std::string& unit) {
    Inspected result;
    result.mesh = preparation.mesh(spec);
    result.unit = unit;
    result.faults = result.mesh->changes;
    std::ranges::move(
        faults(result.mesh->findings,
               result.mesh->inside == InsideTest::winding ? MeshUse::winding_field : MeshUse::pseudonormal_field, unit,
               spec.unit),
        std::back_inserter(result.faults));
    result.spec = std::move(spec);
    return result;
}

// How a piece stands among the others.
std::string_view standing_of(const MeshPiece& piece) {
    return piece.one_sided         ? "one-sided"
           : piece.opposed > 0     ? "facets disagree"
           : !piece.closed         ? "open"
           : piece.is_inside_out() ? "inside out"
           : piece.is_nested()     ? "outward within another"
           : piece.volume < 0      ? "cavity"
                                   : "outward";
}

nlohmann::ordered_json as_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

std::string as_json(const Inspected& one) {
    const MeshFindings& found = one.mesh->findings;
    const double m = one.spec.unit;
    std::vector<std::string> warnings;
    nlohmann::ordered_json faults = nlohmann::ordered_json::array();
    for (const MeshFault& fault : one.faults) {
        warnings.push_back(sentence(fault));
        faults.push_back({{"what", fault.what}, {"force", fault.force}, {"remedy", fault.remedy}, {"key", fault.key}});
    }
    nlohmann::ordered_json pieces = nlohmann::ordered_json::array();
    for (const MeshPiece& piece : find_pieces(one.mesh->mesh.polygons).pieces)
        pieces.push_back({{"first_facet", piece.first_facet},
                          {"facets", piece.facets},
                          {"volume", piece.closed ? nlohmann::ordered_json(piece.volume) : nullptr},
                          {"standing", standing_of(piece)}});
    nlohmann::ordered_json json{{"file", one.spec.file},
                                {"format", one.mesh->format},
                                {"sha256", one.mesh->sha256},
                                {"unit", one.unit == "m" ? "m" : "file"},
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
                                {"sharp_edges", one.marks.sharp.size()},
                                {"inside", one.mesh->inside == InsideTest::winding ? "winding" : "pseudonormal"},
                                {"pieces", pieces},
                                {"faults", faults},
                                {"warnings", warnings}};
    if (found.self_intersections)
        json["self_intersections"] = *found.self_intersections;
    return json.dump(2) + "\n";
}

// "5856 triangles", "32 triangles, 468 quadrilaterals"
std::string facet_kinds(const MeshFindings& found) {
    std::vector<std::string> kinds;
    if (found.triangles > 0)
        kinds.push_back(numbers::counted(found.triangles, "triangle"));
    if (found.quadrilaterals > 0)
        kinds.push_back(numbers::counted(found.quadrilaterals, "quadrilateral"));
    if (found.others > 0)
        kinds.push_back(
            fmt::format("{} of up to {} corners", numbers::counted(found.others, "facet"), found.most_corners));
    return fmt::format("{}", fmt::join(kinds, ", "));
}

std::string triple(const glm::dvec3& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

std::string contents(const Inspected& one) {
    const MeshFindings& found = one.mesh->findings;
    const double m = one.spec.unit;
    const glm::dvec3 size = (found.high - found.low) * m;
    const std::string joined = found.joined_vertices > 0
                                   ? fmt::format(" (and {} more at the same places, joined)", found.joined_vertices)
                                   : "";
    return fmt::format("{}: {} vertices{}, {}; {:.6g} x {:.6g} x {:.6g} {}, from {} to {}", one.mesh->format,
                       found.vertices, joined, facet_kinds(found), size.x, size.y, size.z, one.unit,
                       triple(found.low * m), triple(found.high * m));
}

std::string surface(const Inspected& one) {
    const MeshFindings& found = one.mesh->findings;
    const double m = one.spec.unit;
    const std::string faces = !found.closed ? ""
                              : !found.inside_out.empty()
                                  ? fmt::format(", {} of them inside out", found.inside_out.size())
                              : found.misoriented_edges > 0 ? ", facets do not agree on a side"
                              : found.volume > 0            ? ", faces outward"
                              : found.volume < 0            ? ", faces inward"
                                                            : "";
    const std::string crossings = !found.self_intersections ? "crossings not looked for in a mesh of this size"
                                  : *found.self_intersections == 0
                                      ? "no crossings"
                                      : (found.more_self_intersections ? "at least " : "") +
                                            numbers::counted(*found.self_intersections, "crossing");
    return fmt::format("{}, {}{}, {}; area {:.6g} {}^2, volume {:.6g} {}^3{}", found.closed ? "closed" : "open",
                       numbers::counted(found.components, "piece"), faces, crossings, found.area * m * m, one.unit,
                       found.volume * m * m * m, one.unit,
                       found.closed ? "" : " (of an open surface: no meaning of its own)");
}

// "1: 12 facets, 1e-06 m^3, outward; 2: ...".
std::string few_pieces(const Inspected& one) {
    std::string text;
    const std::vector<MeshPiece> pieces = find_pieces(one.mesh->mesh.polygons).pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        text += fmt::format("{}{}: {}, {}{}", i == 0 ? "" : "; ", i + 1, numbers::counted(pieces[i].facets, "facet"),
                            pieces[i].closed ? fmt::format("{:.6g} {}^3, ", pieces[i].volume, one.unit) : "",
                            standing_of(pieces[i]));
    return text;
}

// Where a force is, in a field and on paths, and what shading does.
std::string force(const Inspected& one) {
    const bool winding = one.mesh->inside == InsideTest::winding, closed = one.mesh->findings.closed;
    std::string text = closed && !winding ? "inside, out of the nearest facet"
                       : closed           ? "where the winding number exceeds 1/2, out of the nearest facet"
                       : winding          ? "inside, as if holes were closed (winding number), out of the nearest facet"
                                 : "behind the sheet, however far away; a path's stays on the side where it began";
    if (one.mesh->findings.components > 1)
        text += ", whichever piece that is of";
    if (const std::size_t sharp = one.marks.sharp.size())
        text += fmt::format("; shading rounds {} sharper than {:g} deg (normals = \"crease:{:g} deg\" keeps {})",
                            numbers::counted(sharp, "edge"), MeshMarks::kSharp, MeshMarks::kSharp,
                            sharp == 1 ? "it" : "them");
    return text;
}

// The keys that help, each once.
std::vector<std::string> keys_of(const Inspected& one) {
    std::vector<std::string> keys;
    for (const MeshFault& fault : one.faults)
        if (!fault.key.empty() && std::ranges::find(keys, fault.key) == keys.end())
            keys.push_back(fault.key);
    return keys;
}

// [surface] of a scene of this mesh.
std::string to_write(const Inspected& one, const std::string& unit) {
    std::string text =
        fmt::format("[surface] kind = \"mesh\"  file = {}  unit = \"{}\"", toml_string(one.spec.file), unit);
    for (const std::string& key : keys_of(one))
        text += "  " + key;
    return text;
}

// m, or of the file's unit: 0.003 of weld = "0.003 m".
double length_in(const std::string& key) {
    const std::size_t number = key.find('"') + 1;
    return parse_quantity(key.substr(number, key.find(' ', number) - number) + " m", Dimension::length);
}

// What is wrong once the keys that help are written; empty where none do.
std::string outcome(CasePreparation& preparation, const Inspected& one) {
    if (keys_of(one).empty())
        return "";
    MeshSpec mended = one.spec;
    for (const MeshFault& fault : one.faults) {
        if (fault.key.starts_with("orient"))
            mended.orient = Orientation::outward;
        if (fault.key.starts_with("normals"))
            mended.normals = NormalWeights::groups;
        if (fault.key.starts_with("weld"))
            mended.weld = length_in(fault.key);
    }
    Inspected then;
    try {
        then = look_at(preparation, mended, one.unit);
    } catch (const UsageError& error) {
        return error.what();
    }
    std::string left;
    for (std::size_t i = then.mesh->changes.size(); i < then.faults.size(); ++i)
        if (const MeshFault& fault = then.faults[i]; fault.is_wrong)
            left += (left.empty() ? "" : "; ") + fault.what;
    return fmt::format("{}, {}; {}", then.mesh->findings.closed ? "closed" : "open",
                       numbers::counted(then.mesh->findings.components, "piece"),
                       left.empty() ? "nothing is wrong" : left);
}

std::string as_text(CasePreparation& preparation, const Inspected& one, const std::string& unit) {
    std::vector<std::pair<std::string, std::string>> rows{{"mesh", contents(one)}, {"surface", surface(one)}};
    if (const std::size_t pieces = one.mesh->findings.components; pieces > 1 && pieces <= kFewPieces)
        rows.emplace_back("pieces", few_pieces(one));
    const std::size_t sound = rows.size();
    for (const MeshFault& fault : one.faults)
        if (fault.is_wrong)
            rows.emplace_back("wrong", sentence(fault));
    if (rows.size() == sound)
        rows.emplace_back("wrong", "nothing");
    rows.emplace_back("force", force(one));
    rows.emplace_back("write", to_write(one, unit));
    if (const std::string then = outcome(preparation, one); !then.empty())
        rows.emplace_back("then", then);
    std::string text;
    for (const auto& [name, value] : rows)
        text += fmt::format("{:<9}{}\n", name, value);
    return text;
}

int run(const Arguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    picture::Endings endings;
    for (const std::string& name : arguments.also)
        endings.add(name);
    const std::filesystem::path file(arguments.file);
    const std::filesystem::path stem = arguments.out.empty() ? file.stem().string() + ".mesh" : arguments.out;
    refuse_unused(endings, arguments.look == picture::Look{} && arguments.out.empty());
    std::vector<std::filesystem::path> files;
    for (const std::string& name : picture::names_with(stem.string(), endings))
        files.emplace_back(name);
    const bool draws = endings.any() && may_write(files, common);
    MeshSpec spec;
    spec.file = arguments.file;
    spec.path = file;
    std::string unit = arguments.unit;
    if (!unit.empty()) {
        unit = std::isdigit(static_cast<unsigned char>(unit[0])) ? unit : "1 " + unit;
        spec.unit = option_quantity("--unit", unit, Dimension::length);
    }
    CasePreparation preparation;
    Inspected one = look_at(preparation, spec, unit.empty() ? "file units" : "m");
    one.marks = find_marks(one.mesh->mesh, one.mesh->structure, one.mesh->findings);
    print_data(common.json ? as_json(one) : as_text(preparation, one, unit.empty() ? "UNIT" : arguments.unit));
    if (draws) {
        picture::Look look = arguments.look;
        if (look.title.empty())
            look.title = "Mesh " + file.filename().string();
        write_picture(stem, endings,
                      picture::draw_mesh(look, {contents(one), surface(one)}, one.mesh->mesh, one.marks, one.unit));
    }
    if (unit.empty())
        note(common, "lengths are in the file's unit, which mesh files do not state; for metres say what a coordinate "
                     "of 1 is, as --unit mm\n");
    return 0;
}

} // namespace

void add_mesh_command(CommandLine& program) {
    program.add<Arguments>(
        "mesh", "Say what is in a mesh file, what is wrong with it and what to write", run,
        [](Options& options, Arguments& arguments) {
            options.required("FILE", arguments.file, "OBJ, OFF, PLY or STL");
            options.optional("--unit UNIT", arguments.unit,
                             "what a coordinate of 1 means, as mm or in; sizes are then in m");
            options.list("--also png|svg|pdf", arguments.also,
                         "a picture of the mesh from two sides, with holes, crossings, facets that face inward and "
                         "sharp edges marked");
            options.optional("--out STEM", arguments.out,
                             "of the picture's files; without it FILE's name and .mesh, in this folder");
            describe_look(options, arguments.look);
            options.example("mesh bone.ply --unit mm", "its size in metres, holes, crossings, what helps")
                .example("mesh bone.ply --also png", "and a picture, bone.mesh.png")
                .example("mesh bone.ply --json", "the same for a script");
        });
}

} // namespace forceshade

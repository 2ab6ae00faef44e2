// The worst error of single precision, law by law.
#include <algorithm>

#include <fmt/format.h>

#include "host/study/stability/number.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::study {
namespace {

struct SearchedLaw {
    std::string name;
    PreparedCase prepared;
    bool strokes = false; /* of the god-object */
};

PreparedCase textured(PreparedCase prepared) {
    TextureSpec& texture = prepared.one.scene.texture.emplace();
    texture.stiffness = prepared.one.scene.force.stiffness;
    texture.map.function = MapFunction::sine;
    texture.map.width = 0.002;
    texture.map.height = 0.0001;
    return prepared;
}

std::vector<SearchedLaw> own_laws() {
    std::vector<SearchedLaw> laws{
        {"bump of 8 facets, none", own_case({})},
        {"bump of 8 facets, reference", own_case({.shaded = true})},
        {"bump of 8 facets, reference, textured", textured(own_case({.shaded = true}))},
        {"height map of the cylinder", own_case({.kind = SurfaceKind::height_map, .shaded = true})}};
    constexpr std::pair<Shading, const char*> kShadings[] = {{Shading::none, "none"},
                                                             {Shading::morgenbesser, "morgenbesser"},
                                                             {Shading::barycentric, "barycentric"},
                                                             {Shading::mean_value, "mean_value"},
                                                             {Shading::two_pass, "two_pass"}};
    for (const auto& [rows, what] :
         {std::pair(4u, "mesh of 8 x 4 cells"), std::pair(256u, "mesh of 8 x 256 thin cells")}) {
        PreparedCase mesh = own_case({.kind = SurfaceKind::mesh, .rows = rows});
        for (const auto& [shading, name] : kShadings) {
            mesh.one.scene.force.shading = shading;
            laws.push_back({fmt::format("{}, {}", what, name), mesh});
            if (rows == 4)
                laws.push_back({fmt::format("{}, {}, god-object", what, name), mesh, true});
        }
    }
    return laws;
}

// In single precision, whatever it asks for.
std::vector<SearchedLaw> laws_of(PreparedCase scene) {
    scene.one.scene.precision = Precision::f32;
    std::vector<SearchedLaw> laws{{"this scene", scene}};
    if (scene.images.mesh)
        laws.push_back({"this scene, god-object", scene, true});
    return laws;
}

} // namespace

std::vector<Part> worst_rounding_parts(const PreparedCase* scene, bool quick, std::vector<LawRounding>& found) {
    std::vector<Part> parts;
    for (const SearchedLaw& law : scene ? laws_of(*scene) : own_laws())
        parts.push_back({"single precision of " + law.name, [law, quick, &found] {
                             const std::size_t places = quick ? 20'000 : 200'000;
                             for (const WorstRounding& one : law.strokes
                                                                 ? worst_rounding_of_strokes(law.prepared, places / 20)
                                                                 : worst_rounding(law.prepared, places))
                                 found.push_back({one, law.name});
                         }});
    return parts;
}

void add_worst_rounding(StudyData& data, const std::vector<LawRounding>& found, bool own) {
    using R = LawRounding;
    const auto coordinate = [](int axis) { return [axis](const R& r) { return 1e3 * r.place[axis]; }; };
    data.tables.push_back(table_of<R>(
        "worst_rounding", "Largest errors of single precision that a search found, 0.02 to 2 mm deep",
        {{"law", "",
          fmt::format("{}god-object: at the end of a straight stroke from the open",
                      own ? "R = 2 a, a = 12.7 mm, K = 1000 N/m; " : "the scene's, static; "),
          &R::law},
         {"facet", "",
          "same: both precisions meet the same facet, away from edges of the law; another: rounding chose between "
          "facets that are equally near, or sides of an edge",
          [](const R& r) { return r.same_facet ? "same facet" : "another facet"; }},
         {"error_1", "1", "difference of the forces over the largest force of the search, that at 2 mm", &R::error},
         {"local_1", "1", "over the force there", &R::local},
         {"turn_deg", "deg", "angle between both forces", &R::turn},
         {"gradient_1", "1",
          "most that the law in double changes by within the rounding of single precision, over K times the way: how "
          "ill-conditioned the force is there",
          &R::gradient},
         {"depth_mm", "mm", "of the place", [](const R& r) { return 1e3 * r.depth; }},
         {"x_mm", "mm", "of the place", coordinate(0)},
         {"y_mm", "mm", "of the place", coordinate(1)},
         {"z_mm", "mm", "of the place", coordinate(2)},
         {"evaluations", "1",
          "of the law in each precision, aimed at facets, edges, corners and ties and climbing from the worst",
          &R::evaluations}},
        found));
    const auto worst = [&](bool strokes, bool same) {
        const LawRounding* most = nullptr;
        for (const LawRounding& one : found)
            if (one.from.has_value() == strokes && one.same_facet == same && (!most || one.error > most->error))
                most = &one;
        return most;
    };
    const LawRounding *same = worst(false, true), *other = worst(false, false);
    if (!same)
        return;
    std::size_t evaluations = 0;
    for (const LawRounding& one : found)
        evaluations += one.same_facet ? one.evaluations : 0;
    std::string text =
        fmt::format("Single precision of a field differs from double by up to {:.2g} of the largest force "
                    "where both meet the same facet",
                    same->error);
    if (other)
        text += fmt::format(", and by up to {:.2g} where two facets are equally near and rounding chooses: the static "
                            "field jumps there whatever the shading",
                            other->error);
    std::string laws = same->law + (other ? "; " + other->law : std::string());
    if (const LawRounding* stroke = worst(true, true)) {
        text += fmt::format(". A god-object's differs by up to {:.2g} at the ends of strokes", stroke->error);
        laws += "; " + stroke->law;
    }
    if (const LawRounding* fork = worst(true, false)) {
        text +=
            fmt::format(", and by up to {:.2g} where two strokes fork at an edge: along each of them its force does "
                        "not jump",
                        fork->error);
        laws += "; " + fork->law;
    }
    data.figures.push_back(make_figure(
        "worst-rounding", "Largest error of single precision that a search found, law by law",
        "Largest difference of the forces that a search found, over the largest force. Where rounding chooses another "
        "facet of a tie, a law whose direction jumps from facet to facet jumps with it.",
        FigureKind::bars, "worst_rounding", {}, {"law", "law"},
        {"error_1", "difference of the forces / largest force", true}, "facet"));
    data.findings.push_back({"worst_rounding", text + ".", "worst-rounding", laws,
                             own ? "R = 2 a, probe 0.02 to 2 mm deep" : "as deep as a hand goes",
                             fmt::format("the worst of {} evaluations of {} laws: a search, not a bound", evaluations,
                                         std::ranges::count(found, true, &LawRounding::same_facet))});
}

} // namespace forceshade::study

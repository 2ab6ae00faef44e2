// The worst error of single precision in a law, by a search near corners and edges, not by samples.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/field/case_law.h"
#include "host/random.h"
#include "host/study/stability/number.h"
#include "host/touch/angle.h"
#include "host/touch/bump_mesh.h"

namespace forceshade::study {
namespace {

constexpr double kHalf = 0.0127, kRadius = 2 * kHalf; // m: a and R = 2 a
constexpr double kStiff = 1000;                       // N/m
constexpr double kShallowest = 2e-5, kDeepest = 2e-3; // m
constexpr std::size_t kClimbs = 64, kClimbSteps = 300;

struct SearchedLaw {
    std::string name;
    PreparedCase prepared;
};

std::vector<SearchedLaw> searched_laws() {
    std::vector<SearchedLaw> laws;
    const auto add = [&](std::string name, const Scene& scene, std::shared_ptr<const SceneMesh> mesh = nullptr) {
        SearchedLaw law{std::move(name), {}};
        law.prepared.one.scene = scene;
        law.prepared.images.mesh = std::move(mesh);
        laws.push_back(std::move(law));
    };
    add("bump of 8 facets, none", number_scene("bump"));
    add("bump of 8 facets, reference", number_scene("shaded bump"));
    add("height map of the cylinder", number_scene("height map, cylinder"));
    Scene scene = number_scene("mesh");
    constexpr std::pair<Shading, const char*> kShadings[] = {{Shading::none, "none"},
                                                             {Shading::morgenbesser, "morgenbesser"},
                                                             {Shading::barycentric, "barycentric"},
                                                             {Shading::mean_value, "mean_value"},
                                                             {Shading::two_pass, "two_pass"}};
    for (const auto& [rows, what] :
         {std::pair(4u, "mesh of 8 x 4 cells"), std::pair(256u, "mesh of 8 x 256 thin cells")}) {
        const auto mesh = bump_mesh({kHalf, kRadius, 8, rows}, glm::dvec3(0));
        for (const auto& [shading, name] : kShadings) {
            scene.force.shading = shading;
            add(fmt::format("{}, {}", what, name), scene, mesh);
        }
    }
    return laws;
}

// Both precisions at a place.
class BothLaws {
public:
    explicit BothLaws(const SearchedLaw& law) : law_(law), single_(law.prepared), twice_(law.prepared) {}

    /// Empty if the place is outside of the depths of a hand, in either precision.
    std::optional<WorstRounding> operator()(const glm::dvec3& at) {
        ++evaluations_;
        const auto one = single_.at(at, single_hint_);
        const auto two = twice_.at(at, twice_hint_);
        const glm::dvec3 force(one.force), truth(two.force);
        const double size = reference::length(truth), off = reference::length(force - truth);
        if (!(two.depth >= kShallowest && two.depth <= kDeepest) || one.facet == layout::kNoFacet || !(size > 0))
            return std::nullopt;
        const bool same = one.facet == two.facet && !jumps_near(at, truth, 0.5 * off);
        WorstRounding found{law_.name, same, off / (kStiff * kDeepest), off / size, 0, two.depth, at, evaluations_};
        if (reference::length(force) > 0)
            found.turn = angle_between(force, truth) / kDegree;
        return found;
    }
    std::size_t evaluations() const { return evaluations_; }

private:
    // Whether the law itself, in double, differs as much between places that rounding to single precision may choose:
    // its direction has an edge there, on any facet.
    bool jumps_near(const glm::dvec3& at, const glm::dvec3& force, double much) {
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const double step = 0x1p-22 * std::max(std::fabs(at[axis]), kHalf);
                glm::dvec3 moved = at;
                moved[axis] += side * step;
                const auto there = twice_.at(moved, twice_hint_);
                const double slope = 16 * kStiff * step; // a law without edges changes less
                if (reference::length(glm::dvec3(there.force) - force) > std::max(much, slope))
                    return true;
            }
        return false;
    }

    const SearchedLaw& law_;
    CaseLaw<float> single_;
    CaseLaw<double> twice_;
    layout::uint single_hint_ = 0, twice_hint_ = 0;
    std::size_t evaluations_ = 0;
};

double log_uniform(Random& draw, double low, double high) {
    return low * std::pow(high / low, draw(0, 1));
}

glm::dvec3 any_direction(Random& draw) {
    const double z = draw(-1, 1), angle = draw(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

// A point of the surface: a corner, a point of an edge, or one within a facet, moved by 1 nm to 0.1 mm.
glm::dvec3 aimed_place(const SearchedLaw& law, Random& draw) {
    const double depth = log_uniform(draw, kShallowest, kDeepest);
    const glm::dvec3 aside = log_uniform(draw, 1e-9, 1e-4) * any_direction(draw);
    if (!law.prepared.images.mesh) {
        const double vertex = kHalf * std::round(draw(-1, 1) * 4) / 4,
                     angle = std::asin(std::clamp(vertex / kRadius, -1.0, 1.0));
        const double x = draw(0, 1) < 0.5 ? vertex : kRadius * std::sin(angle * draw(0.99, 1.01));
        const bool flat = law.prepared.one.scene.surface.kind == SurfaceKind::height_map;
        const double rise =
            flat ? 0 : std::sqrt(kRadius * kRadius - x * x) - std::sqrt(kRadius * kRadius - kHalf * kHalf);
        return glm::dvec3(x, draw(-1e-3, 1e-3), rise - depth) + aside;
    }
    const Mesh& mesh = law.prepared.images.mesh->mesh;
    const auto triangle = static_cast<std::size_t>(draw(0, static_cast<double>(mesh.triangles.corners.size())));
    const auto& corners = mesh.triangles.corners[triangle];
    double weights[3] = {draw(0, 1), draw(0, 1), draw(0, 1)};
    const double kind = draw(0, 3); // within, on an edge, at a corner
    weights[0] = kind > 1 ? 0 : weights[0];
    weights[1] = kind > 2 ? 0 : weights[1];
    glm::dvec3 at(0);
    for (std::size_t i = 0; i < 3; ++i)
        at += weights[i] / (weights[0] + weights[1] + weights[2]) * mesh.polygons.vertices[corners[i]];
    return at - depth * mesh.triangles.normals[triangle] + aside;
}

// Climbs from a place to worse ones of the same kind.
WorstRounding climbed(BothLaws& both, WorstRounding best, Random& draw) {
    double reach = 1e-5; // m
    for (std::size_t step = 0; step < kClimbSteps; ++step) {
        const auto next = both(best.place + reach * draw(0, 1) * any_direction(draw));
        if (next && next->same_facet == best.same_facet && next->error > best.error) {
            best = *next;
            reach *= 1.5;
        } else {
            reach = std::max(reach * 0.93, 1e-10);
        }
    }
    return best;
}

void search(const SearchedLaw& law, std::size_t places, std::vector<WorstRounding>& found) {
    BothLaws both(law);
    Random draw(11);
    std::vector<WorstRounding> seen;
    for (std::size_t i = 0; i < places; ++i)
        if (const auto one = both(aimed_place(law, draw)))
            seen.push_back(*one);
    std::ranges::sort(seen, std::greater{}, &WorstRounding::error);
    for (const bool same : {true, false}) {
        std::optional<WorstRounding> worst;
        std::size_t climbs = 0;
        for (const WorstRounding& one : seen) {
            if (one.same_facet != same || climbs++ >= kClimbs)
                continue;
            const WorstRounding top = climbed(both, one, draw);
            if (!worst || top.error > worst->error)
                worst = top;
        }
        if (worst)
            found.push_back(*worst);
    }
    for (WorstRounding& one : found)
        if (one.law == law.name)
            one.evaluations = both.evaluations();
}

} // namespace

std::vector<Part> worst_rounding_parts(bool quick, std::vector<WorstRounding>& found) {
    std::vector<Part> parts;
    for (const SearchedLaw& law : searched_laws())
        parts.push_back({"single precision of " + law.name,
                         [law, quick, &found] { search(law, quick ? 20'000 : 200'000, found); }});
    return parts;
}

void add_worst_rounding(StudyData& data, const std::vector<WorstRounding>& found) {
    using R = WorstRounding;
    const auto coordinate = [](int axis) { return [axis](const R& r) { return 1e3 * r.place[axis]; }; };
    data.tables.push_back(table_of<R>(
        "worst_rounding", "Largest errors of single precision that a search found, 0.02 to 2 mm deep",
        {{"law", "", "R = 2 a, a = 12.7 mm, K = 1000 N/m", &R::law},
         {"facet", "",
          "same: both precisions meet the same facet, away from edges of the law; another: rounding chose another "
          "facet of a tie, or the other side of an edge",
          [](const R& r) { return r.same_facet ? "same facet" : "another facet"; }},
         {"error_1", "1", "difference of the forces over the largest force of the search, that at 2 mm", &R::error},
         {"local_1", "1", "over the force there", &R::local},
         {"turn_deg", "deg", "angle between both forces", &R::turn},
         {"depth_mm", "mm", "of the place", [](const R& r) { return 1e3 * r.depth; }},
         {"x_mm", "mm", "of the place", coordinate(0)},
         {"y_mm", "mm", "of the place", coordinate(1)},
         {"z_mm", "mm", "of the place", coordinate(2)},
         {"evaluations", "1", "of the law in each precision, aimed at corners and edges and climbing from the worst",
          &R::evaluations}},
        found));
    const auto worst = [&](bool same) {
        const WorstRounding* most = nullptr;
        for (const WorstRounding& one : found)
            if (one.same_facet == same && (!most || one.error > most->error))
                most = &one;
        return most;
    };
    const WorstRounding *same = worst(true), *other = worst(false);
    if (!same)
        return;
    std::size_t evaluations = 0;
    for (const WorstRounding& one : found)
        evaluations += one.same_facet ? one.evaluations : 0;
    std::string text =
        fmt::format("Single precision differs from double by up to {:.1e} of the largest force where both "
                    "meet the same facet",
                    same->error);
    if (other)
        text += fmt::format(", and by up to {:.1e} where rounding chooses the other side of an edge", other->error);
    data.figures.push_back(make_figure(
        "worst-rounding", "Largest error of single precision that a search found, law by law",
        "Largest difference of the forces that a search found, over the largest force. Where rounding chooses another "
        "facet of a tie, a law whose direction jumps from facet to facet jumps with it.",
        FigureKind::bars, "worst_rounding", {}, {"law", "law"},
        {"error_1", "difference of the forces / largest force", true}, "facet"));
    data.findings.push_back({"worst_rounding", text + ".", "worst-rounding",
                             same->law + (other ? "; " + other->law : std::string()),
                             "R = 2 a, probe 0.02 to 2 mm deep, static evaluation",
                             fmt::format("the worst of {} evaluations of {} laws: a search, not a bound", evaluations,
                                         std::ranges::count(found, true, &WorstRounding::same_facet))});
}

} // namespace forceshade::study

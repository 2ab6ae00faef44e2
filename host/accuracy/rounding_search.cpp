#include "host/accuracy/rounding_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "host/field/case_law.h"
#include "host/mesh/mesh.h"
#include "host/touch/angle.h"
#include "host/touch/places.h"

namespace forceshade {
namespace {

constexpr std::size_t kClimbSteps = 300;

// Where two facets are equally near: neighbours in double, one on either side, on a way across.
struct Tie {
    glm::dvec3 here, there, way; /* m */
};

// Both precisions at a place.
class BothLaws {
public:
    explicit BothLaws(const PreparedCase& prepared)
        : single_(prepared), twice_(prepared), shape_(scene_shape(prepared)) {
        shape_.force = [this](const TouchPlace& place) { return glm::dvec3(twice_.at(place.at, twice_hint_).force); };
        stiffness_ = prepared.one.scene.force.stiffness;
    }
    BothLaws(const BothLaws&) = delete;
    BothLaws& operator=(const BothLaws&) = delete;

    const TouchedShape& shape() const { return shape_; }

    /// The first on a way from a place, in double.
    std::optional<Tie> tie_on(const glm::dvec3& from, const glm::dvec3& way) {
        constexpr int kSteps = 16, kHalvings = 64;
        const layout::uint facet = facet_at(from);
        for (int i = 0; i < kSteps && facet != layout::kNoFacet; ++i) {
            glm::dvec3 here = from + double(i) / kSteps * way, there = from + double(i + 1) / kSteps * way;
            const layout::uint next = facet_at(there);
            if (next == layout::kNoFacet)
                break;
            if (next == facet)
                continue;
            for (int halving = 0; halving < kHalvings; ++halving) {
                const glm::dvec3 middle = 0.5 * (here + there);
                (facet_at(middle) == facet ? here : there) = middle;
            }
            return Tie{here, there, way};
        }
        return std::nullopt;
    }

    /// Empty if the place is outside of the depths of a hand, in either precision.
    std::optional<WorstRounding> operator()(const glm::dvec3& at) {
        ++evaluations_;
        const auto one = single_.at(at, single_hint_);
        const auto two = twice_.at(at, twice_hint_);
        const glm::dvec3 force(one.force), truth(two.force);
        const double size = reference::length(truth), off = reference::length(force - truth);
        const TouchScale& scale = shape_.scale;
        if (!(two.depth >= scale.shallowest() && two.depth <= scale.deepest) || one.facet == layout::kNoFacet ||
            !(size > 0))
            return std::nullopt;
        const bool same = one.facet == two.facet && !jumps_near(at, truth, 0.5 * off);
        WorstRounding found{same, off / (stiffness_ * scale.deepest), off / size, 0, two.depth, at, evaluations_};
        if (reference::length(force) > 0)
            found.turn = angle_between(force, truth) / kDegree;
        return found;
    }
    std::size_t evaluations() const { return evaluations_; }

private:
    layout::uint facet_at(const glm::dvec3& at) { return twice_.at(at, twice_hint_).facet; }

    // Whether the law itself, in double, differs as much between places that rounding to single precision may choose:
    // its direction has an edge there, on any facet.
    bool jumps_near(const glm::dvec3& at, const glm::dvec3& force, double much) {
        const double size =
            std::max(reference::largest_coordinate(shape_.low), reference::largest_coordinate(shape_.high));
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const double step = 0x1p-22 * std::max(std::fabs(at[axis]), size);
                glm::dvec3 moved = at;
                moved[axis] += side * step;
                const double slope = 16 * stiffness_ * step; // a law without edges changes less
                if (reference::length(glm::dvec3(twice_.at(moved, twice_hint_).force) - force) > std::max(much, slope))
                    return true;
            }
        return false;
    }

    CaseLaw<float> single_;
    CaseLaw<double> twice_;
    TouchedShape shape_;
    double stiffness_ = 1; /* N/m */
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

// Aims at places of a case.
class Aim {
public:
    Aim(BothLaws& both, const PreparedCase& prepared)
        : both_(both), mesh_(prepared.images.mesh ? &prepared.images.mesh->mesh : nullptr),
          places_(both.shape(), prepared, 12), draw_(11) {}

    /// Below a facet, an edge or a corner of a mesh, or anywhere below another surface; moved by up to a twentieth of
    /// the depth of a hand.
    std::optional<glm::dvec3> below_the_surface() {
        const TouchScale& scale = both_.shape().scale;
        const glm::dvec3 aside = log_uniform(draw_, 5e-7, 0.05) * scale.deepest * any_direction(draw_);
        if (!mesh_) {
            const auto place = places_();
            return place ? std::optional(place->at + aside) : std::nullopt;
        }
        const auto triangle = static_cast<std::size_t>(draw_(0, static_cast<double>(mesh_->triangles.corners.size())));
        double weights[3] = {draw_(0, 1), draw_(0, 1), draw_(0, 1)};
        const double kind = draw_(0, 3); // within, on an edge, at a corner
        weights[0] = kind > 1 ? 0 : weights[0];
        weights[1] = kind > 2 ? 0 : weights[1];
        glm::dvec3 at(0);
        for (std::size_t i = 0; i < 3; ++i)
            at += weights[i] / (weights[0] + weights[1] + weights[2]) *
                  mesh_->polygons.vertices[mesh_->triangles.corners[triangle][i]];
        return at - log_uniform(draw_, scale.shallowest(), scale.deepest) * mesh_->triangles.normals[triangle] + aside;
    }

    /// On a way from a place below the surface.
    std::optional<Tie> tie() {
        const std::optional<glm::dvec3> from = below_the_surface();
        return from ? both_.tie_on(*from,
                                   log_uniform(draw_, 0.01, 4) * both_.shape().scale.deepest * any_direction(draw_))
                    : std::nullopt;
    }

    glm::dvec3 near(const glm::dvec3& place, double reach) {
        return place + reach * draw_(0, 1) * any_direction(draw_);
    }

private:
    BothLaws& both_;
    const Mesh* mesh_; /* null: another surface */
    PlaceDraw places_;
    Random draw_;
};

// Climbs to worse places: `moved` gives the worst near the best one so far, within a reach, m.
template <typename Best, typename Moved> Best climbed(double scale, Best best, const Moved& moved) {
    double reach = 0.5 * scale;
    for (std::size_t step = 0; step < kClimbSteps; ++step) {
        const std::optional<Best> next = moved(best, reach);
        if (next && next->error() > best.error()) {
            best = *next;
            reach *= 1.5;
        } else {
            reach = std::max(reach * 0.93, 5e-8 * scale);
        }
    }
    return best;
}

// The same facet in both precisions.
struct SeenPlace {
    WorstRounding worst;
    double error() const { return worst.error; }
};
// On either side of a tie, the worse one.
struct SeenTie {
    Tie tie;
    WorstRounding worst;
    double error() const { return worst.error; }
};

std::optional<SeenPlace> looked_at(BothLaws& both, const glm::dvec3& place) {
    const auto found = both(place);
    return found && found->same_facet ? std::optional(SeenPlace{*found}) : std::nullopt;
}

std::optional<SeenTie> looked_at(BothLaws& both, const std::optional<Tie>& tie) {
    std::optional<SeenTie> worse;
    if (tie)
        for (const glm::dvec3& side : {tie->here, tie->there})
            if (const auto found = both(side);
                found && !found->same_facet && !(worse && worse->error() >= found->error))
                worse = SeenTie{*tie, *found};
    return worse;
}

// The worst that climbs reach which begin at the worst of each of some groups.
template <typename Seen, typename Moved>
void add_worst(std::vector<WorstRounding>& found, const std::vector<Seen>& seen, std::size_t climbs, double scale,
               const Moved& moved) {
    std::optional<Seen> worst;
    for (std::size_t climb = 0; climb < climbs; ++climb) {
        const auto group = std::span(seen)
                               .subspan(climb * seen.size() / climbs)
                               .first((climb + 1) * seen.size() / climbs - climb * seen.size() / climbs);
        if (group.empty())
            continue;
        const Seen top = climbed(scale, *std::ranges::max_element(group, {}, &Seen::error), moved);
        if (!worst || top.error() > worst->error())
            worst = top;
    }
    if (worst)
        found.push_back(worst->worst);
}

} // namespace

std::vector<WorstRounding> worst_rounding(const PreparedCase& prepared, std::size_t places) {
    BothLaws both(prepared);
    Aim aim(both, prepared);
    const double scale = both.shape().scale.deepest;
    std::vector<SeenPlace> smooth;
    std::vector<SeenTie> ties;
    for (std::size_t i = 0; i < places; ++i)
        if (const auto at = aim.below_the_surface())
            if (const auto one = looked_at(both, *at))
                smooth.push_back(*one);
    for (std::size_t i = 0; i < places / 10; ++i)
        if (const auto one = looked_at(both, aim.tie()))
            ties.push_back(*one);
    const std::size_t climbs = std::clamp<std::size_t>(places / 300, 4, 64);
    std::vector<WorstRounding> found;
    add_worst(found, smooth, climbs, scale,
              [&](const SeenPlace& best, double reach) { return looked_at(both, aim.near(best.worst.place, reach)); });
    add_worst(found, ties, climbs, scale, [&](const SeenTie& best, double reach) {
        const glm::dvec3 across = 4 * reach / reference::length(best.tie.way) * best.tie.way;
        return looked_at(both, both.tie_on(aim.near(best.tie.here, reach) - 0.5 * across, across));
    });
    for (WorstRounding& one : found)
        one.evaluations = both.evaluations();
    return found;
}

} // namespace forceshade

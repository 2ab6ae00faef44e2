#include "host/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/field/case_law.h"
#include "host/mesh/mesh.h"
#include "host/mesh/structure.h"
#include "host/touch/force_errors.h"
#include "host/touch/places.h"

namespace forceshade {
namespace {

constexpr std::size_t kClimbSteps = 300;

// A place; with a history, the end of a straight stroke from another one in the open.
struct Probed {
    glm::dvec3 at{0}, from{0}; /* m */

    Probed moved(const glm::dvec3& end, const glm::dvec3& begin) const { return {at + end, from + begin}; }
};

// Where two facets are equally near, or strokes fork: neighbours in double, one on either side, on a way across.
struct Tie {
    Probed here, there;
    glm::dvec3 way; /* m */
    std::pair<layout::uint, layout::uint> facets;
};

// Both precisions at a place, or at the end of a stroke.
class BothLaws {
public:
    BothLaws(const PreparedCase& prepared, bool strokes)
        : strokes_(strokes), single_(prepared), twice_(prepared), shape_(scene_shape(prepared)) {
        shape_.force = [this](const TouchPlace& place) {
            return glm::dvec3(twice_.law().at(place.at, twice_hint_).force);
        };
        stiffness_ = prepared.one.scene.force.stiffness;
    }
    BothLaws(const BothLaws&) = delete;
    BothLaws& operator=(const BothLaws&) = delete;

    const TouchedShape& shape() const { return shape_; }
    bool strokes() const { return strokes_; }

    /// The first on a way from a place, in double.
    std::optional<Tie> tie_on(const Probed& from, const glm::dvec3& way) {
        constexpr int kSteps = 16, kHalvings = 64;
        const layout::uint facet = facet_at(from);
        for (int i = 0; i < kSteps && facet != layout::kNoFacet; ++i) {
            const glm::dvec3 begin = double(i) / kSteps * way, end = double(i + 1) / kSteps * way;
            Probed here = from.moved(begin, begin), there = from.moved(end, end);
            const layout::uint next = facet_at(there);
            if (next == layout::kNoFacet)
                break;
            if (next == facet)
                continue;
            for (int halving = 0; halving < kHalvings; ++halving) {
                const Probed middle{0.5 * (here.at + there.at), 0.5 * (here.from + there.from)};
                if (middle.at == here.at || middle.at == there.at)
                    break;
                (facet_at(middle) == facet ? here : there) = middle;
            }
            return Tie{here, there, way, std::minmax(facet, next)};
        }
        return std::nullopt;
    }

    /// Empty if the place is outside of the depths of a hand, in either precision, or its error is no more than
    /// `least`.
    std::optional<WorstRounding> operator()(const Probed& probed, double least) {
        ++evaluations_;
        const auto one = contact(single_, probed, single_hint_);
        const auto two = contact(twice_, probed, twice_hint_);
        const glm::dvec3 force(one.force), truth(two.force);
        const double size = reference::length(truth), off = reference::length(force - truth);
        const TouchScale& scale = shape_.scale;
        if (!(two.depth >= scale.shallowest() && two.depth <= scale.deepest && one.depth <= scale.deepest) ||
            one.facet == layout::kNoFacet || !(size > 0))
            return std::nullopt;
        WorstRounding found;
        found.error = std::isnan(off) ? INFINITY : off / (stiffness_ * scale.deepest);
        if (!(found.error > least))
            return std::nullopt;
        found.same_facet = !jumps_near(probed, truth, 0.5 * off, found.gradient) && one.facet == two.facet;
        found.local = off / size;
        found.depth = two.depth;
        found.place = probed.at;
        if (strokes_)
            found.from = probed.from;
        if (reference::length(force) > 0)
            found.turn = angle_between(force, truth) / kDegree;
        return found;
    }
    std::size_t evaluations() const { return evaluations_; }

private:
    static constexpr int kSamples = 6; // of a stroke

    template <typename T>
    reference::Contact<T> contact(CaseProbe<T>& probe, const Probed& probed, layout::uint& hint) const {
        if (!strokes_)
            return probe.law().at(probed.at, hint);
        probe.begin_path();
        reference::Contact<T> last{};
        for (int i = 0; i <= kSamples; ++i) {
            last = probe.at(probed.from + double(i) / kSamples * (probed.at - probed.from)).contact;
            if (i == 0 && last.facet != layout::kNoFacet) { // not from the open
                last.facet = layout::kNoFacet;
                break;
            }
        }
        return last;
    }
    layout::uint facet_at(const Probed& probed) { return contact(twice_, probed, twice_hint_).facet; }

    // Whether the law itself, in double, differs as much between places that rounding to single precision may choose:
    // its direction has an edge there, on any facet; or strokes fork.
    bool jumps_near(const Probed& probed, const glm::dvec3& force, double much, double& gradient) {
        const double size =
            std::max(reference::largest_coordinate(shape_.low), reference::largest_coordinate(shape_.high));
        bool jumps = false;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const double step = 0x1p-22 * std::max(std::fabs(probed.at[axis]), size);
                glm::dvec3 by(0);
                by[axis] = side * step;
                const double change =
                    reference::length(glm::dvec3(contact(twice_, probed.moved(by, by), twice_hint_).force) - force);
                gradient = std::max(gradient, change / (stiffness_ * step));
                const double slope = 16 * stiffness_ * step; // a law without edges changes less
                jumps = jumps || change > std::max(much, slope);
            }
        return jumps;
    }

    bool strokes_;
    CaseProbe<float> single_;
    CaseProbe<double> twice_;
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

// A convex edge, or one between triangles in a plane; the way from it along which both stay equally near.
struct Ridge {
    glm::dvec3 begin, end; /* m */
    glm::dvec3 inwards;    /* 1: to a depth of 1 below both */
};

std::vector<Ridge> ridges_of(const MeshStructure& mesh) {
    const MeshParts& parts = *mesh.parts;
    const auto corner = [&](std::size_t triangle, std::size_t i) {
        return mesh.centre + mesh.scale * reference::vector_at(std::span<const double>(mesh.reals->vertices),
                                                               parts.triangle_corners[3 * triangle + i % 3]);
    };
    const auto normal = [&](std::size_t triangle) {
        return reference::vector_at(std::span<const double>(mesh.reals->triangle_normals), triangle);
    };
    std::vector<Ridge> ridges;
    for (std::size_t triangle = 0; triangle < mesh.triangles(); ++triangle)
        for (std::size_t i = 0; i < 3; ++i) {
            const layout::uint across = parts.triangle_neighbours[3 * triangle + i];
            if ((across & layout::kMeshManyBit) || across < triangle) // no one triangle; seen from there
                continue;
            const glm::dvec3 begin = corner(triangle, i), one = normal(triangle), other = normal(across);
            double height = 0; // of the corner that is not on the edge
            for (std::size_t k = 0; k < 3; ++k)
                height += reference::dot(one, corner(across, k) - begin);
            const glm::dvec3 end = corner(triangle, i + 1);
            const double size = reference::length(end - begin);
            if (size > 0 && height < 1e-9 * size && reference::dot(one, other) > -0.99)
                ridges.push_back({begin, end, (one + other) / -(1 + reference::dot(one, other))});
        }
    return ridges;
}

// Draws one of some things: half of the time each as often, half by weight, so that neither small ones nor the large
// ones among many small are missed.
class WeightedDraw {
public:
    template <typename Things, typename Weight> WeightedDraw(const Things& things, const Weight& weight) {
        for (const auto& thing : things)
            sums_.push_back((sums_.empty() ? 0 : sums_.back()) + weight(thing));
    }
    bool empty() const { return sums_.empty(); }
    std::size_t operator()(Random& draw) const {
        if (draw(0, 1) < 0.5)
            return draw.below(sums_.size());
        const auto found = std::ranges::upper_bound(sums_, draw(0, sums_.back()));
        return std::min(static_cast<std::size_t>(found - sums_.begin()), sums_.size() - 1);
    }

private:
    std::vector<double> sums_;
};

double area_of(const Mesh& mesh, const std::array<layout::uint, 3>& corners) {
    const auto at = [&](std::size_t i) { return mesh.polygons.vertices[corners[i]]; };
    return reference::length(reference::cross(at(1) - at(0), at(2) - at(0)));
}

// Aims at places of a case.
class Aim {
public:
    Aim(BothLaws& both, const PreparedCase& prepared)
        : both_(both), mesh_(prepared.images.mesh ? &prepared.images.mesh->mesh : nullptr),
          ridges_(mesh_ ? ridges_of(prepared.images.mesh->structure) : std::vector<Ridge>{}),
          ridge_(ridges_, [](const Ridge& one) { return reference::length(one.end - one.begin); }),
          triangle_(mesh_ ? mesh_->triangles.corners : decltype(mesh_->triangles.corners){},
                    [&](const auto& corners) { return area_of(*mesh_, corners); }),
          places_(both.shape(), prepared, 12), draw_(11), normal_draw_(13) {}

    /// Below a facet, an edge or a corner of a mesh, or anywhere below another surface; moved by up to a twentieth of
    /// the depth of a hand.
    std::optional<Probed> below_the_surface() {
        const TouchScale& scale = both_.shape().scale;
        const glm::dvec3 aside = log_uniform(draw_, 5e-7, 0.05) * scale.deepest * any_direction(draw_);
        if (!mesh_) {
            const auto place = places_();
            return place ? std::optional(Probed{place->at + aside, {}}) : std::nullopt;
        }
        const auto [at, normal] = on_the_mesh(draw_);
        Probed found{at - log_uniform(draw_, scale.shallowest(), scale.deepest) * normal + aside, {}};
        if (both_.strokes())
            found.from = at + draw_(0.01, 1) * scale.deepest * (normal + 0.7 * any_direction(draw_));
        return found;
    }

    /// Where a normal of a mesh, inwards, meets its medial axis.
    std::optional<Tie> tie_on_a_normal() {
        if (!mesh_ || both_.strokes())
            return std::nullopt;
        const auto [at, normal] = on_the_mesh(normal_draw_);
        const TouchScale& scale = both_.shape().scale;
        return both_.tie_on({at - scale.shallowest() * normal, {}}, -scale.deepest * normal);
    }

    /// On the plane between the facets at a ridge, or on a way from a place below the surface.
    std::optional<Tie> tie() {
        if (!ridge_.empty() && draw_(0, 1) < 0.5)
            return below_a_ridge();
        const std::optional<Probed> from = below_the_surface();
        return from ? both_.tie_on(*from,
                                   log_uniform(draw_, 0.01, 4) * both_.shape().scale.deepest * any_direction(draw_))
                    : std::nullopt;
    }

    Probed near(const Probed& place, double reach) {
        const auto aside = [&] { return reach * draw_(0, 1) * any_direction(draw_); };
        const glm::dvec3 end = aside();
        return place.moved(end, both_.strokes() ? aside() : glm::dvec3(0));
    }

    /// Near a tie: half of the time along it, where both facets of a mesh stay as near as they are.
    Probed near_tie(const Tie& tie, double reach) {
        if (!mesh_ || both_.strokes() || draw_(0, 1) < 0.5)
            return near(tie.here, reach);
        const glm::dvec3 &one = mesh_->facet_normals[tie.facets.first],
                         &other = mesh_->facet_normals[tie.facets.second];
        constexpr double kInAPlane = 1e-6;
        const glm::dvec3 ridge = reference::cross(one, other),
                         along =
                             reference::length(ridge) > kInAPlane ? ridge : reference::cross(one, any_direction(draw_));
        const glm::dvec3 aside = reach * draw_(-1, 1) / reference::length(along) * along;
        return tie.here.moved(aside, aside);
    }

private:
    struct OnMesh {
        glm::dvec3 at, normal; /* m, 1 */
    };
    OnMesh on_the_mesh(Random& draw) const {
        const std::size_t triangle = triangle_(draw);
        double weights[3] = {draw(0, 1), draw(0, 1), draw(0, 1)};
        const double kind = draw(0, 3); // within, on an edge, at a corner
        weights[0] = kind > 1 ? 0 : weights[0];
        weights[1] = kind > 2 ? 0 : weights[1];
        glm::dvec3 at(0);
        for (std::size_t i = 0; i < 3; ++i)
            at += weights[i] / (weights[0] + weights[1] + weights[2]) *
                  mesh_->polygons.vertices[mesh_->triangles.corners[triangle][i]];
        return {at, mesh_->triangles.normals[triangle]};
    }

    std::optional<Tie> below_a_ridge() {
        const Ridge& ridge = ridges_[ridge_(draw_)];
        const TouchScale& scale = both_.shape().scale;
        const double deepest = 0.9999 * scale.deepest;
        const double depth = draw_(0, 1) < 0.5 ? deepest : log_uniform(draw_, scale.shallowest(), deepest);
        const glm::dvec3 on = ridge.begin + draw_(0, 1) * (ridge.end - ridge.begin);
        const glm::dvec3 across = reference::cross(ridge.end - ridge.begin, ridge.inwards);
        const glm::dvec3 way = 0.01 * depth / reference::length(across) * across;
        Probed at{on + depth * ridge.inwards - 0.5 * way, {}};
        if (both_.strokes())
            at.from = on + draw_(0.01, 1) * scale.deepest * (0.7 * any_direction(draw_) - ridge.inwards);
        return both_.tie_on(at, way);
    }

    BothLaws& both_;
    const Mesh* mesh_; /* null: another surface */
    std::vector<Ridge> ridges_;
    WeightedDraw ridge_, triangle_;
    PlaceDraw places_;
    Random draw_, normal_draw_;
};

// What was found at a place; at a tie, on the worse of its sides.
struct Seen : WorstRounding {
    Tie tie{};
};

// Where both precisions meet the same facet, if its error is more than `least`.
std::optional<Seen> seen_at(BothLaws& both, const Probed& place, double least) {
    const auto found = both(place, least);
    return found && found->same_facet ? std::optional(Seen{*found}) : std::nullopt;
}

// Where they do not.
std::optional<Seen> seen_at(BothLaws& both, const std::optional<Tie>& tie, double least) {
    std::optional<Seen> worse;
    if (tie)
        for (const Probed& side : {tie->here, tie->there})
            if (const auto found = both(side, worse ? worse->error : least); found && !found->same_facet)
                worse = Seen{*found, *tie};
    return worse;
}

// Climbs to worse places: `moved` gives one near the best one so far, within a reach, m, if it is worse.
template <typename Moved> Seen climbed(double scale, Seen best, const Moved& moved) {
    double reach = 0.5 * scale;
    for (std::size_t step = 0; step < kClimbSteps; ++step) {
        const std::optional<Seen> next = moved(best, reach);
        if (next) {
            best = *next;
            reach *= 1.5;
        } else {
            reach = std::max(reach * 0.93, 5e-8 * scale);
        }
    }
    return best;
}

// The worst of each of some groups, by the group's key.
template <typename Key> struct WorstOfGroups : std::map<Key, Seen> {
    // `seen(least)` gives one whose error is more than that.
    template <typename Look> void keep(const Key& key, const Look& seen) {
        const auto at = this->find(key);
        if (const std::optional<Seen> worse = seen(at == this->end() ? -1 : at->second.error))
            this->insert_or_assign(key, *worse);
    }

    // Adds the worst that climbs reach from them, from those with the worst first.
    template <typename Moved>
    void add_climbed(std::vector<WorstRounding>& found, std::size_t climbs, double scale, const Moved& moved) const {
        std::vector<Seen> tops;
        for (const auto& [key, seen] : *this)
            tops.push_back(seen);
        std::ranges::sort(tops, std::greater<>(), &Seen::error);
        tops.resize(std::min(tops.size(), climbs));
        for (Seen& top : tops)
            top = climbed(scale, top, moved);
        if (const auto worst = std::ranges::max_element(tops, {}, &Seen::error); worst != tops.end())
            found.push_back(*worst);
    }
};

} // namespace

std::vector<WorstRounding> worst_rounding(const PreparedCase& prepared, std::size_t places, bool strokes) {
    BothLaws both(prepared, strokes);
    Aim aim(both, prepared);
    const double scale = both.shape().scale.deepest;
    const std::size_t climbs = std::clamp<std::size_t>(places / 1000, 4, 64);
    WorstOfGroups<std::size_t> smooth;                         // parts of the draw
    WorstOfGroups<std::pair<layout::uint, layout::uint>> ties; // each two facets
    for (std::size_t i = 0; i < places; ++i)
        if (const auto at = aim.below_the_surface())
            smooth.keep(i * climbs / places, [&](double least) { return seen_at(both, *at, least); });
    for (std::size_t i = 0; i < places / 10; ++i)
        for (const auto& tie : {aim.tie(), aim.tie_on_a_normal()})
            if (tie)
                ties.keep(tie->facets, [&](double least) { return seen_at(both, tie, least); });
    std::vector<WorstRounding> found;
    smooth.add_climbed(found, climbs, scale, [&](const Seen& best, double reach) {
        return seen_at(both, aim.near({best.place, best.from.value_or(glm::dvec3(0))}, reach), best.error);
    });
    ties.add_climbed(found, climbs, scale, [&](const Seen& best, double reach) {
        const glm::dvec3 across = 4 * reach / reference::length(best.tie.way) * best.tie.way;
        return seen_at(both, both.tie_on(aim.near_tie(best.tie, reach).moved(-0.5 * across, -0.5 * across), across),
                       best.error);
    });
    for (WorstRounding& one : found)
        one.evaluations = both.evaluations();
    return found;
}

} // namespace forceshade

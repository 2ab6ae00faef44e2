// Places that a hand touches: under points anywhere on the surface, at depths that are log-uniform.
#include "host/study/error_time/places.h"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>

#include "host/study/error_time/angle.h"
#include "host/study/error_time/law_at.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTriesAPlace = 32;                      // draws for each place that is kept
constexpr std::size_t kTriesOfKinds = 100, kTriesOfRare = 10; // draws for each place of a kind
constexpr int kHalvings = 60;
constexpr double kSmoothTurn = 5 * kDegree;  // across a ring; more is an edge of the smooth shape
constexpr double kFacetTurn = 0.5 * kDegree; // across a ring; less is not an edge of facets
constexpr double kFlatTurn = 0.01 * kDegree; // across a ring; more is curved
constexpr std::size_t kRing = 8;             // places of a ring

bool touches(const glm::dvec3& force) {
    return force != glm::dvec3(0);
}

// The true shape's surface point between a place inside and one outside, with its normal; `up` without one.
std::optional<Place> surface_between(const Subject& subject, glm::dvec3 inside, glm::dvec3 outside, glm::dvec3 up) {
    if (!touches(subject.truth({inside})) || touches(subject.truth({outside})))
        return std::nullopt;
    for (int i = 0; i < kHalvings; ++i) {
        const glm::dvec3 middle = 0.5 * (inside + outside);
        (touches(subject.truth({middle})) ? inside : outside) = middle;
    }
    const glm::dvec3 force = subject.truth({inside - 1e-3 * subject.scale.shallowest() * up});
    return Place{inside, touches(force) ? force / reference::length(force) : up, 0};
}

std::optional<Place> on_graph(const Subject& subject, double x, double y) {
    return surface_between(subject, {x, y, subject.low.z}, {x, y, subject.high.z}, {0, 0, 1});
}

std::array<glm::dvec3, 3> corners_of(const Mesh& mesh, std::size_t triangle) {
    const auto& at = mesh.triangles.corners[triangle];
    return {mesh.polygons.vertices[at[0]], mesh.polygons.vertices[at[1]], mesh.polygons.vertices[at[2]]};
}

std::optional<Place> on_triangle(const Subject& subject, const Mesh& mesh, std::size_t i, double u, double v) {
    const auto [a, b, c] = corners_of(mesh, i);
    const glm::dvec3 at = a + u * (b - a) + v * (c - a), normal = mesh.triangles.normals[i],
                     reach = subject.scale.deepest * normal;
    return subject.against == kSmoothShape ? surface_between(subject, at - reach, at + reach, normal)
                                           : Place{at, normal, 0};
}

// Draws places of a subject: of a mesh uniform over the triangles' area, moved onto the smooth shape where that is
// known; else above or below (x, y) drawn in the box.
class PlaceDraw {
public:
    PlaceDraw(const Subject& subject, const PreparedCase& prepared, std::uint64_t seed)
        : subject_(subject), mesh_(prepared.images.mesh ? &prepared.images.mesh->mesh : nullptr), draw_(seed) {
        for (std::size_t i = 0; mesh_ && i < mesh_->triangles.corners.size(); ++i) {
            const auto [a, b, c] = corners_of(*mesh_, i);
            const double area = reference::length(reference::cross(b - a, c - a));
            areas_.push_back((areas_.empty() ? 0 : areas_.back()) + area);
        }
    }
    /// Empty without a surface, or if the place would be outside of the box or not in contact.
    std::optional<Place> operator()() {
        std::optional<Place> place = mesh_ ? drawn_on_mesh() : drawn_on_graph();
        const TouchScale& scale = subject_.scale;
        const double depth = scale.shallowest() * std::pow(scale.deepest / scale.shallowest(), draw_(0, 1));
        if (!place)
            return place;
        place->depth = depth;
        place->at -= depth * place->normal;
        return is_in_box(place->at) && touches(subject_.truth(*place)) ? place : std::nullopt;
    }

private:
    std::optional<Place> drawn_on_graph() {
        const double x = draw_(subject_.low.x, subject_.high.x), y = draw_(subject_.low.y, subject_.high.y);
        return on_graph(subject_, x, y);
    }
    std::optional<Place> drawn_on_mesh() {
        const double share = draw_(0, areas_.back());
        const auto i = static_cast<std::size_t>(std::ranges::upper_bound(areas_, share) - areas_.begin());
        const double u = draw_(0, 1), v = draw_(0, 1);
        return u + v > 1 ? on_triangle(subject_, *mesh_, i, 1 - u, 1 - v) : on_triangle(subject_, *mesh_, i, u, v);
    }
    bool is_in_box(const glm::dvec3& at) const {
        return glm::all(glm::greaterThanEqual(at, subject_.low)) && glm::all(glm::lessThanEqual(at, subject_.high));
    }

    const Subject& subject_;
    const Mesh* mesh_;
    Draw draw_;
    std::vector<double> areas_; // up to each triangle
};

PreparedCase unshaded(PreparedCase prepared) {
    prepared.one.scene.force.shading = Shading::none;
    prepared.one.scene.texture.reset();
    return prepared;
}

} // namespace

const char* name_of(Kind kind) {
    constexpr const char* kNames[] = {"flat", "facet", "edge", "rim", "boundary"};
    return kNames[static_cast<std::size_t>(kind)];
}

KindOf::KindOf(const Subject& subject, const Variant& variant)
    : subject_(subject), plain_(std::make_unique<PreparedCase>(unshaded(*variant.prepared))),
      facets_(std::make_unique<DirectLaw<double>>(*plain_)) {}

KindOf::~KindOf() = default;

Kind KindOf::operator()(const Place& place) {
    const glm::dvec3 across = std::abs(place.normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    glm::dvec3 u = reference::cross(place.normal, across);
    u /= reference::length(u);
    const glm::dvec3 v = reference::cross(place.normal, u);
    // The largest turn of the force on a ring about the place.
    const auto turn_of = [&](const auto& force_at) {
        const glm::dvec3 middle = force_at(place);
        double largest = 0;
        for (std::size_t i = 0; i < kRing; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kRing;
            Place near = place;
            near.at += subject_.scale.ring() * (std::cos(angle) * u + std::sin(angle) * v);
            if (const glm::dvec3 force = force_at(near); touches(force) && touches(middle))
                largest = std::max(largest, angle_between(middle, force));
        }
        return largest;
    };
    const double smooth_turn = turn_of(subject_.truth);
    const double facet_turn = turn_of([&](const Place& at) { return facets_->force(facets_->input(at)); });
    if (smooth_turn > kSmoothTurn)
        return Kind::rim;
    if (facet_turn > kFacetTurn)
        return Kind::edge;
    if (place.depth < subject_.scale.skin())
        return Kind::boundary;
    return smooth_turn < kFlatTurn && facet_turn < kFlatTurn ? Kind::flat : Kind::facet;
}

std::vector<Place> shared_places(const Subject& subject, const PreparedCase& prepared, std::size_t count) {
    PlaceDraw draw(subject, prepared, 1);
    std::vector<Place> places;
    for (std::size_t tries = 0; places.size() < count && tries < kTriesAPlace * count; ++tries)
        if (const auto place = draw())
            places.push_back(*place);
    return places;
}

std::optional<Place> surface_at(const Subject& subject, const PreparedCase& prepared, double x, double y) {
    if (!prepared.images.mesh)
        return on_graph(subject, x, y);
    const Mesh& mesh = prepared.images.mesh->mesh;
    std::optional<Place> found;
    for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
        const auto [a, b, c] = corners_of(mesh, i);
        const glm::dvec3 p = b - a, q = c - a, at = glm::dvec3(x, y, 0) - a;
        const double area = p.x * q.y - p.y * q.x, u = (at.x * q.y - at.y * q.x) / area,
                     v = (p.x * at.y - p.y * at.x) / area;
        if (u >= 0 && v >= 0 && u + v <= 1)
            if (const auto place = on_triangle(subject, mesh, i, u, v); place && (!found || place->at.z > found->at.z))
                found = place;
    }
    return found;
}

KindPlaces places_of(const Subject& subject, const Variant& variant, const Extents& extents) {
    KindOf kind_of(subject, variant);
    KindPlaces all{{}, {}, subject.places.size()};
    std::array<std::size_t, kKinds.size()> counts{};
    const auto add = [&](const Place& place, Kind kind) {
        all.at.push_back(place);
        all.kinds.push_back(kind);
        ++counts[static_cast<std::size_t>(kind)];
    };
    for (const Place& place : subject.places)
        add(place, kind_of(place));
    PlaceDraw draw(subject, *variant.prepared, 2);
    const std::size_t wanted = extents.places_of_kind;
    for (std::size_t tries = 0; tries < kTriesOfKinds * wanted; ++tries) {
        const bool early = tries < kTriesOfRare * wanted; // a kind not met by then does not exist
        if (std::ranges::all_of(counts, [&](std::size_t count) { return count >= wanted || (count == 0 && !early); }))
            break;
        if (const auto place = draw())
            if (const Kind kind = kind_of(*place); counts[static_cast<std::size_t>(kind)] < wanted)
                add(*place, kind);
    }
    // As far above the surface as the shallow ones are below it: there should be no force.
    for (std::size_t i = 0, end = all.at.size(); i < end; ++i)
        if (all.kinds[i] == Kind::boundary) {
            Place above = all.at[i];
            above.at += 2 * above.depth * above.normal;
            above.depth = -above.depth;
            if (!touches(subject.truth(above)))
                add(above, Kind::boundary);
        }
    return all;
}

} // namespace forceshade::study::error_time

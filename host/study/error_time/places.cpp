// Places that a hand touches: under points anywhere on the surface, at depths that are log-uniform.
#include <algorithm>
#include <cmath>

#include "host/study/error_time/law_at.h"
#include "host/study/error_time/places.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTriesAPlace = 32;                      // draws for each place that is kept
constexpr std::size_t kTriesOfKinds = 100, kTriesOfRare = 10; // likewise for each place of a kind
constexpr int kHalvings = 60;
constexpr double kSmoothTurn = 5 * kDegree;  // across a ring; more is an edge of the smooth shape
constexpr double kFeltTurn = 0.5 * kDegree;  // likewise; less is no edge of facets
constexpr double kFlatTurn = 0.01 * kDegree; // likewise; more is curved
constexpr std::size_t kRing = 8;             // places of a ring

bool touches(const glm::dvec3& force) {
    return force != glm::dvec3(0);
}

// Where contact begins between a place inside and one outside.
glm::dvec3 surface_between(const Truth& truth, glm::dvec3 inside, glm::dvec3 outside) {
    for (int i = 0; i < kHalvings; ++i) {
        const glm::dvec3 middle = 0.5 * (inside + outside);
        (touches(truth({middle})) ? inside : outside) = middle;
    }
    return inside;
}

// Its normal is the smooth shape's.
std::optional<Place> on_graph(const Subject& subject, double x, double y) {
    const glm::dvec3 inside(x, y, subject.low.z), outside(x, y, subject.high.z);
    if (!touches(subject.truth({inside})) || touches(subject.truth({outside})))
        return std::nullopt;
    const glm::dvec3 at = surface_between(subject.truth, inside, outside);
    const glm::dvec3 force = subject.truth({at - glm::dvec3(0, 0, 1e-3 * subject.scale.shallowest())});
    return touches(force) ? std::optional(Place{at, force / reference::length(force), 0}) : std::nullopt;
}

// Uniform over the triangles' area; moved onto the smooth shape where that is known.
class MeshDraw {
public:
    explicit MeshDraw(const Mesh& mesh) : mesh_(mesh) {
        for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
            const auto [a, b, c] = corners(i);
            const double area = reference::length(reference::cross(b - a, c - a));
            areas_.push_back((areas_.empty() ? 0 : areas_.back()) + area);
        }
    }
    std::optional<Place> draw(const Subject& subject, Draw& draw) const {
        const double share = draw(0, areas_.back());
        const auto i = static_cast<std::size_t>(std::ranges::upper_bound(areas_, share) - areas_.begin());
        double u = draw(0, 1), v = draw(0, 1);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        return on_triangle(subject, i, u, v);
    }
    std::optional<Place> highest(const Subject& subject, double x, double y) const {
        std::optional<Place> found;
        for (std::size_t i = 0; i < mesh_.triangles.corners.size(); ++i) {
            const auto [a, b, c] = corners(i);
            const glm::dvec3 p = b - a, q = c - a, at = glm::dvec3(x, y, 0) - a;
            const double area = p.x * q.y - p.y * q.x, u = (at.x * q.y - at.y * q.x) / area,
                         v = (p.x * at.y - p.y * at.x) / area;
            if (u >= 0 && v >= 0 && u + v <= 1)
                if (const auto place = on_triangle(subject, i, u, v); place && (!found || place->at.z > found->at.z))
                    found = place;
        }
        return found;
    }

private:
    std::optional<Place> on_triangle(const Subject& subject, std::size_t i, double u, double v) const {
        const auto [a, b, c] = corners(i);
        const glm::dvec3 normal = mesh_.triangles.normals[i];
        Place place{a + u * (b - a) + v * (c - a), normal, 0};
        if (subject.against == kSmoothShape) {
            const double reach = subject.scale.deepest;
            const glm::dvec3 inside = place.at - reach * normal, outside = place.at + reach * normal;
            if (!touches(subject.truth({inside})) || touches(subject.truth({outside})))
                return std::nullopt;
            place.at = surface_between(subject.truth, inside, outside);
            const glm::dvec3 force = subject.truth({place.at - 1e-3 * subject.scale.shallowest() * normal});
            place.normal = touches(force) ? force / reference::length(force) : normal;
        }
        return place;
    }

    std::array<glm::dvec3, 3> corners(std::size_t triangle) const {
        const auto& at = mesh_.triangles.corners[triangle];
        return {mesh_.polygons.vertices[at[0]], mesh_.polygons.vertices[at[1]], mesh_.polygons.vertices[at[2]]};
    }

    const Mesh& mesh_;
    std::vector<double> areas_;
};

bool is_in_box(const Subject& subject, const glm::dvec3& at) {
    for (int i = 0; i < 3; ++i)
        if (!(at[i] >= subject.low[i] && at[i] <= subject.high[i]))
            return false;
    return true;
}

// Draws places of a subject.
class PlaceDraw {
public:
    PlaceDraw(const Subject& subject, const PreparedCase& prepared, std::uint64_t seed)
        : subject_(subject), draw_(seed) {
        if (prepared.images.mesh)
            mesh_.emplace(prepared.images.mesh->mesh);
    }
    /// Nothing where no surface is, or the place would be outside of the box or not in contact.
    std::optional<Place> operator()() {
        std::optional<Place> place = mesh_ ? mesh_->draw(subject_, draw_) : on_graph();
        const TouchScale& scale = subject_.scale;
        const double depth = scale.shallowest() * std::pow(scale.deepest / scale.shallowest(), draw_(0, 1));
        if (!place)
            return place;
        place->depth = depth;
        place->at -= depth * place->normal;
        return is_in_box(subject_, place->at) && touches(subject_.truth(*place)) ? place : std::nullopt;
    }

private:
    std::optional<Place> on_graph() {
        const double x = draw_(subject_.low.x, subject_.high.x), y = draw_(subject_.low.y, subject_.high.y);
        return error_time::on_graph(subject_, x, y);
    }

    const Subject& subject_;
    Draw draw_;
    std::optional<MeshDraw> mesh_;
};

double largest_turn(const glm::dvec3& middle, const std::vector<glm::dvec3>& ring) {
    double largest = 0;
    for (const glm::dvec3& force : ring)
        if (touches(force) && touches(middle))
            largest = std::max(largest, angle_between(middle, force));
    return largest;
}

Variant unshaded(const Variant& variant) {
    auto prepared = std::make_shared<PreparedCase>(*variant.prepared);
    prepared->one.scene.force.shading = Shading::none;
    prepared->one.scene.texture.reset();
    Variant plain = variant;
    plain.prepared = std::move(prepared);
    return plain;
}

} // namespace

const char* name_of(Kind kind) {
    constexpr const char* kNames[] = {"flat", "facet", "edge", "rim", "boundary"};
    return kNames[static_cast<std::size_t>(kind)];
}

KindOf::KindOf(const Subject& subject, const Variant& variant)
    : subject_(subject), plain_(unshaded(variant)), facets_(std::make_unique<DirectLaw<double>>(*plain_.prepared)) {}

KindOf::~KindOf() = default;

Kind KindOf::operator()(const Place& place) {
    const glm::dvec3 across = std::abs(place.normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    glm::dvec3 u = reference::cross(place.normal, across);
    u /= reference::length(u);
    const glm::dvec3 v = reference::cross(place.normal, u);
    const auto facet_force = [&](const glm::dvec3& at) {
        return facets_->at(rounded_places<double>(*plain_.prepared, std::span(&at, 1))[0]).force;
    };
    std::vector<glm::dvec3> smooth, flat;
    for (std::size_t i = 0; i < kRing; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kRing;
        Place near = place;
        near.at += subject_.scale.ring() * (std::cos(angle) * u + std::sin(angle) * v);
        smooth.push_back(subject_.truth(near));
        flat.push_back(facet_force(near.at));
    }
    const double smooth_turn = largest_turn(subject_.truth(place), smooth);
    const double facet_turn = largest_turn(facet_force(place.at), flat);
    if (smooth_turn > kSmoothTurn)
        return Kind::rim;
    if (facet_turn > kFeltTurn)
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
    return prepared.images.mesh ? MeshDraw(prepared.images.mesh->mesh).highest(subject, x, y) : on_graph(subject, x, y);
}

KindPlaces places_of(const Subject& subject, const Variant& variant, const Extents& extents) {
    KindOf kind_of(subject, variant);
    KindPlaces all{subject.places, {}, subject.places.size()};
    std::array<std::size_t, kKinds.size()> counts{};
    const auto add_kind = [&](Kind kind) {
        all.kinds.push_back(kind);
        ++counts[static_cast<std::size_t>(kind)];
    };
    for (const Place& place : subject.places)
        add_kind(kind_of(place));
    PlaceDraw draw(subject, *variant.prepared, 2);
    const std::size_t wanted = extents.places_of_kind;
    for (std::size_t tries = 0; tries < kTriesOfKinds * wanted; ++tries) {
        const bool early = tries < kTriesOfRare * wanted; // a kind that was not met by then is not there
        if (std::ranges::all_of(counts, [&](std::size_t count) { return count >= wanted || (count == 0 && !early); }))
            break;
        const auto place = draw();
        const Kind kind = place ? kind_of(*place) : Kind::flat;
        if (!place || counts[static_cast<std::size_t>(kind)] >= wanted)
            continue;
        all.at.push_back(*place);
        add_kind(kind);
    }
    // As far above the surface as the shallow ones are below it: there should be no force.
    for (std::size_t i = 0, end = all.at.size(); i < end; ++i)
        if (all.kinds[i] == Kind::boundary) {
            Place above = all.at[i];
            above.at += 2 * above.depth * above.normal;
            above.depth = -above.depth;
            if (subject.truth(above) != glm::dvec3(0))
                continue;
            all.at.push_back(above);
            all.kinds.push_back(Kind::boundary);
        }
    return all;
}

} // namespace forceshade::study::error_time

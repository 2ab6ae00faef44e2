// The surface of a scene, as loops rest on it, and places at which a hand may rest: anywhere on it, and on its edges.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/vector_relational.hpp>

#include "host/error.h"
#include "host/limits/rest_places.h"
#include "host/mesh/mesh.h"
#include "host/touch/force_errors.h"
#include "host/touch/places.h"

namespace forceshade {
namespace {

constexpr double kSharp = 5 * kDegree;    // a jump of the direction; less is smooth
constexpr double kLevel = 1 * kDegree;    // off upright: flat, if it does not turn
constexpr double kUpright = 10 * kDegree; // crest or hollow
constexpr double kEven = 0.05;            // 1/m: turns less
constexpr double kEdgeDistance = 5e-3;    // depths
constexpr double kSame = 0.05;            // of a slope: by how much halves of a step may differ; more is an edge

bool is_nonzero(const glm::dvec3& force) {
    return reference::length(force) > 0;
}

// Moved along the normal to where the force over the stiffness is `depth`; empty without a force.
std::optional<TouchPlace> pressed(ContactForce& force, TouchPlace place, double depth) {
    constexpr int kSteps = 24; // each leaves half of the way, on slopes up to 70 deg
    for (int i = 0; i < kSteps; ++i) {
        const glm::dvec3 here = force(place);
        if (!is_nonzero(here))
            return std::nullopt;
        const double down = 0.5 * (depth - reference::length(here));
        place.at -= down * place.normal;
        place.depth += down;
    }
    return place;
}

RestPlace rest_at(const TouchPlace& place, const glm::dvec3& force) {
    RestPlace rest;
    rest.at = place.at;
    rest.normal = place.normal;
    rest.below = rest.depth = place.depth;
    rest.force = force;
    return rest;
}

glm::dmat3 slope_with(ContactForce& force, const TouchPlace& place, double step) {
    glm::dmat3 slope(0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 aside(0);
        aside[axis] = step;
        slope[axis] = (force(place, -aside) - force(place, aside)) / (2 * step);
    }
    return slope;
}

PlaceKind smooth_kind(const RestPlace& rest) {
    const double tilt = angle_between(rest.force, glm::dvec3(0, 0, 1)), turn = turn_of(rest);
    if (tilt < kLevel && std::abs(turn) < kEven)
        return PlaceKind::flat;
    if (tilt < kUpright && std::abs(turn) >= kEven)
        return turn > 0 ? PlaceKind::crest : PlaceKind::hollow;
    return PlaceKind::slope;
}

// Empty without a force, or if an edge is within a step.
std::optional<RestPlace> smooth_place(ContactForce& force, const TouchPlace& place) {
    constexpr double kStep = 1e-3; // of the depth
    RestPlace rest = rest_at(place, force(place));
    if (!is_nonzero(rest.force))
        return std::nullopt;
    rest.slope = slope_with(force, place, kStep * place.depth);
    const glm::dmat3 finer = slope_with(force, place, kStep / 2 * place.depth);
    for (int axis = 0; axis < 3; ++axis)
        if (reference::length(finer[axis] - rest.slope[axis]) > kSame)
            return std::nullopt;
    rest.kind = smooth_kind(rest);
    return rest;
}

std::optional<RestPlace> smooth_at(ContactForce& force, const TouchPlace& from, double depth) {
    const auto place = pressed(force, from, depth);
    auto rest = place ? smooth_place(force, *place) : std::nullopt;
    if (rest)
        rest->depth = depth;
    return rest;
}

// Next to an edge, where a slope is often steepest.
void add_next_to(ContactForce& force, TouchPlace edge, const glm::dvec3& along, double depth,
                 std::vector<RestPlace>& places) {
    edge.at += kEdgeDistance * depth * along;
    if (auto smooth = smooth_at(force, edge, depth)) {
        smooth->edge_distance = kEdgeDistance * depth;
        places.push_back(*smooth);
    }
}

bool is_within_box(const LoopSurface& surface, const glm::dvec3& at) {
    return glm::all(glm::greaterThanEqual(at, surface.low)) && glm::all(glm::lessThanEqual(at, surface.high));
}

// At `most` vertices of a mesh within the box, and on four sides of each.
void add_vertices(ContactForce& force, const LoopSurface& surface, std::size_t most, std::vector<RestPlace>& places) {
    const Mesh& mesh = surface.prepared.images.mesh->mesh;
    std::vector<TouchPlace> vertices;
    const double shallow = surface.scale().shallowest();
    for (std::size_t i = 0; i < mesh.vertex_normals.size(); ++i) {
        const glm::dvec3 &normal = mesh.vertex_normals[i], at = mesh.polygons.vertices[i] - shallow * normal;
        if (normal != glm::dvec3(0) && is_within_box(surface, at))
            vertices.push_back({at, normal, shallow});
    }
    const std::size_t some = std::min(most, vertices.size());
    for (std::size_t i = 0; i < some; ++i) {
        const TouchPlace& vertex = vertices[i * vertices.size() / some];
        const auto [u, v] = directions_across(vertex.normal);
        for (const double depth : surface.depths()) {
            const std::size_t first = places.size();
            if (const auto smooth = smooth_at(force, vertex, depth)) // as below one that points inwards
                places.push_back(*smooth);
            for (const glm::dvec3& along : {u, -u, v, -v})
                add_next_to(force, vertex, along, depth, places);
            for (std::size_t one = first; one < places.size(); ++one)
                places[one].by_vertex = true;
        }
    }
}

// The largest jump of the direction on a displacement from `from`, below the surface; empty: none.
std::optional<TouchPlace> jump_between(ContactForce& force, const TouchPlace& from, const glm::dvec3& displacement) {
    constexpr int kSteps = 32, kHalvings = 22;
    double low = 0, high = 0, most = kSharp / 2; // shares of the displacement
    for (int i = 0; i < kSteps; ++i) {
        const double here = double(i) / kSteps, next = double(i + 1) / kSteps;
        const glm::dvec3 one = force(from, here * displacement), two = force(from, next * displacement);
        const double turn = is_nonzero(one) && is_nonzero(two) ? angle_between(one, two) : 0;
        if (turn > most) {
            most = turn;
            low = here;
            high = next;
        }
    }
    if (high == 0)
        return std::nullopt;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        const glm::dvec3 one = force(from, low * displacement), half = force(from, middle * displacement),
                         two = force(from, high * displacement);
        if (!is_nonzero(one) || !is_nonzero(half) || !is_nonzero(two))
            return std::nullopt;
        (angle_between(one, half) > angle_between(half, two) ? high : low) = middle;
    }
    TouchPlace edge = from;
    edge.at += 0.5 * (low + high) * displacement;
    return edge;
}

// m: the force's component away from the jump, above 0 where it turns outwards. Averaged over directions, so that it
// does not depend on the one that found the jump.
double spread_at(ContactForce& force, const TouchPlace& jump, double step) {
    double spread = 0;
    for (const int x : {-1, 0, 1})
        for (const int y : {-1, 0, 1})
            for (const int z : {-1, 0, 1})
                if (x != 0 || y != 0 || z != 0) {
                    const glm::dvec3 direction = glm::dvec3(x, y, z) / std::sqrt(double(x * x + y * y + z * z));
                    spread += reference::dot(force(jump, step * direction), direction);
                }
    return spread;
}

// The place on the edge at `edge`, the hand balancing the mean of the forces on both sides.
std::optional<RestPlace> edge_place(ContactForce& force, const TouchPlace& edge, const glm::dvec3& along,
                                    double depth) {
    constexpr double kStep = 1e-4; // of the depth
    const double step = kStep * depth;
    const glm::dvec3 aside = step * along;
    const glm::dvec3 before = force(edge, -aside), after = force(edge, aside);
    if (!is_nonzero(before) || !is_nonzero(after))
        return std::nullopt;
    RestPlace rest = rest_at(edge, 0.5 * (before + after));
    rest.depth = depth;
    rest.jump = angle_between(before, after);
    if (rest.jump < kSharp)
        return std::nullopt;
    rest.kind = spread_at(force, edge, step) > 0 ? PlaceKind::edge : PlaceKind::foot;
    rest.edge_distance = 0;
    return rest;
}

} // namespace

double turn_of(const RestPlace& rest) {
    const auto [u, v] = directions_across(rest.force / reference::length(rest.force));
    const glm::dvec3 of_u = rest.slope * u, of_v = rest.slope * v;
    const double uu = reference::dot(u, of_u), vv = reference::dot(v, of_v);
    const double uv = (reference::dot(u, of_v) + reference::dot(v, of_u)) / 2;
    const double middle = -(uu + vv) / 2, half = std::hypot((uu - vv) / 2, uv); // the eigenvalues of its symmetric part
    return (middle > 0 ? middle + half : middle - half) / reference::length(rest.force);
}

std::optional<RestPlace> NearbyPlaces::aside(const RestPlace& from, const glm::dvec3& aside) {
    const auto place = smooth_at(force_, {from.at + aside, from.normal, from.below}, from.depth);
    if (!place)
        return std::nullopt;
    // Approached along the normal there: the surface's own, or the one that shading gives.
    const glm::dvec3 normal = place->force / reference::length(place->force);
    auto there = smooth_at(force_, {place->at, normal, place->depth}, from.depth);
    return there && is_within_box(surface_, there->at) ? there : std::nullopt;
}

std::optional<RestPlace> at_depth(const LoopSurface& surface, const RestPlace& place, double depth) {
    ContactForce force(surface.prepared, surface.scale());
    return smooth_at(force, {place.at, place.normal, place.below}, depth);
}

LoopSurface scene_surface(const PreparedCase& given) {
    const Scene& scene = given.one.scene;
    if (!(scene.force.stiffness > 0))
        throw UsageError("force.stiffness is 0: a loop needs a force; use a stiffness above 0");
    if (!(damping_of(scene.hand) > 0))
        throw UsageError("hand.damping and hand.grip_damping are 0: without damping no sampled loop comes to rest at "
                         "any stiffness");
    LoopSurface surface;
    surface.name = "scene";
    surface.prepared = given;
    surface.prepared.one.scene.force.stiffness = 1;
    if (surface.prepared.one.scene.texture)
        surface.prepared.one.scene.texture->stiffness /= scene.force.stiffness;
    surface.hand = coupled(scene.hand, 0, 0);
    surface.rate = scene.paths.value_or(PathsSpec{}).rate;
    surface.stiffness = scene.force.stiffness;
    const TouchedShape shape = scene_shape(given);
    surface.low = shape.low;
    surface.high = shape.high;
    surface.deepest = shape.scale.deepest;
    return surface;
}

std::string hand_text(const LoopSurface& surface) {
    const HandSpec& hand = surface.hand;
    return fmt::format("hand of {:.3g} kg, {:.3g} N s/m, grip {:.4g} N/m, {:.4g} Hz{}", hand.mass, damping_of(hand),
                       hand.grip_stiffness, surface.rate,
                       hand.delay_samples > 0 ? fmt::format(", {} samples late", hand.delay_samples) : ", no delay");
}

const char* name_of(PlaceKind kind) {
    constexpr const char* kNames[] = {"flat", "crest", "hollow", "slope", "edge", "foot"};
    return kNames[static_cast<std::size_t>(kind)];
}

RestPlace wall_place() {
    RestPlace wall;
    wall.below = wall.depth = wall.force.z = 1e-3;
    wall.slope[2][2] = 1;
    return wall;
}

std::vector<RestPlace> rest_places(const LoopSurface& surface, std::size_t count) {
    ContactForce force(surface.prepared, surface.scale());
    const TouchedShape shape{[&](const TouchPlace& place) { return force(place); }, surface.scale(), surface.low,
                             surface.high};
    std::vector<TouchPlace> points = touched_places(shape, surface.prepared, count);
    Random draw(5);
    const auto depths = surface.depths();
    const std::size_t edges = std::max<std::size_t>(4, count / 8);
    std::vector<RestPlace> places;
    std::size_t found = 0;
    for (TouchPlace& point : points) {
        for (const double depth : depths)
            if (const auto place = smooth_at(force, point, depth); place && is_within_box(surface, place->at))
                places.push_back(*place);
        if (found == edges)
            continue;
        const glm::dvec3 far(draw(-1, 1), draw(-1, 1), draw(-1, 1));
        glm::dvec3 along = reference::cross(point.normal, far);
        along /= reference::length(along);
        const auto shallow = pressed(force, point, depths.front());
        const auto edge = shallow ? jump_between(force, *shallow, 2 * surface.deepest * along) : std::nullopt;
        if (!edge)
            continue;
        bool any = false;
        for (const double depth : depths) {
            // Deeper down the edge may lie elsewhere, and the force there may differ.
            std::optional<TouchPlace> there = edge;
            for (int i = 0; i < 3 && there; ++i) {
                there = pressed(force, *there, depth);
                if (there) {
                    there->at -= 0.5 * depth * along;
                    there = jump_between(force, *there, depth * along);
                }
            }
            const auto place = there ? edge_place(force, *there, along, depth) : std::nullopt;
            if (!place || !is_within_box(surface, place->at))
                continue;
            places.push_back(*place);
            any = true;
            for (const double side : {-1.0, 1.0})
                add_next_to(force, *there, side * along, depth, places);
        }
        found += any ? 1 : 0;
    }
    if (surface.is_mesh())
        add_vertices(force, surface, edges, places);
    return places;
}

std::vector<std::pair<double, double>> direction_profile(const LoopSurface& surface) {
    constexpr int kPoints = 200;
    ContactForce force(surface.prepared, surface.scale());
    const double y = 0.5 * (surface.low.y + surface.high.y), step = (surface.high.x - surface.low.x) / kPoints;
    std::vector<std::pair<double, double>> profile;
    double z = 0;
    for (int i = 0; i < kPoints; ++i) {
        const double x = surface.low.x + (i + 0.5) * step;
        // Down a column to the first force.
        TouchPlace place{{x, y, surface.high.z}, {0, 0, 1}, 0};
        glm::dvec3 found(0);
        for (int down = 0; down <= kPoints && !is_nonzero(found); ++down) {
            place.at.z = surface.high.z + (surface.low.z - surface.high.z) * down / kPoints;
            found = force(place);
        }
        if (is_nonzero(found) && found.z > 0) {
            profile.emplace_back(x, z);
            z -= found.x / found.z * step;
        }
    }
    return profile;
}

} // namespace forceshade

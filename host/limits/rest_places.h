// The places at which a hand may rest on a surface.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "host/limits/linear_loop.h"
#include "host/touch/force_at.h"

namespace forceshade {

struct LoopSurface {
    std::string name;      /* "shaded bump" */
    PreparedCase prepared; /* its law has a stiffness of 1 N/m */
    HandSpec hand;
    double rate = 1000;         /* Hz */
    double stiffness = 0;       /* N/m: the scene's own; 0: of the study's own surfaces */
    double deepest = 2e-3;      /* m */
    glm::dvec3 low{0}, high{0}; /* m: places are within this box */
    bool limits_alone = false;  // the study examines nothing else of it

    /// m: depths to which probes are pressed: the force over the stiffness.
    TouchScale scale() const { return {deepest}; }
    std::array<double, 4> depths() const { return {deepest / 10, deepest / 4, deepest / 2, deepest}; }
    bool is_mesh() const { return prepared.images.mesh != nullptr; }
};

/// The user's scene with its own hand, without its virtual coupling. \throws UsageError for one that permits no loop.
LoopSurface scene_surface(const PreparedCase& scene);

/// "hand of 0.2 kg, 3 N s/m, grip 300 N/m, 1000 Hz", and its delay.
std::string hand_text(const LoopSurface& surface);

/// By the direction of the force: flat: that of a level plane; crest, hollow: nearly upright, turning
/// outwards or inwards; slope: tilted; edge, foot: it jumps outwards, or inwards as at the foot of a bump.
enum class PlaceKind { flat, crest, hollow, slope, edge, foot };
inline constexpr std::array kPlaceKinds{PlaceKind::flat,  PlaceKind::crest, PlaceKind::hollow,
                                        PlaceKind::slope, PlaceKind::edge,  PlaceKind::foot};
const char* name_of(PlaceKind kind);
inline bool jumps(PlaceKind kind) {
    return kind == PlaceKind::edge || kind == PlaceKind::foot;
}

/// Where a probe rests.
struct RestPlace {
    PlaceKind kind = PlaceKind::flat;
    glm::dvec3 at{0};                    /* m: of the probe */
    glm::dvec3 normal{0, 0, 1};          /* of the surface above it */
    double below = 0;                    /* m: below the surface, along the normal */
    double depth = 0;                    /* m: the force over the stiffness */
    std::optional<double> edge_distance; /* m: from a jump of the direction, if the place was found by one */
    glm::dvec3 force{0};                 /* m: for each N/m of stiffness; at a jump the mean of both sides */
    glm::dmat3 slope{0};                 /* 1: -dF/dp for a stiffness of 1 N/m, columns first; not at a jump */
    double jump = 0;                     /* rad: between the directions of both sides */
    bool by_vertex = false;              // found at a vertex of a mesh, or next to one

    ForceAround force_around() const { return {slope, force / reference::length(force)}; }
};

/// `count` points anywhere on the surface, at each of its depths; those of its edges that were found from there, an
/// eighth of them at most; and as many vertices of a mesh, and next to them. \throws UsageError without contact in the
/// box.
std::vector<RestPlace> rest_places(const LoopSurface& surface, std::size_t count);

/// Places about another, at its depth, within the surface's box.
class NearbyPlaces {
public:
    /// `surface` must outlive it.
    explicit NearbyPlaces(const LoopSurface& surface) : surface_(surface), force_(surface.prepared, surface.scale()) {}
    /// That one `aside` of it, m; empty: no smooth place of rest.
    std::optional<RestPlace> aside(const RestPlace& from, const glm::dvec3& aside);

private:
    const LoopSurface& surface_;
    ContactForce force_;
};

/// The same place pressed to another depth, m, along the normal; empty: no smooth place of rest.
std::optional<RestPlace> at_depth(const LoopSurface& surface, const RestPlace& place, double depth);

/// 1/m: the largest turn of the force's direction along a direction across it: 1 / R on a crest, below 0 in a hollow.
double turn_of(const RestPlace& place);

/// A level wall's, at a depth of 1 mm.
RestPlace wall_place();

/// The shape, (x, z) in m, integrated from the directions of the force along x through the middle of the box; z is 0
/// where it begins.
std::vector<std::pair<double, double>> direction_profile(const LoopSurface& surface);

} // namespace forceshade

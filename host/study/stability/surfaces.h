// The surfaces whose loops are studied, and the places at which a hand may rest on them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "host/study/error_time/law_at.h"

namespace forceshade::study {

struct LoopSurface {
    std::string name;      /* "shaded bump" */
    PreparedCase prepared; /* its law has a stiffness of 1 N/m */
    HandSpec hand;
    double rate = 1000;         /* Hz */
    double stiffness = 0;       /* N/m: the scene's own; 0: of the study's own surfaces */
    double deepest = 2e-3;      /* m */
    glm::dvec3 low{0}, high{0}; /* m: places are within this box */

    /// m: depths to which probes are pressed: the force over the stiffness.
    std::array<double, 4> depths() const { return {deepest / 10, deepest / 4, deepest / 2, deepest}; }
    bool is_mesh() const { return prepared.images.mesh != nullptr; }
};

/// With the program's default hand: plane, bump of 2 facets with and without shading, height map of a bump and of a
/// dip, mesh with and without shading.
std::vector<LoopSurface> own_surfaces();

/// The user's scene with its own hand. \throws UsageError for one that permits no loop.
LoopSurface scene_surface(const PreparedCase& scene);

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
};

/// `count` points anywhere on the surface, at each of its depths; and those of its edges that were found from there, a
/// hundredth of them at most. \throws UsageError without contact in the box.
std::vector<RestPlace> rest_places(const LoopSurface& surface, std::size_t count);

/// The shape, (x, z) in m, integrated from the directions of the force along x through the middle of the box; z is 0
/// where it begins.
std::vector<std::pair<double, double>> direction_profile(const LoopSurface& surface);

/// A surface's force, by the CPU oracle in double, at a probe that came down to a place.
class ContactForce {
public:
    /// `surface` must outlive it.
    explicit ContactForce(const LoopSurface& surface) : surface_(surface), probe_(surface.prepared) {
        scale_.deepest = surface.deepest;
    }

    /// m, for each N/m of stiffness: at the place, `aside` of it.
    glm::dvec3 operator()(const error_time::Place& place, const glm::dvec3& aside = glm::dvec3(0)) {
        const glm::dvec3 at = place.at + aside;
        if (!surface_.is_mesh())
            return glm::dvec3(probe_.law().at(at).force);
        std::vector<glm::dvec3> way = error_time::descent(place, scale_);
        if (aside != glm::dvec3(0))
            way.push_back(at);
        return glm::dvec3(error_time::force_after(probe_, way));
    }

private:
    const LoopSurface& surface_;
    error_time::TouchScale scale_;
    CaseProbe<double> probe_;
};

} // namespace forceshade::study

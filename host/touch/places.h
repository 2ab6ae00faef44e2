// Where a hand touches a surface: under points anywhere on it, at depths that are log-uniform.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/random.h"

namespace forceshade {

/// A place that a hand touches.
struct TouchPlace {
    glm::dvec3 at{0};           /* m */
    glm::dvec3 normal{0, 0, 1}; /* of the surface above it */
    double depth = 0;           /* m: under the surface along the normal; negative above it */
};

/// Lengths that follow from how deep a hand goes, m.
struct TouchScale {
    double deepest = 2e-3;
    double shallowest() const { return deepest / 100; }
    double ring() const { return deepest / 20; }
    double skin() const { return deepest / 40; } /* shallower is boundary */
};

/// m: where a sample of a grid lies, in the grid's axes.
inline glm::dvec3 sample_place(const GridSpec& grid, std::size_t i, std::size_t j, std::size_t k) {
    return glm::make_vec3(grid.origin.data()) + glm::make_vec3(grid.spacing.data()) * glm::dvec3(i, j, k);
}

/// N, at a place.
using ForceAt = std::function<glm::dvec3(const TouchPlace&)>;

/// What is touched: where it has a force, and where to look.
struct TouchedShape {
    ForceAt force{};
    TouchScale scale{};
    glm::dvec3 low{0}, high{0}; /* m: the box that places are within */
    bool smooth = false; /* of a mesh: `force` is that of the shape that it approximates, under which places lie */

    /// Of a grid.
    void set_box(const GridSpec& grid);
};

inline bool touches(const glm::dvec3& force) {
    return force != glm::dvec3(0);
}

/// Draws places: of a mesh uniform over the triangles' area, else above or below (x, y) drawn in the box.
class PlaceDraw {
public:
    /// `shape`, and the mesh of `prepared`, must outlive it.
    PlaceDraw(const TouchedShape& shape, const PreparedCase& prepared, std::uint64_t seed);
    /// Empty without a surface, or if the place would be outside of the box or not in contact.
    std::optional<TouchPlace> operator()();
    /// Begins again with another seed.
    void begin(std::uint64_t seed) { draw_ = Random(seed); }

private:
    std::optional<TouchPlace> drawn_on_graph();
    std::optional<TouchPlace> drawn_on_mesh();

    const TouchedShape& shape_;
    const Mesh* mesh_;
    Random draw_;
    std::vector<double> areas_; /* up to each triangle */
};

/// Up to `count` places. \throws UsageError without contact in the box.
std::vector<TouchPlace> touched_places(PlaceDraw& draw, std::size_t count);

/// The same for the same seed.
std::vector<TouchPlace> touched_places(const TouchedShape& shape, const PreparedCase& prepared, std::size_t count,
                                       std::uint64_t seed = 1);

/// The box of a scene's grid, or without one that of its mesh, or of its paths; as deep as a hand goes. Without a
/// force.
TouchedShape scene_shape(const PreparedCase& prepared);

/// The point of the surface of `prepared` above or below (x, y), the highest of a mesh; empty: none.
std::optional<TouchPlace> surface_at(const TouchedShape& shape, const PreparedCase& prepared, double x, double y);

} // namespace forceshade

// What a referee says of one probe position.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "host/field/tables.h"
#include "host/scene/scene.h"

namespace forceshade::brute {

using Real = long double;
using Vector = glm::vec<3, Real>;

struct Answer {
    Vector force{0}, unshaded{0}; /* N */
    Vector proxy{0};              /* m */
    Real depth = 0;               /* m */
    std::uint32_t facet = 0xFFFFFFFFu;
};

// The closed forms of L1 to L5 and L8, derived differently from the oracle: angles instead of chords, plain loops
// instead of bisection, extended precision instead of care against cancellation. Referees reference and kernels alike.
// Shares no code with either.

/// What depends on the probe's (x, y) alone; finding it loops over all facets.
struct Column {
    Real x, y;
    bool on_bump = false;
    std::uint32_t facet = 0;
    Real height = 0;               /* m: nominal surface */
    Real facet_angle = 0;          /* rad: of the facet's normal from z towards x */
    Vector smooth{0, 0, 1};        /* unit normal of the smooth shape above the probe */
    std::array<Real, 2> texture{}; /* gradient of the texture */
};

/// The gradient of a height map at (x, y) in m; `image` that of a map from a file.
std::array<Real, 2> map_slope(const HeightMapSpec& map, const HeightImage* image, Real x, Real y);

class Referee {
public:
    /// The scene and images must outlive the referee.
    Referee(const Scene& scene, const SceneImages& images);

    Column column(double x, double y) const;
    Answer at(const Column& column, double z) const;

private:
    Answer cylinder_bump(const Column& column, Real z) const;
    Answer facets(const Column& column, Real z) const;
    Real texture_stiffness() const;

    const Scene& scene_;
    const SceneImages& images_;
    Real half_width_, radius_, edge_angle_, axis_depth_, top_;
};

} // namespace forceshade::brute

// How far rounding may take a computed voxel from the exact one, derived a priori, law by law; and the edges where
// another rounding may rightly say something else.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/norm.h"
#include "host/referee/referee.h"
#include "host/reference/path_step.h"

// How far rounding may take each part of a law, in units of the roundoff u (2^-24, 2^-53): one table for all laws.
// Tests recompute every line but the first three by running the law's own code in affine arithmetic
// (tests/unit/law_bounds_test.cpp, tests/mesh/mesh_bounds_test.cpp), and fail where a factor is too small, or twice too
// large.
namespace forceshade::roundings {

/// Single precision as Vulkan's table of precisions allows it: + - * to the nearest number, 1 u; / to 2.5 ULP, 5 u; a
/// square root as one divided by an inverse root to 2 ULP, 9 u. In double precision all of these are taken to round as
/// IEEE 754 says, 1 u, which holds for the software device, and is tried wherever else a device is validated.
struct Factor {
    double f32, f64;
};

// What is handed to a law, of its own size.
inline constexpr Factor kGiven{1, 0};   // as a scene states it: radius, width, stiffness
inline constexpr Factor kMade{1, 6};    // as the host makes it of that in double: an arc tangent, a sine and more
inline constexpr Factor kCircle{4, 12}; // G1: R^2 - x^2, of R^2: two of R (given), two of x (made)

// Bumps, with U(x) the height at a facet's left vertex, s its slope.
inline constexpr Factor kFacetHeight{23, 10}; // G2: of U + s a. The chord's root 9, / 5 and 4, then / or * and 2 sums
inline constexpr Factor kFacetNormal{25, 7};  // L3: of 1. Root 9, / 5, 2 products; half of the chord's 17
inline constexpr Factor kReference{16, 4};    // L4: of 1. Root 9, / 5, half of 3
inline constexpr Factor kRadial{17, 7};       // L2, L4: of 1 + c / r. Root 9, / 5, half of 3; c is made
// L2: of (a^2 + x^2 + |z| (|z| + 2 c)) / (R + r). Root 9, / 5, 3; two that are made.
inline constexpr Factor kCylinderDepth{19, 20};

// Height maps and textures, with s the slope.
inline constexpr Factor kCylinderSlope{16, 4}; // G3: of s. Root 9, / 5, half of 3
inline constexpr Factor kSine{9, 14};          // G3: of the largest s. The series, a product, an amplitude that is made
inline constexpr Factor kTurns{13, 44};    // G3: of the largest s and a turn. 2 pi times one that is made, a product
inline constexpr Factor kGaussian{9, 25};  // G3: of s (1 + (x^2 + y^2) / radius^2). The series; the radius is made
inline constexpr Factor kSamples{9, 25};   // G3: of the largest s (1 + columns + rows). Where between nodes: 2 and made
inline constexpr Factor kMapNormal{17, 5}; // L5: of 1. Root 9, / 5, half of 3, a product

// Meshes, with P the probe's largest coordinate, d its depth, l an edge's length.
inline constexpr Factor kNearest{40, 40}; // L6: of 1 + P, of d / l more on an edge. Which side of an edge 15, a foot 10
inline constexpr Factor kPlace{2, 2};     // L6: of a point and the centre, m. Two sums, or one and what is given
inline constexpr Factor kMorgenbesser{27, 21}; // L7: of the length, and 1 more a corner. Two roots, a product
inline constexpr Factor kBarycentric{6, 5}; // L7: of the length times 1 + aspect. Areas cancel: 3 of their longest side
inline constexpr Factor kMeanValue{11, 8};  // L7: of the same; two roots and two quotients on the way
inline constexpr double kTurn = 2;          // L7: turn of a normal, per displacement of the point over the height
inline constexpr Factor kTilt{20, 12};      // L9: of 1 + s. Root 9, / 5, the projection

// Forces.
inline constexpr Factor kLength{17, 5}; // of 1: a unit vector's length. Root 9, / 5, half of 3, a product
inline constexpr Factor kForce{3, 2};   // of K d: K is given, two products

} // namespace forceshade::roundings

namespace forceshade {

/// Whether a computed voxel is a referee's, allowing for rounding; on an edge, rounding chooses between two answers.
enum class Verdict { within, on_edge, beyond };

/// The roundoff of a precision, and how many of it a part of a law may be off.
struct Roundoff {
    explicit Roundoff(Precision precision)
        : single(precision == Precision::f32), one(single ? 0x1p-24 : 0x1p-53),
          tiny(4 * (single ? 0x1p-126 : 0x1p-1022)) {}
    double operator()(const roundings::Factor& factor) const { return (single ? factor.f32 : factor.f64) * one; }

    bool single;
    double one;  // u
    double tiny; // the smallest normal number, four times
};

/// First-order bounds, law by law: what each part of it may be off (roundings), carried through its formula. One
/// bound serves hardware and CPU alike. With s the slope of facet or map, and every coordinate taken as exact:
///  - a height of G2 is off by what its operations and rounded vertices make of U(left) + s a, and exact outside of the
///  bump or with one facet. Where R is barely above a vertex, R and a being rounded moves the circle's rise there by up
///  to 4 u R^2 / rise, never more than 2 sqrt(u) R; slope and height of the facet follow;
///  - a depth by that and u d, a direction by what is said there, a force by both and the products.
/// Below the smallest normal number m no error is relative, and hardware may take such numbers for zero: each depth,
/// direction and force is off by 4 m more, a gradient by 32 m (1 + s). No direction is off by more than 2, whatever its
/// condition.
class RoundingBound {
public:
    /// The case must outlive the bound.
    RoundingBound(const PreparedCase& prepared, Precision precision);

    /// The bound at a sample position in m.
    Bound at(double x, double y, double z) const;

    /// How much the channels may differ over a distance in m, on either side of an edge's neighbourhood.
    Bound over(double distance) const;

    /// The law in double precision.
    layout::Law<double> law() const { return tables_.law(); }

private:
    const Scene& scene_;
    FieldTables<double> tables_;
    Roundoff u_;
    double steepest_map_ = 0, steepest_texture_ = 0;
};

/// A law as a referee in precision T, and what a device displays of it.
template <typename T> struct OracleReferee {
    layout::Law<T> law;
    const layout::HandParams<T>* hand = nullptr; /* null: the law's own force */

    reference::Column<T> column(double x, double y) const {
        return reference::column_at(law, static_cast<T>(x), static_cast<T>(y));
    }
    Reading at(const reference::Column<T>& column, double z) const {
        reference::Contact<T> contact = reference::contact_at(law, column, static_cast<T>(z));
        if (hand)
            contact.force = reference::commanded(*hand, contact.force);
        return reading_of(contact);
    }
    static layout::uint facet(const reference::Column<T>& column) { return column.facet.id; }
};

/// The closed form as a referee.
struct ClosedFormReferee {
    const brute::Referee& referee;

    brute::Column column(double x, double y) const { return referee.column(x, y); }
    Reading at(const brute::Column& column, double z) const { return reading_of(referee.at(column, z)); }
    static layout::uint facet(const brute::Column& column) { return column.facet; }
};

/// Whether force(place) jumps between two places a rounding apart: however often the line is halved, one half of it
/// keeps most of the difference.
template <typename Force> bool jumps_between(glm::dvec3 from, glm::dvec3 to, const Force& force) {
    glm::dvec3 at_from = force(from), at_to = force(to);
    const double whole = norm(at_from - at_to);
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 middle = from + (to - from) / 2.0, at_middle = force(middle);
        const bool in_first = norm(at_from - at_middle) > norm(at_middle - at_to);
        (in_first ? to : from) = middle;
        (in_first ? at_to : at_from) = at_middle;
    }
    return norm(at_from - at_to) > whole / 2;
}

/// The number that many steps of T beyond `value`.
template <typename T> double stepped(double value, int steps) {
    const T towards = steps < 0 ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::infinity();
    T result = static_cast<T>(value);
    for (int i = 0; i < std::abs(steps); ++i)
        result = std::nextafter(result, towards);
    return static_cast<double>(result);
}

/// L2: the other of two solids that are equally deep but for `tolerance`, m: which of them a voxel names is a matter of
/// rounding, and its proxy lies on the one that it names.
inline std::optional<Reading> other_solid(const Reading& reading, const layout::Law<double>& law,
                                          const glm::dvec3& probe, double tolerance) {
    if (law.features.surface != layout::kSurfaceCylinderBump || reading.facet == layout::kNoFacet)
        return std::nullopt;
    const layout::LawParams<double>& params = law.params;
    const double x = probe.x, y = probe.y, z = probe.z;
    const reference::Radial<double> radial = reference::radial_at(params, x, z);
    const double power = (params.half_width - x) * (params.half_width + x) - z * (z + 2 * params.centre_depth);
    const double cylinder = power / (params.radius + radial.distance);
    if (!(std::abs(cylinder + z) <= tolerance))
        return std::nullopt;
    Reading other = reading;
    other.facet = 1 - reading.facet;
    other.proxy = {x, y, 0};
    if (other.facet == 0)
        other.proxy = {x + cylinder * radial.direction.x, y, z + cylinder * radial.direction.z};
    return other;
}

/// True if a bump's facets within a few steps of T of x include this one; vertices may coincide in T.
template <typename T, typename Referee>
bool is_facet_near(layout::uint facet, const layout::Law<double>& law, const Referee& referee, double x, double y) {
    const layout::uint plane = law.params.facets;
    const layout::uint low = referee.facet(referee.column(stepped<T>(x, -4), y));
    const layout::uint high = referee.facet(referee.column(stepped<T>(x, 4), y));
    if (facet == plane || (low == plane && high == plane))
        return low == plane || high == plane;
    return facet >= (low == plane ? 0 : low) && facet <= (high == plane ? plane - 1 : high);
}

/// True if the referee gives a reading at a point so near to the probe that rounding may have moved it there: a few
/// steps of T away, or as far up or down as the depth may be off. `sides` is how many of the two round.
template <typename T, typename Referee>
bool is_on_edge(const Reading& computed, const glm::dvec3& probe, const Referee& referee, const RoundingBound& bound,
                double sides, layout::uint channels) {
    const double x = probe.x, y = probe.y, z = probe.z;
    const layout::Law<double> law = bound.law();
    const Bound here = bound.at(x, y, z);
    const double reach = 1.01 * sides * here.depth; /* m */
    std::vector<double> across{stepped<T>(x, 0)};
    for (const int steps : {-1, 1, -2, 2, -4, 4})
        across.push_back(stepped<T>(x, steps));
    if (std::abs(x) < static_cast<double>(std::numeric_limits<T>::min()))
        across.push_back(0); // as hardware may read it
    const bool near_facet = law.features.surface == layout::kSurfaceBump && channels & layout::kChannelFacet &&
                            computed.facet != layout::kNoFacet && is_facet_near<T>(computed.facet, law, referee, x, y);
    for (const double near_x : across)
        for (const double near_y : {y, stepped<T>(y, -2), stepped<T>(y, 2)}) {
            const auto column = referee.column(near_x, near_y);
            for (const double near_z : {z, stepped<T>(z, -2), stepped<T>(z, 2), z - reach, z + reach}) {
                Reading truth = referee.at(column, near_z);
                if (near_facet && truth.facet != layout::kNoFacet)
                    truth.facet = computed.facet;
                const double moved = std::hypot(std::hypot(near_x - x, near_y - y), near_z - z); /* m */
                const Bound allowed = sides * (here + bound.at(near_x, near_y, near_z)) + bound.over(moved);
                if (!first_misfit(computed, truth, allowed, channels))
                    return true;
                const auto other = other_solid(truth, law, {near_x, near_y, near_z}, 2 * sides * here.depth + moved);
                if (other && !first_misfit(computed, *other, allowed, channels))
                    return true;
            }
        }
    return false;
}

/// In the mesh's frame no coordinate exceeds 1, and with P the probe's largest coordinate, or 1, every distance, offset
/// and proxy is off by at most e = kNearest u (1 + P). Then:
///  - any triangle within 2 e of the nearest may be taken for it, with its own facet, proxy and direction, and so may
///  an edge of it for its face, or another edge;
///  - rounded vertices turn an edge: a point at a distance d on one of length l is off by e (1 + d / l);
///  - a probe within 2 e of the surface may be taken for inside or outside; so may one whose offset is so nearly in the
///  plane of a triangle taken for the nearest that the exact law says otherwise there;
///  - the interpolated normal moves with the proxy: by at most 2 e / (height of the facet) of the length it had before
///  it was normalised, and that length is no less than the least component of a vertex normal along their sum;
///  - a gradient of a height map is taken at a proxy that is off by e: what that changes is looked up on either side.
class MeshBound {
public:
    /// The case must outlive the bound.
    MeshBound(const PreparedCase& prepared, Precision precision);

    /// Whether a reading is the law's at the probe (mesh frame), allowing for the rounding of `sides` sides.
    Verdict compare(const Reading& computed, const reference::Vector<double>& probe, double sides,
                    layout::uint channels) const;

    /// True if rounding, of the probe's position too, decides which point of the mesh an exact force near `probe`
    /// and one computed there belong to: the difference between them is then meaningless.
    bool is_ambiguous(const glm::dvec3& computed, const reference::Vector<double>& probe,
                      const glm::dvec3& exact) const;

    /// The bound where the law touches a given point of a facet.
    Bound at(const reference::Vector<double>& probe, const reference::MeshTouch<double>& touch) const;

    /// 1: e at a probe.
    double reach(const reference::Vector<double>& probe) const;

private:
    struct FacetShape;
    FacetShape shape_of(layout::uint facet) const;
    double place_error(const reference::Vector<double>& point) const; /* m, from the scene's origin */
    double map_error(const reference::Vector<double>& point) const;   /* m, where a height map is read */
    // `off`, 1: of the touched point.
    double direction_error(const reference::MeshTouch<double>& touch, const FacetShape& shape, double off) const;
    double slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                       double steepest, const reference::MeshTouch<double>& touch, double off) const;

    FieldTables<double> tables_;
    layout::Law<double> law_;
    Roundoff u_;
    double steepest_map_ = 0, steepest_texture_ = 0;
};

} // namespace forceshade

#include "host/study/stability/number_terms.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/prepare/prepared_case.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"

namespace forceshade::study {
namespace {

constexpr const char* kConditions[] = {"arithmetic of the force: u F",
                                       "rounded coordinates: u |x|",
                                       "depth as a difference of heights: u U / d",
                                       "below the smallest numbers: F near 1e-45 N or 1e-324 N",
                                       "beyond the largest number",
                                       "two facets equally near but for rounding"};
using Terms = std::array<double, 6>; /* N, in that order */

struct Numbers {
    double unit, least, largest;
};

Numbers numbers_of(Precision precision) {
    return precision == Precision::f32
               ? Numbers{0x1p-24, std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max()}
               : Numbers{0x1p-53, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max()};
}

/// Of the surface below the probe: height and slope.
struct Below {
    double height = 0, slope = 0;
};

Below below(const layout::Law<double>& law, const Vector& place) {
    const double radius = law.params.radius, a = law.params.half_width;
    if (law.features.surface == layout::kSurfaceBump) {
        const reference::Facet<double> facet = reference::facet_at(law, place.x);
        return {facet.height, std::abs(facet.normal_x / facet.normal_z)};
    }
    if (law.features.surface == layout::kSurfaceCylinderBump && std::abs(place.x) < a) {
        const double rise = std::sqrt((radius - place.x) * (radius + place.x));
        return {(a - place.x) * (a + place.x) / (rise + law.params.centre_depth), std::abs(place.x) / rise};
    }
    return {};
}

/// Of a mesh of the bump: how much a force turns between two facets that are equally near, N, if rounding leaves open
/// which of them is for more than a voxel in a thousand.
double facet_turn(const SurfaceSpec& surface, double force, double depth, double off) {
    constexpr double kSteepShare = 1e-3;
    const double cell = surface.width / surface.facets, radius = surface.radius; /* m */
    return 2 * off * radius > kSteepShare * cell * cell ? 2 * force * (cell / radius) * (depth / radius) : 0;
}

/// How much a rounded x turns the force of a sine, N.
double turned(const layout::Law<double>& law, double force, double off) {
    if (law.features.map != layout::kMapSine)
        return 0;
    return force *
           std::min(2.0, std::abs(law.params.map.slope) * 2 * std::numbers::pi * law.params.map.inverse_length * off);
}

} // namespace

void add_expected(const PreparedCase& prepared, const PreparedCase& home, const std::vector<Vector>& home_places,
                  const std::vector<Vector>& places, Precision precision, Expected& expected) {
    const Numbers numbers = numbers_of(precision);
    const FieldTables<double> tables = make_tables<double>(home.one.scene, home.images, Extent::everything);
    const layout::Law<double> law = tables.law();
    const double u = numbers.unit, stiffness = home.one.scene.force.stiffness;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vector& place = places[i];
        Terms terms{};
        double force = 0; /* N */
        if (home.images.mesh) {
            const double scale = law.mesh.params.scale;
            const Vector local = reference::to_mesh_frame(law.mesh.params, home_places[i]);
            const reference::Contact<double> contact = reference::evaluate(law, local);
            const double off = u * scale * (1 + size_of(local)); /* m */
            force = size_of(contact.force);
            terms[2] = stiffness * off;
            terms[5] = facet_turn(home.one.scene.surface, force, contact.depth, off);
            if (&prepared != &home) // the mesh's vertices are rounded to double, far away
                terms[1] = 2 * stiffness * 0x1p-53 * size_of(place);
        } else {
            force = size_of(reference::evaluate(law, home_places[i]).force);
            const Below surface = below(law, home_places[i]);
            const double touched = force > 0 ? 1 : 0;
            terms[1] = touched * stiffness * u * (std::abs(place.z) + surface.slope * std::abs(place.x)) +
                       turned(law, force, 2 * u * std::abs(place.x));
            terms[2] = 2 * touched * stiffness * u * surface.height;
        }
        terms[0] = 4 * u * force;
        terms[3] = force > 0 ? 2 * numbers.least : 0;
        terms[4] = force > numbers.largest ? std::numeric_limits<double>::infinity() : 0;
        double sum = 0;
        std::size_t heaviest = 0;
        for (std::size_t term = 0; term < terms.size(); ++term) {
            sum += terms[term];
            heaviest = terms[term] > terms[heaviest] ? term : heaviest;
        }
        if (sum > expected.most) {
            expected.most = sum;
            expected.condition = kConditions[heaviest];
        }
    }
}

} // namespace forceshade::study

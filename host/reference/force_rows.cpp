#include "host/reference/field.h"

#include <cmath>
#include <limits>

#include "host/reference/wide.h"

namespace forceshade::reference {
namespace {

// As facet_contact, of which each component of the force is a number by itself.
template <bool kNormal, bool kTextured, typename T>
FS_INLINE void facet_forces(const ForceColumns<T>& columns, const layout::LawParams<T>& params, const T z,
                            T* __restrict force) {
    const T* const __restrict height = columns.height, * const __restrict normal = columns.normal;
    const T* const __restrict direction = columns.direction, * const __restrict texture = columns.texture;
    const T* const __restrict sideways = columns.sideways;
    const T stiffness = params.stiffness, texture_stiffness = params.texture_stiffness;
    const std::size_t count = 3 * columns.samples;
    for (std::size_t i = 0; i < count; ++i) {
        const T below = height[i] - z;
        const T depth = kNormal ? below * normal[i] : below;
        T component = stiffness * depth * direction[i];
        if constexpr (kTextured) {
            const T textured = component - texture_stiffness * depth * texture[i];
            component = sideways[i] != T(0) ? textured : component;
        }
        force[i] = below > T(0) ? component : T(0);
    }
}

template <typename T> struct RowCylinder {
    T rise, rise_square; // m, m^2: of the probe above the axis
    explicit RowCylinder(const layout::LawParams<T>& params, T z)
        : rise(z + params.centre_depth), rise_square(rise * rise) {}
    // As radial_at.
    FS_INLINE void at(T x, T& across, T& up, T& distance) const {
        const T square = x * x + rise_square;
        const bool apart = square >= std::numeric_limits<T>::min();
        const T root = std::sqrt(square);
        distance = apart ? root : T(0);
        across = apart ? x / root : T(0);
        up = apart ? rise / root : T(1);
    }
};

// As facet_contact where the reference direction is radial, and z outside of the bump.
template <bool kNormal, bool kTextured, typename T>
FS_INLINE void radial_forces(const ForceColumns<T>& columns, const layout::LawParams<T>& params, const T z,
                             T* __restrict force) {
    const T* const __restrict height = columns.facet_height, * const __restrict normal = columns.facet_normal;
    const T* const __restrict xs = columns.x, * const __restrict on_bump = columns.on_bump;
    const T* const __restrict texture = columns.texture;
    const T stiffness = params.stiffness, texture_stiffness = params.texture_stiffness;
    const RowCylinder<T> cylinder(params, z);
    const std::size_t count = columns.samples;
    for (std::size_t i = 0; i < count; ++i) {
        T across, up, distance;
        cylinder.at(xs[i], across, up, distance);
        const T below = height[i] - z;
        const T depth = kNormal ? below * normal[i] : below;
        const T magnitude = stiffness * depth;
        T force_x = magnitude * (on_bump[i] != T(0) ? across : T(0)), force_y = magnitude * T(0);
        const T force_z = magnitude * (on_bump[i] != T(0) ? up : T(1));
        if constexpr (kTextured) {
            force_x -= texture_stiffness * depth * texture[3 * i];
            force_y -= texture_stiffness * depth * texture[3 * i + 1];
        }
        const bool touching = below > T(0);
        force[3 * i] = touching ? force_x : T(0);
        force[3 * i + 1] = touching ? force_y : T(0);
        force[3 * i + 2] = touching ? force_z : T(0);
    }
}

// As cylinder_bump_contact.
template <bool kTextured, typename T>
FS_INLINE void cylinder_forces(const ForceColumns<T>& columns, const layout::LawParams<T>& params, const T z,
                               T* __restrict force) {
    const T* const __restrict xs = columns.x, * const __restrict texture = columns.texture;
    const T stiffness = params.stiffness, texture_stiffness = params.texture_stiffness;
    const T half_width = params.half_width, radius = params.radius;
    const T plane_depth = z < T(0) ? -z : T(0), plane_force = stiffness * plane_depth;
    const T drop = z * (z + (params.centre_depth + params.centre_depth));
    const RowCylinder<T> cylinder(params, z);
    const std::size_t count = columns.samples;
    for (std::size_t i = 0; i < count; ++i) {
        const T x = xs[i], power = (half_width - x) * (half_width + x) - drop;
        T across, up, distance;
        cylinder.at(x, across, up, distance);
        const T inside = power / (radius + distance);
        const T depth = power > T(0) ? inside : T(0);
        const T magnitude = stiffness * depth;
        T force_x = magnitude * across, force_y = T(0);
        const T force_z = plane_force + magnitude * up;
        if constexpr (kTextured) {
            const T deeper = depth >= plane_depth ? depth : plane_depth;
            force_x -= texture_stiffness * deeper * texture[3 * i];
            force_y -= texture_stiffness * deeper * texture[3 * i + 1];
        }
        const bool touching = plane_depth > T(0) || power > T(0);
        force[3 * i] = touching ? force_x : T(0);
        force[3 * i + 1] = touching ? force_y : T(0);
        force[3 * i + 2] = touching ? force_z : T(0);
    }
}

// The variants of a law along a row, as bits.
constexpr unsigned kTexturedLaw = 1, kNormalLaw = 2, kRadialLaw = 4, kCylinderLaw = 8;

unsigned law_of(const layout::Features& features) {
    const bool radial = features.shading == layout::kShadingReference && features.reference == layout::kReferenceRadial;
    return (features.texture != layout::kMapNone ? kTexturedLaw : 0) |
           (features.surface == layout::kSurfaceCylinderBump
                ? kCylinderLaw
                : (features.depth == layout::kDepthNormal ? kNormalLaw : 0) | (radial ? kRadialLaw : 0));
}

template <typename T>
FS_INLINE void forces(unsigned law, const ForceColumns<T>& columns, const layout::LawParams<T>& params, T z, T* force) {
    switch (law) {
    case 0:
        return facet_forces<false, false>(columns, params, z, force);
    case kTexturedLaw:
        return facet_forces<false, true>(columns, params, z, force);
    case kNormalLaw:
        return facet_forces<true, false>(columns, params, z, force);
    case kNormalLaw | kTexturedLaw:
        return facet_forces<true, true>(columns, params, z, force);
    case kRadialLaw:
        return radial_forces<false, false>(columns, params, z, force);
    case kRadialLaw | kTexturedLaw:
        return radial_forces<false, true>(columns, params, z, force);
    case kRadialLaw | kNormalLaw:
        return radial_forces<true, false>(columns, params, z, force);
    case kRadialLaw | kNormalLaw | kTexturedLaw:
        return radial_forces<true, true>(columns, params, z, force);
    case kCylinderLaw:
        return cylinder_forces<false>(columns, params, z, force);
    default:
        return cylinder_forces<true>(columns, params, z, force);
    }
}

} // namespace

// The loader picks the processor's own version, so these have external linkage and are not templates.
#define FS_FORCES(T)                                                                                                   \
    FS_WIDE void forces_along(unsigned law, const ForceColumns<T>& columns, const layout::LawParams<T>& params, T z,   \
                              T* force) {                                                                              \
        forces(law, columns, params, z, force);                                                                        \
    }
FS_FORCES(float)
FS_FORCES(double)

namespace {

// Of the columns.
bool depends_on_y(const layout::Features& features) {
    const auto varies = [](layout::uint map) { return map == layout::kMapGaussian || map == layout::kMapSamples; };
    return varies(features.map) || varies(features.texture);
}

} // namespace

template <typename T> std::size_t ForceRows<T>::bytes(const layout::FieldInput<T>& input, std::size_t rows) {
    return sizeof(T) * input.x.size() * (13 + 6 * (depends_on_y(input.law.features) ? rows : 1));
}

template <typename T>
void ForceRows<T>::prepare(const layout::FieldInput<T>& input, std::size_t first, std::size_t rows, Crew& crew) {
    const bool shaded = input.law.features.shading != layout::kShadingNone;
    const std::size_t count = input.x.size();
    alike_ = !depends_on_y(input.law.features);
    first_ = first;
    for (std::vector<T>* each : {&height_, &normal_, &sideways_})
        each->resize(3 * count);
    for (std::vector<T>* each : {&x_, &on_bump_, &facet_height_, &facet_normal_})
        each->resize(count);
    for (std::vector<T>* each : {&direction_, &texture_})
        each->resize(3 * count * (alike_ ? 1 : rows));
    crew.share_out(alike_ ? 1 : rows, [&](std::size_t, std::size_t row) {
        for (std::size_t i = 0; i < count; ++i) {
            const Column<T> column = column_at(input.law, input.x[i], input.y[first + row]);
            const Facet<T>& facet = column.facet;
            const Vector<T> direction = shaded ? column.direction : Vector<T>(facet.normal_x, T(0), facet.normal_z);
            const T texture[3] = {column.texture.x, column.texture.y, T(0)};
            for (std::size_t c = 0; c < 3; ++c) {
                direction_[3 * (row * count + i) + c] = direction[static_cast<int>(c)];
                texture_[3 * (row * count + i) + c] = texture[c];
            }
            if (row > 0)
                continue;
            for (std::size_t c = 0; c < 3; ++c) {
                height_[3 * i + c] = facet.height;
                normal_[3 * i + c] = facet.normal_z;
                sideways_[3 * i + c] = c < 2 ? T(1) : T(0);
            }
            x_[i] = column.x;
            on_bump_[i] = column.on_bump ? T(1) : T(0);
            facet_height_[i] = facet.height;
            facet_normal_[i] = facet.normal_z;
        }
    });
}

template <typename T> void ForceRows<T>::evaluate(const layout::Law<T>& law, std::size_t y, T z, T* force) const {
    const std::size_t row = alike_ ? 0 : 3 * x_.size() * (y - first_);
    forces_along(law_of(law.features),
                 {height_.data(), normal_.data(), &direction_[row], &texture_[row], sideways_.data(), x_.data(),
                  on_bump_.data(), facet_height_.data(), facet_normal_.data(), x_.size()},
                 law.params, z, force);
}

template class ForceRows<float>;
template class ForceRows<double>;

} // namespace forceshade::reference

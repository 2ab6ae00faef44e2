// The factors of rounding_bound.h, recomputed by running the laws in affine arithmetic; the bounds made of them hold
// for all that affine arithmetic and the worst device that Vulkan allows say, and see a device that is worse.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "host/norm.h"
#include "host/referee/rounding_bound.h"
#include "host/referee/validate.h"
#include "tests/gpu/random_scene.h"
#include "tests/unit/affine.h"
#include "tests/unit/emulated.h"
#include "tests/unit/laws.h"
#include "tests/unit/rounded_law.h"

namespace forceshade::test {
namespace {

using reference::Vector;

constexpr double kUnit = AffineRun::kUnit;

// Numbers that single precision holds.
class SingleDraw {
public:
    explicit SingleDraw(std::uint64_t seed) : engine_(seed) {}
    double between(double low, double high) { return single_precision(std::lerp(low, high, uniform())); }
    double of_size(double low, double high) { return single_precision(low * std::pow(high / low, uniform())); }
    std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() % limit); }

private:
    double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    std::mt19937_64 engine_;
};

// The largest errors of each part of a law that affine arithmetic finds, in u of what rounding_bound.h says.
struct Parts {
    double facet_height = 0, facet_normal = 0, reference = 0, radial = 0, cylinder_depth = 0, cylinder_slope = 0,
           sine = 0, turns = 0, gaussian = 0, samples = 0, map_normal = 0, length = 0, force = 0;
};

template <typename T> class Measurement {
public:
    Parts run() {
        for (int i = 0; i < 4000; ++i) {
            const double half_width = draw_.of_size(1e-3, 1);
            const double radius = single_precision(half_width * (1 + draw_.of_size(1e-6, 1e3)));
            bump(half_width, radius);
            cylinder(half_width, radius);
            maps(i);
            force();
        }
        return parts_;
    }

private:
    static void keep(double& most, double error, double shape) {
        if (!affine_run.undecided)
            most = std::max(most, error / (kUnit * shape));
    }
    static double error_of_gradient(const reference::Gradient<T>& found, const reference::Gradient<double>& exact) {
        return error_of(Vector<T>(found.x, found.y, T(0)), {exact.x, exact.y, 0});
    }
    void unit_vector(double& most, const Vector<T>& found, const Vector<double>& exact, double shape = 1) {
        keep(most, error_of(found, exact), shape);
        affine_run.rounds = false;
        const T length = reference::length(found);
        affine_run.rounds = true;
        keep(parts_.length, length.radius() + std::abs(length.value() - 1), 1);
    }

    // What the operations do; a radius and vertices that are rounded are rise_error()'s.
    void bump(double half_width, double radius) {
        affine_run.begin();
        const double depth = single_precision(std::sqrt((radius - half_width) * (radius + half_width)));
        const double middle = draw_.between(-half_width, half_width);
        const double left = std::max(-half_width, middle - draw_.of_size(1e-3, 1) * half_width);
        const double right = std::min(half_width, middle + draw_.of_size(1e-3, 1) * half_width);
        const double x = draw_.between(left, std::nextafter(right, left));
        layout::Law<double> exact{};
        const std::vector<double> vertices{single_precision(left), single_precision(right)};
        exact.params.half_width = half_width, exact.params.radius = radius, exact.params.centre_depth = depth;
        exact.params.facets = 1;
        exact.facet_vertices = vertices;
        layout::Law<T> law{};
        const std::vector<T> rounded{T(vertices[0]), T(vertices[1])};
        law.params.half_width = T(half_width), law.params.radius = T(radius), law.params.centre_depth = T(depth);
        law.params.facets = 1;
        law.facet_vertices = rounded;
        const reference::Facet<T> facet = reference::facet_at(law, T(x));
        const reference::Facet<double> truth = reference::facet_at(exact, x);
        const double slope = std::abs(truth.normal_x / truth.normal_z);
        keep(parts_.facet_height, facet.height.radius(),
             reference::cylinder_height(half_width, radius, depth, vertices[0]) + slope * half_width);
        unit_vector(parts_.facet_normal, {facet.normal_x, T(0), facet.normal_z}, {truth.normal_x, 0, truth.normal_z});
        unit_vector(parts_.reference, reference::reference_normal(T(radius), T(x), true),
                    reference::reference_normal(radius, x, true));
        layout::MapParams<T> map{};
        map.half_width = T(half_width), map.radius = T(radius);
        keep(parts_.cylinder_slope, reference::cylinder_gradient(map, T(x), false).x.radius(),
             std::abs(x) / reference::circle_rise(radius, x));
    }

    void cylinder(double half_width, double radius) {
        affine_run.begin();
        const double depth = std::sqrt((radius - half_width) * (radius + half_width));
        const double x = draw_.between(-2 * half_width, 2 * half_width);
        const double z = (draw_.below(2) ? 1 : -1) * draw_.of_size(1e-6, 2) * half_width;
        layout::Law<double> exact{};
        exact.params.half_width = half_width, exact.params.radius = radius, exact.params.centre_depth = depth;
        layout::Law<T> law{};
        law.params.half_width = T::given(half_width), law.params.radius = T::given(radius);
        law.params.centre_depth = T::made(depth);
        law.params.stiffness = T(0);
        const double distance = std::hypot(x, z + depth);
        unit_vector(parts_.radial, reference::radial_at(law.params, T(x), T(z)).direction,
                    reference::radial_at(exact.params, x, z).direction, 1 + depth / distance);
        const reference::Column<T> column{
            .x = T(x), .y = T(0), .facet = {}, .direction = {}, .texture = {T(0), T(0)}, .on_bump = false};
        const auto contact = reference::cylinder_bump_contact(law, column, T(z));
        if (contact.facet == 0)
            keep(parts_.cylinder_depth, contact.depth.radius(),
                 (half_width * half_width + x * x + std::abs(z) * (std::abs(z) + 2 * depth)) / (radius + distance));
    }

    void maps(int i) {
        affine_run.begin();
        layout::MapParams<double> exact{};
        exact.slope = draw_.between(0.5, 1), exact.inverse_length = draw_.between(0.5, 1);
        layout::MapParams<T> map{};
        map.slope = T::made(exact.slope), map.inverse_length = T::made(exact.inverse_length);
        const double x = draw_.of_size(1e-3, 1e3), turns = x * exact.inverse_length;
        const double sine = error_of_gradient(reference::sine_gradient(map, T(x)), reference::sine_gradient(exact, x));
        const double by_turns = 2 * std::numbers::pi * (1 + T::kMade) * kUnit * turns;
        keep(parts_.sine, sine / exact.slope - by_turns, 1);
        keep(parts_.turns, sine / exact.slope, std::max(100.0, turns));
        const double u = draw_.between(-6, 6), v = draw_.between(-6, 6);
        const auto truth = reference::gaussian_gradient(exact, u, v);
        const double slope = std::hypot(truth.x, truth.y);
        keep(parts_.gaussian, error_of_gradient(reference::gaussian_gradient(map, T(u), T(v)), truth),
             slope * (1 + (u * u + v * v) * exact.inverse_length * exact.inverse_length));
        const auto hx = draw_.of_size(1e-3, 1e3), hy = draw_.of_size(1e-3, 1e3);
        unit_vector(parts_.map_normal, reference::map_normal(reference::Gradient<T>{T(hx), T(hy)}),
                    reference::map_normal(reference::Gradient<double>{hx, hy}));
        samples(i);
    }

    // Neighbouring slopes as unlike as can be: where the probe lies between them then says the most.
    void samples(int i) {
        const layout::uint columns = 1 + static_cast<layout::uint>(draw_.below(12));
        const layout::uint rows = 1 + static_cast<layout::uint>(draw_.below(12));
        std::vector<double> gradients;
        for (std::size_t node = 0; node < std::size_t(columns) * rows; ++node)
            for (int axis = 0; axis < 2; ++axis)
                gradients.push_back(i % 2 ? draw_.between(-1, 1) : (node % columns + node / columns) % 2 ? -1 : 1);
        std::vector<T> rounded;
        for (const double value : gradients)
            rounded.push_back(T::made(value));
        layout::MapParams<double> exact{};
        exact.half_width = draw_.between(0.5, 1), exact.half_length = draw_.between(0.5, 1);
        exact.columns = columns, exact.rows = rows;
        exact.nodes_per_x = (columns - 1) / (2 * exact.half_width);
        exact.nodes_per_y = (rows - 1) / (2 * exact.half_length);
        layout::MapParams<T> map{};
        map.half_width = T::given(exact.half_width), map.half_length = T::given(exact.half_length);
        map.nodes_per_x = T::made(exact.nodes_per_x), map.nodes_per_y = T::made(exact.nodes_per_y);
        map.columns = columns, map.rows = rows;
        const double x = draw_.between(-exact.half_width, exact.half_width);
        const double y = draw_.between(-exact.half_length, exact.half_length);
        keep(parts_.samples,
             error_of_gradient(reference::sampled_gradient(map, std::span<const T>(rounded), T(x), T(y)),
                               reference::sampled_gradient(exact, std::span<const double>(gradients), x, y)),
             1.0 + columns + rows);
    }

    void force() {
        affine_run.begin();
        const double stiffness = draw_.of_size(1, 1e4), z = -draw_.of_size(1e-6, 1);
        layout::Law<T> law{};
        law.params.stiffness = T::given(stiffness);
        const reference::Column<T> column{
            .x = T(0), .y = T(0), .facet = {T(0), T(0.6f), T(0.8f), 0}, .texture = {T(0), T(0)}};
        const auto contact = reference::facet_contact(law, column, T(z));
        keep(parts_.force, error_of(contact.force, glm::dvec3{0.6f, 0, 0.8f} * (-stiffness * z)), -stiffness * z);
    }

    SingleDraw draw_{7};
    Parts parts_;
};

void expect_tight(const char* name, double factor, double found) {
    EXPECT_LE(found, 1.00001 * factor) << name << " is too small";
    EXPECT_GE(2 * found, factor) << name << " is too large";
}

TEST(LawBounds, AreWhatAffineArithmeticFinds) {
    const Parts single = Measurement<Affine<VulkanRounding>>().run(), twice = Measurement<Affine<IeeeRounding>>().run();
    const auto check = [&](const char* name, const roundings::Factor& factor, double Parts::*part) {
        expect_tight((std::string(name) + " f32").c_str(), factor.f32, single.*part);
        expect_tight((std::string(name) + " f64").c_str(), factor.f64, twice.*part);
    };
    check("kFacetHeight", roundings::kFacetHeight, &Parts::facet_height);
    check("kFacetNormal", roundings::kFacetNormal, &Parts::facet_normal);
    check("kReference", roundings::kReference, &Parts::reference);
    check("kRadial", roundings::kRadial, &Parts::radial);
    check("kCylinderDepth", roundings::kCylinderDepth, &Parts::cylinder_depth);
    check("kCylinderSlope", roundings::kCylinderSlope, &Parts::cylinder_slope);
    check("kSine", roundings::kSine, &Parts::sine);
    check("kTurns", roundings::kTurns, &Parts::turns);
    check("kGaussian", roundings::kGaussian, &Parts::gaussian);
    check("kSamples", roundings::kSamples, &Parts::samples);
    check("kMapNormal", roundings::kMapNormal, &Parts::map_normal);
    check("kLength", roundings::kLength, &Parts::length);
    check("kForce", roundings::kForce, &Parts::force);
}

PreparedCase scene_of(std::uint64_t seed) {
    return random_scene(seed, seed % 2 ? Conditioning::anything : Conditioning::moderate);
}

// Some of a scene's voxels, where a float holds them; none of a scene with so many facets that rounding them takes
// long.
class Places {
public:
    explicit Places(const PreparedCase& prepared)
        : exact_(make_tables<double>(prepared.one.scene, prepared.images, Extent::everything)) {}
    template <typename Visit> void each(std::size_t count, std::uint64_t seed, const Visit& visit) const {
        SingleDraw draw(seed);
        const auto any = [&](const std::vector<double>& axis) {
            return single_precision(axis[draw.below(axis.size())]);
        };
        const layout::Law<double> law = exact_.law();
        for (std::size_t i = 0; i < count && law.facet_vertices.size() < 2000; ++i) {
            const double x = any(exact_.x), y = any(exact_.y), z = any(exact_.z);
            visit(law, glm::dvec3(x, y, z));
        }
    }

private:
    FieldTables<double> exact_;
};

TEST(LawBounds, HoldWhateverAffineArithmeticSaysOfALawAndAreNotMuchLarger) {
    using T = Affine<VulkanRounding>;
    std::size_t compared = 0;
    std::map<SurfaceKind, std::vector<double>> shares; // of the bound: each scene's largest
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const PreparedCase prepared = scene_of(seed);
        SCOPED_TRACE(prepared.scene);
        const RoundingBound bound(prepared, Precision::f32);
        double most = 0;
        Places(prepared).each(20, seed, [&](const layout::Law<double>& law, const glm::dvec3& p) {
            affine_run.begin();
            const reference::Contact<T> found = RoundedLaw<T>(law, p.x)(p.x, p.y, p.z);
            const reference::Contact<double> truth = reference::evaluate(law, p);
            if (affine_run.undecided || truth.facet == layout::kNoFacet)
                return;
            const Bound allowed = bound.at(p.x, p.y, p.z);
            // Both are of first order: they say nothing of a sine whose phase is lost.
            if (!(allowed.force < 0.1 * norm(truth.force)))
                return;
            const auto share = [&](double error, double of) { most = std::max(most, error / of); };
            share(found.depth.radius(), allowed.depth);
            share(error_of(found.force, truth.force), allowed.force);
            share(error_of(found.unshaded, truth.unshaded), allowed.unshaded);
            share(error_of(found.proxy, truth.proxy), allowed.proxy);
            ++compared;
        });
        ASSERT_LE(most, 1) << "seed " << seed;
        if (most > 0)
            shares[prepared.one.scene.surface.kind].push_back(most);
    }
    for (auto& [kind, all] : shares) {
        std::ranges::sort(all);
        EXPECT_GT(all.back(), 0.7) << int(kind);
        EXPECT_GT(all[all.size() / 5], 0.1) << int(kind);
    }
    EXPECT_EQ(shares.size(), 3u);
    EXPECT_GT(compared, 1000u);
}

// Of the voxels of random scenes that a device computes, those in contact and those that the bound finds wrong.
struct Count {
    std::size_t touching = 0, beyond = 0;
};

Count counted(const EmulatedDevice& device, std::uint64_t scenes) {
    Count count;
    emulated_device = device;
    for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
        const PreparedCase prepared = scene_of(seed);
        const RoundingBound bound(prepared, Precision::f32);
        const Scene rounded_scene = forceshade::rounded_scene<float>(prepared.one.scene);
        const FieldTables<double> rounded = make_tables<double>(rounded_scene, prepared.images, Extent::what_varies);
        const Places places(prepared);
        places.each(100, seed, [&](const layout::Law<double>& law, const glm::dvec3& p) {
            const Reading computed = reading_of(RoundedLaw<Emulated>(law, p.x)(p.x, p.y, p.z));
            const Reading truth = reading_of(reference::evaluate(law, p));
            const layout::uint channels = law.features.channels;
            count.touching += truth.facet != layout::kNoFacet;
            count.beyond += first_misfit(computed, truth, bound.at(p.x, p.y, p.z), channels) &&
                            !is_on_edge<float>(computed, p, OracleReferee<double>{rounded.law()}, bound, 1, channels);
        });
    }
    return count;
}

TEST(LawBounds, HoldForTheWorstDeviceThatVulkanAllows) {
    const Count count = counted({}, 300);
    EXPECT_EQ(count.beyond, 0u);
    EXPECT_GT(count.touching, 5000u);
}

// A blanket bound of 64 roundings found none of these.
TEST(LawBounds, SeeADeviceWhoseDivisionIsOffBy16UnitsInTheLastPlace) {
    const Count count = counted({.quotient = 16, .inverse_root = 1}, 100);
    EXPECT_GT(count.beyond, count.touching / 200);
}

// The plane's force has three roundings.
TEST(LawBounds, SeeAForceThatIsOffByTwentyRoundings) {
    PreparedCase prepared;
    prepared.one.scene = bump(kRadii[0], 1);
    const RoundingBound bound(prepared, Precision::f32);
    const OwnedLaw<double> law(prepared.one.scene);
    const double beside = 2 * kHalfWidth, depth = 0.001;
    const Reading truth = reading_of(law(beside, 0, -depth));
    Reading computed = truth;
    computed.force *= 1 + 20 * kUnit;
    EXPECT_TRUE(first_misfit(computed, truth, bound.at(beside, 0, -depth), layout::kChannelForce));
    computed.force = truth.force * (1 + 3 * kUnit);
    EXPECT_FALSE(first_misfit(computed, truth, bound.at(beside, 0, -depth), layout::kChannelForce));
}

// One facet is the plane, whose depth is exact.
TEST(RoundingBound, IsThatOfThePlaneWithOneFacet) {
    PreparedCase flat, beside;
    flat.one.scene = bump(kRadii[0], 1);
    beside.one.scene = bump(kRadii[0], 2);
    const RoundingBound on_facet(flat, Precision::f32), on_plane(beside, Precision::f32);
    const double x = 0.001, depth = 1e-6;
    EXPECT_EQ(on_facet.at(x, 0, -depth).depth, on_plane.at(2 * kHalfWidth, 0, -depth).depth);
    EXPECT_LE(on_facet.at(x, 0, -depth).depth, 1e-7 * depth);
    EXPECT_GT(on_plane.at(x, 0, -depth).depth, 1e-5 * depth);
}

} // namespace
} // namespace forceshade::test

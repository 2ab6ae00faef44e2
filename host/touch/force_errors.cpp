#include "host/touch/force_errors.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/touch/force_at.h"

namespace forceshade {
namespace {

ForceAt best_truth(const PreparedCase& scene, const TouchScale& scale) {
    const auto prepared = std::make_shared<PreparedCase>(scene);
    prepared->one.scene.force.shading = shadings_of(scene).back().first;
    const auto force = std::make_shared<ContactForce>(*prepared, scale);
    return [prepared, force](const TouchPlace& place) { return (*force)(place); };
}

} // namespace

std::vector<NamedShading> shadings_of(const PreparedCase& scene) {
    std::vector<NamedShading> shadings{{Shading::none, "none"}};
    const SurfaceKind kind = scene.one.scene.surface.kind;
    if (kind == SurfaceKind::bump)
        shadings.push_back({Shading::reference, "reference"});
    if (kind == SurfaceKind::height_map)
        shadings.push_back({Shading::height_map, "height_map"});
    if (kind != SurfaceKind::mesh)
        return shadings;
    const PolygonSoup& polygons = scene.images.mesh->mesh.polygons;
    shadings.push_back({Shading::morgenbesser, "morgenbesser"});
    if (polygons.corners.size() == 3 * polygons.facets())
        shadings.push_back({Shading::barycentric, "barycentric"});
    shadings.insert(shadings.end(), {{Shading::two_pass, "two_pass"}, {Shading::mean_value, "mean_value"}});
    return shadings;
}

ForceAt cylinder_force(const Scene& scene) {
    const bool normal = scene.force.depth == DepthReading::normal;
    return [normal, own = SmoothCylinder(scene)](const TouchPlace& place) {
        const glm::dvec3& at = place.at;
        double depth = reference::cylinder_height(own.half, own.radius, own.centre_depth, at.x) - at.z;
        if (!(depth > 0))
            return glm::dvec3(0);
        glm::dvec3 direction(0, 0, 1);
        if (std::abs(at.x) < own.half)
            direction = {at.x / own.radius, 0, reference::circle_rise(own.radius, at.x) / own.radius};
        if (normal)
            depth *= direction.z;
        return own.stiffness * depth * direction;
    };
}

std::string set_true_force(TouchedShape& shape, const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    shape.smooth = scene.surface.kind == SurfaceKind::bump && !scene.texture;
    shape.force = shape.smooth ? cylinder_force(scene) : best_truth(prepared, shape.scale);
    return shape.smooth ? kSmoothShape
                        : fmt::format("{} shading in double precision", shadings_of(prepared).back().second);
}

Summary summary_of(std::vector<double> values) {
    if (values.empty())
        return {};
    std::ranges::sort(values);
    double squares = 0;
    for (const double value : values)
        squares += value * value;
    const auto count = static_cast<double>(values.size());
    const auto at = [&](double share) { return values[static_cast<std::size_t>(std::ceil(share * count)) - 1]; };
    return {std::sqrt(squares / count), at(0.5), at(0.95), values.back()};
}

ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical) {
    ForceErrors errors;
    errors.places = forces.size();
    std::vector<double> directions, local, sizes, of_typical;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const double off = reference::length(forces[i] - truth[i]);
        const bool is = forces[i] != glm::dvec3(0), should = truth[i] != glm::dvec3(0);
        of_typical.push_back(off / typical);
        if (should)
            local.push_back(off / reference::length(truth[i]));
        if (is && should) {
            const double size = reference::length(truth[i]);
            directions.push_back(angle_between(forces[i], truth[i]) / kDegree);
            sizes.push_back(std::abs(reference::length(forces[i]) - size) / size);
        }
        errors.missed += should && !is;
        errors.phantom += is && !should;
        errors.above += !should;
        if (!should)
            errors.phantom_largest = std::max(errors.phantom_largest, off / typical);
    }
    errors.direction = summary_of(std::move(directions));
    errors.local = summary_of(std::move(local));
    errors.size = summary_of(std::move(sizes));
    errors.typical = summary_of(std::move(of_typical));
    return errors;
}

std::optional<TouchRecord> touched_error(const PreparedCase& prepared) {
    constexpr std::size_t kDraws = 8, kPlaces = 125; // of each draw
    if (shadings_of(prepared).size() == 1)           // which nothing else is closer than
        return std::nullopt;
    try {
        TouchedShape shape = scene_shape(prepared);
        const std::string against = set_true_force(shape, prepared);
        if (shape.smooth) { // on the plane around the bump no shading changes anything
            const double half = SmoothCylinder(prepared.one.scene).half;
            shape.low.x = std::max(shape.low.x, -half);
            shape.high.x = std::min(shape.high.x, half);
        }
        ContactForce law(prepared, shape.scale);
        std::vector<glm::dvec3> forces, true_ones;
        std::vector<ForceErrors> draws;
        PlaceDraw place_draw(shape, prepared, 0);
        for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
            const std::size_t begin = forces.size();
            place_draw.begin(seed);
            for (const TouchPlace& place : touched_places(place_draw, kPlaces)) {
                forces.push_back(law(place));
                true_ones.push_back(shape.force(place));
            }
            draws.push_back(force_errors(std::span(forces).subspan(begin), std::span(true_ones).subspan(begin), 1));
        }
        const ForceErrors all = force_errors(forces, true_ones, 1);
        if (std::isnan(all.local.median))
            return std::nullopt;
        const auto drawn = [&](const auto& number) {
            DrawnNumber one{.value = number(all)};
            for (const ForceErrors& draw : draws) {
                one.low = std::fmin(one.low, number(draw));
                one.high = std::fmax(one.high, number(draw));
            }
            return one;
        };
        return TouchRecord{.against = against,
                           .places = forces.size(),
                           .draws = kDraws,
                           .deepest = shape.scale.deepest,
                           .direction = drawn([](const ForceErrors& one) { return one.direction.rms; }),
                           .median_error = drawn([](const ForceErrors& one) { return one.local.median; }),
                           .p95_error = drawn([](const ForceErrors& one) { return one.local.p95; }),
                           .missed = drawn([](const ForceErrors& one) { return one.missed_share(); })};
    } catch (const UsageError&) { // nothing to touch, or beyond the numbers
        return std::nullopt;
    }
}

} // namespace forceshade

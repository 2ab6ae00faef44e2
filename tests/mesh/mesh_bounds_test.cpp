// The factors of rounding_bound.h that meshes have, recomputed by running their laws in affine arithmetic; the bound
// made of them holds for the worst device that Vulkan allows, and sees one that is worse.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "host/norm.h"
#include "host/referee/rounding_bound.h"
#include "tests/mesh/shapes.h"
#include "tests/unit/affine.h"
#include "tests/unit/emulated.h"

namespace forceshade::test {
namespace {

using layout::uint;
using reference::Vector;

constexpr double kUnit = AffineRun::kUnit;
constexpr uint kAllChannels = layout::kChannelForce | layout::kChannelDepth | layout::kChannelFacet |
                              layout::kChannelProxy | layout::kChannelUnshaded;

class Draw {
public:
    double between(double low, double high) { return std::lerp(low, high, double(engine_() >> 11) * 0x1p-53); }
    double of_size(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
    Vector<double> in_box(double size) {
        const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
        return {x, y, z};
    }

private:
    std::mt19937_64 engine_{7};
};

Vector<double> single(const Vector<double>& v) {
    return {single_precision(v.x), single_precision(v.y), single_precision(v.z)};
}
template <typename T> Vector<T> exactly(const Vector<double>& v) {
    return {T::off_by(v.x, 0), T::off_by(v.y, 0), T::off_by(v.z, 0)};
}
template <typename T> Vector<T> made(const Vector<double>& v) {
    return {T::made(v.x), T::made(v.y), T::made(v.z)};
}
// Rounded once, where the mesh's frame is made.
template <typename T> Vector<T> vertex(const Vector<double>& v) {
    return {T::off_by(v.x, kUnit * std::abs(v.x)), T::off_by(v.y, kUnit * std::abs(v.y)),
            T::off_by(v.z, kUnit * std::abs(v.z))};
}
// Off by so much, whichever way.
template <typename T> Vector<T> moved(const Vector<double>& v, double error) {
    const double each = error / std::numbers::sqrt3;
    return {T::off_by(v.x, each), T::off_by(v.y, each), T::off_by(v.z, each)};
}

struct Shape {
    std::vector<Vector<double>> corners;
    std::vector<Vector<double>> normals; // of the vertices
    Vector<double> normal, point;
    double height, aspect, shortest;
};

// A facet with this many corners on an ellipse, its normals turned at random, and a point of it.
Shape random_facet(Draw& draw, uint corners) {
    Shape shape;
    shape.normal = reference::normalised(draw.in_box(1));
    const Vector<double> across = reference::normalised(reference::cross(shape.normal, draw.in_box(1)));
    const Vector<double> along = reference::cross(shape.normal, across), centre = draw.in_box(0.5);
    const double width = draw.of_size(1e-3, 0.5), length = width * draw.of_size(1e-2, 1),
                 turned = draw.of_size(0.01, 2);
    std::vector<double> angles;
    for (uint i = 0; i < corners; ++i)
        angles.push_back(draw.between(0, 2 * std::numbers::pi));
    std::sort(angles.begin(), angles.end());
    Vector<double> sum(0.0), area(0.0), point(0.0);
    double weights = 0, longest = 0, edge = 1;
    for (const double angle : angles) {
        shape.corners.push_back(single(centre + width * std::cos(angle) * across + length * std::sin(angle) * along));
        shape.normals.push_back(reference::normalised(shape.normal + draw.in_box(turned)));
        sum += shape.normals.back();
        const double weight = draw.between(0.05, 1);
        point += weight * shape.corners.back();
        weights += weight;
    }
    for (std::size_t i = 0; i < corners; ++i) {
        const Vector<double> a = shape.corners[i] - centre, b = shape.corners[(i + 1) % corners] - centre;
        area += reference::cross(a, b);
        longest = std::max(longest, norm(b - a));
        edge = std::min(edge, norm(b - a));
    }
    shape.point = single(point / weights);
    shape.height = std::min(norm(area) / 2 / longest, edge);
    shape.aspect = longest / shape.height;
    shape.shortest = 1;
    for (const Vector<double>& own : shape.normals)
        shape.shortest = std::min(shape.shortest, reference::dot(own, reference::normalised(sum)));
    return shape;
}

// One facet as a mesh that shading_direction() takes.
template <typename T> struct FacetMesh {
    std::vector<T> vertices, vertex_normals, facet_normals;
    std::vector<uint> begins, corners;

    template <typename Corner, typename Normal>
    FacetMesh(const Shape& shape, const Corner& corner, const Normal& normal)
        : begins{0, static_cast<uint>(shape.corners.size())} {
        const auto append = [](std::vector<T>& to, const Vector<T>& v) { to.insert(to.end(), {v.x, v.y, v.z}); };
        for (uint i = 0; i < begins[1]; ++i) {
            append(vertices, corner(shape.corners[i]));
            append(vertex_normals, normal(shape.normals[i]));
            corners.push_back(i);
        }
        append(facet_normals, normal(shape.normal));
    }
    layout::MeshView<T> view() const {
        layout::MeshView<T> mesh{};
        mesh.vertices = vertices, mesh.vertex_normals = vertex_normals, mesh.facet_normals = facet_normals;
        mesh.facet_begins = begins, mesh.facet_corners = corners;
        return mesh;
    }
};

struct Parts {
    double nearest = 0, place = 0, morgenbesser = 0, barycentric = 0, mean_value = 0, tilt = 0;
    double moved = 0; // 1: the most that an interpolated normal turns, as the facet's shape has it
};

template <typename T> class Measurement {
public:
    Parts run() {
        for (int i = 0; i < 4000; ++i)
            nearest(i);
        for (int i = 0; i < 800; ++i)
            shading(random_facet(draw_, 3 + static_cast<uint>(i % 6)));
        return parts_;
    }

private:
    static void keep(double& most, double error, double shape) { most = std::max(most, error / (kUnit * shape)); }

    // Probes above and below a face, an edge, a corner, or hardly beside one; deep ones, and of large and small
    // triangles and slivers. Comparisons that rounding can turn are drawn.
    void nearest(int i) {
        const double size = i % 4 == 0 ? 1 : draw_.of_size(1e-4, 1);
        const Vector<double> middle = draw_.in_box(1 - size);
        Vector<double> corners[3];
        for (Vector<double>& corner : corners)
            corner = single(middle + draw_.in_box(size));
        if (i % 5 == 0)
            corners[2] = single(corners[0] + draw_.between(0.05, 0.95) * (corners[1] - corners[0]) +
                                draw_.in_box(size * draw_.of_size(1e-4, 1)));
        const Vector<double> normal = reference::normalised(
            reference::cross(Vector<double>(corners[1] - corners[0]), Vector<double>(corners[2] - corners[0])));
        double at[3] = {draw_.between(0, 1), draw_.between(0, 1), draw_.between(0, 1)};
        const int kind = i % 7;
        if (kind == 1 || kind == 3)
            at[0] = 0;
        if (kind == 3)
            at[1] = 0;
        if (kind == 2 || kind == 4)
            at[0] = draw_.between(-8, 8) * kUnit;
        if (kind == 4)
            at[1] = draw_.between(-8, 8) * kUnit;
        if (kind == 5)
            at[0] = draw_.between(-1, 0);
        const Vector<double> foot =
            (at[0] * corners[0] + at[1] * corners[1] + at[2] * corners[2]) / (at[0] + at[1] + at[2]);
        const double height = draw_.of_size(1e-6, i % 3 ? 1 : 64) * (i % 2 ? 1 : -1);
        nearest(single(foot + height * normal), corners, normal);
    }

    void nearest(const Vector<double>& probe, const Vector<double> (&corners)[3], const Vector<double>& normal) {
        const double reach = 1 + std::max(1.0, reference::largest_coordinate(probe));
        const auto exact = reference::nearest_on_triangle(probe, corners[0], corners[1], corners[2], normal);
        affine_run.by_chance = true;
        for (int k = 0; k < 4; ++k) {
            affine_run.begin();
            const auto found =
                reference::nearest_on_triangle(exactly<T>(probe), vertex<T>(corners[0]), vertex<T>(corners[1]),
                                               vertex<T>(corners[2]), made<T>(normal));
            if (found.feature == layout::kMeshFace) {
                affine_run.by_chance = false;
                const T distance = sqrt(found.square);
                affine_run.by_chance = true;
                keep(parts_.nearest, error_of(found.offset, exact.offset), reach);
                keep(parts_.nearest, distance.radius() + std::abs(distance.value() - std::sqrt(exact.square)), reach);
                continue;
            }
            // Of the edge, or of one of the two at a corner.
            double least = std::numeric_limits<double>::infinity();
            for (uint i = 0; i < 3; ++i) {
                const Vector<double> edge = corners[(i + 1) % 3] - corners[i];
                const auto point = reference::nearest_on_edge(Vector<double>(corners[i] - probe),
                                                              Vector<double>(corners[(i + 1) % 3] - probe), edge,
                                                              reference::dot(edge, edge));
                const double turned = 1 + std::sqrt(point.square) / norm(edge);
                least = std::min(least, error_of(found.offset, point.offset) / turned);
            }
            keep(parts_.nearest, least, reach);
        }
        affine_run.by_chance = false;
        affine_run.begin();
        layout::MeshParams<T> frame{};
        const Vector<double> centre = draw_.in_box(draw_.of_size(1e-2, 10));
        frame.centre_x = T::given(centre.x), frame.centre_y = T::given(centre.y), frame.centre_z = T::given(centre.z);
        frame.scale = T(1);
        const Vector<double> offset = single(exact.offset);
        const Vector<T> place = reference::to_scene(frame, Vector<T>(exactly<T>(probe) + exactly<T>(offset)));
        keep(parts_.place, error_of(place, Vector<double>(probe + offset + centre)),
             norm(centre) + norm(Vector<double>(probe + offset)));
    }

    void shading(const Shape& shape) {
        if (!(shape.shortest > 0.05) || !(shape.aspect < 1e3))
            return;
        const auto same = [](const Vector<double>& v) { return v; };
        const FacetMesh<double> exact(shape, same, same);
        double* const kinds[] = {&parts_.morgenbesser, &parts_.barycentric, &parts_.mean_value};
        for (const uint kind : {layout::kShadingMorgenbesser, layout::kShadingBarycentric, layout::kShadingMeanValue}) {
            if (kind == layout::kShadingBarycentric && shape.corners.size() != 3)
                continue;
            const Vector<double> truth = reference::shading_direction(exact.view(), kind, 0, shape.point);
            affine_run.begin();
            const FacetMesh<T> rounded(shape, exactly<T>, made<T>);
            const Vector<T> found = reference::shading_direction(rounded.view(), kind, 0, exactly<T>(shape.point));
            const bool sums = kind == layout::kShadingMorgenbesser;
            const double size = shape.shortest / (sums ? 1 : 1 + shape.aspect);
            if (!affine_run.undecided)
                keep(*kinds[kind - layout::kShadingMorgenbesser],
                     error_of(found, truth) * size - (sums ? kUnit * double(shape.corners.size()) : 0), 1);
            affine_run.begin();
            affine_run.rounds = false;
            const FacetMesh<T> same_facet(shape, exactly<T>, exactly<T>);
            const double off = 1e-5 * shape.height;
            const Vector<T> turned =
                reference::shading_direction(same_facet.view(), kind, 0, moved<T>(shape.point, off));
            affine_run.rounds = true;
            if (!affine_run.undecided)
                parts_.moved = std::max(parts_.moved, error_of(turned, truth) * shape.shortest / (off / shape.height));
        }
        tilt(shape);
    }

    void tilt(const Shape& shape) {
        affine_run.begin();
        const double lift = reference::dot(shape.normals[0], shape.normal), slope = draw_.of_size(1e-2, 1e2);
        if (!(lift > 0.1))
            return;
        const double x = single_precision(slope * draw_.between(-1, 1)),
                     y = single_precision(slope * draw_.between(-1, 1));
        const auto tilted = [](const auto& direction, auto gradient, const auto& normal) {
            using Result = std::remove_cvref_t<decltype(direction)>;
            return reference::normalised(Result(direction - reference::in_plane(gradient, normal)));
        };
        const Vector<double> truth = tilted(shape.normals[0], reference::Gradient<double>{x, y}, shape.normal);
        const Vector<T> found =
            tilted(exactly<T>(shape.normals[0]), reference::Gradient<T>{T(x), T(y)}, made<T>(shape.normal));
        keep(parts_.tilt, error_of(found, truth) * lift, 1 + std::hypot(x, y));
    }

    Draw draw_;
    Parts parts_;
};

TEST(MeshBounds, AreWhatAffineArithmeticFinds) {
    const Parts single = Measurement<Affine<VulkanRounding>>().run(), twice = Measurement<Affine<IeeeRounding>>().run();
    const auto check = [&](const char* name, const roundings::Factor& factor, double Parts::*part) {
        for (const auto& [most, found] : {std::pair(factor.f32, single.*part), std::pair(factor.f64, twice.*part)}) {
            EXPECT_LE(found, 1.00001 * most) << name << " is too small";
            EXPECT_GE(2 * found, most) << name << " is too large";
        }
    };
    check("kNearest", roundings::kNearest, &Parts::nearest);
    check("kPlace", roundings::kPlace, &Parts::place);
    check("kMorgenbesser", roundings::kMorgenbesser, &Parts::morgenbesser);
    check("kBarycentric", roundings::kBarycentric, &Parts::barycentric);
    check("kMeanValue", roundings::kMeanValue, &Parts::mean_value);
    check("kTilt", roundings::kTilt, &Parts::tilt);
    EXPECT_LE(single.moved, roundings::kTurn);
    EXPECT_GE(2 * single.moved, roundings::kTurn);
}

// A mesh's law on a device that rounds otherwise, as a loop over all triangles.
class EmulatedMesh {
public:
    explicit EmulatedMesh(const layout::Law<double>& exact) : vertices_(rounded(exact.mesh.vertices)) {
        law_.features = exact.features;
        const layout::MeshParams<double>& frame = exact.mesh.params;
        law_.mesh.params = {Emulated(frame.centre_x),
                            Emulated(frame.centre_y),
                            Emulated(frame.centre_z),
                            Emulated(frame.map_x),
                            Emulated(frame.map_y),
                            Emulated(frame.scale),
                            Emulated(frame.stiffness),
                            frame.facets,
                            frame.triangles,
                            frame.nodes,
                            0};
        layout::MeshView<Emulated>& mesh = law_.mesh;
        mesh.triangle_corners = exact.mesh.triangle_corners, mesh.triangle_facets = exact.mesh.triangle_facets;
        mesh.triangle_neighbours = exact.mesh.triangle_neighbours, mesh.facet_begins = exact.mesh.facet_begins;
        mesh.facet_corners = exact.mesh.facet_corners;
        mesh.vertices = vertices_;
        const std::pair<std::span<const double>, std::span<const Emulated>*> reals[] = {
            {exact.mesh.triangle_normals, &mesh.triangle_normals},
            {exact.mesh.vertex_pseudonormals, &mesh.vertex_pseudonormals},
            {exact.mesh.edge_pseudonormals, &mesh.edge_pseudonormals},
            {exact.mesh.facet_normals, &mesh.facet_normals},
            {exact.mesh.vertex_normals, &mesh.vertex_normals}};
        for (std::size_t i = 0; i < std::size(reals); ++i) {
            normals_[i] = rounded(reals[i].first);
            *reals[i].second = normals_[i];
        }
    }
    EmulatedMesh(const EmulatedMesh&) = delete;
    EmulatedMesh& operator=(const EmulatedMesh&) = delete;

    reference::Contact<Emulated> at(const Vector<double>& place) const {
        const Vector<Emulated> probe{Emulated(place.x), Emulated(place.y), Emulated(place.z)};
        const auto first = reference::nearest_on_triangle(probe, reference::triangle_at(law_.mesh, 0));
        reference::Nearest<Emulated> best{0, law_.mesh.triangle_facets[0], first.feature, first.offset, first.square};
        for (uint triangle = 1; triangle < law_.mesh.params.triangles; ++triangle)
            reference::keep_nearer(law_.mesh, triangle, probe, best);
        return reference::inside_by_pseudonormal(law_.mesh, best) ? reference::contact_with(law_, best, probe)
                                                                  : reference::free_contact(law_, probe);
    }

private:
    static std::vector<Emulated> rounded(std::span<const double> values) {
        std::vector<Emulated> result;
        for (const double value : values)
            result.push_back(Emulated(value));
        return result;
    }

    std::vector<Emulated> vertices_, normals_[5];
    layout::Law<Emulated> law_{};
};

struct Count {
    std::size_t touching = 0, beyond = 0;
};

// Of probes in meshes that a device evaluates, those in contact and those that the bound finds wrong.
Count counted(const EmulatedDevice& device) {
    Count count;
    Draw draw;
    const PolygonSoup soups[] = {shapes::cube(), shapes::icosphere(2), shapes::random_polyhedra(6, 3),
                                 shapes::many_gon_prism(9), shapes::sliver_box(12, 20)};
    for (const PolygonSoup& soup : soups)
        for (const Shading shading :
             {Shading::none, Shading::morgenbesser, Shading::barycentric, Shading::mean_value, Shading::two_pass}) {
            const auto mesh = std::make_shared<SceneMesh>();
            mesh->mesh = shapes::mesh_of(soup);
            const bool triangles = mesh->mesh.triangles.corners.size() == mesh->mesh.polygons.facets();
            if (shading == Shading::barycentric && !triangles)
                continue;
            mesh->structure = build_structure(mesh->mesh);
            PreparedCase prepared;
            prepared.one.scene.surface.kind = SurfaceKind::mesh;
            prepared.one.scene.force.shading = shading;
            prepared.one.scene.grid.size = {1, 1, 1};
            prepared.images.mesh = mesh;
            const MeshBound bound(prepared, Precision::f32);
            const FieldTables<double> tables =
                make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies);
            emulated_device = device;
            const EmulatedMesh emulated(tables.law());
            for (int i = 0; i < 600; ++i) {
                const Vector<double> probe = single(draw.in_box(1.01));
                const Reading computed = reading_of(emulated.at(probe));
                count.touching += computed.facet != layout::kNoFacet;
                count.beyond += bound.compare(computed, probe, 1, kAllChannels) == Verdict::beyond;
            }
        }
    return count;
}

TEST(MeshBounds, HoldForTheWorstDeviceThatVulkanAllows) {
    const Count count = counted({});
    EXPECT_EQ(count.beyond, 0u);
    EXPECT_GT(count.touching, 3000u);
}

TEST(MeshBounds, SeeADeviceWhoseDivisionIsOffBy64UnitsInTheLastPlace) {
    const Count count = counted({.quotient = 64, .inverse_root = 1});
    EXPECT_GT(count.beyond, count.touching / 100);
}

} // namespace
} // namespace forceshade::test

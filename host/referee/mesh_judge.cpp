#include "host/referee/mesh_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/norm.h"
#include "host/prepare/prepared_case.h"
#include "host/program.h"
#include "host/referee/mesh_referee.h"
#include "host/referee/referee.h"

namespace forceshade {

namespace {

using Vector = reference::Vector<double>;

constexpr double kRoundings = 64;
constexpr double kOpposite = 2; // how far two unit vectors can be apart
constexpr double kNever = std::numeric_limits<double>::infinity();

// What the direction of a facet's interpolated normal hangs on.
struct FacetShape {
    double height = 0;   /* 1: the facet's area over its longest edge */
    double shortest = 0; /* 1: the least length that an interpolated normal can have before it is normalised */
    double lift = 0;     /* 1: the least component along the facet's normal, of a unit normal */
};

FacetShape shape_of(const layout::MeshView<double>& mesh, layout::uint facet) {
    const layout::uint first = mesh.facet_begins[facet], end = mesh.facet_begins[facet + 1];
    Vector area(0.0), sum(0.0);
    double longest = 0;
    const Vector origin = reference::vector_at(mesh.vertices, mesh.facet_corners[first]);
    for (layout::uint i = first; i < end; ++i) {
        const layout::uint from = mesh.facet_corners[i], to = mesh.facet_corners[i + 1 < end ? i + 1 : first];
        const Vector a = reference::vector_at(mesh.vertices, from) - origin;
        const Vector b = reference::vector_at(mesh.vertices, to) - origin;
        area = area + reference::cross(a, b);
        longest = std::max(longest, norm(b.x - a.x, b.y - a.y, b.z - a.z));
        sum = sum + reference::vector_at(mesh.vertex_normals, from);
    }
    const Vector middle = reference::normalised(sum);
    const Vector normal = reference::vector_at(mesh.facet_normals, facet);
    FacetShape shape{longest > 0 ? norm(area.x, area.y, area.z) / 2 / longest : 0, 1, 1};
    for (layout::uint i = first; i < end; ++i) {
        const Vector own = reference::vector_at(mesh.vertex_normals, mesh.facet_corners[i]);
        shape.shortest = std::min(shape.shortest, reference::dot(own, middle));
        shape.lift = std::min(shape.lift, reference::dot(own, normal));
    }
    return shape;
}

reference::MeshTouch<double> touch_of(const Vector& probe, layout::uint facet,
                                      const reference::TrianglePoint<double>& point) {
    return {facet, point.offset, Vector(probe + point.offset), std::sqrt(point.square)};
}

} // namespace

MeshBound::MeshBound(const PreparedCase& prepared, Precision precision)
    : tables_(make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()),
      unit_(kRoundings * (precision == Precision::f32 ? 0x1p-24 : 0x1p-53)),
      tiny_(4 * (precision == Precision::f32 ? 0x1p-126 : 0x1p-1022)) {}

double MeshBound::reach(const Vector& probe) const {
    return unit_ * (1 + std::max(1.0, reference::largest_coordinate(probe)));
}

double MeshBound::slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                              const Vector& world, double reach) const {
    const auto at = [&](double dx, double dy) {
        return reference::gradient_at(kind, map, samples, world.x + dx, world.y + dy);
    };
    const double centre = std::max(std::abs(world.x), std::abs(world.y));
    const double off = reach * law_.mesh.params.scale + unit_ * centre; /* m */
    const auto here = at(0, 0);
    double most = 0;
    for (const auto& [dx, dy] : {std::pair(off, 0.0), {-off, 0.0}, {0.0, off}, {0.0, -off}}) {
        const auto there = at(dx, dy);
        most = std::max(most, std::hypot(there.x - here.x, there.y - here.y));
    }
    const double turns = centre * std::abs(map.inverse_length) + map.columns + map.rows;
    return 2 * most + unit_ * (1 + turns) * (std::hypot(here.x, here.y) + std::abs(map.slope)) + tiny_;
}

double MeshBound::direction_error(const reference::MeshTouch<double>& touch, double reach) const {
    const layout::Features& features = law_.features;
    double error = unit_;
    if (features.shading != layout::kShadingNone) {
        const FacetShape shape = shape_of(law_.mesh, touch.facet);
        if (!(shape.shortest > 0) || !(shape.height > 0))
            return kOpposite;
        error = (unit_ + 8 * reach / shape.height) / shape.shortest;
    }
    if (features.map != layout::kMapNone)
        error += slope_error(features.map, law_.params.map, law_.map_gradients,
                             reference::to_world(law_.mesh.params, touch.point), reach);
    return std::min(error, kOpposite);
}

Bound MeshBound::at(const Vector& probe, const reference::MeshTouch<double>& touch) const {
    const layout::MeshParams<double>& params = law_.mesh.params;
    const double off = reach(probe);
    const double plain = std::abs(params.stiffness) * off + tiny_; /* N */
    const double unshaded = std::abs(params.stiffness) * touch.distance;
    const bool shaded = law_.features.shading != layout::kShadingNone || law_.features.map != layout::kMapNone;
    const double turned = shaded ? unshaded * direction_error(touch, off) : 0;
    Bound bound{plain + turned, plain + unit_ * unshaded, plain + unit_ * unshaded, off * params.scale,
                off * params.scale + unit_ * norm(params.centre_x, params.centre_y, params.centre_z)};
    if (law_.features.shading == layout::kShadingTwoPass) {
        const double lift = shape_of(law_.mesh, touch.facet).lift;
        bound.force = lift > 0 ? 2 * bound.force / (lift * lift) : kNever;
        bound.magnitude = bound.force;
    }
    if (law_.features.texture != layout::kMapNone) {
        const Vector world = reference::to_world(params, touch.point);
        const auto slope = reference::gradient_at(law_.features.texture, law_.params.texture, law_.texture_gradients,
                                                  world.x, world.y);
        const double steep = std::hypot(slope.x, slope.y);
        const double error =
            slope_error(law_.features.texture, law_.params.texture, law_.texture_gradients, world, off);
        const double pull = std::abs(law_.params.texture_stiffness) * params.scale *
                            (off * steep + touch.distance * (unit_ * steep + error));
        bound.force += pull;
        bound.unshaded += pull;
        bound.magnitude = bound.force;
    }
    return bound;
}

MeshBound::Verdict MeshBound::judge(const Reading& computed, const Vector& probe, double sides,
                                    layout::uint channels) const {
    const layout::MeshView<double>& mesh = law_.mesh;
    const reference::Nearest<double> found = reference::nearest(mesh, probe);
    const double slack = 2 * sides * reach(probe), nearest = std::sqrt(found.square);
    const auto fits_free = [&] {
        const double off = sides * reach(probe) * mesh.params.scale +
                           unit_ * norm(mesh.params.centre_x, mesh.params.centre_y, mesh.params.centre_z);
        return !first_misfit(computed, reading_of(reference::free_contact(law_, probe)), {0, 0, 0, 0, off}, channels);
    };
    const auto fits = [&](const reference::MeshTouch<double>& touch) {
        return !first_misfit(computed, reading_of(reference::touching_contact(law_, touch)), sides * at(probe, touch),
                             channels);
    };
    const auto is_inside = [&](const reference::Nearest<double>& one) {
        return law_.features.inside == layout::kInsideWinding ? reference::inside_by_winding(mesh, probe)
                                                              : reference::inside_by_pseudonormal(mesh, one);
    };
    const bool inside = is_inside(found);
    if (inside ? fits(touch_of(probe, found.facet, {found.square, found.offset, found.feature})) : fits_free())
        return Verdict::within;
    const bool either = nearest <= slack;
    if (either && fits_free())
        return Verdict::on_edge;
    for (layout::uint triangle = 0; triangle < mesh.params.triangles; ++triangle) {
        const auto point = reference::nearest_on_triangle(mesh, triangle, probe);
        if (!(std::sqrt(point.square) <= nearest + slack))
            continue;
        const layout::uint facet = mesh.triangle_facets[triangle];
        const bool here = is_inside({triangle, facet, point.feature, point.offset, point.square});
        if (here || either ? fits(touch_of(probe, facet, point)) : false)
            return Verdict::on_edge;
        if (!here && fits_free())
            return Verdict::on_edge;
    }
    return Verdict::beyond;
}

bool MeshBound::parts(const Triple& computed, const Vector& probe, const Triple& exact) const {
    const double off = norm(computed[0] - exact[0], computed[1] - exact[1], computed[2] - exact[2]);
    // Few voxels are so far off that it is worth asking.
    if (off <= std::abs(law_.mesh.params.stiffness) * reach(probe))
        return false;
    const auto verdict = [&](const Triple& force) {
        Reading reading;
        reading.force = force;
        return judge(reading, probe, 1, layout::kChannelForce);
    };
    const Verdict own = verdict(computed);
    return own == Verdict::on_edge || (own == Verdict::within && verdict(exact) == Verdict::on_edge);
}

namespace {

constexpr double kDoubleRoundoff = 0x1p-53;
constexpr std::uint64_t kBudget = 20'000'000; // triangles that the brute referee may look at: some seconds

brute::MeshShading brute_shading(Shading shading) {
    switch (shading) {
    case Shading::morgenbesser:
        return brute::MeshShading::morgenbesser;
    case Shading::barycentric:
        return brute::MeshShading::barycentric;
    case Shading::mean_value:
        return brute::MeshShading::mean_value;
    case Shading::two_pass:
        return brute::MeshShading::two_pass;
    default:
        return brute::MeshShading::none;
    }
}

// The scene as plain loops see it. The case must outlive the law.
brute::MeshLaw brute_law(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    brute::MeshLaw law;
    law.stiffness = scene.force.stiffness;
    law.shading = brute_shading(scene.force.shading);
    if (scene.surface.mesh.inside == InsideTest::winding)
        law.inside = brute::MeshInside::winding;
    if (!scene.texture)
        return law;
    const auto slope = [map = &scene.texture->map, image = prepared.images.texture.get()](
                           brute::Real x, brute::Real y) { return brute::map_slope(*map, image, x, y); };
    if (scene.texture->effect == TextureEffect::normal) {
        law.map = slope;
    } else {
        law.texture = slope;
        law.texture_stiffness = scene.texture->stiffness;
    }
    return law;
}

template <typename T> class MeshJudge {
public:
    MeshJudge(const PreparedCase& prepared, bool exact_bits)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::everything)),
          exact_(make_tables<double>(prepared.one.scene, prepared.images, Extent::everything)), law_(tables_.law()),
          exact_law_(exact_.law()), referee_(prepared.images.mesh->mesh, brute_law(prepared)),
          bound_(prepared, std::is_same_v<T, float> ? Precision::f32 : Precision::f64), exact_bits_(exact_bits),
          channels_(tables_.features.channels) {
        const std::uint64_t voxels = std::uint64_t(tables_.x.size()) * tables_.y.size() * tables_.z.size();
        const std::uint64_t affordable = std::max<std::uint64_t>(1, kBudget / law_.mesh.params.triangles);
        every_ = std::max<std::uint64_t>(1, voxels / affordable);
    }

    layout::FieldInput<T> input() const { return tables_.input(); }

    void compare_row(const layout::FieldChunk<T>& chunk, std::size_t row, Comparison& partial) const {
        const std::size_t z = chunk.z_first + row / chunk.y_count, y = chunk.y_first + row % chunk.y_count;
        layout::uint hint = 0, exact_hint = 0;
        for (std::size_t x = 0; x < chunk.x_count; ++x) {
            const std::size_t sample = row * chunk.x_pitch + x;
            const VoxelIndex at{x, y, z};
            const Reading computed = reading_of(chunk, sample);
            ++partial.voxels;
            const layout::uint facet = compare_with_alike(chunk, sample, at, hint, partial);
            compare_with_oracle(computed, facet, at, exact_hint, partial);
            if (((z * tables_.y.size() + y) * tables_.x.size() + x) % every_ == 0)
                compare_with_brute(computed, at, partial);
        }
    }

private:
    using Point = reference::Vector<double>;

    Point probe_at(VoxelIndex at) const {
        return {double(tables_.x[at.x]), double(tables_.y[at.y]), double(tables_.z[at.z])};
    }

    // Where the bits must be the oracle's, nothing else is said of them. Returns the oracle's facet.
    layout::uint compare_with_alike(const layout::FieldChunk<T>& chunk, std::size_t sample, VoxelIndex at,
                                    layout::uint& hint, Comparison& partial) const {
        const reference::Contact<T> alike = reference::mesh_contact(
            law_, reference::Vector<T>(tables_.x[at.x], tables_.y[at.y], tables_.z[at.z]), hint);
        if (same_bits(chunk, sample, alike))
            return alike.facet;
        count_difference(chunk, sample, alike, partial);
        const Reading computed = reading_of(chunk, sample);
        if (!exact_bits_)
            switch (bound_.judge(computed, probe_at(at), 1, channels_)) {
            case MeshBound::Verdict::within:
                return alike.facet;
            case MeshBound::Verdict::on_edge:
                ++partial.boundary;
                return alike.facet;
            case MeshBound::Verdict::beyond:
                break;
            }
        ++partial.beyond;
        const Reading expected = reading_of(alike);
        note_failure(partial, at, computed, expected, first_misfit(computed, expected, {}, channels_),
                     "the oracle in the same precision");
        return alike.facet;
    }

    // The error counts against the true position; the bound holds at the position that was rounded to T. Where rounding
    // chose another facet, the difference says nothing of errors.
    void compare_with_oracle(const Reading& computed, layout::uint facet, VoxelIndex at, layout::uint& hint,
                             Comparison& partial) const {
        const Point probe(exact_.x[at.x], exact_.y[at.y], exact_.z[at.z]);
        const Reading truth = reading_of(reference::mesh_contact(exact_law_, probe, hint));
        partial.largest_force = std::max(partial.largest_force, norm(truth.force[0], truth.force[1], truth.force[2]));
        switch (bound_.judge(computed, probe_at(at), 1, channels_)) {
        case MeshBound::Verdict::within:
            if (facet != truth.facet || bound_.parts(computed.force, probe_at(at), truth.force))
                ++partial.oracle.boundary;
            else
                add_error(computed, truth, partial.oracle);
            return;
        case MeshBound::Verdict::on_edge:
            ++partial.oracle.boundary;
            return;
        case MeshBound::Verdict::beyond:
            add_error(computed, truth, partial.oracle);
            ++partial.oracle.unexplained;
            note_failure(partial, at, computed, truth, layout::kChannelForce, "the oracle in double precision");
        }
    }

    // Where rounding decides which facet is the nearest, the answer may be that of any of them.
    void compare_with_brute(const Reading& computed, VoxelIndex at, Comparison& partial) const {
        const Point probe = probe_at(at);
        const Reading truth = reading_of(referee_.at(world_of(probe)));
        if (fits_brute(computed, truth, probe)) {
            add_error(computed, truth, partial.closed_form);
            return;
        }
        const double tolerance = 2 * sides_of(probe) * bound_.reach(probe) * exact_law_.mesh.params.scale; /* m */
        for (const brute::Answer& answer : referee_.all_at(world_of(probe), tolerance))
            if (fits_brute(computed, reading_of(answer), probe)) {
                ++partial.closed_form.boundary;
                return;
            }
        add_error(computed, truth, partial.closed_form);
        ++partial.closed_form.unexplained;
        note_failure(partial, at, computed, truth, layout::kChannelForce, "a loop over all triangles");
    }

    bool fits_brute(const Reading& computed, const Reading& truth, const Point& probe) const {
        const layout::MeshParams<double>& frame = exact_law_.mesh.params;
        const Point proxy((truth.proxy[0] - frame.centre_x) / frame.scale,
                          (truth.proxy[1] - frame.centre_y) / frame.scale,
                          (truth.proxy[2] - frame.centre_z) / frame.scale);
        const bool touching = truth.depth > 0;
        const reference::MeshTouch<double> touch{touching ? truth.facet : 0, Point(proxy - probe), proxy,
                                                 truth.depth / frame.scale};
        Bound allowed = sides_of(probe) * bound_.at(probe, touch);
        if (!touching)
            allowed = {0, 0, 0, 0, allowed.proxy};
        return !first_misfit(computed, truth, allowed, channels_);
    }

    // One, and as many as the rounding of the probe's place in the world comes to.
    double sides_of(const Point& probe) const {
        const layout::MeshParams<double>& frame = exact_law_.mesh.params;
        const double placed = 2 * kDoubleRoundoff * norm(frame.centre_x, frame.centre_y, frame.centre_z) / frame.scale;
        return 1 + placed / bound_.reach(probe);
    }

    glm::dvec3 world_of(const Point& probe) const {
        const layout::MeshParams<double>& frame = exact_law_.mesh.params;
        return {probe.x * frame.scale + frame.centre_x, probe.y * frame.scale + frame.centre_y,
                probe.z * frame.scale + frame.centre_z};
    }

    static void add_error(const Reading& computed, const Reading& truth, Distance& distance) {
        const double off = force_error(computed, truth);
        if (off > distance.largest || std::isnan(off))
            distance.largest = off;
    }

    FieldTables<T> tables_;
    FieldTables<double> exact_;
    layout::Law<T> law_;
    layout::Law<double> exact_law_;
    brute::MeshReferee referee_;
    MeshBound bound_;
    bool exact_bits_;
    layout::uint channels_;
    std::uint64_t every_; // voxels: one in so many goes to the brute referee
};

} // namespace

template <typename T> void compare_mesh(Engine& engine, const PreparedCase& prepared, Comparison& result) {
    const MeshJudge<T> judge(prepared, engine.report().software);
    engine.evaluate(judge.input(), [&](const layout::FieldChunk<T>& chunk) {
        check_interrupt();
        compare_rows(judge, chunk, result);
    });
}

template void compare_mesh<float>(Engine&, const PreparedCase&, Comparison&);
template void compare_mesh<double>(Engine&, const PreparedCase&, Comparison&);

} // namespace forceshade

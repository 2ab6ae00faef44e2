#include "host/validate/mesh_judge.h"

#include <cmath>

#include "host/brute/mesh_referee.h"
#include "host/brute/referee.h"
#include "host/field/scene_mesh.h"
#include "host/interrupt.h"
#include "host/norm.h"
#include "host/validate/judged_rows.h"
#include "host/validate/mesh_bound.h"

namespace forceshade {
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
            const Voxel at{x, y, z};
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

    Point probe_at(Voxel at) const {
        return {double(tables_.x[at.x]), double(tables_.y[at.y]), double(tables_.z[at.z])};
    }

    // Where the bits must be the oracle's, nothing else is said of them. Returns the oracle's facet.
    layout::uint compare_with_alike(const layout::FieldChunk<T>& chunk, std::size_t sample, Voxel at,
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
    void compare_with_oracle(const Reading& computed, layout::uint facet, Voxel at, layout::uint& hint,
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
    void compare_with_brute(const Reading& computed, Voxel at, Comparison& partial) const {
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

#include "host/validate/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/interrupt.h"
#include "host/norm.h"
#include "host/validate/excuse.h"
#include "host/validate/held_scene.h"
#include "host/validate/judged_rows.h"
#include "host/validate/mesh_judge.h"

namespace forceshade {
namespace {

// Everything one case is compared with, and the tables that it takes.
template <typename T> class Judge {
public:
    Judge(const PreparedCase& prepared, bool exact_bits)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::everything)),
          exact_(make_tables<double>(prepared.one.scene, prepared.images, Extent::everything)),
          referee_(prepared.one.scene, prepared.images), held_(held_scene<T>(prepared.one.scene)),
          held_tables_(make_tables<double>(held_, prepared.images, Extent::what_varies)),
          held_referee_(held_, prepared.images),
          bound_(prepared, std::is_same_v<T, float> ? Precision::f32 : Precision::f64), exact_bits_(exact_bits),
          channels_(tables_.features.channels) {}

    const FieldTables<T>& tables() const { return tables_; }

    // Compares one row of a chunk; `partial` belongs to the calling thread.
    void compare_row(const layout::FieldChunk<T>& chunk, std::size_t row, Comparison& partial) const {
        const std::size_t z = chunk.z_first + row / chunk.y_count, y = chunk.y_first + row % chunk.y_count;
        for (std::size_t x = 0; x < chunk.x_count; ++x)
            compare_voxel(chunk, row * chunk.x_pitch + x, {x, y, z}, partial);
    }

    // The closed form's columns are dear where there are many facets: made once for each (x, y) of the rows to come.
    void prepare_columns(std::size_t y_first, std::size_t y_count) {
        const bool alike = !depends_on_y(tables_.features);
        if (alike && !columns_.empty())
            return;
        columns_y_ = y_first;
        columns_.clear();
        for (std::size_t y = 0; y < (alike ? 1 : y_count); ++y)
            for (const double x : exact_.x)
                columns_.push_back(referee_.column(x, exact_.y[y_first + y]));
        alike_ = alike;
    }

private:
    void compare_voxel(const layout::FieldChunk<T>& chunk, std::size_t sample, Voxel at, Comparison& partial) const {
        const T x = tables_.x[at.x], y = tables_.y[at.y], z = tables_.z[at.z];
        const reference::Contact<T> alike = reference::evaluate(tables_.law(), {x, y, z});
        const Reading computed = reading_of(chunk, sample);
        ++partial.voxels;
        if (!same_bits(chunk, sample, alike)) {
            count_difference(chunk, sample, alike, partial);
            compare_with_alike(computed, reading_of(alike), at, partial);
        }
        compare_with_oracle(computed, at, partial);
        compare_with_closed_form(computed, at, partial);
    }

    // Both sides round. Where the bits must be the oracle's, nothing else is said of them.
    void compare_with_alike(const Reading& computed, const Reading& alike, Voxel at, Comparison& partial) const {
        const Triple probe = probe_at(at);
        const Bound allowed = exact_bits_ ? Bound{} : 2 * bound_.at(probe[0], probe[1], probe[2]);
        const layout::uint misfit = first_misfit(computed, alike, allowed, channels_);
        if (!exact_bits_ && !misfit)
            return;
        if (!exact_bits_ && is_on_edge<T>(computed, probe, OracleReferee<T>{tables_.law()}, bound_, 2, channels_)) {
            ++partial.boundary;
            return;
        }
        ++partial.beyond;
        note_failure(partial, at, computed, alike, misfit, "the oracle in the same precision");
    }

    void compare_with_oracle(const Reading& computed, Voxel at, Comparison& partial) const {
        const OracleReferee<double> exact{exact_.law()}, held{held_tables_.law()};
        const auto column = exact.column(exact_.x[at.x], exact_.y[at.y]);
        judge(computed, at, exact.at(column, exact_.z[at.z]), exact, held, partial, partial.oracle,
              "the oracle in double precision");
    }

    void compare_with_closed_form(const Reading& computed, Voxel at, Comparison& partial) const {
        const ClosedFormReferee exact{referee_}, held{held_referee_};
        const brute::Column& column = columns_[(alike_ ? 0 : at.y - columns_y_) * exact_.x.size() + at.x];
        const Reading truth = exact.at(column, exact_.z[at.z]);
        partial.largest_force = std::max(partial.largest_force, norm(truth.force[0], truth.force[1], truth.force[2]));
        judge(computed, at, truth, exact, held, partial, partial.closed_form, "the closed form");
    }

    // A voxel beyond the bound is excused only if the referee gives it within a few ULP, for the scene as T holds it.
    template <typename Referee>
    void judge(const Reading& computed, Voxel at, const Reading& truth, const Referee& exact, const Referee& held,
               Comparison& partial, Distance& result, const char* who) const {
        const Triple probe = probe_at(at);
        const auto [x, y, z] = probe;
        const Bound allowed = bound_.at(x, y, z);
        const layout::uint misfit = first_misfit(computed, truth, allowed, channels_);
        // The error counts against the true position; the bound holds at the position that was rounded to T, which may
        // lie on the other side of an edge.
        const bool fits = !misfit || !first_misfit(computed, exact.at(exact.column(x, y), z), allowed, channels_);
        const bool on_edge =
            misfit && (fits ? jumps_between({exact_.x[at.x], exact_.y[at.y], exact_.z[at.z]}, probe,
                                            [&](const Triple& place) {
                                                return exact.at(exact.column(place[0], place[1]), place[2]).force;
                                            })
                            : is_on_edge<T>(computed, probe, held, bound_, 1, channels_));
        if (on_edge) {
            ++result.boundary;
            return;
        }
        const double off = force_error(computed, truth);
        if (off > result.largest || std::isnan(off))
            result.largest = off;
        if (fits)
            return;
        ++result.unexplained;
        note_failure(partial, at, computed, truth, misfit, who);
    }

    Triple probe_at(Voxel at) const {
        return {double(tables_.x[at.x]), double(tables_.y[at.y]), double(tables_.z[at.z])};
    }

    FieldTables<T> tables_;
    FieldTables<double> exact_;
    brute::Referee referee_;
    Scene held_;
    FieldTables<double> held_tables_;
    brute::Referee held_referee_;
    RoundingBound bound_;
    bool exact_bits_;
    layout::uint channels_;
    std::vector<brute::Column> columns_;
    std::size_t columns_y_ = 0;
    bool alike_ = false;
};

void merge(Distance& into, const Distance& from) {
    into.largest = std::isnan(from.largest) ? from.largest : std::max(into.largest, from.largest);
    into.boundary += from.boundary;
    into.unexplained += from.unexplained;
}

template <typename T> void compare(Engine& engine, const PreparedCase& prepared, Comparison& result) {
    if (prepared.images.mesh)
        return compare_mesh<T>(engine, prepared, result);
    Judge<T> judge(prepared, engine.report().software);
    engine.evaluate(judge.tables().input(), [&](const layout::FieldChunk<T>& chunk) {
        check_interrupt();
        judge.prepare_columns(chunk.y_first, chunk.y_count);
        compare_rows(judge, chunk, result);
    });
}

} // namespace

void merge(Comparison& into, const Comparison& from) {
    into.voxels += from.voxels;
    into.differing += from.differing;
    into.beyond += from.beyond;
    into.boundary += from.boundary;
    into.largest_ulp = std::max(into.largest_ulp, from.largest_ulp);
    into.largest_force = std::max(into.largest_force, from.largest_force);
    merge(into.oracle, from.oracle);
    merge(into.closed_form, from.closed_form);
    if (into.first_difference.empty())
        into.first_difference = from.first_difference;
}

Comparison compare_case(Engine& engine, const PreparedCase& prepared, Precision precision) {
    Comparison result;
    result.name = prepared.one.name;
    result.precision = precision;
    if (precision == Precision::f32)
        compare<float>(engine, prepared, result);
    else
        compare<double>(engine, prepared, result);
    result.passed = result.beyond == 0 && result.oracle.unexplained == 0 && result.closed_form.unexplained == 0;
    return result;
}

} // namespace forceshade

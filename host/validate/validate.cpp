#include "host/validate/validate.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "host/brute/referee.h"
#include "host/interrupt.h"
#include "host/norm.h"
#include "host/reference/contact.h"
#include "host/validate/force_bound.h"
#include "host/validate/held_scene.h"
#include "host/validate/ulp.h"

namespace forceshade {
namespace {

using Force = std::array<double, 3>;

double distance(const Force& a, const Force& b) {
    return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

template <typename T> Force to_force(const reference::Vector<T>& vector) {
    return {double(vector.x), double(vector.y), double(vector.z)};
}

// Everything one case is compared with, and the tables that it takes.
template <typename T> class Judge {
public:
    Judge(const PreparedCase& prepared, bool exact_bits)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::everything)),
          exact_(make_tables<double>(prepared.one.scene, prepared.images, Extent::everything)),
          referee_(prepared.one.scene, prepared.images), held_(held_scene<T>(prepared.one.scene)),
          held_tables_(make_tables<double>(held_, prepared.images, Extent::what_varies)),
          held_referee_(held_, prepared.images),
          bound_(prepared, static_cast<double>(std::numeric_limits<T>::epsilon()) / 2), exact_bits_(exact_bits) {}

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
    struct Voxel {
        std::size_t x, y, z;
    };

    bool same_bits(const layout::FieldChunk<T>& chunk, std::size_t sample, const reference::Contact<T>& contact) const {
        const auto same = [&](std::span<const T> channel, const reference::Vector<T>& value) {
            const T bits[3] = {value.x, value.y, value.z};
            return channel.empty() || std::memcmp(&channel[3 * sample], bits, sizeof(bits)) == 0;
        };
        return same(chunk.force, contact.force) && same(chunk.proxy, contact.proxy) &&
               same(chunk.unshaded, contact.unshaded) &&
               (chunk.depth.empty() || std::memcmp(&chunk.depth[sample], &contact.depth, sizeof(T)) == 0) &&
               (chunk.facet.empty() || chunk.facet[sample] == contact.facet);
    }

    void compare_voxel(const layout::FieldChunk<T>& chunk, std::size_t sample, Voxel at, Comparison& partial) const {
        const T x = tables_.x[at.x], y = tables_.y[at.y], z = tables_.z[at.z];
        const T* const computed = &chunk.force[3 * sample];
        const Force force{double(computed[0]), double(computed[1]), double(computed[2])};
        const reference::Contact<T> alike = reference::evaluate(tables_.law(), {x, y, z});
        ++partial.voxels;
        if (!same_bits(chunk, sample, alike)) {
            ++partial.differing;
            const T expected[3] = {alike.force.x, alike.force.y, alike.force.z};
            for (int i = 0; i < 3; ++i)
                partial.largest_ulp = std::max(partial.largest_ulp, ulp_distance(computed[i], expected[i]));
            const double off = distance(force, to_force(alike.force));
            if (exact_bits_ || !(off <= 2 * bound_.at(x, y, z))) {
                ++partial.beyond;
                note(partial, at, force, to_force(alike.force), "the oracle in the same precision");
            }
        }
        compare_with_oracle(force, at, partial);
        compare_with_closed_form(force, at, partial);
    }

    void compare_with_oracle(const Force& force, Voxel at, Comparison& partial) const {
        const auto of = [](const FieldTables<double>& tables) {
            return [&tables](double x, double y, double z) {
                return to_force(reference::evaluate(tables.law(), {x, y, z}).force);
            };
        };
        const Force truth = of(exact_)(exact_.x[at.x], exact_.y[at.y], exact_.z[at.z]);
        judge(force, at, truth, of(exact_), of(held_tables_), partial, partial.oracle,
              "the oracle in double precision");
    }

    void compare_with_closed_form(const Force& force, Voxel at, Comparison& partial) const {
        const auto to_double = [](const brute::Answer& answer) {
            return Force{double(answer.force[0]), double(answer.force[1]), double(answer.force[2])};
        };
        const auto of = [&](const brute::Referee& referee) {
            return [&](double x, double y, double z) { return to_double(referee.at(referee.column(x, y), z)); };
        };
        const brute::Column& column = columns_[(alike_ ? 0 : at.y - columns_y_) * exact_.x.size() + at.x];
        const Force truth = to_double(referee_.at(column, exact_.z[at.z]));
        partial.largest_force = std::max(partial.largest_force, norm(truth[0], truth[1], truth[2]));
        judge(force, at, truth, of(referee_), of(held_referee_), partial, partial.closed_form, "the closed form");
    }

    // A force beyond the bound is excused only if the referee gives it within a few ULP of the voxel, for the scene as
    // T holds it.
    template <typename Exact, typename Held>
    void judge(const Force& force, Voxel at, const Force& truth, const Exact& exact, const Held& held,
               Comparison& partial, Distance& result, const char* who) const {
        const double off = distance(force, truth);
        if (off > result.largest || std::isnan(off))
            result.largest = off;
        const double x = tables_.x[at.x], y = tables_.y[at.y], z = tables_.z[at.z];
        const double allowed = bound_.at(x, y, z);
        // The error counts against the true position; the bound holds at the position that was rounded to T.
        if (off <= allowed || distance(force, exact(x, y, z)) <= allowed)
            return;
        for (const int steps_x : {0, -1, 1, -2, 2, -4, 4})
            for (const int steps_y : {0, -2, 2})
                for (const int steps_z : {0, -2, 2}) {
                    const double near_x = stepped(tables_.x[at.x], steps_x), near_y = stepped(tables_.y[at.y], steps_y),
                                 near_z = stepped(tables_.z[at.z], steps_z);
                    if (distance(force, held(near_x, near_y, near_z)) <= allowed + bound_.at(near_x, near_y, near_z)) {
                        ++result.boundary;
                        return;
                    }
                }
        ++result.unexplained;
        note(partial, at, force, truth, who);
    }

    static double stepped(T value, int steps) {
        const T towards = steps < 0 ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::infinity();
        for (int i = 0; i < std::abs(steps); ++i)
            value = std::nextafter(value, towards);
        return static_cast<double>(value);
    }

    static void note(Comparison& partial, Voxel at, const Force& force, const Force& expected, const char* who) {
        if (partial.first_difference.empty())
            partial.first_difference =
                fmt::format("voxel ({}, {}, {}): ({}, {}, {}) N, {} says ({}, {}, {}) N", at.x, at.y, at.z, force[0],
                            force[1], force[2], who, expected[0], expected[1], expected[2]);
    }

    FieldTables<T> tables_;
    FieldTables<double> exact_;
    brute::Referee referee_;
    Scene held_;
    FieldTables<double> held_tables_;
    brute::Referee held_referee_;
    ForceBound bound_;
    bool exact_bits_;
    std::vector<brute::Column> columns_;
    std::size_t columns_y_ = 0;
    bool alike_ = false;
};

void merge(Distance& into, const Distance& from) {
    into.largest = std::isnan(from.largest) ? from.largest : std::max(into.largest, from.largest);
    into.boundary += from.boundary;
    into.unexplained += from.unexplained;
}

void merge(Comparison& into, const Comparison& from) {
    into.voxels += from.voxels;
    into.differing += from.differing;
    into.beyond += from.beyond;
    into.largest_ulp = std::max(into.largest_ulp, from.largest_ulp);
    into.largest_force = std::max(into.largest_force, from.largest_force);
    merge(into.oracle, from.oracle);
    merge(into.closed_form, from.closed_form);
    if (into.first_difference.empty())
        into.first_difference = from.first_difference;
}

template <typename T>
void compare_chunk(const Judge<T>& judge, const layout::FieldChunk<T>& chunk, Comparison& result) {
    const std::size_t rows = chunk.y_count * chunk.z_count;
    const std::size_t threads = std::min<std::size_t>(rows, std::max(1u, std::thread::hardware_concurrency()));
    std::vector<Comparison> partial(threads);
    std::vector<std::jthread> workers;
    for (std::size_t worker = 0; worker < threads; ++worker)
        workers.emplace_back([&, worker] {
            for (std::size_t row = worker * rows / threads; row < (worker + 1) * rows / threads; ++row)
                judge.compare_row(chunk, row, partial[worker]);
        });
    workers.clear();
    for (const Comparison& part : partial)
        merge(result, part);
}

template <typename T> void compare(Engine& engine, const PreparedCase& prepared, Comparison& result) {
    Judge<T> judge(prepared, engine.report().software);
    engine.evaluate(judge.tables().input(), [&](const layout::FieldChunk<T>& chunk) {
        check_interrupt();
        judge.prepare_columns(chunk.y_first, chunk.y_count);
        compare_chunk(judge, chunk, result);
    });
}

} // namespace

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

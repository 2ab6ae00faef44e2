#include "host/referee/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/norm.h"
#include "host/program.h"
#include "host/referee/mesh_judge.h"
#include "host/referee/reading.h"

namespace forceshade {

namespace {

// The nearest T. Volatile, because g++ 12 at -O2 turns two of these side by side into vectors and drops the rounding.
template <typename T> double held(double value) {
    const volatile T rounded = static_cast<T>(value);
    return static_cast<double>(rounded);
}

// Half of a length is what a kernel is given, and twice a T is exact.
template <typename T> void hold_extent(double& length) {
    length = 2 * held<T>(length / 2);
}

template <typename T> void hold_map(HeightMapSpec& map) {
    if (map.function == MapFunction::file) {
        hold_extent<T>(map.size[0]);
        hold_extent<T>(map.size[1]);
    }
    if (map.function == MapFunction::cylinder || map.function == MapFunction::dip) {
        hold_extent<T>(map.width);
        map.radius = held<T>(map.radius);
    }
}

} // namespace

template <typename T> Scene held_scene(const Scene& scene) {
    Scene result = scene;
    hold_extent<T>(result.surface.width);
    result.surface.radius = held<T>(scene.surface.radius);
    hold_map<T>(result.surface.map);
    if (result.texture)
        hold_map<T>(result.texture->map);
    return result;
}

template Scene held_scene<float>(const Scene&);
template Scene held_scene<double>(const Scene&);

namespace {

const char* precision_name(Precision precision) {
    return precision == Precision::f32 ? "f32" : "f64";
}

nlohmann::ordered_json to_json(const Comparison& one, const Distance& distance) {
    return {{"largest_error_N", distance.largest},
            {"relative_error", one.relative(distance)},
            {"boundary_voxels", distance.boundary},
            {"unexplained_voxels", distance.unexplained}};
}

} // namespace

Totals totals_of(const std::vector<Comparison>& comparisons) {
    Totals totals;
    for (const Comparison& one : comparisons) {
        totals.voxels += one.voxels;
        totals.differing += one.differing;
        totals.passed = totals.passed && one.passed;
    }
    return totals;
}

std::string comparison_table(const std::vector<Comparison>& comparisons) {
    std::size_t width = 4;
    for (const Comparison& one : comparisons)
        width = std::max(width, one.name.size());
    std::string text = fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "case",
                                   width, "", "voxels", "bits", "ULP", "max |F|", "against", "boundary", "against", "");
    text += fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "", width, "", "",
                        "differ", "", "N", "oracle f64", "voxels", "closed form", "");
    for (const Comparison& one : comparisons)
        text += fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11.4g}  {:>11.2e}  {:>8}  {:>11.2e}  {}\n",
                            one.name, width, precision_name(one.precision), one.voxels, one.differing, one.largest_ulp,
                            one.largest_force, one.relative(one.oracle),
                            one.boundary + one.oracle.boundary + one.closed_form.boundary,
                            one.relative(one.closed_form), one.passed ? "ok" : "FAILED: " + one.first_difference);
    return text + "errors are the largest |F - F_referee| over the largest |F|; boundary voxels are not among them: "
                  "rounding took them to the other side of an edge\n";
}

std::string comparison_json(const std::vector<Comparison>& comparisons, const EngineReport& engine) {
    nlohmann::ordered_json json;
    json["engine"] = {{"kind", engine.engine},
                      {"device", engine.device},
                      {"uuid", engine.uuid},
                      {"driver", engine.driver},
                      {"software", engine.software}};
    json["cases"] = nlohmann::ordered_json::array();
    for (const Comparison& one : comparisons)
        json["cases"].push_back({{"case", one.name},
                                 {"precision", precision_name(one.precision)},
                                 {"voxels", one.voxels},
                                 {"differing", one.differing},
                                 {"largest_ulp", one.largest_ulp},
                                 {"beyond_bound", one.beyond},
                                 {"boundary_voxels", one.boundary},
                                 {"largest_force_N", one.largest_force},
                                 {"oracle_f64", to_json(one, one.oracle)},
                                 {"closed_form", to_json(one, one.closed_form)},
                                 {"passed", one.passed},
                                 {"first_difference", one.first_difference}});
    const Totals totals = totals_of(comparisons);
    json["voxels"] = totals.voxels;
    json["differing"] = totals.differing;
    json["passed"] = totals.passed;
    return json.dump(2);
}

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
    void compare_voxel(const layout::FieldChunk<T>& chunk, std::size_t sample, VoxelIndex at,
                       Comparison& partial) const {
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
    void compare_with_alike(const Reading& computed, const Reading& alike, VoxelIndex at, Comparison& partial) const {
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

    void compare_with_oracle(const Reading& computed, VoxelIndex at, Comparison& partial) const {
        const OracleReferee<double> exact{exact_.law()}, held{held_tables_.law()};
        const auto column = exact.column(exact_.x[at.x], exact_.y[at.y]);
        judge(computed, at, exact.at(column, exact_.z[at.z]), exact, held, partial, partial.oracle,
              "the oracle in double precision");
    }

    void compare_with_closed_form(const Reading& computed, VoxelIndex at, Comparison& partial) const {
        const ClosedFormReferee exact{referee_}, held{held_referee_};
        const brute::Column& column = columns_[(alike_ ? 0 : at.y - columns_y_) * exact_.x.size() + at.x];
        const Reading truth = exact.at(column, exact_.z[at.z]);
        partial.largest_force = std::max(partial.largest_force, norm(truth.force[0], truth.force[1], truth.force[2]));
        judge(computed, at, truth, exact, held, partial, partial.closed_form, "the closed form");
    }

    // A voxel beyond the bound is excused only if the referee gives it within a few ULP, for the scene as T holds it.
    template <typename Referee>
    void judge(const Reading& computed, VoxelIndex at, const Reading& truth, const Referee& exact, const Referee& held,
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

    Triple probe_at(VoxelIndex at) const {
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

#include "host/referee/validate.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/field/case_law.h"
#include "host/norm.h"
#include "host/program.h"
#include "host/referee/rounding_bound.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_contact.h"
#include "host/threads.h"

namespace forceshade {

namespace {

// The nearest T. Volatile, because g++ 12 at -O2 turns two of these side by side into vectors and drops the rounding.
template <typename T> double rounded_to(double value) {
    const volatile T result = static_cast<T>(value);
    return static_cast<double>(result);
}

// Half of a length is what a kernel is given, and twice a T is exact.
template <typename T> void round_extent(double& length) {
    length = 2 * rounded_to<T>(length / 2);
}

template <typename T> void round_map(HeightMapSpec& map) {
    if (map.function == MapFunction::file) {
        round_extent<T>(map.size[0]);
        round_extent<T>(map.size[1]);
    }
    if (map.function == MapFunction::cylinder || map.function == MapFunction::dip) {
        round_extent<T>(map.width);
        map.radius = rounded_to<T>(map.radius);
    }
}

} // namespace

template <typename T> Scene rounded_scene(const Scene& scene) {
    Scene result = scene;
    round_extent<T>(result.surface.width);
    result.surface.radius = rounded_to<T>(scene.surface.radius);
    round_map<T>(result.surface.map);
    if (result.texture)
        round_map<T>(result.texture->map);
    return result;
}

template Scene rounded_scene<float>(const Scene&);
template Scene rounded_scene<double>(const Scene&);

namespace {

nlohmann::ordered_json to_json(const Comparison& one, const Distance& distance) {
    return {{"largest_error_N", distance.largest},
            {"relative_error", one.relative(distance)},
            {"boundary_voxels", distance.boundary},
            {"unexplained_voxels", distance.unexplained}};
}

} // namespace

std::string comparison_table(const std::vector<Comparison>& comparisons) {
    std::size_t width = 4;
    for (const Comparison& one : comparisons)
        width = std::max(width, one.name.size());
    std::string text = fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "case",
                                   width, "", "voxels", "bits", "ULP", "max |F|", "against", "boundary", "against", "");
    text += fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "", width, "", "",
                        "differ", "", "N", "oracle f64", "voxels", "closed form", "");
    for (const Comparison& one : comparisons)
        text +=
            fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11.4g}  {:>11.2e}  {:>8}  {:>11.2e}  {}\n", one.name,
                        width, name_of(one.precision), one.voxels, one.differing, one.largest_ulp, one.largest_force,
                        one.relative(one.oracle), one.boundary + one.oracle.boundary + one.closed_form.boundary,
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
                                 {"precision", name_of(one.precision)},
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
    json["voxels"] = totals.compared;
    json["differing"] = totals.differing;
    json["passed"] = totals.passed;
    return json.dump(2);
}

namespace {

struct VoxelIndex {
    std::size_t x, y, z;
};

template <typename T> glm::dvec3 probe_at(const CaseLaw<T>& law, VoxelIndex at) {
    return glm::dvec3(law.voxel(at.x, at.y, at.z));
}

// What a referee says of a computed voxel.
struct Finding {
    Verdict verdict;
    Reading truth;
    layout::uint channel = layout::kChannelForce; /* that is beyond the bound */
};

// Triangles near which the next search for the nearest one begins.
struct Hints {
    layout::uint same = 0, exact = 0;
};

// What is remembered along a row of voxels.
struct RowMemory {
    std::optional<glm::dvec3> proxy;  /* m: of the last voxel, if it was in contact */
    unsigned jumps = 0, features = 0; /* voxels of each kind that the brute referee looked at */
};

// Everything a case of an analytic surface is compared with, and the tables that it takes.
template <typename T> class SurfaceReferees {
public:
    static constexpr bool kOracleGivesForce = false; // the closed form does
    static constexpr const char* kClosedForm = "the closed form";

    explicit SurfaceReferees(const PreparedCase& prepared)
        : law_(prepared, Extent::everything), exact_law_(prepared, Extent::everything),
          referee_(prepared.one.scene, prepared.images), rounded_(rounded_scene<T>(prepared.one.scene)),
          rounded_tables_(make_tables<double>(rounded_, prepared.images, Extent::what_varies)),
          rounded_referee_(rounded_, prepared.images), bound_(prepared, kPrecisionOf<T>) {}

    const FieldTables<T>& tables() const { return law_.tables(); }

    // The closed form's columns are dear where there are many facets: made once for each (x, y) of the rows to come.
    void begin_rows(std::size_t y_first, std::size_t y_count) {
        const bool extruded = !depends_on_y(tables().features);
        if (extruded && !columns_.empty())
            return;
        columns_y_ = y_first;
        columns_.clear();
        for (std::size_t y = 0; y < (extruded ? 1 : y_count); ++y)
            for (const double x : exact_grid().x)
                columns_.push_back(referee_.column(x, exact_grid().y[y_first + y]));
        extruded_ = extruded;
    }

    const CaseLaw<T>& law() const { return law_; }

    // Both sides round.
    Finding against_same_precision(const Reading& computed, const Reading& expected, VoxelIndex at) const {
        const glm::dvec3 probe = probe_at(law_, at);
        const Bound allowed = 2 * bound_.at(probe.x, probe.y, probe.z);
        const layout::uint misfit = first_misfit(computed, expected, allowed, channels());
        if (!misfit)
            return {Verdict::within, expected};
        const OracleReferee<T> oracle{law_.law()};
        return {is_on_edge<T>(computed, probe, oracle, bound_, 2, channels()) ? Verdict::on_edge : Verdict::beyond,
                expected, misfit};
    }

    Finding against_oracle(const Reading& computed, layout::uint, VoxelIndex at, Hints&) const {
        const OracleReferee<double> exact{exact_law_.law()}, rounded{rounded_tables_.law()};
        return against(computed, at, exact.column(exact_grid().x[at.x], exact_grid().y[at.y]), exact, rounded);
    }

    std::optional<Finding> against_closed_form(const Reading& computed, const Reading&, VoxelIndex at,
                                               RowMemory&) const {
        const ClosedFormReferee exact{referee_}, rounded{rounded_referee_};
        const std::size_t row = extruded_ ? 0 : at.y - columns_y_;
        return against(computed, at, columns_[row * exact_grid().x.size() + at.x], exact, rounded);
    }

private:
    const FieldTables<double>& exact_grid() const { return exact_law_.tables(); }
    layout::uint channels() const { return tables().features.channels; }

    // A voxel beyond the bound is excused only if the referee gives it within a few ULP, for the scene as T holds it.
    template <typename Referee, typename Column>
    Finding against(const Reading& computed, VoxelIndex at, const Column& column, const Referee& exact,
                    const Referee& rounded) const {
        const glm::dvec3 probe = probe_at(law_, at);
        const double x = probe.x, y = probe.y, z = probe.z;
        const Reading truth = exact.at(column, exact_grid().z[at.z]);
        const Bound allowed = bound_.at(x, y, z);
        const layout::uint misfit = first_misfit(computed, truth, allowed, channels());
        if (!misfit)
            return {Verdict::within, truth};
        // The error counts against the true position; the bound holds at the position that was rounded to T, which may
        // lie on the other side of an edge.
        const bool fits = !first_misfit(computed, exact.at(exact.column(x, y), z), allowed, channels());
        const auto force_at = [&](const glm::dvec3& place) {
            return exact.at(exact.column(place.x, place.y), place.z).force;
        };
        const bool on_edge = fits ? jumps_between(probe_at(exact_law_, at), probe, force_at)
                                  : is_on_edge<T>(computed, probe, rounded, bound_, 1, channels());
        return {on_edge ? Verdict::on_edge : fits ? Verdict::within : Verdict::beyond, truth, misfit};
    }

    CaseLaw<T> law_;
    CaseLaw<double> exact_law_;
    brute::Referee referee_;
    Scene rounded_;
    FieldTables<double> rounded_tables_;
    brute::Referee rounded_referee_;
    RoundingBound bound_;
    std::vector<brute::Column> columns_;
    std::size_t columns_y_ = 0;
    bool extruded_ = false;
};

constexpr double kDoubleRoundoff = 0x1p-53;
constexpr std::uint64_t kBruteBudget = 20'000'000; // triangles that the brute referee may look at: some seconds
constexpr unsigned kChosenOfRow = 2;               // voxels of a kind that it looks at in a row, at most
constexpr std::uint64_t kChosenRows = 1024;        // rows in which it does, at most

// The scene as plain loops see it. The case must outlive the law.
brute::MeshLaw brute_law(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    brute::MeshLaw law;
    law.stiffness = scene.force.stiffness;
    law.shading = scene.force.shading;
    law.inside = scene.surface.mesh.inside;
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

// The same for a mesh. The closed form's place takes the brute referee, which loops over all triangles: on evenly
// chosen voxels; and where a wrong facet is most likely, which are voxels next to the medial axis and those whose
// nearest place is on an edge or a corner. Their number keeps the loops within some seconds.
template <typename T> class MeshReferees {
public:
    static constexpr bool kOracleGivesForce = true;
    static constexpr const char* kClosedForm = "a loop over all triangles";

    explicit MeshReferees(const PreparedCase& prepared)
        : law_(prepared, Extent::everything), exact_law_(prepared, Extent::everything),
          referee_(prepared.images.mesh->mesh, brute_law(prepared)), bound_(prepared, kPrecisionOf<T>),
          centre_(prepared.images.mesh->structure.centre), channels_(tables().features.channels) {
        const std::uint64_t rows = std::uint64_t(tables().y.size()) * tables().z.size();
        const std::uint64_t voxels = tables().x.size() * rows;
        const std::uint64_t affordable = std::max<std::uint64_t>(1, kBruteBudget / law_.law().mesh.params.triangles);
        every_ = std::max<std::uint64_t>(1, voxels / affordable);
        row_every_ = rows / std::clamp<std::uint64_t>(affordable / (4 * kChosenOfRow), 1, kChosenRows) + 1;
    }

    const FieldTables<T>& tables() const { return law_.tables(); }
    void begin_rows(std::size_t, std::size_t) {}

    const CaseLaw<T>& law() const { return law_; }

    Finding against_same_precision(const Reading& computed, const Reading& expected, VoxelIndex at) const {
        return {bound_.compare(computed, probe_at(law_, at), 1, channels_), expected,
                first_misfit(computed, expected, {}, channels_)};
    }

    // The error counts against the true position; the bound holds at the position that was rounded to T. Where rounding
    // chose another facet, the difference is not an error.
    Finding against_oracle(const Reading& computed, layout::uint facet, VoxelIndex at, Hints& hints) const {
        const Reading truth = reading_of(exact_law_.at_rounded(probe_at(exact_law_, at), hints.exact));
        const Point probe = probe_at(law_, at);
        Verdict verdict = bound_.compare(computed, probe, 1, channels_);
        if (verdict == Verdict::within &&
            (facet != truth.facet || bound_.is_ambiguous(computed.force, probe, truth.force)))
            verdict = Verdict::on_edge;
        return {verdict, truth};
    }

    // Where rounding decides which facet is the nearest, the answer may be that of any of them.
    std::optional<Finding> against_closed_form(const Reading& computed, const Reading& same, VoxelIndex at,
                                               RowMemory& row) const {
        const std::size_t number = at.z * tables().y.size() + at.y;
        const bool critical = number % row_every_ == 0 && is_critical(same, at, row);
        if ((number * tables().x.size() + at.x) % every_ != 0 && !critical)
            return std::nullopt;
        const Point probe = probe_at(law_, at);
        const Reading truth = from_origin(referee_.at(world_of(probe)));
        if (fits_brute(computed, truth, probe))
            return Finding{Verdict::within, truth};
        const double tolerance = 2 * sides_of(probe) * bound_.reach(probe) * frame().scale; /* m */
        for (const brute::Answer& answer : referee_.all_at(world_of(probe), tolerance))
            if (fits_brute(computed, from_origin(answer), probe))
                return Finding{Verdict::on_edge, truth};
        return Finding{Verdict::beyond, truth};
    }

private:
    using Point = reference::Vector<double>;

    const layout::MeshParams<double>& frame() const { return exact_law_.law().mesh.params; }

    // Whether the proxy jumped from one side to another since the last voxel of the row, as it does across the medial
    // axis, or is on an edge or a corner; of either the first ones of the row.
    bool is_critical(const Reading& same, VoxelIndex at, RowMemory& row) const {
        const bool touching = same.depth > 0;
        const std::optional<glm::dvec3> last =
            std::exchange(row.proxy, touching ? std::optional(same.proxy) : std::nullopt);
        if (!touching || at.x == 0)
            return false;
        const double step = (exact_law_.tables().x[at.x] - exact_law_.tables().x[at.x - 1]) * frame().scale;
        if (last && norm(same.proxy - *last) > 2 * step)
            return row.jumps++ < kChosenOfRow;
        return row.features < kChosenOfRow &&
               reference::nearest(exact_law_.law().mesh, probe_at(law_, at)).feature != layout::kMeshFace &&
               row.features++ < kChosenOfRow;
    }

    bool fits_brute(const Reading& computed, const Reading& truth, const Point& probe) const {
        const Point proxy = reference::to_mesh_frame(frame(), Point(truth.proxy));
        const bool touching = truth.depth > 0;
        const reference::MeshTouch<double> touch{touching ? truth.facet : 0, Point(proxy - probe), proxy,
                                                 truth.depth / frame().scale};
        Bound allowed = sides_of(probe) * bound_.at(probe, touch);
        if (!touching)
            allowed = {0, 0, 0, 0, allowed.proxy};
        return !first_misfit(computed, truth, allowed, channels_);
    }

    // One, and more for the rounding of the probe's place in the world.
    double sides_of(const Point& probe) const {
        const double placed = 2 * kDoubleRoundoff * norm(centre_) / frame().scale;
        return 1 + placed / bound_.reach(probe);
    }

    glm::dvec3 world_of(const Point& probe) const { return probe * frame().scale + centre_; }

    // The brute referee's proxies are of the world, those of engines from the scene's origin.
    Reading from_origin(const brute::Answer& answer) const {
        Reading reading = reading_of(answer);
        reading.proxy -= exact_law_.origin();
        return reading;
    }

    CaseLaw<T> law_;
    CaseLaw<double> exact_law_;
    brute::MeshReferee referee_;
    MeshBound bound_;
    glm::dvec3 centre_; /* m, in the world: of the mesh's frame */
    layout::uint channels_;
    std::uint64_t every_;     // voxels: every n-th goes to the brute referee
    std::uint64_t row_every_; // rows: in every n-th, critical voxels do
};

// True if every channel of the sample equals the contact's bit for bit.
template <typename T>
bool same_bits(const layout::FieldChunk<T>& chunk, std::size_t sample, const reference::Contact<T>& contact) {
    const auto same = [&](std::span<const T> channel, const reference::Vector<T>& value) {
        const T bits[3] = {value.x, value.y, value.z};
        return channel.empty() || std::memcmp(&channel[3 * sample], bits, sizeof(bits)) == 0;
    };
    return same(chunk.force, contact.force) && same(chunk.proxy, contact.proxy) &&
           same(chunk.unshaded, contact.unshaded) &&
           (chunk.depth.empty() || std::memcmp(&chunk.depth[sample], &contact.depth, sizeof(T)) == 0) &&
           (chunk.facet.empty() || chunk.facet[sample] == contact.facet);
}

void merge(Distance& into, const Distance& from) {
    into.largest = std::isnan(from.largest) ? from.largest : std::max(into.largest, from.largest);
    into.boundary += from.boundary;
    into.unexplained += from.unexplained;
}

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

// Some voxels compared with all referees of a case; one for each thread.
template <typename T, typename Referees> struct VoxelComparison {
    const Referees& referees;
    bool exact_bits;
    Comparison result;

    void compare_row(const layout::FieldChunk<T>& chunk, std::size_t row) {
        const std::size_t z = chunk.z_first + row / chunk.y_count, y = chunk.y_first + row % chunk.y_count;
        Hints hints;
        RowMemory memory;
        for (std::size_t x = 0; x < chunk.x_count; ++x)
            compare_voxel(chunk, row * chunk.x_pitch + x, {x, y, z}, hints, memory);
    }

private:
    void compare_voxel(const layout::FieldChunk<T>& chunk, std::size_t sample, VoxelIndex at, Hints& hints,
                       RowMemory& memory) {
        const reference::Contact<T> same =
            referees.law().at_rounded(referees.law().voxel(at.x, at.y, at.z), hints.same);
        const Reading computed = reading_of(chunk, sample);
        ++result.voxels;
        if (!same_bits(chunk, sample, same))
            compare_with_same_precision(chunk, sample, computed, same, at);
        const Finding oracle = referees.against_oracle(computed, same.facet, at, hints);
        add(oracle, computed, at, result.oracle, "the oracle in double precision");
        const std::optional<Finding> closed_form = referees.against_closed_form(computed, reading_of(same), at, memory);
        if (closed_form)
            add(*closed_form, computed, at, result.closed_form, Referees::kClosedForm);
        const Finding& source = Referees::kOracleGivesForce ? oracle : *closed_form;
        result.largest_force = std::max(result.largest_force, norm(source.truth.force));
    }

    // Where the bits must be the oracle's, no other check is made.
    void compare_with_same_precision(const layout::FieldChunk<T>& chunk, std::size_t sample, const Reading& computed,
                                     const reference::Contact<T>& same, VoxelIndex at) {
        ++result.differing;
        const T force[3] = {same.force.x, same.force.y, same.force.z};
        for (std::size_t i = 0; i < 3; ++i)
            result.largest_ulp = std::max(result.largest_ulp, ulp_distance(chunk.force[3 * sample + i], force[i]));
        const Reading expected = reading_of(same);
        const layout::uint channels = referees.tables().features.channels;
        const Finding finding = exact_bits
                                    ? Finding{Verdict::beyond, expected, first_misfit(computed, expected, {}, channels)}
                                    : referees.against_same_precision(computed, expected, at);
        result.boundary += finding.verdict == Verdict::on_edge;
        if (finding.verdict != Verdict::beyond)
            return;
        ++result.beyond;
        note_failure(finding, computed, at, "the oracle in the same precision");
    }

    void add(const Finding& finding, const Reading& computed, VoxelIndex at, Distance& distance, const char* who) {
        if (finding.verdict == Verdict::on_edge) {
            ++distance.boundary;
            return;
        }
        const double off = norm(computed.force - finding.truth.force);
        if (off > distance.largest || std::isnan(off))
            distance.largest = off;
        if (finding.verdict == Verdict::within)
            return;
        ++distance.unexplained;
        note_failure(finding, computed, at, who);
    }

    // Keeps the first failure in words.
    void note_failure(const Finding& finding, const Reading& computed, VoxelIndex at, const char* who) {
        if (result.first_difference.empty())
            result.first_difference =
                fmt::format("voxel ({}, {}, {}): {}, {} says {}", at.x, at.y, at.z, describe(computed, finding.channel),
                            who, describe(finding.truth, finding.channel));
    }
};

// A chunk's rows are shared out among all cores.
template <typename T, typename Referees>
void compare(Engine& engine, const PreparedCase& prepared, Comparison& result) {
    Referees referees(prepared);
    const bool exact_bits = engine.report().software;
    engine.evaluate(referees.tables().input(), [&](const layout::FieldChunk<T>& chunk) {
        check_interrupt();
        referees.begin_rows(chunk.y_first, chunk.y_count);
        const std::size_t rows = chunk.y_count * chunk.z_count;
        const std::size_t threads = std::min<std::size_t>(rows, most_threads());
        std::vector<VoxelComparison<T, Referees>> parts(threads, {referees, exact_bits, {}});
        reference::share_out(threads, threads, [&](std::size_t, std::size_t part) {
            for (std::size_t row = part * rows / threads; row < (part + 1) * rows / threads; ++row)
                parts[part].compare_row(chunk, row);
        });
        for (const auto& part : parts)
            merge(result, part.result);
    });
}

} // namespace

Comparison compare_case(Engine& engine, const PreparedCase& prepared, Precision precision) {
    Comparison result;
    result.name = prepared.one.name;
    result.precision = precision;
    in_precision(precision, [&]<typename T>(std::type_identity<T>) {
        prepared.images.mesh ? compare<T, MeshReferees<T>>(engine, prepared, result)
                             : compare<T, SurfaceReferees<T>>(engine, prepared, result);
    });
    result.passed = result.beyond == 0 && result.oracle.unexplained == 0 && result.closed_form.unexplained == 0;
    return result;
}

} // namespace forceshade

#include "host/study/energy/loop_case.h"

#include <algorithm>
#include <cmath>

#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/study/energy/loop_paths.h"
#include "host/study/energy/scenes.h"
#include "host/study/error_time/angle.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMilli = 1e-3;

struct DirectionErrors {
    double squares = 0, weight = 0, largest = 0; /* rad^2 m, m, rad */
    double rms() const { return weight > 0 ? std::sqrt(squares / weight) : 0; }
};

/// Where the piece that `piece_at` names changes over shares (0, 1) of a way, to the last bit of a share. A piece
/// shorter than the 512th part of the way is missed where one other piece lies on both sides of it.
template <typename PieceAt> std::vector<double> changes(const PieceAt& piece_at) {
    constexpr int kSamples = 512;
    std::vector<double> shares;
    layout::uint before = piece_at(0.0);
    for (int i = 1; i <= kSamples; ++i) {
        double from = (i - 1.0) / kSamples;
        const double to = static_cast<double>(i) / kSamples;
        for (const layout::uint now = piece_at(to); before != now; before = piece_at(from)) {
            double low = from, high = to;
            while (low < (low + high) / 2 && (low + high) / 2 < high) {
                const double middle = (low + high) / 2;
                (piece_at(middle) == before ? low : high) = middle;
            }
            shares.push_back(high);
            from = high;
        }
    }
    return shares;
}

/// The section cut where a probe at this depth comes to another piece, whose force may jump or bend there.
Section cut_section(const Section& section, const PlacedLaw& law, double depth) {
    Section cut = section;
    cut.breaks.clear();
    for (std::size_t arc = 0; arc + 1 < section.breaks.size(); ++arc) {
        const double left = section.breaks[arc], right = section.breaks[arc + 1];
        cut.breaks.push_back(left);
        const auto x_at = [&](double share) { return std::lerp(left, right, share); };
        for (const double share : changes([&](double at) { return law.piece(section.below(x_at(at), depth)); }))
            cut.breaks.push_back(x_at(share));
    }
    cut.breaks.push_back(section.breaks.back());
    return cut;
}

/// Along a straight line, cut likewise.
Work cut_work(const ForceAt& force, const PlacedLaw& law, const Vector& from, const Vector& to, Pieces pieces) {
    const auto place = [&](double share) { return from + share * (to - from); };
    Work sum;
    double before = 0;
    std::vector<double> shares = changes([&](double share) { return law.piece(place(share)); });
    shares.push_back(1);
    for (const double share : shares) {
        sum += work_along(force, place(before), place(share), pieces);
        before = share;
    }
    return sum;
}

/// As work_round, cut where pieces change.
Work cut_round(const LoopCase& one, const PlacedLaw& law, const Section& section) {
    const ForceAt force = [&](const Vector& place) { return law(place).force; };
    const double first = section.breaks.front(), last = section.breaks.back();
    Work sum = work_leg(force, cut_section(section, law, one.out), one.out, false, one.pieces);
    sum += cut_work(force, law, section.below(last, one.out), section.below(last, one.back), one.pieces);
    sum += work_leg(force, cut_section(section, law, one.back), one.back, true, one.pieces);
    sum += cut_work(force, law, section.below(first, one.back), section.below(first, one.out), one.pieces);
    return sum;
}

/// Along both legs: of the force against the smooth shape's normal above the place of contact.
DirectionErrors direction_errors(const LoopCase& one, const PlacedLaw& law) {
    DirectionErrors errors;
    for (const Section& section : one.sections)
        for (const double depth : {one.out, one.back})
            over_leg(cut_section(section, law, depth), depth, one.pieces, [&](const Vector& place, double weight) {
                const reference::Contact<double> contact = law(place);
                if (contact.facet == layout::kNoFacet || !(reference::dot(contact.force, contact.force) > 0))
                    return;
                const double error = angle_between(contact.force, one.smooth(contact.proxy.x, contact.proxy.y));
                errors.squares += weight * error * error;
                errors.weight += weight;
                errors.largest = std::max(errors.largest, error);
            });
    return errors;
}

std::vector<LoopPlaces> both_ways(const LoopCase& one) {
    std::vector<LoopPlaces> loops;
    for (const Section& section : one.sections) {
        loops.push_back(loop_places(section, one.out, one.back, one.steps));
        loops.emplace_back(loops.back().rbegin(), loops.back().rend());
    }
    return loops;
}

/// The mean over the sections of the work one way about and the other, and of the effort one way.
struct BothWays {
    double forth = 0, back = 0, effort = 0; /* J */
    unsigned unfinished = 0;
    double most() const { return std::max(forth, back); }
};

BothWays mean_of(const std::vector<PathWork>& works) {
    BothWays mean;
    const double share = 2.0 / static_cast<double>(works.size());
    for (std::size_t i = 0; i < works.size(); i += 2) {
        mean.forth += share * works[i].work.work;
        mean.back += share * works[i + 1].work.work;
        mean.effort += share * 0.5 * (works[i].work.effort + works[i + 1].work.effort);
        mean.unfinished += works[i].unfinished + works[i + 1].unfinished;
    }
    return mean;
}

BothWays static_work(const LoopCase& one, const PlacedLaw& law) {
    BothWays mean;
    for (const Section& section : one.sections) {
        const Work work = cut_round(one, law, section);
        const double share = 1.0 / static_cast<double>(one.sections.size());
        mean.forth += share * work.work;
        mean.effort += share * work.effort;
    }
    mean.back = -mean.forth;
    return mean;
}

} // namespace

PlacedLaw::PlacedLaw(const PreparedCase& prepared)
    : tables_(make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

reference::Contact<double> PlacedLaw::operator()(const Vector& place) const {
    if (law_.features.surface == layout::kSurfaceMesh)
        return reference::evaluate(law_, reference::to_mesh_frame(law_.mesh.params, place));
    return reference::evaluate(law_, place);
}

layout::uint PlacedLaw::piece(const Vector& place) const {
    const layout::uint facet = (*this)(place).facet;
    if (law_.features.surface != layout::kSurfaceCylinderBump || facet == layout::kNoFacet)
        return facet;
    const layout::LawParams<double>& params = law_.params;
    const double power = (params.half_width - place.x) * (params.half_width + place.x) -
                         place.z * (place.z + 2 * params.centre_depth); // R^2 - r^2, m^2
    return 4 * facet + (place.z < 0 ? 2 : 0) + (power > 0 ? 1 : 0);
}

Json loop_row(const LoopCase& one, Engine& engine) {
    const PlacedLaw law(one.prepared);
    const bool on_mesh = law.law().features.surface == layout::kSurfaceMesh;
    const bool by_samples = on_mesh && !one.god_object; // the engine's paths on meshes are the god-object's
    const std::vector<LoopPlaces> loops = by_samples ? std::vector<LoopPlaces>() : both_ways(one);
    const BothWays found = one.god_object ? mean_of(oracle_work(one.prepared, loops)) : static_work(one, law);
    Json row{{"surface", one.surface},
             {"scheme", one.scheme},
             {"loop", one.loop},
             {"facets", one.facets ? Json(one.facets) : Json()}};
    row["radius_mil"] = one.radius_mil > 0 ? Json(one.radius_mil) : Json();
    row["stiffness_N_per_m"] = one.prepared.one.scene.force.stiffness;
    row["out_mm"] = one.out / kMilli;
    row["back_mm"] = one.back / kMilli;
    row["work_mJ"] = found.forth / kMilli;
    row["work_back_mJ"] = found.back / kMilli;
    row["gained_mJ"] = found.most() / kMilli;
    row["effort_mJ"] = found.effort / kMilli;
    row["eta"] = found.most() / found.effort;
    if (one.closed_form) {
        row["closed_form_mJ"] = *one.closed_form / kMilli;
        row["closed_form_difference"] = std::abs(found.forth - *one.closed_form) / found.effort;
    }
    if (!by_samples) {
        const BothWays computed = mean_of(engine_work(engine, one.prepared, loops));
        row["engine_work_mJ"] = computed.forth / kMilli;
        row["engine_difference"] = std::abs(computed.forth - found.forth) / found.effort;
        row["unfinished_samples"] = computed.unfinished;
    }
    if (one.smooth) {
        const DirectionErrors errors = direction_errors(one, law);
        row["direction_rms_deg"] = errors.rms() / kDegree;
        row["direction_largest_deg"] = errors.largest / kDegree;
    }
    return row;
}

} // namespace forceshade::study

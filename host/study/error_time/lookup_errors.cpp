#include "host/study/error_time/lookup_errors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/reference/elementary.h"
#include "host/study/error_time/angle.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/lookup_volume.h"

namespace forceshade::study::error_time {
namespace {

using Vector = reference::Vector<double>;
using Volume = ForceVolume<double, double>;

constexpr double kFeeble = 1e-3; // of the root mean square force: below it a direction means little
constexpr std::size_t kShifts =
    5; // volumes, moved against each other: an edge lies now here, now there between samples
constexpr std::size_t kTries = 1000; // places drawn for each that is kept

enum Place : std::size_t { smooth, edge, boundary };
constexpr std::array<const char*, 3> kPlaces{"smooth", "edge", "boundary"};
constexpr std::array<const char*, 2> kMethods{"trilinear", "tricubic"};

struct Truth {
    std::vector<glm::dvec3> at;  /* m */
    std::vector<Vector> force;   /* N */
    std::vector<bool> is_smooth; /* one facet all round */
    double typical = 0;          /* N: root mean square */
};

// Whether one facet is touched all round a place, twice the coarsest spacing away: so far a tricubic reading looks. The
// places of a smooth part are so the same for every spacing.
bool is_smooth(const LookupCase& one, DirectLaw<double>& law, const glm::dvec3& at) {
    std::vector<glm::dvec3> around;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                around.push_back(at + 2 * one.coarsest * glm::dvec3(x, y, z));
    const auto places = places_of<double>(*one.prepared, around);
    const layout::uint facet = law.at(places.front()).facet;
    return facet != layout::kNoFacet &&
           std::ranges::all_of(places, [&](const Vector& place) { return law.at(place).facet == facet; });
}

Truth truth_of(const LookupCase& one, std::size_t count) {
    DirectLaw<double> law(*one.prepared);
    Draw draw(4);
    Truth truth;
    double squares = 0;
    for (std::size_t tries = 0; truth.at.size() < count && tries < kTries * count; ++tries) {
        const double x = draw(one.low.x, one.high.x), y = draw(one.low.y, one.high.y);
        const glm::dvec3 at(x, y, draw(one.low.z, one.high.z));
        const auto contact = law.at(places_of<double>(*one.prepared, std::span(&at, 1))[0]);
        if (contact.facet == layout::kNoFacet || contact.depth > one.deepest)
            continue;
        truth.at.push_back(at);
        truth.force.push_back(contact.force);
        truth.is_smooth.push_back(is_smooth(one, law, at));
        squares += reference::dot(contact.force, contact.force);
    }
    truth.typical = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, truth.at.size())));
    return truth;
}

// Of the samples that a reading takes: `reach` below the place and reach + 1 above it.
Place samples_of(const VolumeGrid& grid, const std::vector<layout::uint>& facets,
                 const std::array<std::size_t, 3>& below, std::size_t reach) {
    const auto facet_at = [&](std::size_t x, std::size_t y, std::size_t z) {
        return facets[(z * grid.size[1] + y) * grid.size[0] + x];
    };
    const layout::uint first = facet_at(below[0], below[1], below[2]);
    Place place = smooth;
    for (std::size_t z = below[2] - reach; z <= below[2] + 1 + reach; ++z)
        for (std::size_t y = below[1] - reach; y <= below[1] + 1 + reach; ++y)
            for (std::size_t x = below[0] - reach; x <= below[0] + 1 + reach; ++x) {
                const layout::uint facet = facet_at(x, y, z);
                if (facet == layout::kNoFacet)
                    return boundary;
                place = facet == first ? place : edge;
            }
    return place;
}

struct Sums {
    std::size_t places = 0, directions = 0;
    double squares = 0, largest = 0, angles = 0;

    void add(const Vector& found, const Vector& should, double typical) {
        const double error = reference::length(found - should) / typical;
        ++places;
        squares += error * error;
        largest = std::max(largest, error);
        if (reference::length(found) < kFeeble * typical || reference::length(should) < kFeeble * typical)
            return;
        const double angle = angle_between(found, should) / kDegree;
        ++directions;
        angles += angle * angle;
    }
};

} // namespace

std::vector<LookupError> lookup_errors(const LookupCase& one, double spacing, std::size_t count) {
    const Truth truth = truth_of(one, count);
    Sums sums[2][3];
    for (std::size_t shift = 0; shift < kShifts; ++shift) {
        const double part = static_cast<double>(shift) / kShifts * spacing;
        const VolumeGrid grid = volume_grid(one.low - part, one.high, spacing);
        Sampled<double> samples = sampled<double>(*one.prepared, grid);
        const Volume volume(grid, std::move(samples.forces));
        for (std::size_t i = 0; i < truth.at.size(); ++i) {
            const Vector place = truth.at[i];
            const Vector readings[2] = {volume.trilinear(place), volume.tricubic(place)};
            for (std::size_t method = 0; method < 2; ++method) {
                const Place at = samples_of(grid, samples.facets, volume.below(place), method);
                if (at != smooth || truth.is_smooth[i])
                    sums[method][at].add(readings[method], truth.force[i], truth.typical);
            }
        }
    }
    std::vector<LookupError> errors;
    for (std::size_t method = 0; method < 2; ++method)
        for (std::size_t place = 0; place < 3; ++place) {
            const Sums& sum = sums[method][place];
            const auto mean = [](double total, std::size_t of) {
                return of ? std::sqrt(total / static_cast<double>(of)) : 0.0;
            };
            errors.push_back({kMethods[method], kPlaces[place], sum.places, mean(sum.squares, sum.places), sum.largest,
                              mean(sum.angles, sum.directions)});
        }
    return errors;
}

std::optional<double> expected_order(const LookupCase& one, const std::string& method, const std::string& place) {
    if (place == "edge")
        return one.across;
    if (place == "boundary") // the force begins with a kink; where edges end there, too, their jumps are among it
        return one.across == 0 ? std::nullopt : std::optional(1.0);
    if (one.flat)
        return std::nullopt; // exact but for rounding
    return method == "trilinear" ? 2 : 3;
}

} // namespace forceshade::study::error_time

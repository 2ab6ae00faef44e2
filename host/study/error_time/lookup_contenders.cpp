// Forces read from precomputed volumes, on one thread.
#include <algorithm>

#include <fmt/format.h>

#include "host/study/error_time/contender.h"
#include "host/study/error_time/half_forces.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/lookup_volume.h"

namespace forceshade::study::error_time {
namespace {

using Place = reference::Vector<float>;

// A volume and the places at which it is read.
template <typename Stored> struct Reading {
    const ForceVolume<Stored, float>* volume;
    std::vector<Place> places;
};

enum class Method { trilinear, tricubic };

template <typename Stored> Place read(const ForceVolume<Stored, float>& volume, Method method, const Place& place) {
    return method == Method::trilinear ? volume.trilinear(place) : volume.tricubic(place);
}

template <typename Stored, typename Volume>
Contender lookup(const Subject& subject, const Variant& variant, const VolumeGrid& grid, Method method,
                 const Volume& volume, std::size_t count) {
    const bool half = sizeof(Stored) == 2;
    const std::string family = method == Method::trilinear ? "look-up, trilinear" : "look-up, tricubic";
    Contender contender = contender_of(subject, variant, family, half ? "f32, half stored" : "f32");
    contender.name = contender_name(
        subject, variant, fmt::format("{} {:.3g} mm{}", family, grid.spacing * 1e3, half ? ", half stored" : ""));
    contender.spacing = grid.spacing;
    contender.bytes = static_cast<double>(3 * sizeof(Stored) * grid.samples());
    contender.evaluate = [volume, method, probes = &subject.probes] {
        Evaluated evaluated{*probes, {}};
        for (const glm::dvec3& at : *probes)
            evaluated.force.emplace_back(read<Stored>(volume(), method, Place(at)));
        return evaluated;
    };
    contender.exact = [prepared = variant.prepared](const std::vector<glm::dvec3>& at) {
        return direct_forces<double>(*prepared, at);
    };
    const std::size_t timed_probes = std::min(count, subject.probes.size());
    const auto reading = lazily([volume, probes = &subject.probes, timed_probes] {
        const auto end = probes->begin() + static_cast<std::ptrdiff_t>(timed_probes);
        return Reading<Stored>{&volume(), std::vector<Place>(probes->begin(), end)};
    });
    contender.seconds = timed(timed_probes, [reading, method] {
        const Reading<Stored>& now = reading();
        double sum = 0;
        for (const Place& place : now.places) {
            const Place force = read<Stored>(*now.volume, method, place);
            sum += static_cast<double>(force.x) + static_cast<double>(force.z);
        }
        return sum;
    });
    return contender;
}

} // namespace

void add_lookups(Contenders& contenders, const Subject& subject, const Variant& variant, const Extents& extents) {
    for (const double spacing : subject.spacings) {
        const VolumeGrid grid = volume_grid(subject.low, subject.high, spacing);
        const auto volume = lazily([prepared = variant.prepared, grid] {
            return ForceVolume<float, float>(grid, sampled<float>(*prepared, grid).forces);
        });
        const auto halves = lazily([prepared = variant.prepared, grid] {
            std::vector<Half> stored;
            to_halves(sampled<float>(*prepared, grid).forces, stored);
            return ForceVolume<Half, float>(grid, std::move(stored));
        });
        for (const Method method : {Method::trilinear, Method::tricubic})
            contenders.push_back(lookup<float>(subject, variant, grid, method, volume, extents.timed));
        contenders.push_back(lookup<Half>(subject, variant, grid, Method::trilinear, halves, extents.timed));
    }
}

} // namespace forceshade::study::error_time

// Forces evaluated where the probe is, one after the other on one thread: what a live loop does.
#include <algorithm>
#include <type_traits>

#include "host/study/error_time/contender.h"
#include "host/study/error_time/half_forces.h"
#include "host/study/error_time/law_at.h"

namespace forceshade::study::error_time {
namespace {

template <typename T> using Vector = reference::Vector<T>;

template <typename T> std::vector<float> numbers_of(const std::vector<Vector<T>>& forces) {
    std::vector<float> numbers;
    for (const Vector<T>& force : forces)
        numbers.insert(numbers.end(), {float(force.x), float(force.y), float(force.z)});
    return numbers;
}

// A law and the places at which it is timed.
template <typename T, template <typename> class Law> struct Loop {
    std::unique_ptr<Law<T>> law;
    std::vector<Vector<T>> places;
};

template <typename T, template <typename> class Law>
auto loop_over(const Subject& subject, const Variant& variant, std::size_t count) {
    return lazily([prepared = variant.prepared, probes = &subject.probes, count] {
        const std::span<const glm::dvec3> world(probes->data(), std::min(count, probes->size()));
        return Loop<T, Law>{std::make_unique<Law<T>>(*prepared), places_of<T>(*prepared, world)};
    });
}

template <typename T> double sum_of(const Vector<T>& force) {
    return static_cast<double>(force.x) + static_cast<double>(force.z);
}

template <typename T> Contender direct(const Subject& subject, const Variant& variant, std::size_t count) {
    Contender contender = contender_of(subject, variant, "direct", kPrecision<T>);
    contender.evaluate = [prepared = variant.prepared, probes = &subject.probes] {
        return Evaluated{*probes, in_double<T>(direct_forces<T>(*prepared, *probes))};
    };
    contender.exact = [prepared = variant.prepared](const std::vector<glm::dvec3>& at) {
        return direct_forces<double>(*prepared, at);
    };
    contender.seconds =
        timed(std::min(count, subject.probes.size()), [loop = loop_over<T, DirectLaw>(subject, variant, count)] {
            auto& [law, places] = loop();
            double sum = 0;
            for (const Vector<T>& place : places)
                sum += sum_of(law->at(place).force);
            return sum;
        });
    return contender;
}

Contender half_output(const Subject& subject, const Variant& variant, std::size_t count) {
    Contender contender = direct<float>(subject, variant, count);
    contender.precision = "f32, half output";
    contender.name = contender_name(subject, variant, "direct f32, half output");
    contender.evaluate = [prepared = variant.prepared, probes = &subject.probes] {
        std::vector<Half> halves;
        to_halves(numbers_of(direct_forces<float>(*prepared, *probes)), halves);
        return Evaluated{*probes, vectors_of<Half>(halves)};
    };
    contender.seconds = timed(std::min(count, subject.probes.size()),
                              [loop = loop_over<float, DirectLaw>(subject, variant, count),
                               numbers = std::vector<float>(), halves = std::vector<Half>()]() mutable {
                                  auto& [law, places] = loop();
                                  numbers.clear();
                                  for (const Vector<float>& place : places) {
                                      const Vector<float> force = law->at(place).force;
                                      numbers.insert(numbers.end(), {force.x, force.y, force.z});
                                  }
                                  to_halves(numbers, halves);
                                  return static_cast<double>(static_cast<std::uint16_t>(halves.back()));
                              });
    return contender;
}

template <typename T> Contender god_object(const Subject& subject, const Variant& variant, std::size_t count) {
    Contender contender = contender_of(subject, variant, "god-object", kPrecision<T>);
    contender.evaluate = [prepared = variant.prepared, &subject] {
        return Evaluated{subject.probes, in_double<T>(proxy_forces<T>(*prepared, subject.probes, subject.stroke))};
    };
    contender.exact = [prepared = variant.prepared, stroke = subject.stroke](const std::vector<glm::dvec3>& at) {
        return proxy_forces<double>(*prepared, at, stroke);
    };
    if (subject.best)
        contender.smooth = [best = subject.best, stroke = subject.stroke](const std::vector<glm::dvec3>& at) {
            return proxy_forces<double>(*best, at, stroke);
        };
    contender.seconds = timed(std::min(count, subject.probes.size()),
                              [loop = loop_over<T, ProxyLaw>(subject, variant, count), stroke = subject.stroke] {
                                  auto& [law, places] = loop();
                                  double sum = 0;
                                  for (std::size_t i = 0; i < places.size(); ++i) {
                                      if (i % stroke == 0)
                                          law->begin(places[i]);
                                      sum += sum_of(law->force(places[i]));
                                  }
                                  return sum;
                              });
    return contender;
}

} // namespace

void add_direct(Contenders& contenders, const Subject& subject, const Variant& variant, const Extents& extents) {
    contenders.push_back(direct<double>(subject, variant, extents.timed));
    contenders.push_back(direct<float>(subject, variant, extents.timed));
    if (variant.half)
        contenders.push_back(half_output(subject, variant, extents.timed));
    if (variant.proxies && subject.stroke > 0) {
        contenders.push_back(god_object<double>(subject, variant, extents.timed));
        contenders.push_back(god_object<float>(subject, variant, extents.timed));
    }
}

} // namespace forceshade::study::error_time

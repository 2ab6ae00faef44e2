#include "host/score/measures.h"

#include <algorithm>
#include <array>
#include <complex>
#include <numbers>

#include <unsupported/Eigen/FFT>

#include <glm/geometric.hpp>

#include "host/norm.h"
#include "host/study/study_data.h"

namespace forceshade::score {
namespace {

constexpr std::size_t kWindow = 256; // samples
constexpr int kMostShift = 20;       // samples
constexpr double kTouch = 0.05;      // of the stroke's largest force: a contact that counts
constexpr double kFelt = 1e-3;       // of it: a force at all
constexpr double kBackHome = 0.01;   // of a stroke's length: it ends where it began

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return reference::angle_between(a, b) * 180 / std::numbers::pi;
}

struct Squares {
    double sum = 0;
    std::size_t count = 0;
    void add(double value) {
        sum += value * value;
        ++count;
    }
    double rms() const { return count > 0 ? std::sqrt(sum / double(count)) : NAN; }
};

double p95(const std::vector<double>& values) {
    return values.empty() ? NAN : study::quantile(values, 0.95);
}

// Samples from one that the oracle touches to the last one of that contact.
struct Contact {
    std::size_t begin, end;
};

std::vector<Contact> contacts_of(const Truth& truth) {
    std::vector<Contact> all;
    for (std::size_t i = 0; i < truth.touching.size(); ++i) {
        if (!truth.touching[i])
            continue;
        if (i == 0 || !truth.touching[i - 1])
            all.push_back({i, i});
        all.back().end = i + 1;
    }
    return all;
}

// Runs of samples of a contact at which the oracle pushes with more than `firm`, N, and the renderer does not, or the
// other way.
void add_faults(std::vector<Fault>& faults, const Contact& contact, const Stroke& stroke, const Truth& truth,
                std::span<const glm::dvec3> forces, double firm) {
    enum class State { unknown, holds, lost, reversed };
    const auto state_at = [&](std::size_t i) {
        if (glm::length(truth.force[i]) < firm || !truth.certain[i])
            return State::unknown;
        if (!is_force(forces[i]) || glm::length(forces[i]) < kTouch * glm::length(truth.force[i]))
            return State::lost;
        return glm::dot(forces[i], truth.force[i]) < 0 ? State::reversed : State::holds;
    };
    bool lasts = false, reversed = false;
    std::size_t begin = 0, last = 0; // of a fault that lasts
    const auto add = [&](bool comes_back) {
        if (lasts)
            faults.push_back({begin, stroke.time[last] - stroke.time[begin], reversed || !comes_back});
        lasts = reversed = false;
    };
    for (std::size_t i = contact.begin; i < contact.end; ++i) {
        const State state = state_at(i);
        if (state == State::holds)
            add(true);
        else if (state != State::unknown) {
            begin = lasts ? begin : i;
            lasts = true;
            last = i;
            reversed = reversed || state == State::reversed;
        }
    }
    add(false);
}

} // namespace

Yardstick::Yardstick(const PreparedCase& prepared) : stiffness(prepared.one.scene.force.stiffness), probe(prepared) {
    if (prepared.one.scene.compare)
        smooth.emplace(prepared);
    probe.law().find_obstacles();
}

Truth Yardstick::along(const Stroke& stroke) {
    Truth truth;
    probe.begin_path();
    for (const glm::dvec3& place : stroke.probe) {
        const reference::LawContact<double> found = probe.at(place);
        truth.force.emplace_back(found.contact.force);
        truth.proxy.push_back(probe.law().in_world(found.contact.proxy));
        truth.touching.push_back(found.contact.facet != layout::kNoFacet);
        truth.certain.push_back(found.finished);
    }
    return truth;
}

double rms_above(std::span<const glm::dvec3> signal, double period, double frequency) {
    constexpr std::size_t kHalf = kWindow / 2;
    const auto lowest = static_cast<std::size_t>(std::ceil(frequency * period * double(kWindow)));
    if (signal.size() < kWindow || lowest >= kHalf)
        return NAN;
    Eigen::FFT<double> transform;
    transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    std::vector<double> window(kWindow), weights(kWindow), line(kWindow);
    double all_weights = 0, spread = 0;
    for (std::size_t i = 0; i < kWindow; ++i) {
        weights[i] = 0.5 * (1 - std::cos(2 * std::numbers::pi * double(i) / double(kWindow)));
        line[i] = double(i) - 0.5 * (double(kWindow) - 1);
        all_weights += weights[i] * weights[i];
        spread += line[i] * line[i];
    }
    std::vector<std::complex<double>> spectrum;
    double sum = 0;
    std::size_t windows = 0;
    for (std::size_t begin = 0; begin + kWindow <= signal.size(); begin += kHalf, ++windows)
        for (int axis = 0; axis < 3; ++axis) {
            double mean = 0, slope = 0;
            for (std::size_t i = 0; i < kWindow; ++i) {
                mean += signal[begin + i][axis] / double(kWindow);
                slope += line[i] * signal[begin + i][axis] / spread;
            }
            for (std::size_t i = 0; i < kWindow; ++i)
                window[i] = weights[i] * (signal[begin + i][axis] - mean - slope * line[i]);
            transform.fwd(spectrum, window);
            for (std::size_t bin = lowest; bin <= kHalf; ++bin)
                sum += (bin == kHalf ? 1 : 2) * std::norm(spectrum[bin]) / (double(kWindow) * all_weights);
        }
    return std::sqrt(sum / double(windows));
}

double shift_between(std::span<const glm::dvec3> early, std::span<const glm::dvec3> late) {
    const auto size = static_cast<int>(std::min(early.size(), late.size()));
    if (size < 4 * kMostShift)
        return NAN;
    std::array<double, 2 * kMostShift + 1> difference{};
    double early_change = 0, late_change = 0;
    for (int i = kMostShift; i < size - kMostShift; ++i) {
        for (int shift = -kMostShift; shift <= kMostShift; ++shift) {
            const std::ptrdiff_t before = std::ptrdiff_t(i) - shift;
            const glm::dvec3 apart = late[std::size_t(i)] - early[std::size_t(before)];
            difference[static_cast<unsigned>(shift + kMostShift)] += glm::dot(apart, apart);
        }
        early_change += glm::length(early[std::size_t(i)] - early[std::size_t(i - 1)]);
        late_change += glm::length(late[std::size_t(i)] - late[std::size_t(i - 1)]);
    }
    int at = kMostShift;
    for (int shift = 1; shift <= kMostShift; ++shift)
        for (const int other : {kMostShift + shift, kMostShift - shift})
            if (difference[std::size_t(other)] < difference[std::size_t(at)])
                at = other;
    const double* const least = &difference[std::size_t(at)];
    if (!(early_change > 0 && late_change > 0) || !std::isfinite(*least))
        return NAN;
    if (*least == 0 || at == 0 || at == 2 * kMostShift)
        return at - kMostShift;
    const double earlier = least[-1], later = least[1], curvature = earlier - 2 * *least + later;
    return at - kMostShift + (curvature > 0 ? 0.5 * (earlier - later) / curvature : 0);
}

StrokeScore score_stroke(const Yardstick& yardstick, const Stroke& stroke, const Truth& truth,
                         std::span<const glm::dvec3> forces, std::span<const glm::dvec3> proxies,
                         std::optional<double> period) {
    StrokeScore score;
    double largest = 0; // N: of the oracle
    for (const glm::dvec3& force : truth.force)
        largest = std::max(largest, glm::length(force));
    Squares errors, own, magnitudes, directions, smooth_angles, smooth_magnitudes;
    std::vector<double> sizes, angles;
    std::size_t free = 0, phantoms = 0, jumps = 0;
    double phantom = 0, way = 0, work = 0, excess = 0;
    layout::uint hint = 0, smooth_hint = 0;
    std::vector<glm::dvec3> difference;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const glm::dvec3 &force = forces[i], &exact = truth.force[i];
        if (!is_force(force)) {
            ++score.not_finite;
            difference.emplace_back(NAN);
            continue;
        }
        const double size = glm::length(force), exact_size = glm::length(exact);
        difference.push_back(force - exact);
        sizes.push_back(glm::length(difference.back()));
        errors.add(sizes.back());
        score.error_largest = std::fmax(score.error_largest, sizes.back());
        own.add(exact_size);
        magnitudes.add(size - exact_size);
        if (size > kFelt * largest && exact_size > kFelt * largest) {
            angles.push_back(degrees_between(force, exact));
            directions.add(angles.back());
        }
        if (!truth.touching[i]) {
            ++free;
            phantoms += size > kFelt * largest && size > 0 ? 1 : 0;
            phantom = std::max(phantom, size);
        }
        if (yardstick.smooth) {
            const Deviation apart = yardstick.smooth->at(stroke.probe[i], force, smooth_hint);
            if (apart.counts && std::isfinite(apart.angle))
                smooth_angles.add(apart.angle);
            if (apart.counts && std::isfinite(apart.magnitude_error))
                smooth_magnitudes.add(apart.magnitude_error);
        }
        if (!proxies.empty() && is_finite(proxies[i]) && yardstick.law().reaches(proxies[i]))
            score.inside = std::fmax(score.inside, yardstick.law().at(proxies[i], hint).depth);
        if (i == 0 || !is_force(forces[i - 1]))
            continue;
        const glm::dvec3 step = stroke.probe[i] - stroke.probe[i - 1];
        const double moved = glm::length(step);
        work += glm::dot(0.5 * (forces[i - 1] + force), step);
        excess += glm::dot(0.5 * (difference[i - 1] + difference[i]), step);
        if (truth.touching[i] || size > kFelt * largest) {
            way += moved;
            jumps += glm::length(force - forces[i - 1]) > 2 * yardstick.stiffness * moved + kFelt * largest ? 1 : 0;
        }
    }
    score.error_rms = errors.rms();
    score.error_p95 = p95(sizes);
    score.error_share = own.rms() > 0 ? errors.rms() / own.rms() : NAN;
    score.magnitude_rms = magnitudes.rms();
    score.direction_rms = directions.rms();
    score.direction_p95 = p95(angles);
    score.smooth_direction = smooth_angles.rms();
    score.smooth_magnitude = smooth_magnitudes.rms();
    if (free > 0) {
        score.phantom_share = double(phantoms) / double(free);
        score.phantom_largest = phantom;
    }
    score.jumps = way > 0 ? double(jumps) / (1e3 * way) : NAN;
    const bool whole = score.not_finite == 0; // what needs every sample
    if (whole) {
        score.work = work;
        score.excess_work = excess;
    }
    const glm::dvec3 apart = stroke.probe.back() - stroke.probe.front();
    double length = 0;
    for (std::size_t i = 1; i < stroke.probe.size(); ++i)
        length += glm::length(stroke.probe[i] - stroke.probe[i - 1]);
    if (whole && length > 0 && glm::length(apart) <= kBackHome * length)
        score.loop_work = work;
    if (whole && period) {
        score.buzz_30 = rms_above(forces, *period, 30);
        score.buzz_100 = rms_above(forces, *period, 100);
        score.added_30 = rms_above(difference, *period, 30);
        score.added_100 = rms_above(difference, *period, 100);
        score.delay = shift_between(truth.force, forces) * *period;
    }
    for (const Contact& contact : contacts_of(truth))
        add_faults(score.faults, contact, stroke, truth, forces, kTouch * largest);
    score.pop_throughs = double(std::ranges::count_if(score.faults, &Fault::through));
    score.drop_outs = double(score.faults.size()) - score.pop_throughs;
    return score;
}

} // namespace forceshade::score

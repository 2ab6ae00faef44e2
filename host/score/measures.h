// How far a renderer's forces along a stroke are from the oracle's at the same places, and what is wrong with them.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/case_law.h"
#include "host/field/comparison.h"
#include "host/score/strokes.h"

namespace forceshade::score {

/// The oracle along a stroke: a god-object in double precision, on a mesh with its history.
struct Truth {
    std::vector<glm::dvec3> force; /* N */
    std::vector<glm::dvec3> proxy; /* m */
    std::vector<bool> touching;
    std::vector<bool> certain; /* its contact has a certificate: the proxy came to rest */
};

/// What the measures need of a scene.
struct Yardstick {
    explicit Yardstick(const PreparedCase& prepared);

    Truth along(const Stroke& stroke);

    double stiffness;                      /* N/m */
    std::optional<ShapeComparison> smooth; /* of [compare] */
    CaseProbe<double> probe;

    const CaseLaw<double>& law() const { return probe.law(); }
};

/// Where a renderer loses a contact that the oracle has, and has a certificate of.
struct Fault {
    std::size_t sample; /* of the stroke: where it begins */
    double seconds;     /* s: how long it lasts */
    bool through;       /* it pushes to the other side, or does not come back while the contact lasts */
};

/// Of one stroke. NaN: there is nothing to measure.
struct StrokeScore {
    double error_rms = NAN, error_p95 = NAN, error_largest = NAN; /* N: |F - oracle's F| */
    double error_share = NAN;                                     /* 1: its RMS over that of the oracle's force */
    double magnitude_rms = NAN;                                   /* N: |F| - |oracle's F| */
    double direction_rms = NAN, direction_p95 = NAN;              /* deg: where both push */
    double smooth_direction = NAN, smooth_magnitude = NAN;        /* deg, N: RMS against the shape of [compare] */
    double phantom_share = NAN, phantom_largest = NAN;            /* 1, N: force where the oracle is free */
    double drop_outs = NAN, pop_throughs = NAN;                   /* 1: faults of either kind */
    double jumps = NAN;                                           /* 1/mm: of the way in contact */
    double buzz_30 = NAN, buzz_100 = NAN;                         /* N: RMS of the force above 30 and 100 Hz */
    double added_30 = NAN, added_100 = NAN;                       /* N: the same of its difference from the oracle's */
    double work = NAN, excess_work = NAN;                         /* J: on the hand; more than the oracle's */
    double loop_work = NAN; /* J: on the hand, of a stroke that ends where it began */
    double inside = NAN;    /* m: how deep its proxy is below the surface, at most */
    double delay = NAN;     /* s: by which its forces come after the oracle's */
    double not_finite = 0;  /* 1: samples without is_force(): left out of errors, lost for faults; with one there is no
                               spectrum, work and delay */
    std::vector<Fault> faults;
};

/// `proxies`: empty if the renderer gives none; NaN where it gives none.
StrokeScore score_stroke(const Yardstick& yardstick, const Stroke& stroke, const Truth& truth,
                         std::span<const glm::dvec3> forces, std::span<const glm::dvec3> proxies,
                         std::optional<double> period);

/// N: the root mean square of what a signal, N, sampled each `period`, s, has above `frequency`, Hz: of Hann windows of
/// 256 samples, half overlapping, each without its line (Welch 1967). NaN for fewer samples.
double rms_above(std::span<const glm::dvec3> signal, double period, double frequency);

/// Samples by which `late` comes after `early`, at most 20: the shift with the least mean square difference, to a part
/// of a sample by a parabola; the smaller of shifts that are alike. NaN where either does not change.
double shift_between(std::span<const glm::dvec3> early, std::span<const glm::dvec3> late);

} // namespace forceshade::score

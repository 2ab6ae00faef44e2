// The strokes of the standard course: the same twelve on every shape, in the coordinates of its nominal surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/random.h"
#include "host/score/course.h"

namespace forceshade::score {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;        // rad
constexpr double kLift = 1;                           // mm: above the nominal surface at either end of a stroke
constexpr double kRamp = 0.12;                        // s: from there to its depth, and back
constexpr double kLast = (kCourseSamples - 1) * 1e-3; // s
constexpr double kHandReach = 0.25;                   // of the span: to the hand's targets, on each axis
constexpr std::size_t kTargets = 4;

// Lengths along the surface are parts of the shape's span, depths are in mm below its nominal surface.

struct Constant {
    double speed;   // spans/s
    double heading; // rad, from u to v
    double aside;   // mm: of the middle, so that no stroke runs along a symmetry of a shape
    double depth;
};
constexpr std::array<Constant, 3> kConstant{{{1, 0, 0.7, 0.5}, {0.7, 1.1, 0.4, 1}, {0.4, 1.55, 0.3, 1.5}}};

struct Taps {
    double frequency; // Hz
    double u, v;
    double depth;
};
constexpr std::array<Taps, 3> kTaps{{{2, 0.02, 0.01, 0.5}, {3, 0.2, -0.05, 1}, {4, -0.15, 0.2, 1.5}}};

struct Circle {
    double rounds; // 1/s
    double radius;
    double u, v; // of the centre
    double depth;
};
constexpr std::array<Circle, 3> kCircles{
    {{1, 0.12, 0.003, 0.004, 0.5}, {2, 0.08, -0.1, 0.05, 1}, {3, 0.05, 0.15, -0.1, 1.5}}};

struct Hand {
    double tremor; // mm: root mean square on each axis
    double depth;
};
constexpr std::array<Hand, 3> kHands{{{0.05, 0.5}, {0.075, 1}, {0.1, 1.5}}};

static_assert(kConstant.size() + kTaps.size() + kCircles.size() + kHands.size() == kCourseStrokes);

// Of minimum jerk, from 0 to 1 (Flash & Hogan 1985).
double smooth_step(double part) {
    const double p = std::clamp(part, 0.0, 1.0);
    return p * p * p * (10 + p * (6 * p - 15));
}

struct Place {
    double u, v;
    double height; /* above the nominal surface */
};                 // mm

double pressed(double time, double depth) {
    const double down = smooth_step(time / kRamp) * smooth_step((kLast - time) / kRamp);
    return kLift - (kLift + depth) * down;
}

Place place_of(const Constant& stroke, double time, double span, double pressing) {
    const double along = stroke.speed * span * (time - kLast / 2), c = std::cos(stroke.heading),
                 s = std::sin(stroke.heading);
    return {along * c - stroke.aside * s, along * s + stroke.aside * c, pressed(time, pressing * stroke.depth)};
}

Place place_of(const Taps& stroke, double time, double span, double pressing) {
    const double down = (1 - std::cos(kTurn * stroke.frequency * time)) / 2;
    return {stroke.u * span, stroke.v * span, kLift - (kLift + pressing * stroke.depth) * down};
}

Place place_of(const Circle& stroke, double time, double span, double pressing) {
    const double angle = kTurn * stroke.rounds * time;
    return {span * (stroke.u + stroke.radius * std::cos(angle)), span * (stroke.v + stroke.radius * std::sin(angle)),
            pressed(time, pressing * stroke.depth)};
}

// A signal of four sines, root mean square 1.
class Tremor {
public:
    explicit Tremor(Random& random) {
        for (auto& [frequency, phase] : parts_) {
            frequency = random(8, 12);
            phase = random(0, kTurn);
        }
    }
    double at(double time) const {
        double sum = 0;
        for (const auto& [frequency, phase] : parts_)
            sum += std::sin(kTurn * frequency * time + phase);
        return sum * std::sqrt(2.0 / double(parts_.size()));
    }

private:
    std::array<std::pair<double, double>, 4> parts_; /* Hz, rad */
};

// From target to target, each way of minimum jerk, at a depth that varies by 30 %, and trembling.
class HandWay {
public:
    HandWay(const Hand& hand, std::uint64_t seed)
        : hand_(hand), random_(seed), u_(random_), v_(random_), height_(random_) {
        for (auto& [u, v] : targets_) {
            u = random_(-kHandReach, kHandReach);
            v = random_(-kHandReach, kHandReach);
        }
        frequency_ = random_(1, 2);
        phase_ = random_(0, kTurn);
    }
    Place at(double time, double span, double pressing) const {
        const double ways = double(kTargets - 1), now = ways * time / kLast;
        const auto way = std::min(static_cast<std::size_t>(now), kTargets - 2);
        const double part = smooth_step(now - double(way));
        const auto [u, v] = targets_[way];
        const auto [next_u, next_v] = targets_[way + 1];
        const double depth = hand_.depth * (1 + 0.3 * std::sin(kTurn * frequency_ * time + phase_));
        return {span * (u + part * (next_u - u)) + hand_.tremor * u_.at(time),
                span * (v + part * (next_v - v)) + hand_.tremor * v_.at(time),
                pressed(time, pressing * depth) + hand_.tremor * height_.at(time)};
    }

private:
    Hand hand_;
    Random random_;
    Tremor u_, v_, height_;
    std::array<std::pair<double, double>, kTargets> targets_; /* spans */
    double frequency_ = 0, phase_ = 0;                        /* of the depth: Hz, rad */
};

} // namespace

std::string fixed_decimals(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-')
        text.erase(0, 1);
    return text;
}

std::string course_strokes(const CourseShape& shape) {
    std::string text = "path,t,x,y,z\n";
    std::size_t path = 0;
    const auto add = [&](const auto& place_at) {
        for (std::size_t i = 0; i < kCourseSamples; ++i) {
            const double time = double(i) * 1e-3;
            const Place place = place_at(time);
            const SurfacePoint surface = shape.surface(place.u, place.v);
            const glm::dvec3 probe = (surface.place + place.height * surface.normal) * 1e-3;
            text += fmt::format("{},{:.3f},{},{},{}\n", path, time, fixed_decimals(probe.x, 9),
                                fixed_decimals(probe.y, 9), fixed_decimals(probe.z, 9));
        }
        ++path;
    };
    const auto add_all = [&](const auto& strokes) {
        for (const auto& stroke : strokes)
            add([&](double time) { return place_of(stroke, time, shape.span, shape.pressing); });
    };
    add_all(kConstant);
    add_all(kTaps);
    add_all(kCircles);
    for (const Hand& hand : kHands) {
        const HandWay way(hand, kCourseHandSeed + path);
        add([&](double time) { return way.at(time, shape.span, shape.pressing); });
    }
    return text;
}

} // namespace forceshade::score

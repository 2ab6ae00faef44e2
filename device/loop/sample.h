// What is remembered of one sample of the live loop.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <glm/vec3.hpp>

namespace forceshade::device {

/// What happened to a sample, as bits.
enum Happening : std::uint32_t {
    kClamped = 1u << 0,     // the force was larger than allowed
    kSlewed = 1u << 1,      // it changed faster than allowed
    kRamping = 1u << 2,     // it is being brought up, after the start, a fault, or a while without contact
    kDamped = 1u << 3,      // the passivity controller took energy out
    kNoNumber = 1u << 4,    // the law's force was no finite number: none was displayed
    kBadPosition = 1u << 5, // the position was none: likewise
    kStale = 1u << 6,       // there was no new one for too long: likewise
    kOutside = 1u << 7,     // it lay outside of the workspace: likewise
    kTooFast = 1u << 8,     // the probe moved faster than allowed: likewise
    kTooLate = 1u << 9,     // the sample came later than the watchdog allows: likewise; or the pause was so
                            // long that the device has let go; the next force starts from none
    kFailed = 1u << 10,     // the device did not take or give what it should
    kUnfinished = 1u << 11, // the proxy could not come to rest
    kOverrun = 1u << 12,    // the sample ended after the next one was due
    kOwnOverrun = 1u << 13, // and would have, had it begun in time and never been interrupted
    kWithheld = 1u << 14,   // the device displays no force: it is not calibrated, switched off, ...: likewise
    kLasting = 1u << 15,    // the force was larger than the motors bear for so long
    kNewPath = 1u << 16,    // a path begins in mid-run: the force of the one before was dropped
};

inline constexpr std::array<std::string_view, 17> kHappenings{
    "clamped",  "slewed", "ramping",    "damped",  "no_number",   "bad_position", "stale",   "outside", "too_fast",
    "too_late", "failed", "unfinished", "overrun", "own_overrun", "withheld",     "lasting", "new_path"};

/// Those with which no force is displayed.
inline constexpr std::uint32_t kForceless =
    kNoNumber | kBadPosition | kStale | kOutside | kTooFast | kTooLate | kFailed | kWithheld;

struct LiveSample {
    std::uint64_t tick = 0;     // from 0 on, none left out
    std::uint32_t path = 0;     // one more with each change of the scene or beginning of a recorded path
    std::uint32_t happened = 0; // Happening
    double time = 0;            /* s since the start: when the position had been read */
    glm::dvec3 probe{0};        /* m: where the law was evaluated: the last position that was one */
    glm::dvec3 proxy{0};        /* m */
    glm::dvec3 force{0};        /* N: the law's */
    glm::dvec3 commanded{0};    /* N: what was sent to the device; zero where it was not taken */
    double depth = 0;           /* m */
    double energy = 0;          /* J: given to the hand since the start */
    std::int64_t late = 0;      /* ns: the loop woke so long after the sample was due */
    std::int32_t reading = 0;   /* ns */
    std::int32_t computing = 0; /* ns: law and safety */
    std::int32_t writing = 0;   /* ns */
    std::uint32_t facet = 0;    // layout::kNoFacet out of contact
    std::uint64_t scene = 0;    // LiveLaw::scene
};

} // namespace forceshade::device

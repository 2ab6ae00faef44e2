#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"
#include "host/scene/setters.h"
#include "host/scene/spread_keys.h"

namespace forceshade {

namespace {

constexpr std::array<std::string_view, 2> kLoops{"open", "closed"};
constexpr std::string_view kDepthChoice = "depth"; // a depth, or the force that the hand presses with

constexpr std::uint32_t bit(PathKind kind) {
    return 1u << static_cast<std::uint32_t>(kind);
}

constexpr std::uint32_t kAll = 255;
constexpr std::uint32_t kMade = kAll & ~bit(PathKind::recorded); // by a generator
constexpr std::uint32_t kWalk = bit(PathKind::random_walk);

Spread& speed(Scene& s) {
    return s.paths->speed;
}
Spread& depth(Scene& s) {
    return s.paths->depth;
}
Spread& depth_back(Scene& s) {
    return s.paths->depth_back ? *s.paths->depth_back : s.paths->depth_back.emplace();
}
Spread& heading(Scene& s) {
    return s.paths->heading;
}
Spread& offset(Scene& s) {
    return s.paths->offset;
}
Spread& tremor_amplitude(Scene& s) {
    return s.paths->tremor_amplitude;
}

void add_kind(std::vector<Key>& keys) {
    keys.push_back({.table = "paths",
                    .name = "kind",
                    .kind = ValueKind::choice,
                    .default_text = "\"strokes\"",
                    .doc = "how the probe is meant to go: straight there and back, line after line, round a circle, in "
                           "a spiral, up and down, at random (band limited), from point to point (minimum jerk: Flash "
                           "& Hogan 1985), or as recorded in a file",
                    .set = [](Scene& s, const Value& v) { s.paths->kind = choice<PathKind>(v); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .choices = kPathKinds});
    keys.push_back({.table = "paths",
                    .name = "file",
                    .kind = ValueKind::file,
                    .default_text = "",
                    .doc = "recorded paths as CSV with a header and columns path, t, x, y, z (s, m), times of a path "
                           "increasing; relative to this TOML file or absolute",
                    .set =
                        [](Scene& s, const Value& v) {
                            s.paths->file = v.texts.at(0);
                            s.paths->path = v.path;
                            s.paths->sha256 = v.sha256;
                        },
                    .subject = Subject::paths,
                    .forms = bit(PathKind::recorded),
                    .example = "\"paths.csv\""});
    keys.push_back({.table = "paths",
                    .name = "sha256",
                    .kind = ValueKind::digest,
                    .default_text = "",
                    .doc = "what the file's bytes must hash to; a list if `file` is one; left out: any",
                    .set = nullptr,
                    .subject = Subject::paths,
                    .forms = bit(PathKind::recorded),
                    .axis = false});
}

void add_counts(std::vector<Key>& keys) {
    keys.push_back({.table = "paths",
                    .name = "count",
                    .kind = ValueKind::integer,
                    .default_text = "1000",
                    .doc = "paths; an EXR holds up to 1073741822",
                    .set = [](Scene& s, const Value& v) { s.paths->count = v.integers.at(0); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .largest = 1073741822});
    keys.push_back({.table = "paths",
                    .name = "steps",
                    .kind = ValueKind::integer,
                    .default_text = "2000",
                    .doc = "samples of each path; an EXR holds up to 5592405",
                    .set = [](Scene& s, const Value& v) { s.paths->steps = v.integers.at(0); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .largest = 1073741822});
    keys.push_back({.table = "paths",
                    .name = "rate",
                    .kind = ValueKind::quantity,
                    .default_text = "\"1 kHz\"",
                    .doc = "samples a second; recorded paths have times of their own, which in closed loop keep to it",
                    .set = [](Scene& s, const Value& v) { s.paths->rate = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .dimension = Dimension::frequency,
                    .sign = Sign::positive});
    keys.push_back({.table = "paths",
                    .name = "seed",
                    .kind = ValueKind::integer,
                    .default_text = "1",
                    .doc = "of the random numbers: a path follows from it and from its own number alone",
                    .set = [](Scene& s, const Value& v) { s.paths->seed = v.integers.at(0); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .largest = 9223372036854775807,
                    .smallest = 0});
    keys.push_back({.table = "paths",
                    .name = "loop",
                    .kind = ValueKind::choice,
                    .default_text = "",
                    .doc = "whether the probe is where the path is, or a hand and a device take it there ([hand]); "
                           "left out: closed with press or push, else open",
                    .set = [](Scene& s, const Value& v) { s.paths->loop = choice<PathLoop>(v); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .choices = kLoops,
                    .example = "\"open\""});
}

void add_drive(std::vector<Key>& keys) {
    add_spread_keys<speed>(
        keys, {.names = {"speed", "speed.mean", "speed.sd", "speed.min", "speed.max"},
               .choice = "speed",
               .default_text = "\"100 mm/s\"",
               .example = {},
               .doc = "along the way; of a spiral at its largest radius, of taps the mean, of a random walk the root "
                      "mean square, of minimum jerk the mean over the mean distance of two points",
               .forms = kMade,
               .dimension = Dimension::speed,
               .sign = Sign::positive});
    add_spread_keys<depth>(keys, {.names = {"depth", "depth.mean", "depth.sd", "depth.min", "depth.max"},
                                  .choice = kDepthChoice,
                                  .default_text = "\"1 mm\"",
                                  .example = {},
                                  .doc = "below the plane or surface that the path follows; negative: above it",
                                  .forms = kMade});
    keys.push_back({.table = "paths",
                    .name = "press",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "instead of depth: the constant force that the hand presses down with, in closed loop; "
                           "nothing else then holds the probe along z but damping",
                    .set =
                        [](Scene& s, const Value& v) {
                            s.paths->drive = PathDrive::press;
                            s.paths->press = v.numbers.at(0);
                        },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .dimension = Dimension::force,
                    .sign = Sign::not_negative,
                    .example = "\"1 N\"",
                    .choice = kDepthChoice,
                    .option = 3});
    keys.push_back({.table = "paths",
                    .name = "push",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "the same as a vector: the hand's constant force along x, y and z (press is -z)",
                    .set =
                        [](Scene& s, const Value& v) {
                            s.paths->drive = PathDrive::push;
                            s.paths->push = components<3>(v);
                        },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .dimension = Dimension::force,
                    .count = 3,
                    .example = "[\"0 N\", \"0 N\", \"-1 N\"]",
                    .choice = kDepthChoice,
                    .option = 4});
    add_spread_keys<depth_back>(
        keys, {.names = {"depth_back", "depth_back.mean", "depth_back.sd", "depth_back.min", "depth_back.max"},
               .choice = "depth_back",
               .default_text = {},
               .example = "\"1 mm\"",
               .doc = "below the plane or surface on the way back; left out: as deep as on the way there",
               .forms = bit(PathKind::strokes)});
}

void add_variety(std::vector<Key>& keys) {
    add_spread_keys<heading>(
        keys, {.names = {"heading", "heading.mean", "heading.sd", "heading.min", "heading.max"},
               .choice = "heading",
               .default_text = "\"0 deg\"",
               .example = {},
               .doc = "the direction of strokes and lines, from x towards y; other paths are turned by it",
               .forms = kMade & ~kWalk,
               .dimension = Dimension::angle});
    add_spread_keys<offset>(keys, {.names = {"offset", "offset.mean", "offset.sd", "offset.min", "offset.max"},
                                   .choice = "offset",
                                   .default_text = "\"0 m\"",
                                   .example = {},
                                   .doc = "of the path's middle from the centre, to the left of its heading",
                                   .forms = kMade & ~kWalk});
    add_spread_keys<tremor_amplitude>(
        keys, {.names = {"tremor.amplitude", "tremor.amplitude.mean", "tremor.amplitude.sd", "tremor.amplitude.min",
                         "tremor.amplitude.max"},
               .choice = "tremor",
               .default_text = "\"0 m\"",
               .example = {},
               .doc = "root mean square of the trembling on each axis, four harmonics within 20 % of its frequency",
               .forms = kMade & ~kWalk,
               .sign = Sign::not_negative});
    keys.push_back({.table = "paths",
                    .name = "tremor.frequency",
                    .kind = ValueKind::quantity,
                    .default_text = "\"10 Hz\"",
                    .doc = "of the trembling; that of a healthy hand has 8 to 12 Hz (Elble & Koller 1990)",
                    .set = [](Scene& s, const Value& v) { s.paths->tremor_frequency = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kMade & ~kWalk,
                    .dimension = Dimension::frequency,
                    .sign = Sign::positive});
}

} // namespace

void add_path_keys(std::vector<Key>& keys) {
    add_kind(keys);
    add_counts(keys);
    add_drive(keys);
    add_variety(keys);
    add_path_place_keys(keys);
}

} // namespace forceshade

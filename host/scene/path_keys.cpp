#include "host/scene/path_keys.h"

#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"
#include "host/scene/value.h"

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

namespace {

constexpr std::array<std::string_view, 2> kFollows{"plane", "surface"};

void add_centre(std::vector<Key>& keys) {
    keys.push_back({.table = "paths",
                    .name = "centre",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "x and y of the paths' middle; left out: the origin, of a mesh the middle of its box",
                    .set = [](Scene& s, const Value& v) { s.paths->centre = components<2>(v); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .count = 2,
                    .example = "[\"0 m\", \"0 m\"]"});
    keys.push_back({.table = "paths",
                    .name = "height",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "z of the plane that depth is measured from; left out: 0, of a mesh the top of its box",
                    .set = [](Scene& s, const Value& v) { s.paths->height = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .example = "\"0 m\""});
    keys.push_back({.table = "paths",
                    .name = "follow",
                    .kind = ValueKind::choice,
                    .default_text = "\"plane\"",
                    .doc = "whether depth is measured from that plane, or from the nominal surface of a bump or "
                           "cylinder_bump raised by that height",
                    .set = [](Scene& s, const Value& v) { s.paths->follow = choice<PathFollow>(v); },
                    .subject = Subject::paths,
                    .forms = kMade,
                    .choices = kFollows});
}

void add_extent(std::vector<Key>& keys) {
    keys.push_back(
        {.table = "paths",
         .name = "length",
         .kind = ValueKind::quantity,
         .default_text = "",
         .doc = "of a stroke or line from end to end, of a region along the heading, of a circle or spiral "
                "the largest diameter; left out: 1.2 times the feature's width along x, of a mesh its box's, but "
                "half of that box where a hand presses, which would fall off its rim",
         .set = [](Scene& s, const Value& v) { s.paths->length = v.numbers.at(0); },
         .subject = Subject::paths,
         .forms = kMade & ~bit(PathKind::taps),
         .sign = Sign::not_negative,
         .example = "\"30 mm\""});
    keys.push_back(
        {.table = "paths",
         .name = "width",
         .kind = ValueKind::quantity,
         .default_text = "",
         .doc =
             "of a region across the heading; left out: the length, of a mesh 1.2 times its box's along y, or half of "
             "it where a hand presses",
         .set = [](Scene& s, const Value& v) { s.paths->width = v.numbers.at(0); },
         .subject = Subject::paths,
         .forms = bit(PathKind::raster) | bit(PathKind::random_walk) | bit(PathKind::minimum_jerk),
         .sign = Sign::not_negative,
         .example = "\"30 mm\""});
    keys.push_back({.table = "paths",
                    .name = "lines",
                    .kind = ValueKind::integer,
                    .default_text = "16",
                    .doc = "of a raster; of a spiral the rounds from its smallest radius to its largest",
                    .set = [](Scene& s, const Value& v) { s.paths->lines = v.integers.at(0); },
                    .subject = Subject::paths,
                    .forms = bit(PathKind::raster) | bit(PathKind::spiral),
                    .largest = 1000000});
    keys.push_back({.table = "paths",
                    .name = "inner",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "the smallest radius of a spiral; left out: a twentieth of the length",
                    .set = [](Scene& s, const Value& v) { s.paths->inner = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = bit(PathKind::spiral),
                    .sign = Sign::not_negative,
                    .example = "\"1.5 mm\""});
    keys.push_back({.table = "paths",
                    .name = "lift",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "of taps, how far above the surface they turn round; left out: each path's depth",
                    .set = [](Scene& s, const Value& v) { s.paths->lift = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = bit(PathKind::taps),
                    .sign = Sign::not_negative,
                    .example = "\"1 mm\""});
}

} // namespace

void add_path_place_keys(std::vector<Key>& keys) {
    add_centre(keys);
    add_extent(keys);
    keys.push_back({.table = "paths",
                    .name = "start_depth",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0 m\"",
                    .doc = "how far below its path the probe begins, at rest",
                    .set = [](Scene& s, const Value& v) { s.paths->start_depth = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .closed_loop = true});
    keys.push_back({.table = "paths",
                    .name = "bound",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "a probe further than this from its path has left: the loop is unstable there, and the path "
                           "ends; left out: 10 times the length and at least 0.1 m",
                    .set = [](Scene& s, const Value& v) { s.paths->bound = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .sign = Sign::positive,
                    .example = "\"0.3 m\"",
                    .closed_loop = true});
    keys.push_back({.table = "paths",
                    .name = "stretch",
                    .kind = ValueKind::quantity,
                    .default_text = "",
                    .doc = "the way over which the steepest turn of the force is taken; left out: a thousandth of the "
                           "length",
                    .set = [](Scene& s, const Value& v) { s.paths->stretch = v.numbers.at(0); },
                    .subject = Subject::paths,
                    .forms = kAll,
                    .sign = Sign::positive,
                    .example = "\"0.03 mm\""});
}

namespace {

// The device's defaults are those of the Phantom that the paper used, the grip's those of a relaxed hand.
void add_inertia(std::vector<Key>& keys) {
    keys.push_back({.table = "hand",
                    .name = "mass",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0.1 kg\"",
                    .doc = "that the hand moves at the device's tip (Massie & Salisbury 1994: the Phantom's apparent "
                           "mass is below 0.1 kg)",
                    .set = [](Scene& s, const Value& v) { s.hand.mass = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::mass,
                    .sign = Sign::positive});
    keys.push_back({.table = "hand",
                    .name = "damping",
                    .kind = ValueKind::quantity,
                    .default_text = "\"1 N s/m\"",
                    .doc = "of the device, against the world: a round value at which a wall of 2 N/mm is just stable "
                           "at 1 kHz by itself",
                    .set = [](Scene& s, const Value& v) { s.hand.damping = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::damping,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "grip_stiffness",
                    .kind = ValueKind::quantity,
                    .default_text = "\"500 N/m\"",
                    .doc = "of the spring that pulls the probe to its path; along z none with press or push. A round "
                           "value, of the size that is measured at fingertips (Hajian & Howe 1997)",
                    .set = [](Scene& s, const Value& v) { s.hand.grip_stiffness = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::stiffness,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "grip_damping",
                    .kind = ValueKind::quantity,
                    .default_text = "\"2 N s/m\"",
                    .doc = "of the grip, against its path's speed: likewise",
                    .set = [](Scene& s, const Value& v) { s.hand.grip_damping = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::damping,
                    .sign = Sign::not_negative});
}

void add_device(std::vector<Key>& keys) {
    keys.push_back({.table = "hand",
                    .name = "delay_samples",
                    .kind = ValueKind::integer,
                    .default_text = "0",
                    .doc = "from a position measured to its force displayed",
                    .set = [](Scene& s, const Value& v) { s.hand.delay_samples = v.integers.at(0); },
                    .subject = Subject::hand,
                    .largest = 1,
                    .smallest = 0});
    keys.push_back({.table = "hand",
                    .name = "quantisation",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0 m\"",
                    .doc = "step of the measured positions, 0 for none (a Phantom Premium's is nominally 0.03 mm)",
                    .set = [](Scene& s, const Value& v) { s.hand.quantisation = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "coulomb",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0 N\"",
                    .doc = "dry friction of the device on each axis (Massie & Salisbury 1994: below 0.1 N)",
                    .set = [](Scene& s, const Value& v) { s.hand.coulomb = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::force,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "max_force",
                    .kind = ValueKind::quantity,
                    .default_text = "\"8.5 N\"",
                    .doc = "the largest force that the device displays; larger ones keep their direction (a Phantom "
                           "Premium 1.5 has 8.5 N)",
                    .set = [](Scene& s, const Value& v) { s.hand.max_force = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::force,
                    .sign = Sign::positive});
}

} // namespace

void add_hand_keys(std::vector<Key>& keys) {
    add_inertia(keys);
    add_device(keys);
}

} // namespace forceshade

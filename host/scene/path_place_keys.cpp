#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"
#include "host/scene/setters.h"

namespace forceshade {

namespace {

constexpr std::array<std::string_view, 2> kFollows{"plane", "surface"};

constexpr std::uint32_t bit(PathKind kind) {
    return 1u << static_cast<std::uint32_t>(kind);
}

constexpr std::uint32_t kAll = 255;
constexpr std::uint32_t kMade = kAll & ~bit(PathKind::recorded); // by a generator

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

} // namespace forceshade

#include "host/scene/cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <tuple>

#include <fmt/format.h>

namespace forceshade {

namespace {

constexpr double kMostVoxels = 281474976710656; // 2^48: byte counts stay far below 2^64
constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

// Ranges in which squares of lengths, and a stiffness times a length, are normal numbers of the run's precision; the
// sizes of other quantities of paths and hands, in SI units, keep to those of lengths.
struct Range {
    const char* name;
    double smallest_length, largest_length;       /* m */
    double smallest_stiffness, largest_stiffness; /* N/m */
    double steepest;                              // slope of a height map
};
constexpr Range kRangeF32{"f32", 1e-15, 1e15, 1e-20, 1e20, kSteepestF32};
constexpr Range kRangeF64{"f64", 1e-150, 1e150, 1e-150, 1e150, kSteepestF64};

std::string length_text(double metres) {
    const double size = std::abs(metres);
    const bool km = size >= 1e3 && size < 1e6, mm = size < 1 && size >= 1e-3;
    return fmt::format("{:.4g} {}", km ? metres / 1e3 : mm ? metres * 1e3 : metres, km ? "km" : mm ? "mm" : "m");
}

// The distance from a number to the next larger one.
double step_at(double magnitude, Precision precision) {
    if (precision == Precision::f64)
        return std::nextafter(magnitude, std::numeric_limits<double>::infinity()) - magnitude;
    const auto single = static_cast<float>(magnitude);
    return double(std::nextafter(single, std::numeric_limits<float>::infinity())) - double(single);
}

class Checker {
public:
    Checker(const Scene& scene, const Selection& selection, const Document& document, Errors& errors,
            std::vector<std::string>& warnings)
        : scene_(scene), selection_(selection), document_(document), source_(document.source), errors_(errors),
          warnings_(warnings), range_(scene.precision == Precision::f32 ? kRangeF32 : kRangeF64) {}

    void check() {
        if (!document_.sure_of({"run"})) // it says which numbers can be held
            return;
        with({"surface"}, [&] { check_surface(); });
        with({"surface", "force"}, [&] { check_force(); });
        if (scene_.texture)
            with({"surface", "texture"}, [&] { check_texture(*scene_.texture); });
        if (scene_.grid.samples == 0)
            with({"surface", "grid"}, [&] { check_grid(); });
        if (scene_.compare)
            with({"surface", "compare"}, [&] { check_compare(*scene_.compare); });
        with({"hand"}, [&] {
            if (scene_.hand.coupling_damping > 0 && !scene_.hand.coupled())
                fail(
                    source_, find("hand.coupling.damping")->where,
                    "a virtual coupling needs a spring, too: coupling = {{ stiffness = \"5 N/mm\", damping = \"{}\" }}",
                    text_of("hand.coupling.damping"));
            if (scene_.hand.coupling_filter && scene_.hand.coupling_damping == 0)
                fail(source_, find("hand.coupling.filter")->where,
                     "hand.coupling.filter is of the damper's speed: it needs hand.coupling.damping");
        });
        if (scene_.friction)
            with({"friction", "texture"}, [&] { check_friction(*scene_.friction); });
        for (std::size_t key = 0; key < selection_.size(); ++key)
            if (selection_[key])
                check_sizes(schema_keys()[key], *selection_[key]);
        if (!scene_.paths)
            return;
        with({"surface", "paths"}, [&] {
            check_kind(*scene_.paths);
            attempt([&] { check_drive(*scene_.paths); });
        });
        for (const char* name : {"speed", "depth", "depth_back", "heading", "offset", "tremor.amplitude"})
            with({"paths"}, [&] { check_spread(name); });
    }

private:
    // False if it found an error.
    template <typename Check> bool attempt(Check&& check) { return errors_.attempt(std::forward<Check>(check)); }

    // What can be told of these tables only if all of them is known.
    template <typename Check> void with(std::initializer_list<std::string_view> tables, Check&& check) {
        if (document_.sure_of(tables))
            attempt(std::forward<Check>(check));
    }

    const Value* find(std::string_view path) const { return selection_[key_index(path)]; }

    // A quantity as the user wrote it, and another in its unit.
    std::string_view text_of(std::string_view path, std::size_t part = 0) const {
        const Value& value = *find(path);
        return value.texts[value.one_for_all ? 0 : part];
    }
    std::string in_unit_of(std::string_view path, double number, std::size_t part = 0) const {
        return forceshade::in_unit_of(text_of(path, part), number, schema_keys()[key_index(path)].dimension);
    }

    // Of the first of the keys that is given; a default has no place.
    Location place(std::initializer_list<std::string> paths, std::size_t part = 0) const {
        for (const std::string& path : paths)
            if (const Value* value = find(path); value && !value->where.is_default())
                return value->parts[value->one_for_all ? 0 : part];
        return {};
    }

    void check_range(const std::string& path, double size, double least, double most, const char* reason,
                     std::size_t part = 0) const {
        if (size < least || size > most)
            fail(source_, place({path, "run.precision"}, part), "{} must be from {} to {} in {}{}; got {}", path,
                 in_unit_of(path, least, part), in_unit_of(path, most, part), range_.name, reason, text_of(path, part));
    }
    void check_length(const std::string& path, double metres, std::size_t part = 0) const {
        check_range(path, std::abs(metres), range_.smallest_length, range_.largest_length,
                    ", so that its square is a normal number", part);
    }
    void check_stiffness(const std::string& path, double stiffness) const {
        check_range(path, stiffness, range_.smallest_stiffness, range_.largest_stiffness, "");
    }

    void check_circle(const std::string& table, double width, double radius) {
        const std::string of_width = table + ".width", of_radius = table + ".radius";
        const bool held = attempt([&] { check_length(of_width, width); });
        check_length(of_radius, radius);
        if (held && radius < width / 2)
            fail(source_, place({of_radius, of_width}),
                 "radius must be at least half of width: {} is less than half of {}{}", text_of(of_radius),
                 text_of(of_width), half_in_other_unit(of_radius, of_width, width / 2));
    }

    // ", which is 12.7 mm", where the reader would have to convert it.
    std::string half_in_other_unit(const std::string& path, const std::string& of, double half) const {
        const std::string own = in_unit_of(path, half), other = in_unit_of(of, half);
        return own == other ? "" : fmt::format(", which is {}", own);
    }

    void check_map(const std::string& table, const HeightMapSpec& map) {
        switch (map.function) {
        case MapFunction::cylinder:
        case MapFunction::dip:
            return check_circle(table, map.width, map.radius);
        case MapFunction::sine:
            check_length(table + ".width", map.width);
            return check_slope(table, map.height, map.width);
        case MapFunction::gaussian:
            check_length(table + ".radius", map.radius);
            return check_slope(table, map.height, map.radius);
        case MapFunction::file:
            for (const std::size_t axis : {0, 1})
                attempt([&] { check_length(table + ".size", map.size[axis], axis); });
            return check_slope(table, map.height, std::min(map.size[0], map.size[1]));
        }
    }

    void check_slope(const std::string& table, double height, double length) const {
        if (!(std::abs(height) <= range_.largest_length) || !(std::abs(height) / length <= range_.steepest))
            fail(source_, place({table + ".height", table + ".radius", table + ".width", table + ".size"}),
                 "{0}.height {1} is too large for {2}: its size may be {3}, and {4:g} times the length over which it "
                 "rises",
                 table, text_of(table + ".height"), range_.name, in_unit_of(table + ".height", range_.largest_length),
                 range_.steepest);
    }

    void check_surface() {
        const SurfaceSpec& surface = scene_.surface;
        if (surface.kind == SurfaceKind::height_map)
            return check_map("surface", surface.map);
        if (surface.kind == SurfaceKind::mesh)
            return check_mesh(surface.mesh);
        check_circle("surface", surface.width, surface.radius);
        const double facet = surface.width / surface.facets; /* m */
        const double step = step_at(surface.width / 2, scene_.precision);
        if (surface.kind == SurfaceKind::bump && facet < step)
            warn(place({"surface.facets", "surface.width"}),
                 "facets of {} are below the {} step {} at the bump's edge: neighbouring vertices coincide",
                 in_unit_of("surface.width", facet), range_.name, in_unit_of("surface.width", step));
    }

    void check_mesh(const MeshSpec& mesh) const {
        if (mesh.file.empty())
            fail(source_, place({"surface.kind"}),
                 "kind \"mesh\" needs a file: file = \"NAME.obj\" (or .off, .ply, .stl) in [surface]");
        // The other defaults are the paper's, and would hardly meet the mesh.
        const Location given = place({"grid.size", "grid.origin", "grid.spacing"});
        for (const char* path : {"grid.size", "grid.origin", "grid.spacing"})
            if (scene_.grid.samples == 0 && !given.is_default() && place({path}).is_default())
                fail(source_, given,
                     "a mesh's grid needs size, origin and spacing, of which {} is missing; or samples, which makes "
                     "them from the mesh's box",
                     std::string_view(path).substr(5));
    }

    void check_force() {
        attempt([&] { check_stiffness("force.stiffness", scene_.force.stiffness); });
        const Shading shading = scene_.force.shading;
        // By surface: the first and the last that fit beside none.
        constexpr std::array<std::tuple<const char*, Shading, Shading>, 4> kFitting{
            {{"none or reference", Shading::reference, Shading::reference},
             {"none", Shading::none, Shading::none},
             {"none or height_map", Shading::height_map, Shading::height_map},
             {"none, morgenbesser, barycentric, mean_value or two_pass", Shading::morgenbesser, Shading::two_pass}}};
        const auto& [allowed, first, last] = kFitting[static_cast<std::size_t>(scene_.surface.kind)];
        if (shading != Shading::none && (shading < first || shading > last))
            fail(source_, place({"force.shading", "surface.kind"}),
                 "shading \"{}\" does not fit kind \"{}\", whose shading is {}", find("force.shading")->texts.front(),
                 find("surface.kind")->texts.front(), allowed);
        if (shading == Shading::two_pass)
            warn(place({"force.shading"}), "shading \"two_pass\" turns the force and makes it 1/cos of that angle as "
                                           "large, without a bound; the other shadings keep its magnitude");
    }

    void check_texture(const TextureSpec& texture) {
        if (texture.effect == TextureEffect::normal && scene_.surface.kind != SurfaceKind::mesh)
            fail(source_, place({"texture.effect"}),
                 "effect \"normal\" tilts the normals of a mesh; kind \"height_map\" does that for a plane (L5)");
        if (texture.effect == TextureEffect::normal && !place({"texture.stiffness"}).is_default())
            warn(place({"texture.stiffness"}), "stiffness does nothing with effect \"normal\", which adds no force");
        if (texture.stiffness != 0)
            attempt([&] { check_stiffness("texture.stiffness", texture.stiffness); });
        check_map("texture", texture.map);
    }

    void check_compare(const CompareSpec& compare) {
        const auto name = kCompareKinds[static_cast<std::size_t>(compare.kind)];
        const auto require = [&](bool given, std::string_view key, std::string_view example) {
            if (!given)
                fail(source_, place({"compare.surface.kind", "compare.surface.centre", "compare.depth"}),
                     "the {} that forces are compared with needs a {}: surface = {{ kind = \"{}\", {} }} in [compare]",
                     name, key, name, example);
        };
        const SurfaceKind own = scene_.surface.kind;
        const bool bump = own == SurfaceKind::bump || own == SurfaceKind::cylinder_bump;
        if (compare.kind == CompareKind::sphere || (compare.kind == CompareKind::cylinder && !bump))
            require(compare.radius.has_value(), "radius", "radius = \"20 mm\"");
        if (compare.kind == CompareKind::mesh)
            require(!compare.file.file.empty(), "file", "file = \"fine.obj\"");
        if (compare.radius)
            check_length("compare.surface.radius", *compare.radius);
        check_length("compare.depth", compare.depth);
        if (bump && compare.kind == CompareKind::cylinder && compare.radius && !compare.centre)
            warn(place({"compare.surface.radius"}),
                 "a cylinder with a radius has its axis through the origin unless centre says otherwise; the bump's "
                 "own, through its edges, is surface = {{ kind = \"cylinder\" }} without a radius");
    }

    void check_grid() {
        const GridSpec& grid = scene_.grid;
        const double rows = static_cast<double>(grid.size[1]) * static_cast<double>(grid.size[2]);
        if (grid.size[0] > kMostColumns)
            fail(source_, place({"grid.size"}, 0), "size has {} samples along x; an EXR holds up to {}", grid.size[0],
                 kMostColumns);
        if (rows > static_cast<double>(kMostRows))
            fail(source_, place({"grid.size"}, 1), "size has {:.0f} rows, y times z; an EXR holds up to {}", rows,
                 kMostRows);
        const double voxels = rows * static_cast<double>(grid.size[0]);
        if (voxels > kMostVoxels)
            fail(source_, place({"grid.size"}), "size has {:.0f} voxels; the limit is {:.0f}, 2^48", voxels,
                 kMostVoxels);
        for (std::size_t axis = 0; axis < 3; ++axis)
            attempt([&] { check_axis(axis); });
    }

    void check_axis(std::size_t axis) {
        const GridSpec& grid = scene_.grid;
        const double farthest = grid.farthest(axis);
        if (!(farthest <= range_.largest_length))
            fail(source_, place({"grid.origin", "grid.spacing", "grid.size"}, axis),
                 "the grid reaches {} along {}; {} allows {}", in_unit_of("grid.origin", farthest, axis),
                 kAxisNames[axis], range_.name, in_unit_of("grid.origin", range_.largest_length, axis));
        const double step = step_at(farthest, scene_.precision);
        // A mesh is evaluated in a frame of its own, about its centre.
        if (grid.size[axis] < 2 || grid.spacing[axis] >= step || scene_.surface.kind == SurfaceKind::mesh)
            return;
        const Value& spacing = *find("grid.spacing");
        const bool single = scene_.precision == Precision::f32;
        warn(place({"grid.spacing", "grid.origin", "grid.size"}, axis),
             "spacing {} is below the {} step {:.2g} m at {}: neighbouring voxels sample the same point; {}move the "
             "grid",
             spacing.texts[spacing.one_for_all ? 0 : axis], range_.name, step, length_text(farthest),
             single ? "use precision f64 or " : "");
    }

    void check_sizes(const Key& key, const Value& value) {
        const bool along = key.subject == Subject::friction || key.forms == kFormVibration; // the surface
        if ((key.subject != Subject::paths && key.subject != Subject::hand && !along) ||
            key.kind != ValueKind::quantity)
            return;
        for (std::size_t i = 0; i < value.numbers.size(); ++i) {
            const double size = std::abs(value.numbers[i]);
            const bool large = size > range_.largest_length;
            if (large || (needs_square(key) && size > 0 && size < range_.smallest_length))
                attempt([&] {
                    fail(source_, value.parts[i], "{} must be at {} {} in {}; got {}", key.path(),
                         large ? "most" : "least",
                         in_unit_of(key.path(), large ? range_.largest_length : range_.smallest_length, i), range_.name,
                         value.texts[i]);
                });
        }
    }

    // What is divided by, or squared and compared.
    static bool needs_square(const Key& key) {
        constexpr std::string_view kNames[] = {"bound", "quantisation", "mass", "rate", "stretch", "stribeck_speed"};
        return std::ranges::find(kNames, key.name) != std::end(kNames);
    }

    void check_friction(const FrictionSpec& friction) {
        constexpr double kMost = 1000; // far above any pair of materials
        attempt([&] { check_stiffness("friction.stiffness", friction.stiffness); });
        for (const auto& [key, coefficient] : {std::pair("friction.coefficient", friction.coefficient),
                                               std::pair("friction.static_coefficient", friction.static_coefficient)})
            if (coefficient > kMost) // never of an empty one
                fail(source_, place({key}), "{} must be at most {:g}; got {:g}", key, kMost, *coefficient);
        // With the file's coefficient, once it is read (CasePreparation).
        if (!friction.static_coefficient || (!friction.coefficient && scene_.vibration))
            return;
        if (const double least = friction.coefficient.value_or(kFrictionCoefficient);
            *friction.static_coefficient < least)
            fail(source_, place({"friction.static_coefficient"}),
                 "static_coefficient must be at least coefficient, {:g}; got {:g}", least,
                 *friction.static_coefficient);
    }

    void check_kind(const PathsSpec& paths) const {
        const SurfaceKind surface = scene_.surface.kind;
        if (paths.kind == PathKind::recorded && paths.file.empty())
            fail(source_, place({"paths.kind"}), "kind \"recorded\" needs a file: file = \"NAME.csv\" in [paths]");
        if (paths.follow == PathFollow::surface && surface != SurfaceKind::bump &&
            surface != SurfaceKind::cylinder_bump && surface != SurfaceKind::mesh)
            fail(source_, place({"paths.follow", "surface.kind"}),
                 "follow \"surface\" is for the kinds bump, cylinder_bump and mesh; the nominal surface of kind \"{}\" "
                 "is followed by \"plane\"",
                 find("surface.kind")->texts.front());
        if (paths.inner && paths.length && *paths.inner > *paths.length / 2)
            fail(source_, place({"paths.inner", "paths.length"}),
                 "inner, the smallest radius, is at most half of length: {} is more than half of {}{}",
                 text_of("paths.inner"), text_of("paths.length"),
                 half_in_other_unit("paths.inner", "paths.length", *paths.length / 2));
    }

    void check_drive(const PathsSpec& paths) const {
        if (paths.drive == PathDrive::depth)
            return;
        const char* name = paths.drive == PathDrive::press ? "press" : "push";
        const Location where = find(fmt::format("paths.{}", name))->where;
        if (!paths.closed())
            fail(source_, where,
                 "{} is a force of the hand, and an open loop has none: give depth, or loop = \"closed\"", name);
        if (paths.kind == PathKind::taps)
            fail(source_, where, "taps go down to a depth: give depth instead of {}", name);
        if (paths.depth_back)
            fail(source_, place({"paths.depth_back", "paths.depth_back.mean", "paths.depth_back.min"}),
                 "with {} the hand keeps no depth, on the way back neither", name);
    }

    void check_spread(const std::string& name) const {
        const std::string path = "paths." + name;
        const auto check_pair = [&](const char* one, const char* other) {
            const Value* first = find(fmt::format("{}.{}", path, one));
            const Value* second = find(fmt::format("{}.{}", path, other));
            if (!first != !second)
                fail(source_, (first ? first : second)->where, "{} = {{ {}, {} }} needs both; {} is missing", name, one,
                     other, first ? other : one);
            return std::pair(first, second);
        };
        check_pair("mean", "sd");
        const auto [low, high] = check_pair("min", "max");
        if (low && low->numbers.front() > high->numbers.front())
            fail(source_, low->where, "{}: min {} is more than max {}", name, low->texts.front(), high->texts.front());
    }

    template <typename... Parts> void warn(Location where, fmt::format_string<Parts...> message, Parts&&... parts) {
        add_once(location_prefix(source_, where) + fmt::format(message, std::forward<Parts>(parts)...), warnings_);
    }

    const Scene& scene_;
    const Selection& selection_;
    const Document& document_;
    const std::string& source_;
    Errors& errors_;
    std::vector<std::string>& warnings_;
    const Range& range_;
};

} // namespace

void check_scene(const Scene& scene, const Selection& selection, const Document& document, Errors& errors,
                 std::vector<std::string>& warnings) {
    Checker(scene, selection, document, errors, warnings).check();
}

} // namespace forceshade

#include "host/scene/path_check.h"

#include "host/error.h"

#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

namespace forceshade {

namespace {

// Sizes within which squares are normal numbers of the run's precision, in SI units.
struct Sizes {
    const char* name;
    double smallest, largest;
};
constexpr Sizes kSizesF32{"f32", 1e-15, 1e15};
constexpr Sizes kSizesF64{"f64", 1e-150, 1e150};

class PathChecker {
public:
    PathChecker(const Scene& scene, const Selection& selection, const std::string& source)
        : scene_(scene), selection_(selection), source_(source),
          sizes_(scene.precision == Precision::f32 ? kSizesF32 : kSizesF64) {}

    void check() const {
        for (std::size_t key = 0; key < selection_.size(); ++key)
            if (selection_[key])
                check_sizes(schema_keys()[key], *selection_[key]);
        if (!scene_.paths)
            return;
        check_kind(*scene_.paths);
        check_drive(*scene_.paths);
        for (const char* name : {"speed", "depth", "depth_back", "heading", "offset", "tremor.amplitude"})
            check_spread(name);
    }

private:
    const Value* find(std::string_view path) const { return selection_[static_cast<std::size_t>(find_key(path))]; }

    // The first of the keys that stands in the file; a default has no place.
    Location place(std::initializer_list<std::string> paths) const {
        for (const std::string& path : paths)
            if (const Value* value = find(path); value && value->where.line > 0)
                return value->where;
        return {};
    }

    void check_sizes(const Key& key, const Value& value) const {
        if ((key.subject != Subject::paths && key.subject != Subject::hand) || key.kind != ValueKind::quantity)
            return;
        const std::string_view unit = dimension_unit(key.dimension);
        for (std::size_t i = 0; i < value.numbers.size(); ++i) {
            const double size = std::abs(value.numbers[i]);
            if (size > sizes_.largest)
                fail(source_, value.parts[i],
                     fmt::format("{} must be at most {:g} {} in {}; got {} {}", key.path(), sizes_.largest, unit,
                                 sizes_.name, value.numbers[i], unit));
            if (needs_square(key) && size > 0 && size < sizes_.smallest)
                fail(source_, value.parts[i],
                     fmt::format("{} must be at least {:g} {} in {}; got {} {}", key.path(), sizes_.smallest, unit,
                                 sizes_.name, value.numbers[i], unit));
        }
    }

    // What is divided by, or squared and compared.
    static bool needs_square(const Key& key) {
        return key.name == "bound" || key.name == "quantisation" || key.name == "mass" || key.name == "rate" ||
               key.name == "stretch";
    }

    void check_kind(const PathsSpec& paths) const {
        const SurfaceKind surface = scene_.surface.kind;
        if (paths.kind == PathKind::recorded && paths.file.empty())
            fail(source_, place({"paths.kind"}), "kind \"recorded\" needs a file: file = \"NAME.csv\" in [paths]");
        if (paths.follow == PathFollow::surface && surface != SurfaceKind::bump &&
            surface != SurfaceKind::cylinder_bump)
            fail(source_, place({"paths.follow", "surface.kind"}),
                 fmt::format("follow \"surface\" is for the kinds bump and cylinder_bump; the nominal surface of kind "
                             "\"{}\" is followed by \"plane\"",
                             find("surface.kind")->texts.front()));
        if (paths.inner && paths.length && *paths.inner > *paths.length / 2)
            fail(source_, place({"paths.inner", "paths.length"}),
                 fmt::format("inner, the smallest radius, is at most half of length: {} m is more than {} m",
                             *paths.inner, *paths.length / 2));
    }

    void check_drive(const PathsSpec& paths) const {
        if (paths.drive == PathDrive::depth)
            return;
        const char* name = paths.drive == PathDrive::press ? "press" : "push";
        const Location where = place({fmt::format("paths.{}", name)});
        if (!paths.closed())
            fail(source_, where,
                 fmt::format("{} is a force of the hand, and an open loop has none: give depth, or loop = \"closed\"",
                             name));
        if (paths.kind == PathKind::taps)
            fail(source_, where, fmt::format("taps go down to a depth: give depth instead of {}", name));
        if (paths.depth_back)
            fail(source_, place({"paths.depth_back", "paths.depth_back.mean", "paths.depth_back.min"}),
                 fmt::format("with {} the hand keeps no depth, on the way back neither", name));
    }

    void check_spread(const std::string& name) const {
        const std::string path = "paths." + name;
        const auto check_pair = [&](const char* one, const char* other) {
            const Value* first = find(fmt::format("{}.{}", path, one));
            const Value* second = find(fmt::format("{}.{}", path, other));
            if (!first != !second)
                fail(source_, (first ? first : second)->where,
                     fmt::format("{} = {{ {}, {} }} needs both; {} is missing", name, one, other, first ? other : one));
            return std::pair(first, second);
        };
        check_pair("mean", "sd");
        const auto [low, high] = check_pair("min", "max");
        if (low && low->numbers.front() > high->numbers.front())
            fail(source_, low->where,
                 fmt::format("{}: min {} is more than max {}", name, low->texts.front(), high->texts.front()));
    }

    const Scene& scene_;
    const Selection& selection_;
    const std::string& source_;
    const Sizes& sizes_;
};

} // namespace

void check_paths(const Scene& scene, const Selection& selection, const std::string& source) {
    PathChecker(scene, selection, source).check();
}

} // namespace forceshade

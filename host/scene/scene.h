// A scene: one case of a study, resolved, in SI units (m, N, N/m, rad); and the limits of what it may ask for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace forceshade {

/// Most samples along x: OpenEXR holds a block of 16 rows of three floats in half of 2^31 bytes.
inline constexpr std::uint64_t kMostColumns = (2147483647u / 2) / (16 * 3 * sizeof(float));
/// Most rows, y times z: OpenEXR refuses images that are higher.
inline constexpr std::uint64_t kMostRows = 2147483647u / 2 - 1;

/// The steepest gradient of a height map in f32 and in f64.
inline constexpr double kSteepestF32 = 1e15;
inline constexpr double kSteepestF64 = 1e150;

// What is evaluated, where, and what is written.

enum class SurfaceKind { bump, cylinder_bump, height_map, mesh };
enum class FacetSpacing { equal_arc, equal_x };
enum class Shading { none, reference, height_map, morgenbesser, barycentric, mean_value, two_pass };
enum class DepthReading { vertical, normal };
enum class ReferenceDirection { normal, radial };
enum class MapFunction { cylinder, dip, sine, gaussian, file };
/// How the normals of a vertex's facets are weighted in the vertex's own (L7).
enum class NormalWeights {
    plain,  // equally, as in the paper
    angle,  // by the facet's angle at the vertex, which does not depend on how a face was cut into facets
    file,   // not at all: corners have the normals of their file
    groups, // equally, of facets of the same smoothing group only
    crease  // equally, of facets that meet at no sharper an angle than a given one
};
enum class InsideTest { pseudonormal, winding, automatic };
enum class Orientation { file, outward };
enum class TextureEffect { force, normal };
enum class Compression { none, zip1, zip, pxr24 };
enum class PixelType { float32, half };
enum class Precision { f32, f64 };
enum class PathKind { strokes, raster, circle, spiral, taps, random_walk, minimum_jerk, recorded };
enum class PathLoop { open, closed };
enum class PathFollow { plane, surface };
enum class PathDrive { depth, press, push };
enum class CompareKind { sphere, cylinder, plane, mesh };
enum class CompareAxis { x, y, z };

/// "f32" or "f64".
constexpr const char* name_of(Precision precision) {
    return precision == Precision::f32 ? "f32" : "f64";
}
/// That of float, and of double.
template <typename T>
inline constexpr Precision kPrecisionOf = std::is_same_v<T, float> ? Precision::f32 : Precision::f64;
/// What run(std::type_identity<T>) gives for the T of a precision.
template <typename Run> decltype(auto) in_precision(Precision precision, Run&& run) {
    return precision == Precision::f32 ? run(std::type_identity<float>()) : run(std::type_identity<double>());
}

/// A file that a scene names.
struct FileSpec {
    std::string file;   /* as written in the scene; empty if none was */
    std::string path;   /* absolute, never written into results */
    std::string sha256; /* of the file's bytes, lower-case hex; empty until the file is read, if the scene gives none */
    std::string place;  /* where the scene names it, `bump.toml:14:8` */
    friend bool operator==(const FileSpec& a, const FileSpec& b) {
        return a.file == b.file && a.path == b.path && a.sha256 == b.sha256;
    }
};

/// G3: U(x, y) over the plane, analytic or from an image file.
struct HeightMapSpec : FileSpec {
    MapFunction function = MapFunction::cylinder;
    double width = 0.0254;                      /* m: cylinder and dip: W = 2a; sine: wavelength along x */
    double radius = 0.01524;                    /* m: cylinder and dip: R >= a; gaussian: where U is height/e */
    double height = 0.001;                      /* m: sine and gaussian: peak; file: what a sample of 1 means */
    std::array<double, 2> size{0.0254, 0.0254}; /* m: extent in x and y between the outermost samples */
    friend bool operator==(const HeightMapSpec&, const HeightMapSpec&) = default;
};

/// Polygons from a file, and where they are put: vertex v of the file lies at rotate(scale * unit * v) + translate.
struct MeshSpec : FileSpec {
    double unit = 1; /* m: what a coordinate of 1 means */
    NormalWeights normals = NormalWeights::plain;
    double crease = 0; /* rad: of NormalWeights::crease */
    double weld = 0;   /* m: vertices no further apart are one */
    Orientation orient = Orientation::file;
    InsideTest inside = InsideTest::automatic; /* until the mesh is known */
    double scale = 1;
    std::array<double, 3> rotate{};    /* rad: about x, then y, then z */
    std::array<double, 3> translate{}; /* m */
    friend bool operator==(const MeshSpec&, const MeshSpec&) = default;
};

struct SurfaceSpec {
    SurfaceKind kind = SurfaceKind::bump;
    double width = 0.0254;    /* m: W = 2a */
    double radius = 0.01524;  /* m: R >= a */
    std::uint32_t facets = 1; /* n >= 1 */
    FacetSpacing facet_spacing = FacetSpacing::equal_arc;
    HeightMapSpec map; /* kind height_map only */
    MeshSpec mesh;     /* kind mesh only */
    friend bool operator==(const SurfaceSpec&, const SurfaceSpec&) = default;
};

struct ForceSpec {
    double stiffness = 1000.0; /* K, N/m */
    Shading shading = Shading::none;
    DepthReading depth = DepthReading::vertical;
    ReferenceDirection reference = ReferenceDirection::normal;
    friend bool operator==(const ForceSpec&, const ForceSpec&) = default;
};

struct TextureSpec {
    double stiffness = 0.0; /* K_t, N/m */
    HeightMapSpec map;
    TextureEffect effect = TextureEffect::force; /* L8, or L9 on a mesh */
    friend bool operator==(const TextureSpec&, const TextureSpec&) = default;
};

/// Friction on the surface by an elastic bristle (L10), of paths and of the live loop.
struct FrictionSpec {
    std::optional<double> coefficient; /* 1: Coulomb's; empty: that of the vibration file, if it has one, else 0.3 */
    std::optional<double> static_coefficient; /* 1: no less than the other; empty: the same */
    double stribeck_speed = 0.01;             /* m/s */
    double stiffness = 500;                   /* N/m: of the bristle */
    double damping = 0;                       /* N s/m: of the bristle */
    double viscous = 0;                       /* N s/m */
    friend bool operator==(const FrictionSpec&, const FrictionSpec&) = default;
};
inline constexpr double kFrictionCoefficient = 0.3;

/// A material's recorded vibration (L11), of paths and of the live loop: the file's is an acceleration.
struct VibrationSpec : FileSpec {
    double mass = 0.05; /* kg: force over acceleration */
    std::uint64_t seed = 1;
    friend bool operator==(const VibrationSpec&, const VibrationSpec&) = default;
};

/// A shape that forces are compared with: what K and its depth would give, along its normal.
struct CompareSpec {
    CompareKind kind = CompareKind::sphere;
    double depth = 0.002;                        /* m: of contact, to which deviations are summed up */
    std::optional<double> radius;                /* m: sphere, cylinder; a bump's own smooth shape needs none */
    std::optional<std::array<double, 3>> centre; /* m: of the sphere; a place of the cylinder's axis or of the plane */
    std::optional<CompareAxis> axis;             /* of the cylinder, y; that the plane faces, z */
    FileSpec file;                               /* of the mesh; what follows is, left out, the scene's own mesh's */
    std::optional<double> unit, scale;           /* m; 1 */
    std::optional<std::array<double, 3>> rotate, translate; /* rad, m */
    friend bool operator==(const CompareSpec&, const CompareSpec&) = default;
};

/// Voxel (i, j, k) samples origin + spacing * (i, j, k).
struct GridSpec {
    std::array<std::uint64_t, 3> size{256, 64, 128};
    std::array<double, 3> origin{-0.025, -0.006, -0.010};  /* m */
    std::array<double, 3> spacing{0.0002, 0.0002, 0.0002}; /* m */
    std::uint64_t samples = 0; /* along the longest side of a mesh's box and 5 %: size, origin and spacing are made from
                                  them when the mesh is read; 0: they are given */
    bool every_y = false; /* computed at each y, although the scene's own force may not depend on it: of a renderer */
    /// m: where a sample lies along an axis, and where the last one does.
    double at(std::size_t axis, std::uint64_t sample) const {
        return origin[axis] + spacing[axis] * static_cast<double>(sample);
    }
    double last(std::size_t axis) const { return at(axis, size[axis] - 1); }
    /// m: of its samples along an axis, at most.
    double farthest(std::size_t axis, double from = 0) const {
        return std::max(std::abs(origin[axis] - from), std::abs(last(axis) - from));
    }
    friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

struct OutputSpec {
    std::uint32_t channels = 1; /* layout::kChannel... bits; force is always among them */
    Compression compression = Compression::zip;
    PixelType pixel = PixelType::float32;
    friend bool operator==(const OutputSpec&, const OutputSpec&) = default;
};

/// A quantity that may differ from path to path, in SI units.
struct Spread {
    enum class Shape { fixed, normal, uniform };
    Shape shape = Shape::fixed;
    double value = 0;         /* fixed: the value; normal: the mean */
    double sd = 0;            /* normal: the standard deviation */
    double low = 0, high = 0; /* uniform: the range */
    friend bool operator==(const Spread&, const Spread&) = default;
};

constexpr Spread fixed_spread(double value) {
    return {Spread::Shape::fixed, value, 0, 0, 0};
}

/// Exploration paths through a scene. What is not given follows from the surface (host/paths/motions.h).
struct PathsSpec : FileSpec {
    PathKind kind = PathKind::strokes;
    std::uint64_t count = 1000; /* paths */
    std::uint64_t steps = 2000; /* samples of each */
    double rate = 1000;         /* Hz */
    std::uint64_t seed = 1;
    std::optional<PathLoop> loop; /* as written */
    PathDrive drive = PathDrive::depth;
    Spread speed = fixed_spread(0.1);            /* m/s */
    Spread depth = fixed_spread(0.001);          /* m: below the surface */
    std::optional<Spread> depth_back;            /* m: strokes: on the way back */
    double press = 1;                            /* N: into the surface */
    std::array<double, 3> push{};                /* N: the hand's constant force */
    Spread heading;                              /* rad: of the strokes, from x to y */
    Spread offset;                               /* m: of the path's middle to the left of the heading */
    Spread tremor_amplitude;                     /* m: root mean square on each axis */
    double tremor_frequency = 10;                /* Hz */
    std::optional<std::array<double, 2>> centre; /* m */
    std::optional<double> height;                /* m: z of the plane that depth is measured from */
    PathFollow follow = PathFollow::plane;
    std::optional<double> length;  /* m: of a stroke; of circles and spirals the largest diameter */
    std::optional<double> width;   /* m: across */
    std::uint64_t lines = 16;      /* of a raster; rounds of a spiral on its way out */
    std::optional<double> inner;   /* m: the smallest radius of a spiral */
    std::optional<double> lift;    /* m: of taps, above the surface at the top */
    double start_depth = 0;        /* m: closed loop: below the target at the start */
    std::optional<double> bound;   /* m: closed loop: further from the target is unstable */
    std::optional<double> stretch; /* m: the path length over which a turn of the force is measured */

    bool closed() const { return loop ? *loop == PathLoop::closed : drive != PathDrive::depth; }
    friend bool operator==(const PathsSpec&, const PathsSpec&) = default;
};

/// The hand and the device that it holds, used in closed loop.
struct HandSpec {
    double mass = 0.1;           /* kg */
    double damping = 1;          /* N s/m: of the device */
    double grip_stiffness = 500; /* N/m */
    double grip_damping = 2;     /* N s/m */
    std::uint64_t delay_samples = 0;
    double quantisation = 0;               /* m: step of the measured position; 0: none */
    double coulomb = 0;                    /* N: friction on each axis */
    double max_force = 8.5;                /* N */
    double coupling_stiffness = 0;         /* N/m: of a virtual coupling; 0: none */
    double coupling_damping = 0;           /* N s/m */
    std::optional<double> coupling_filter; /* s: time constant with which its damper takes the speed */
    std::optional<double> passivity;       /* N s/m: the most that a live loop's passivity controller may damp */

    bool coupled() const { return coupling_stiffness > 0; }
    friend bool operator==(const HandSpec&, const HandSpec&) = default;
};

struct Scene {
    SurfaceSpec surface;
    ForceSpec force;
    std::optional<TextureSpec> texture; /* [texture] with a height map */
    std::optional<FrictionSpec> friction;
    std::optional<VibrationSpec> vibration;
    GridSpec grid;
    bool field = true; /* false: a scene with [paths] and without [grid] asks for paths only */
    std::optional<PathsSpec> paths;
    HandSpec hand;
    std::optional<CompareSpec> compare;
    OutputSpec output;
    Precision precision = Precision::f32;
    /// The force along the surface has a history, which the CPU alone computes.
    bool rubs() const { return friction || vibration; }
    friend bool operator==(const Scene&, const Scene&) = default;
};

/// The files that a scene may name, with the keys that name them: without a name where it names none.
template <typename SceneOrConst> auto files_of(SceneOrConst& scene) {
    using File = std::conditional_t<std::is_const_v<SceneOrConst>, const FileSpec, FileSpec>;
    auto& surface = scene.surface;
    const bool mesh = surface.kind == SurfaceKind::mesh;
    std::vector<std::pair<std::string_view, File*>> files{
        {"surface.file", mesh ? static_cast<File*>(&surface.mesh) : &surface.map}};
    if (scene.texture)
        files.emplace_back("texture.file", &scene.texture->map);
    if (scene.vibration)
        files.emplace_back("texture.vibration", &*scene.vibration);
    if (scene.paths)
        files.emplace_back("paths.file", &*scene.paths);
    if (scene.compare)
        files.emplace_back("compare.surface.file", &scene.compare->file);
    return files;
}

} // namespace forceshade

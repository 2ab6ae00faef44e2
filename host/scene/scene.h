// A scene: one case of a study, resolved, in SI units (m, N, N/m, rad). What is evaluated, where, and what is written.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace forceshade {

enum class SurfaceKind { bump, cylinder_bump, height_map, mesh };
enum class FacetSpacing { equal_arc, equal_x };
enum class Shading { none, reference, height_map, morgenbesser, barycentric, mean_value, two_pass };
enum class DepthReading { vertical, normal };
enum class ReferenceDirection { normal, radial };
enum class MapFunction { cylinder, dip, sine, gaussian, file };
enum class NormalWeights { plain, angle };
enum class InsideTest { pseudonormal, winding };
enum class TextureEffect { force, normal };
enum class Compression { none, zip1, zip, pxr24 };
enum class PixelType { float32, half };
enum class Precision { f32, f64 };

/// G3: U(x, y) over the plane, analytic or from an image file.
struct HeightMapSpec {
    MapFunction function = MapFunction::cylinder;
    double width = 0.0254;                      /* m: cylinder and dip: W = 2a; sine: wavelength along x */
    double radius = 0.01524;                    /* m: cylinder and dip: R >= a; gaussian: where U is height/e */
    double height = 0.001;                      /* m: sine and gaussian: peak; file: what a sample of 1 means */
    std::string file;                           /* as written in the scene; resolved by `path` */
    std::string path;                           /* absolute path of the file, never written into results */
    std::string sha256;                         /* of the file's bytes, lower-case hex; empty until the file is read */
    std::array<double, 2> size{0.0254, 0.0254}; /* m: extent in x and y between the outermost samples */
    friend bool operator==(const HeightMapSpec&, const HeightMapSpec&) = default;
};

/// Polygons from a file, and where they are put: vertex v of the file lies at rotate(scale * unit * v) + translate.
struct MeshSpec {
    std::string file;   /* as written in the scene; empty if none was */
    std::string path;   /* absolute path of the file, never written into results */
    std::string sha256; /* of the file's bytes, lower-case hex; empty until the file is read */
    double unit = 1;    /* m: what a coordinate of 1 means */
    NormalWeights normals = NormalWeights::plain;
    InsideTest inside = InsideTest::pseudonormal;
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

/// Voxel (i, j, k) samples origin + spacing * (i, j, k).
struct GridSpec {
    std::array<std::uint64_t, 3> size{256, 64, 128};
    std::array<double, 3> origin{-0.025, -0.006, -0.010};  /* m */
    std::array<double, 3> spacing{0.0002, 0.0002, 0.0002}; /* m */
    std::uint64_t samples = 0; /* along the longest side of a mesh's box and 5 %: size, origin and spacing are made from
                                  them when the mesh is read; 0: they are given */
    friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

struct OutputSpec {
    std::uint32_t channels = 1; /* layout::kChannel... bits; force is always among them */
    Compression compression = Compression::zip;
    PixelType pixel = PixelType::float32;
    friend bool operator==(const OutputSpec&, const OutputSpec&) = default;
};

struct Scene {
    SurfaceSpec surface;
    ForceSpec force;
    std::optional<TextureSpec> texture;
    GridSpec grid;
    OutputSpec output;
    Precision precision = Precision::f32;
    friend bool operator==(const Scene&, const Scene&) = default;
};

} // namespace forceshade

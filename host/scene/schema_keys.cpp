#include "host/scene/schema_keys.h"

#include <array>
#include <vector>

#include "host/scene/scene.h"
#include "host/scene/value.h"
#include "shaders/shared/law.h"

namespace forceshade {

namespace {

using Names = std::string_view;

// Each list is in the order of its enumeration in scene.h.
constexpr std::array<Names, 2> kFacetSpacings{"equal_arc", "equal_x"};
constexpr std::array<Names, 7> kShadings{"none",        "reference",  "height_map", "morgenbesser",
                                         "barycentric", "mean_value", "two_pass"};
constexpr std::array<Names, 2> kTextureEffects{"force", "normal"};
constexpr std::array<Names, 2> kDepthReadings{"vertical", "normal"};
constexpr std::array<Names, 2> kReferenceDirections{"normal", "radial"};
constexpr std::array<Names, 5> kChannels{"force", "depth", "facet", "proxy",
                                         "unshaded"}; // bit i of layout::kChannel...
constexpr std::array<Names, 4> kCompressions{"none", "zip1", "zip", "pxr24"};
constexpr std::array<Names, 2> kPixelTypes{"float", "half"};
constexpr std::array<Names, 2> kPrecisions{"f32", "f64"};

constexpr Names kMapChoice = "map"; // a function or a file
constexpr std::uint32_t kFormCircular = kFormMapCylinder | kFormMapDip;
constexpr std::uint32_t kFormAnalytic = kFormCircular | kFormMapSine | kFormMapGaussian;

template <typename Spec> void set_file(Spec& map, const Value& value) {
    if constexpr (std::is_same_v<Spec, HeightMapSpec>)
        map.function = MapFunction::file;
    map.file = value.texts.at(0);
    map.path = value.path;
    map.sha256 = value.sha256;
}

void set_channels(Scene& scene, const Value& value) {
    scene.output.channels = layout::kChannelForce;
    for (const std::uint64_t index : value.integers)
        scene.output.channels |= 1u << index;
}

void add_surface(std::vector<Key>& keys) {
    keys.push_back(
        {"surface", "kind", ValueKind::choice, "\"bump\"",
         "what the probe touches: n facets on a plane (L1, L3, L4), plane and cylinder superposed (L2), or a plane "
         "shaded by a height map (L5), or the facets of a polygon mesh (L6, L7)",
         [](Scene& s, const Value& v) { s.surface.kind = choice<SurfaceKind>(v); }});
    keys.back().choices = kSurfaceKinds;
    keys.push_back({.table = "surface",
                    .name = "width",
                    .kind = ValueKind::quantity,
                    .default_text = "\"1000 mil\"",
                    .doc = "W = 2a, the feature's width along x; of a sine the wavelength",
                    .set =
                        [](Scene& s, const Value& v) {
                            (s.surface.kind == SurfaceKind::height_map ? s.surface.map.width : s.surface.width) =
                                v.numbers.at(0);
                        },
                    .subject = Subject::surface,
                    .forms = kFormBumps | kFormCircular | kFormMapSine,
                    .sign = Sign::positive});
    keys.push_back({.table = "surface",
                    .name = "radius",
                    .kind = ValueKind::quantity,
                    .default_text = "\"600 mil\"",
                    .doc = "R of the cylinder, at least width / 2; of a Gaussian, where it has fallen to height / e",
                    .set =
                        [](Scene& s, const Value& v) {
                            (s.surface.kind == SurfaceKind::height_map ? s.surface.map.radius : s.surface.radius) =
                                v.numbers.at(0);
                        },
                    .subject = Subject::surface,
                    .forms = kFormBumps | kFormCircular | kFormMapGaussian,
                    .sign = Sign::positive});
}

void add_facets(std::vector<Key>& keys) {
    keys.push_back(
        {.table = "surface",
         .name = "facets",
         .kind = ValueKind::integer,
         .default_text = "1",
         .doc = "n, the number of facets across the width; 1 is the flat plane",
         .set = [](Scene& s, const Value& v) { s.surface.facets = static_cast<std::uint32_t>(v.integers.at(0)); },
         .subject = Subject::surface,
         .forms = kFormBump,
         .largest = 100000000}); // a table of as many vertices takes 0.8 GB in f64
    keys.push_back({.table = "surface",
                    .name = "facet_spacing",
                    .kind = ValueKind::choice,
                    .default_text = "\"equal_arc\"",
                    .doc = "whether facets span equal arcs of the cylinder or equal steps of x (G2)",
                    .set = [](Scene& s, const Value& v) { s.surface.facet_spacing = choice<FacetSpacing>(v); },
                    .subject = Subject::surface,
                    .forms = kFormBump,
                    .choices = kFacetSpacings});
}

void add_force(std::vector<Key>& keys) {
    keys.push_back({.table = "force",
                    .name = "stiffness",
                    .kind = ValueKind::quantity,
                    .default_text = "\"1 N/mm\"",
                    .doc = "K, force for each length of penetration",
                    .set = [](Scene& s, const Value& v) { s.force.stiffness = v.numbers.at(0); },
                    .dimension = Dimension::stiffness,
                    .sign = Sign::positive});
    keys.push_back(
        {.table = "force",
         .name = "shading",
         .kind = ValueKind::choice,
         .default_text = "\"none\"",
         .doc = "where the force's direction comes from: the surface itself; the smooth cylinder (kind bump only); "
                "the height map (kind height_map only); of a mesh its vertex normals, interpolated as in the paper, by "
                "barycentric coordinates (triangles only), by mean value coordinates, or those with a force that is as "
                "strong along the facet's normal as the unshaded one (Ruspini 1997)",
         .set = [](Scene& s, const Value& v) { s.force.shading = choice<Shading>(v); },
         .choices = kShadings});
    keys.push_back({.table = "force",
                    .name = "depth",
                    .kind = ValueKind::choice,
                    .default_text = "\"vertical\"",
                    .doc = "how the penetration into a facet is read: straight down, or along the facet's normal (L3)",
                    .set = [](Scene& s, const Value& v) { s.force.depth = choice<DepthReading>(v); },
                    .subject = Subject::surface,
                    .forms = kFormBump,
                    .choices = kDepthReadings});
    keys.push_back(
        {.table = "force",
         .name = "reference",
         .kind = ValueKind::choice,
         .default_text = "\"normal\"",
         .doc = "the direction that the smooth cylinder lends: its surface's normal above the probe, or away from its "
                "axis at the probe itself (L4)",
         .set = [](Scene& s, const Value& v) { s.force.reference = choice<ReferenceDirection>(v); },
         .subject = Subject::shading,
         .forms = kFormBump,
         .choices = kReferenceDirections});
}

// A height map's keys of [surface] and [texture]: `map` finds its part of a scene.
using SetMap = void (*)(Scene&, const Value&);
struct MapSetters {
    SetMap function, file, size, height;
};
struct MapTexts {
    std::string_view function, height; // defaults
    std::string_view file;             // what the file is
    std::uint32_t file_forms;
};

void add_map(std::vector<Key>& keys, std::string_view table, Subject subject, const MapTexts& texts,
             const MapSetters& set) {
    keys.push_back(
        {.table = table,
         .name = "function",
         .kind = ValueKind::choice,
         .default_text = texts.function,
         .doc = "the height map U(x, y) (G3): a bump or dip of width and radius, height sin(2 pi x / width), or "
                "height exp(-(x^2 + y^2) / radius^2); or give a file instead",
         .set = set.function,
         .subject = subject,
         .forms = kFormAnalytic,
         .choices = kMapFunctions,
         .choice = kMapChoice});
    keys.push_back({.table = table,
                    .name = "file",
                    .kind = ValueKind::file,
                    .default_text = "",
                    .doc = texts.file,
                    .set = set.file,
                    .subject = subject,
                    .forms = texts.file_forms,
                    .choice = kMapChoice,
                    .option = 1});
    keys.push_back({.table = table,
                    .name = "sha256",
                    .kind = ValueKind::digest,
                    .default_text = "",
                    .doc = "what the file's bytes must hash to; a list if `file` is one; left out: any",
                    .set = nullptr,
                    .subject = subject,
                    .forms = texts.file_forms,
                    .axis = false});
    keys.push_back({.table = table,
                    .name = "size",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"25.4 mm\", \"25.4 mm\"]",
                    .doc = "the image's extent in x and y, between its outermost samples",
                    .set = set.size,
                    .subject = subject,
                    .forms = kFormMapFile,
                    .sign = Sign::positive,
                    .count = 2});
    keys.push_back({.table = table,
                    .name = "height",
                    .kind = ValueKind::quantity,
                    .default_text = texts.height,
                    .doc = "the peak of a sine or Gaussian; what an image's sample of 1 means",
                    .set = set.height,
                    .subject = subject,
                    .forms = kFormMapSine | kFormMapGaussian | kFormMapFile});
}

constexpr std::string_view kImageFile = "an EXR or PNG image of the height map, relative to this TOML file or "
                                        "absolute, centred on the origin; its row 0 is "
                                        "the largest y";

void add_texture(std::vector<Key>& keys) {
    keys.push_back({.table = "texture",
                    .name = "effect",
                    .kind = ValueKind::choice,
                    .default_text = "\"force\"",
                    .doc = "what the height map below does: add a tangential force (L8), or tilt the force as it would "
                           "tilt the normals of a mesh, whose nominal surface stays as it is (L9)",
                    .set = [](Scene& s, const Value& v) { s.texture->effect = choice<TextureEffect>(v); },
                    .subject = Subject::texture,
                    .forms = kFormAnalytic | kFormMapFile,
                    .choices = kTextureEffects});
    keys.push_back({.table = "texture",
                    .name = "stiffness",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0.2 N/mm\"",
                    .doc = "K_t of the tangential force -K_t d grad h (L8), h the height map below",
                    .set = [](Scene& s, const Value& v) { s.texture->stiffness = v.numbers.at(0); },
                    .subject = Subject::texture,
                    .forms = kFormAnalytic | kFormMapFile,
                    .dimension = Dimension::stiffness,
                    .sign = Sign::not_negative});
    add_map(keys, "texture", Subject::texture, {"\"sine\"", "\"0.1 mm\"", kImageFile, kFormMapFile},
            {[](Scene& s, const Value& v) { s.texture->map.function = choice<MapFunction>(v); },
             [](Scene& s, const Value& v) { set_file(s.texture->map, v); },
             [](Scene& s, const Value& v) { s.texture->map.size = components<2>(v); },
             [](Scene& s, const Value& v) { s.texture->map.height = v.numbers.at(0); }});
    keys.push_back({.table = "texture",
                    .name = "width",
                    .kind = ValueKind::quantity,
                    .default_text = "\"2 mm\"",
                    .doc = "the width of a bump or dip; the wavelength of a sine",
                    .set = [](Scene& s, const Value& v) { s.texture->map.width = v.numbers.at(0); },
                    .subject = Subject::texture,
                    .forms = kFormCircular | kFormMapSine,
                    .sign = Sign::positive});
    keys.push_back({.table = "texture",
                    .name = "radius",
                    .kind = ValueKind::quantity,
                    .default_text = "\"5 mm\"",
                    .doc = "R of a bump or dip, at least width / 2; of a Gaussian, where it has fallen to height / e",
                    .set = [](Scene& s, const Value& v) { s.texture->map.radius = v.numbers.at(0); },
                    .subject = Subject::texture,
                    .forms = kFormCircular | kFormMapGaussian,
                    .sign = Sign::positive});
}

void add_grid(std::vector<Key>& keys) {
    keys.push_back({.table = "grid",
                    .name = "size",
                    .kind = ValueKind::integer,
                    .default_text = "[256, 64, 128]",
                    .doc = "voxels along x, y and z; an EXR holds up to 5592405 along x and 1073741822 rows, y times z",
                    .set =
                        [](Scene& s, const Value& v) {
                            for (std::size_t i = 0; i < 3; ++i)
                                s.grid.size[i] = v.integers.at(i);
                        },
                    .largest = kMostRows,
                    .count = 3});
    keys.push_back({.table = "grid",
                    .name = "samples",
                    .kind = ValueKind::integer,
                    .default_text = "128",
                    .doc = "voxels along the longest side of a mesh's bounding box and 5 % more; the grid covers that "
                           "box. Stands for size, origin and spacing",
                    .set = [](Scene& s, const Value& v) { s.grid.samples = v.integers.at(0); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .largest = 65536});
    keys.push_back({.table = "grid",
                    .name = "origin",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"-25 mm\", \"-6 mm\", \"-10 mm\"]",
                    .doc = "the first voxel's sample; voxel (i, j, k) samples origin + spacing (i, j, k)",
                    .set = [](Scene& s, const Value& v) { s.grid.origin = components<3>(v); },
                    .count = 3});
    keys.push_back({.table = "grid",
                    .name = "spacing",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0.2 mm\"",
                    .doc = "from one sample to the next, one length for all axes or one for each",
                    .set = [](Scene& s, const Value& v) { s.grid.spacing = components<3>(v); },
                    .sign = Sign::positive,
                    .count = 3,
                    .one_for_all = true});
}

void add_output(std::vector<Key>& keys) {
    keys.push_back(
        {.table = "output",
         .name = "channels",
         .kind = ValueKind::choices,
         .default_text = "[\"force\"]",
         .doc = "what is written: force (always), penetration depth, facet id, proxy, and the force without shading",
         .set = set_channels,
         .choices = kChannels});
    keys.push_back({.table = "output",
                    .name = "compression",
                    .kind = ValueKind::choice,
                    .default_text = "\"zip\"",
                    .doc = "how the EXR is compressed; all but pxr24 keep every bit",
                    .set = [](Scene& s, const Value& v) { s.output.compression = choice<Compression>(v); },
                    .choices = kCompressions});
    keys.push_back({.table = "output",
                    .name = "pixel",
                    .kind = ValueKind::choice,
                    .default_text = "\"float\"",
                    .doc = "32 or 16 bits a sample; half is refused where a value would overflow",
                    .set = [](Scene& s, const Value& v) { s.output.pixel = choice<PixelType>(v); },
                    .choices = kPixelTypes});
    keys.push_back({.table = "run",
                    .name = "precision",
                    .kind = ValueKind::choice,
                    .default_text = "\"f32\"",
                    .doc = "the arithmetic that the field is evaluated in",
                    .set = [](Scene& s, const Value& v) { s.precision = choice<Precision>(v); },
                    .choices = kPrecisions});
}

} // namespace

std::vector<Key> make_keys() {
    std::vector<Key> keys;
    add_surface(keys);
    add_facets(keys);
    add_map(keys, "surface", Subject::surface,
            {"\"cylinder\"", "\"1 mm\"",
             "of a height map an image (EXR or PNG), centred on the origin, its row 0 the largest y; of a mesh its "
             "polygons (OBJ, OFF, PLY or STL); relative to this TOML file or absolute",
             kFormMapFile | kFormMesh},
            {[](Scene& s, const Value& v) { s.surface.map.function = choice<MapFunction>(v); },
             [](Scene& s, const Value& v) {
                 s.surface.kind == SurfaceKind::mesh ? set_file(s.surface.mesh, v) : set_file(s.surface.map, v);
             },
             [](Scene& s, const Value& v) { s.surface.map.size = components<2>(v); },
             [](Scene& s, const Value& v) { s.surface.map.height = v.numbers.at(0); }});
    add_mesh_keys(keys);
    add_force(keys);
    add_texture(keys);
    add_grid(keys);
    add_path_keys(keys);
    add_hand_keys(keys);
    add_output(keys);
    return keys;
}

namespace {

constexpr std::array<std::string_view, 2> kNormals{"plain", "angle"};
constexpr std::array<std::string_view, 2> kInsideTests{"pseudonormal", "winding"};

void add_transform(std::vector<Key>& keys) {
    keys.push_back({.table = "surface",
                    .name = "transform.scale",
                    .kind = ValueKind::number,
                    .default_text = "1",
                    .doc = "the mesh is made so many times larger, then turned, then moved",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.scale = v.numbers.at(0); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .sign = Sign::positive});
    keys.push_back({.table = "surface",
                    .name = "transform.rotate",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"0 deg\", \"0 deg\", \"0 deg\"]",
                    .doc = "turns about the fixed x axis, then y, then z, through the file's origin",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.rotate = components<3>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .dimension = Dimension::angle,
                    .count = 3});
    keys.push_back({.table = "surface",
                    .name = "transform.translate",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"0 m\", \"0 m\", \"0 m\"]",
                    .doc = "where the file's origin is put",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.translate = components<3>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .count = 3});
}

} // namespace

void add_mesh_keys(std::vector<Key>& keys) {
    keys.push_back({.table = "surface",
                    .name = "unit",
                    .kind = ValueKind::unit,
                    .default_text = "\"m\"",
                    .doc = "what a coordinate of 1 means in the mesh's file, for example \"mm\"",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.unit = v.numbers.at(0); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .sign = Sign::positive});
    keys.push_back({.table = "surface",
                    .name = "normals",
                    .kind = ValueKind::choice,
                    .default_text = "\"plain\"",
                    .doc =
                        "a vertex normal is the plain average of its facets' normals, as in the paper, or weighted by "
                        "their angles there, which does not depend on how a face was cut into triangles (L7)",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.normals = choice<NormalWeights>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .choices = kNormals});
    keys.push_back({.table = "surface",
                    .name = "inside",
                    .kind = ValueKind::choice,
                    .default_text = "\"pseudonormal\"",
                    .doc =
                        "what tells inside from outside on a grid (L6): the normal of the nearest feature, for closed "
                        "meshes, or the generalized winding number, which also serves meshes with holes",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.inside = choice<InsideTest>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .choices = kInsideTests});
    add_transform(keys);
}

} // namespace forceshade

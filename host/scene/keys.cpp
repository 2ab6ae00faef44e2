#include "host/scene/schema.h"

#include <array>
#include <deque>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "host/scene/scene.h"
#include "host/scene/value.h"
#include "shaders/shared/law.h"

namespace forceshade {

namespace {

using Names = std::span<const std::string_view>;
template <std::size_t n> using List = std::array<std::string_view, n>;

// In the order of the enumerations in scene.h, as those in schema.h.
constexpr List<2> kFacetSpacings{"equal_arc", "equal_x"};
constexpr List<5> kNormals{"plain", "angle", "file", "groups", "crease:30 deg"};
constexpr List<3> kInsideTests{"pseudonormal", "winding", "auto"};
constexpr List<2> kOrientations{"file", "outward"};
constexpr List<7> kShadings{"none", "reference", "height_map", "morgenbesser", "barycentric", "mean_value", "two_pass"};
constexpr List<2> kTextureEffects{"force", "normal"};
constexpr List<2> kDepthReadings{"vertical", "normal"};
constexpr List<2> kReferenceDirections{"normal", "radial"};
constexpr List<5> kChannels{"force", "depth", "facet", "proxy", "unshaded"}; // bit i of layout::kChannel...
constexpr List<4> kCompressions{"none", "zip1", "zip", "pxr24"};
constexpr List<2> kPixelTypes{"float", "half"};
constexpr List<3> kPrecisions{"f32", "f64", "auto"};
constexpr List<2> kLoops{"open", "closed"};
constexpr List<2> kFollows{"plane", "surface"};
constexpr List<3> kAxes{"x", "y", "z"};

constexpr Sign kPositive = Sign::positive, kNotNegative = Sign::not_negative;
constexpr std::uint32_t kFormCircular = kFormMapCylinder | kFormMapDip;
constexpr std::uint32_t kFormAnalytic = kFormCircular | kFormMapSine | kFormMapGaussian;

constexpr std::uint32_t bit(PathKind kind) {
    return 1u << static_cast<std::uint32_t>(kind);
}
constexpr std::uint32_t bit(CompareKind kind) {
    return 1u << static_cast<std::uint32_t>(kind);
}
constexpr std::uint32_t kAllPaths = 255;
constexpr std::uint32_t kMade = kAllPaths & ~bit(PathKind::recorded); // by a generator
constexpr std::uint32_t kMadeButWalks = kMade & ~bit(PathKind::random_walk);

// Setters: a value's content becomes a member of the scene.

using Set = void (*)(Scene&, const Value&);

template <typename T> void assign(T& to, const Value& value, std::size_t part = 0) {
    if constexpr (std::is_floating_point_v<T>)
        to = value.numbers.at(part);
    else
        to = static_cast<T>(value.integers.at(part));
}
template <typename T, std::size_t n> void assign(std::array<T, n>& to, const Value& value) {
    for (std::size_t i = 0; i < n; ++i)
        assign(to[i], value, i);
}
void assign(Spread& to, const Value& value) {
    to = fixed_spread(value.numbers.at(0));
}
template <typename T> void assign(std::optional<T>& to, const Value& value) {
    assign(to.emplace(), value);
}

// A member of the struct that a scene has of its kind.
template <typename Spec, typename T> T& field(Scene& s, T Spec::*member) {
    const std::tuple parts(&s, &s.surface, &s.surface.mesh, &s.force, &s.grid, &s.hand, &s.output,
                           s.texture ? &*s.texture : nullptr, s.paths ? &*s.paths : nullptr,
                           s.compare ? &*s.compare : nullptr, s.friction ? &*s.friction : nullptr,
                           s.vibration ? &*s.vibration : nullptr);
    return std::get<Spec*>(parts)->*member;
}

template <auto member> void store(Scene& s, const Value& v) {
    assign(field(s, member), v);
}
// The plane's map or the texture's.
template <bool texture, auto member> void store_in_map(Scene& s, const Value& v) {
    assign((texture ? s.texture->map : s.surface.map).*member, v);
}
// The same key of a bump and of a height map.
template <auto of_bump, auto of_map> void store_in_surface(Scene& s, const Value& v) {
    assign(s.surface.kind == SurfaceKind::height_map ? s.surface.map.*of_map : s.surface.*of_bump, v);
}
void store_precision(Scene& s, const Value& v) {
    s.precision = v.integers.at(0) == 1 ? Precision::f64 : Precision::f32; // auto: until the mesh is known
}
void store_normals(Scene& s, const Value& v) {
    s.surface.mesh.normals = static_cast<NormalWeights>(v.integers.at(0));
    s.surface.mesh.crease = v.numbers.empty() ? 0 : v.numbers[0];
}
void store_file(FileSpec& spec, const Value& value) {
    spec = {value.texts.at(0), value.path, value.sha256, value.place};
}
void store_image(HeightMapSpec& map, const Value& value) {
    map.function = MapFunction::file;
    store_file(map, value);
}
template <PathDrive drive, auto member> void store_drive(Scene& s, const Value& v) {
    s.paths->drive = drive;
    store<member>(s, v);
}
void store_channels(Scene& scene, const Value& value) {
    scene.output.channels = layout::kChannelForce;
    for (const std::uint64_t index : value.integers)
        scene.output.channels |= 1u << index;
}

// The part `number` of a quantity that may differ from path to path.
template <auto member, Spread::Shape shape, double Spread::*number> void store_in_spread(Scene& s, const Value& v) {
    auto& to = field(s, member);
    Spread* spread = nullptr;
    if constexpr (std::is_same_v<decltype(to), Spread&>)
        spread = &to;
    else
        spread = to ? &*to : &to.emplace();
    spread->shape = shape;
    assign(spread->*number, v);
}

// The components that a member's key has, by the member's type.
template <typename T> constexpr std::uint32_t kCount = 1;
template <typename T, std::size_t n> constexpr std::uint32_t kCount<std::array<T, n>> = n;
template <typename T> constexpr std::uint32_t kCount<std::optional<T>> = kCount<T>;
template <typename Spec, typename T> constexpr std::uint32_t count_of(T Spec::*) {
    return kCount<T>;
}

using Text = std::string_view;

/// A table of the schema, to which rows are added: a name, the default as TOML, what it means, and traits. Rows apply
/// to the table's subject and, where they name no forms, to the table's forms.
class Table {
public:
    Table(std::vector<Key>& keys, Text name, Subject subject = Subject::none, std::uint32_t forms = 0)
        : keys_(keys), name_(name), subject_(subject), forms_(forms) {}

    Key& add(ValueKind kind, Text name, Text default_text, Set set, Text doc, const KeyTraits& traits = {}) {
        Key& key = keys_.emplace_back(Key{traits, name_, name, kind, default_text, doc, set, subject_});
        if (key.forms == 0)
            key.forms = forms_;
        return key;
    }
    Key& quantity(Dimension dimension, Text name, Text default_text, Set set, Text doc, const KeyTraits& traits = {}) {
        Key& key = add(ValueKind::quantity, name, default_text, set, doc, traits);
        key.dimension = dimension;
        return key;
    }
    template <auto member>
    void quantity(Dimension dimension, Text name, Text default_text, Text doc, const KeyTraits& traits = {}) {
        quantity(dimension, name, default_text, store<member>, doc, traits).count = count_of(member);
    }
    template <auto member> void length(Text name, Text default_text, Text doc, const KeyTraits& traits = {}) {
        quantity<member>(Dimension::length, name, default_text, doc, traits);
    }
    template <auto member>
    void integer(Text name, Text default_text, std::uint64_t largest, Text doc, const KeyTraits& traits = {}) {
        Key& key = add(ValueKind::integer, name, default_text, store<member>, doc, traits);
        key.largest = largest;
        key.count = count_of(member);
    }
    template <auto member>
    void choice(Text name, Text default_text, Names names, Text doc, const KeyTraits& traits = {}) {
        add(ValueKind::choice, name, default_text, store<member>, doc, traits).choices = names;
    }
    /// It belongs to the table's file and sets nothing by itself.
    void digest(std::uint32_t forms, Text name = "sha256") {
        add(ValueKind::digest, name, "", nullptr,
            "what the file's bytes must hash to; a list if `file` is one; left out: any",
            {.forms = forms, .example = "\"(64 hexadecimal digits)\""})
            .axis = false;
    }
    template <auto member>
    void spread(Dimension dimension, Text name, Text default_text, Text doc, KeyTraits traits = {});
    template <bool texture>
    void height_map(Text function, Text height, Text file, Set set_file, std::uint32_t file_forms);

private:
    std::vector<Key>& keys_;
    Text name_;
    Subject subject_;
    std::uint32_t forms_;
};

// Keys whose value may differ from path to path: "speed" as a quantity, or as a table with mean and sd, or min and max,
// which replace each other.
template <auto member>
void Table::spread(Dimension dimension, Text name, Text default_text, Text doc, KeyTraits traits) {
    using enum Spread::Shape;
    static std::deque<std::string> part_names; // keys refer to them
    traits.choice = name;
    quantity<member>(dimension, name, default_text, doc, traits);
    const Sign sign = traits.sign;
    const auto add_part = [&](const char* part, int option, Sign part_sign, Set set, Text meaning) {
        traits.option = option;
        traits.sign = part_sign;
        part_names.push_back(std::string(name) + part);
        quantity(dimension, part_names.back(), "", set, meaning, traits).spread_part = true;
    };
    add_part(".mean", 1, sign, store_in_spread<member, normal, &Spread::value>,
             "the mean of a normal distribution, with sd");
    add_part(".sd", 1, kNotNegative, store_in_spread<member, normal, &Spread::sd>,
             "the standard deviation of a normal distribution, with mean");
    add_part(".min", 2, sign, store_in_spread<member, uniform, &Spread::low>,
             "the lower end of a uniform distribution, with max");
    add_part(".max", 2, sign, store_in_spread<member, uniform, &Spread::high>,
             "the upper end of a uniform distribution, with min");
}

// What [surface] and [texture] have in common; `function` and `height` are defaults, `file` says what the file is.
template <bool texture>
void Table::height_map(Text function, Text height, Text file, Set set_file, std::uint32_t file_forms) {
    constexpr Text kMapChoice = "map"; // a function or a file
    add(ValueKind::choice, "function", function, store_in_map<texture, &HeightMapSpec::function>,
        "the height map U(x, y) (G3): a bump or dip of width and radius, height sin(2 pi x / width), or height "
        "exp(-(x^2 + y^2) / radius^2); or give a file instead",
        {.forms = kFormAnalytic, .choice = kMapChoice})
        .choices = kMapFunctions;
    add(ValueKind::file, "file", "", set_file, file,
        {.forms = file_forms, .example = "\"u.exr\"", .choice = kMapChoice, .option = 1});
    digest(file_forms);
    quantity(Dimension::length, "size", "[\"25.4 mm\", \"25.4 mm\"]", store_in_map<texture, &HeightMapSpec::size>,
             "the image's extent in x and y, between its outermost samples", {.forms = kFormMapFile, .sign = kPositive})
        .count = 2;
    quantity(Dimension::length, "height", height, store_in_map<texture, &HeightMapSpec::height>,
             "the peak of a sine or Gaussian; what an image's sample of 1 means",
             {.forms = kFormMapSine | kFormMapGaussian | kFormMapFile});
}

void add_surface(std::vector<Key>& keys) {
    Table(keys, "surface")
        .choice<&SurfaceSpec::kind>(
            "kind", "\"bump\"", kSurfaceKinds,
            "what the probe touches: n facets on a plane (L1, L3, L4), plane and cylinder superposed (L2), or a plane "
            "shaded by a height map (L5), or the facets of a polygon mesh (L6, L7)");
    Table surface(keys, "surface", Subject::surface);
    surface.quantity(Dimension::length, "width", "\"1000 mil\"",
                     store_in_surface<&SurfaceSpec::width, &HeightMapSpec::width>,
                     "W = 2a, the feature's width along x; of a sine the wavelength",
                     {.forms = kFormBumps | kFormCircular | kFormMapSine, .sign = kPositive});
    surface.quantity(Dimension::length, "radius", "\"600 mil\"",
                     store_in_surface<&SurfaceSpec::radius, &HeightMapSpec::radius>,
                     "R of the cylinder, at least width / 2; of a Gaussian, where it has fallen to height / e",
                     {.forms = kFormBumps | kFormCircular | kFormMapGaussian, .sign = kPositive});
    constexpr std::uint64_t kMostFacets = 100000000; // a table of as many vertices takes 0.8 GB in f64
    surface.integer<&SurfaceSpec::facets>("facets", "1", kMostFacets,
                                          "n, the number of facets across the width; 1 is the flat plane",
                                          {.forms = kFormBump});
    surface.choice<&SurfaceSpec::facet_spacing>(
        "facet_spacing", "\"equal_arc\"", kFacetSpacings,
        "whether facets span equal arcs of the cylinder or equal steps of x (G2)", {.forms = kFormBump});
    surface.height_map<false>(
        "\"cylinder\"", "\"1 mm\"",
        "of a height map an image (EXR or PNG), centred on the origin, its row 0 the largest y; of a mesh its polygons "
        "(OBJ, OFF, PLY or STL); relative to this TOML file or absolute",
        [](Scene& s, const Value& v) {
            s.surface.kind == SurfaceKind::mesh ? store_file(s.surface.mesh, v) : store_image(s.surface.map, v);
        },
        kFormMapFile | kFormMesh);

    Table mesh(keys, "surface", Subject::surface, kFormMesh);
    mesh.add(ValueKind::unit, "unit", "\"m\"", store<&MeshSpec::unit>,
             "what a coordinate of 1 means in the mesh's file, for example \"mm\"", {.sign = kPositive});
    mesh.add(ValueKind::choice, "normals", "\"plain\"", store_normals,
             "a vertex normal is the plain average of its facets' normals, as in the paper, or weighted by their "
             "angles there, which does not depend on how a face was cut into triangles, or what the file says, as "
             "other renderers have it (vn of an OBJ; nx, ny and nz of a PLY), or the plain average within each "
             "smoothing group of an OBJ, or over those facets that are connected across edges at which they meet at no "
             "sharper an angle (L7)")
        .choices = kNormals;
    mesh.choice<&MeshSpec::inside>(
        "inside", "\"auto\"", kInsideTests,
        "how inside is found on a grid (L6): the normal of the nearest feature, for closed meshes whose pieces do not "
        "cross, or the generalized winding number, which also serves crossing pieces and meshes with holes; auto: the "
        "first for sheets and for meshes that bound solids, else the second");
    mesh.choice<&MeshSpec::orient>("orient", "\"file\"", kOrientations,
                                   "which way facets face: as the file has them, or turned so that those of a piece "
                                   "agree and closed pieces face outward, but for cavities");
    mesh.length<&MeshSpec::weld>("weld", "\"0 m\"",
                                 "vertices no further apart are joined into one, and chains of them; of equal "
                                 "coordinates always (after unit and transform.scale)",
                                 {.sign = kNotNegative});
    mesh.add(ValueKind::number, "transform.scale", "1", store<&MeshSpec::scale>,
             "the mesh is made so many times larger, then turned, then moved", {.sign = kPositive});
    mesh.quantity<&MeshSpec::rotate>(Dimension::angle, "transform.rotate", "[\"0 deg\", \"0 deg\", \"0 deg\"]",
                                     "turns about the fixed x axis, then y, then z, through the file's origin");
    mesh.length<&MeshSpec::translate>("transform.translate", "[\"0 m\", \"0 m\", \"0 m\"]",
                                      "where the file's origin is put");
}

void add_force(std::vector<Key>& keys) {
    Table force(keys, "force");
    force.quantity<&ForceSpec::stiffness>(Dimension::stiffness, "stiffness", "\"1 N/mm\"",
                                          "K, force for each length of penetration", {.sign = kPositive});
    force.choice<&ForceSpec::shading>(
        "shading", "\"none\"", kShadings,
        "where the force's direction comes from: the surface itself; the smooth cylinder (kind bump only); the height "
        "map (kind height_map only); of a mesh its vertex normals, interpolated as in the paper, by barycentric "
        "coordinates (triangles only), by mean value coordinates, or those with a force that is as strong along the "
        "facet's normal as the unshaded one (Ruspini 1997), and so grows without bound the further it is turned");
    Table(keys, "force", Subject::surface, kFormBump)
        .choice<&ForceSpec::depth>(
            "depth", "\"vertical\"", kDepthReadings,
            "how the penetration into a facet is read: straight down, or along the facet's normal (L3)");
    Table(keys, "force", Subject::shading, kFormBump)
        .choice<&ForceSpec::reference>("reference", "\"normal\"", kReferenceDirections,
                                       "the direction that the smooth cylinder lends: its surface's normal above the "
                                       "probe, or away from its axis at the probe itself (L4)");

    Table texture(keys, "texture", Subject::texture, kFormAnalytic | kFormMapFile);
    texture.choice<&TextureSpec::effect>(
        "effect", "\"force\"", kTextureEffects,
        "what the height map below does: add a tangential force (L8), or tilt the force as it would tilt the normals "
        "of a mesh, whose nominal surface stays as it is (L9)");
    texture.quantity<&TextureSpec::stiffness>(Dimension::stiffness, "stiffness", "\"0.2 N/mm\"",
                                              "K_t of the tangential force -K_t d grad h (L8), h the height map below",
                                              {.sign = kNotNegative});
    texture.height_map<true>(
        "\"sine\"", "\"0.1 mm\"",
        "an EXR or PNG image of the height map, relative to this TOML file or absolute, centred on the origin; its row "
        "0 is the largest y",
        [](Scene& s, const Value& v) { store_image(s.texture->map, v); }, kFormMapFile);
    texture.quantity(Dimension::length, "width", "\"2 mm\"", store_in_map<true, &HeightMapSpec::width>,
                     "the width of a bump or dip; the wavelength of a sine",
                     {.forms = kFormCircular | kFormMapSine, .sign = kPositive});
    texture.quantity(Dimension::length, "radius", "\"5 mm\"", store_in_map<true, &HeightMapSpec::radius>,
                     "R of a bump or dip, at least width / 2; of a Gaussian, where it has fallen to height / e",
                     {.forms = kFormCircular | kFormMapGaussian, .sign = kPositive});

    constexpr std::uint32_t kAnyTexture = kFormAnalytic | kFormMapFile | kFormVibration;
    Table vibration(keys, "texture", Subject::texture, kFormVibration);
    texture.add(ValueKind::file, "vibration", "", [](Scene& s, const Value& v) { store_file(*s.vibration, v); },
                "a material's recorded vibration (L11), an XML file of the Penn Haptic Texture Toolkit, relative to "
                "this TOML file or absolute; with no key of a height map [texture] has none. Of paths and the live "
                "loop, on the CPU alone",
                {.forms = kAnyTexture, .example = "\"Models_Cork.xml\""});
    texture.digest(kAnyTexture, "vibration_sha256");
    vibration.quantity<&VibrationSpec::mass>(
        Dimension::mass, "vibration_mass", "\"50 g\"",
        "the force is the file's acceleration times this: the effective mass of the tool with which it was recorded",
        {.sign = kPositive});
    vibration.integer<&VibrationSpec::seed>("vibration_seed", "1", 9223372036854775807,
                                            "of the vibration's noise: a path follows from it and its own number",
                                            {.smallest = 0});
}

// Of the bristle's stiffness 0.6 mm at 1 N, which loops of 1 kHz resolve at 100 mm/s and hands hold.
void add_friction(std::vector<Key>& keys) {
    Table friction(keys, "friction", Subject::friction);
    friction.add(
        ValueKind::number, "coefficient", "", store<&FrictionSpec::coefficient>,
        "Coulomb's coefficient of friction; left out: that of the vibration file of [texture], if it has one, else 0.3",
        {.sign = kNotNegative, .example = "0.3"});
    friction.add(ValueKind::number, "static_coefficient", "", store<&FrictionSpec::static_coefficient>,
                 "at rest, no less than coefficient; left out: the same, which is Dahl's model (1968)",
                 {.sign = kNotNegative, .example = "0.4"});
    friction.quantity<&FrictionSpec::stribeck_speed>(
        Dimension::speed, "stribeck_speed", "\"10 mm/s\"",
        "at which friction is half way from the static to Coulomb's coefficient", {.sign = kPositive});
    friction.quantity<&FrictionSpec::stiffness>(
        Dimension::stiffness, "stiffness", "\"500 N/m\"",
        "of the bristle, a spring along the surface that the probe drags behind it (L10); a loop is stable up to the "
        "same stiffness as on a wall",
        {.sign = kPositive});
    friction.quantity<&FrictionSpec::damping>(Dimension::damping, "damping", "\"0 N s/m\"",
                                              "against the speed at which the bristle bends", {.sign = kNotNegative});
    friction.quantity<&FrictionSpec::viscous>(Dimension::damping, "viscous", "\"0 N s/m\"",
                                              "against the speed along the surface", {.sign = kNotNegative});
}

void add_grid(std::vector<Key>& keys) {
    Table grid(keys, "grid");
    grid.integer<&GridSpec::size>(
        "size", "[256, 64, 128]", kMostRows,
        "voxels along x, y and z; an EXR holds up to 5592405 along x and 1073741822 rows, y times z");
    Table(keys, "grid", Subject::surface, kFormMesh)
        .integer<&GridSpec::samples>("samples", "128", 65536,
                                     "voxels along the longest side of a mesh's bounding box and 5 % more; the grid "
                                     "covers that box. Stands for size, origin and spacing");
    grid.length<&GridSpec::origin>("origin", "[\"-25 mm\", \"-6 mm\", \"-10 mm\"]",
                                   "the first voxel's sample; voxel (i, j, k) samples origin + spacing (i, j, k)");
    grid.length<&GridSpec::spacing>("spacing", "\"0.2 mm\"",
                                    "from one sample to the next, one length for all axes or one for each",
                                    {.sign = kPositive, .one_for_all = true});
}

void add_paths(std::vector<Key>& keys) {
    constexpr std::uint32_t kRecorded = bit(PathKind::recorded), kRaster = bit(PathKind::raster);
    constexpr std::string_view kDepthChoice = "depth"; // a depth, or the force that the hand presses with
    Table paths(keys, "paths", Subject::paths, kAllPaths);
    Table made(keys, "paths", Subject::paths, kMade); // not of recorded ones
    Table turned(keys, "paths", Subject::paths, kMadeButWalks);
    paths.choice<&PathsSpec::kind>("kind", "\"strokes\"", kPathKinds,
                                   "how the probe is meant to go: straight there and back, line after line, round a "
                                   "circle, in a spiral, up and down, at random (band limited), from point to point "
                                   "(minimum jerk: Flash & Hogan 1985), or as recorded in a file");
    paths.add(ValueKind::file, "file", "", [](Scene& s, const Value& v) { store_file(*s.paths, v); },
              "recorded paths as CSV with a header and columns path, t, x, y, z (s, m), times of a path increasing; a "
              "single path needs no column path; relative to this TOML file or absolute",
              {.forms = kRecorded, .example = "\"paths.csv\""});
    paths.digest(kRecorded);
    made.integer<&PathsSpec::count>("count", "1000", 1073741822, "paths; an EXR holds up to 1073741822");
    made.integer<&PathsSpec::steps>("steps", "2000", 1073741822, "samples of each path; an EXR holds up to 5592405");
    paths.quantity<&PathsSpec::rate>(
        Dimension::frequency, "rate", "\"1 kHz\"",
        "samples a second; recorded paths have times of their own, which in closed loop keep to it",
        {.sign = kPositive});
    made.integer<&PathsSpec::seed>("seed", "1", 9223372036854775807,
                                   "of the random numbers: a path follows from it and from its own number alone",
                                   {.smallest = 0});
    paths.choice<&PathsSpec::loop>("loop", "", kLoops,
                                   "whether the probe is where the path is, or a hand and a device take it there "
                                   "([hand]); left out: closed with press or push, else open",
                                   {.example = "\"open\""});

    // How it is driven.
    made.spread<&PathsSpec::speed>(
        Dimension::speed, "speed", "\"100 mm/s\"",
        "along the path; of a spiral at its largest radius, of taps the mean, of a random walk the root mean square, "
        "of minimum jerk the mean over the mean distance of two points",
        {.sign = kPositive});
    made.spread<&PathsSpec::depth>(Dimension::length, "depth", "\"1 mm\"",
                                   "below the plane or surface that the path follows; negative: above it");
    paths.quantity(Dimension::force, "press", "", store_drive<PathDrive::press, &PathsSpec::press>,
                   "instead of depth: the constant force that the hand presses down with, in closed loop; nothing else "
                   "then holds the probe along z but damping",
                   {.sign = kNotNegative, .example = "\"1 N\"", .choice = kDepthChoice, .option = 3});
    paths
        .quantity(Dimension::force, "push", "", store_drive<PathDrive::push, &PathsSpec::push>,
                  "the same as a vector: the hand's constant force along x, y and z (press is -z)",
                  {.example = "[\"0 N\", \"0 N\", \"-1 N\"]", .choice = kDepthChoice, .option = 4})
        .count = 3;
    paths.spread<&PathsSpec::depth_back>(
        Dimension::length, "depth_back", "",
        "below the plane or surface on the way back; left out: as deep as on the way there",
        {.forms = bit(PathKind::strokes), .example = "\"1 mm\""});
    turned.spread<&PathsSpec::heading>(
        Dimension::angle, "heading", "\"0 deg\"",
        "the direction of strokes and lines, from x towards y; other paths are turned by it");
    turned.spread<&PathsSpec::offset>(Dimension::length, "offset", "\"0 m\"",
                                      "of the path's middle from the centre, to the left of its heading");
    turned.spread<&PathsSpec::tremor_amplitude>(
        Dimension::length, "tremor.amplitude", "\"0 m\"",
        "root mean square of the trembling on each axis, four harmonics within 20 % of its frequency",
        {.sign = kNotNegative});
    turned.quantity<&PathsSpec::tremor_frequency>(
        Dimension::frequency, "tremor.frequency", "\"10 Hz\"",
        "of the trembling; that of a healthy hand has 8 to 12 Hz (Elble & Koller 1990)", {.sign = kPositive});

    // Where it goes.
    made.length<&PathsSpec::centre>(
        "centre", "", "x and y of the paths' middle; left out: the origin, of a mesh the middle of its box",
        {.example = "[\"0 m\", \"0 m\"]"});
    made.length<&PathsSpec::height>(
        "height", "", "z of the plane that depth is measured from; left out: 0, of a mesh the top of its box",
        {.example = "\"0 m\""});
    made.choice<&PathsSpec::follow>("follow", "\"plane\"", kFollows,
                                    "whether depth is measured from that plane, or from the nominal surface of a bump "
                                    "or cylinder_bump raised by that height; of a mesh, from its highest place above "
                                    "or below, or the plane next to it (rounds then count as one)");
    paths.length<&PathsSpec::length>(
        "length", "",
        "of a stroke or line from end to end, of a region along the heading, of a circle or spiral the largest "
        "diameter; left out: 1.2 times the feature's width along x, of a mesh its box's, but half of that box where a "
        "hand presses, which would fall off its rim, and where its surface is followed",
        {.forms = kMade & ~bit(PathKind::taps), .sign = kNotNegative, .example = "\"30 mm\""});
    paths.length<&PathsSpec::width>("width", "",
                                    "of a region across the heading; left out: the length, of a mesh 1.2 times its "
                                    "box's along y, or half of it where a hand presses",
                                    {.forms = kRaster | bit(PathKind::random_walk) | bit(PathKind::minimum_jerk),
                                     .sign = kNotNegative,
                                     .example = "\"30 mm\""});
    paths.integer<&PathsSpec::lines>("lines", "16", 1000000,
                                     "of a raster; of a spiral the rounds from its smallest radius to its largest",
                                     {.forms = kRaster | bit(PathKind::spiral)});
    paths.length<&PathsSpec::inner>("inner", "", "the smallest radius of a spiral; left out: a twentieth of the length",
                                    {.forms = bit(PathKind::spiral), .sign = kNotNegative, .example = "\"1.5 mm\""});
    paths.length<&PathsSpec::lift>("lift", "",
                                   "of taps, how far above the surface they turn round; left out: each path's depth",
                                   {.forms = bit(PathKind::taps), .sign = kNotNegative, .example = "\"1 mm\""});
    paths.length<&PathsSpec::start_depth>("start_depth", "\"0 m\"", "how far below its path the probe begins, at rest",
                                          {.closed_loop = true});
    paths.length<&PathsSpec::bound>("bound", "",
                                    "a probe further than this from its path has left: the loop is unstable there, and "
                                    "the path ends; left out: 10 times the length and at least 0.1 m",
                                    {.sign = kPositive, .example = "\"0.3 m\"", .closed_loop = true});
    paths.length<&PathsSpec::stretch>(
        "stretch", "",
        "the path length over which the steepest turn of the force is measured; left out: a thousandth of the length",
        {.sign = kPositive, .example = "\"0.03 mm\""});
}

// The device's defaults are those of the Phantom that the paper used, the grip's those of a relaxed hand.
void add_hand(std::vector<Key>& keys) {
    Table hand(keys, "hand", Subject::hand);
    hand.quantity<&HandSpec::mass>(Dimension::mass, "mass", "\"0.1 kg\"",
                                   "that the hand moves at the device's tip (Massie & Salisbury 1994: the Phantom's "
                                   "apparent mass is below 0.1 kg)",
                                   {.sign = kPositive});
    hand.quantity<&HandSpec::damping>(
        Dimension::damping, "damping", "\"1 N s/m\"",
        "of the device, against the world: a round value at which a wall of 2 N/mm is just stable at 1 kHz by itself",
        {.sign = kNotNegative});
    hand.quantity<&HandSpec::grip_stiffness>(
        Dimension::stiffness, "grip_stiffness", "\"500 N/m\"",
        "of the spring that pulls the probe to its path; along z none with press or push. A round value, of the size "
        "that is measured at fingertips (Hajian & Howe 1997)",
        {.sign = kNotNegative});
    hand.quantity<&HandSpec::grip_damping>(Dimension::damping, "grip_damping", "\"2 N s/m\"",
                                           "of the grip, against its path's speed; a round value, too",
                                           {.sign = kNotNegative});
    hand.integer<&HandSpec::delay_samples>("delay_samples", "0", 1, "from a position measured to its force displayed",
                                           {.smallest = 0});
    hand.length<&HandSpec::quantisation>(
        "quantisation", "\"0 m\"",
        "step of the measured positions, 0 for none (a Phantom Premium's is nominally 0.03 mm)",
        {.sign = kNotNegative});
    hand.quantity<&HandSpec::coulomb>(Dimension::force, "coulomb", "\"0 N\"",
                                      "dry friction of the device on each axis (Massie & Salisbury 1994: below 0.1 N)",
                                      {.sign = kNotNegative});
    hand.quantity<&HandSpec::max_force>(Dimension::force, "max_force", "\"8.5 N\"",
                                        "the largest force that the device displays; larger ones keep their direction "
                                        "(a Phantom Premium 1.5 has 8.5 N)",
                                        {.sign = kPositive});
    hand.quantity<&HandSpec::coupling_stiffness>(
        Dimension::stiffness, "coupling.stiffness", "\"0 N/m\"",
        "of a virtual coupling, 0 for none: a spring and a damper between the device and the scene's tool (Colgate, "
        "Stanley & Brown 1995), so that scenes stiffer than the loop's limit are stable; a contact at rest displays at "
        "most this stiffness",
        {.sign = kNotNegative});
    hand.quantity<&HandSpec::coupling_damping>(Dimension::damping, "coupling.damping", "\"0 N s/m\"",
                                               "of the virtual coupling's damper", {.sign = kNotNegative});
    hand.quantity<&HandSpec::coupling_filter>(Dimension::time, "coupling.filter", "",
                                              "time constant of the low-pass filter, of first order, through which the "
                                              "damper takes the speed; left out: none, the difference of two samples",
                                              {.sign = kNotNegative, .example = "\"2 ms\""});
    hand.quantity<&HandSpec::passivity>(
        Dimension::damping, "passivity", "",
        "a live loop takes back what energy the hand is given (Hannaford & Ryu 2002), damping at most so much; left "
        "out: not, but for --passivity. Simulated loops leave it out",
        {.sign = kPositive, .example = "\"10 N s/m\""});
}

void add_compare(std::vector<Key>& keys) {
    using enum CompareKind;
    constexpr std::uint32_t kMesh = bit(mesh), kAnalytic = bit(sphere) | bit(cylinder) | bit(plane);
    Table compare(keys, "compare", Subject::compare, kMesh | kAnalytic);
    Table of_mesh(keys, "compare", Subject::compare, kMesh);
    compare.choice<&CompareSpec::kind>(
        "surface.kind", "\"sphere\"", kCompareKinds,
        "the shape that forces are compared with: the channels angle (deg, between the force and the shape's normal at "
        "the probe) and magnitude_error (N, the force's magnitude less K times the depth below the shape)");
    compare.length<&CompareSpec::depth>("depth", "\"2 mm\"",
                                        "root mean squares and largest sizes of the two are those of places where the "
                                        "contact is at most so deep, as a hand presses",
                                        {.sign = kPositive});
    compare.length<&CompareSpec::radius>(
        "surface.radius", "",
        "of a sphere or cylinder; left out: a bump's own smooth shape, its cylinder on its plane, with the normal "
        "above the probe and depth straight down, as shading takes it (L4)",
        {.forms = bit(sphere) | bit(cylinder), .sign = kPositive, .example = "\"20 mm\""});
    compare.length<&CompareSpec::centre>(
        "surface.centre", "", "of a sphere; a place of a cylinder's axis or of a plane; left out: the origin",
        {.forms = kAnalytic, .example = "[\"0 m\", \"0 m\", \"0 m\"]"});
    compare.choice<&CompareSpec::axis>(
        "surface.axis", "", kAxes, "along which a cylinder lies (left out: y), or to which a plane looks (left out: z)",
        {.forms = bit(cylinder) | bit(plane), .example = "\"y\""});
    of_mesh.add(ValueKind::file, "surface.file", "", [](Scene& s, const Value& v) { store_file(s.compare->file, v); },
                "of a mesh its polygons (OBJ, OFF, PLY or STL), closed; relative to this TOML file or absolute",
                {.example = "\"fine.obj\""});
    compare.digest(kMesh, "surface.sha256");
    of_mesh.add(ValueKind::unit, "surface.unit", "", store<&CompareSpec::unit>,
                "what a coordinate of 1 means in that file; left out, as transform: like the scene's own mesh, if it "
                "is one, else m",
                {.sign = kPositive, .example = "\"mm\""});
    of_mesh.add(ValueKind::number, "surface.transform.scale", "", store<&CompareSpec::scale>,
                "that mesh is made so many times larger, then turned, then moved", {.sign = kPositive, .example = "1"});
    of_mesh.quantity<&CompareSpec::rotate>(Dimension::angle, "surface.transform.rotate", "",
                                           "turns about the fixed x axis, then y, then z, through the file's origin",
                                           {.example = "[\"0 deg\", \"0 deg\", \"0 deg\"]"});
    of_mesh.length<&CompareSpec::translate>("surface.transform.translate", "", "where that file's origin is put",
                                            {.example = "[\"0 m\", \"0 m\", \"0 m\"]"});
}

void add_output(std::vector<Key>& keys) {
    Table output(keys, "output");
    output
        .add(ValueKind::choices, "channels", "[\"force\"]", store_channels,
             "what is written: force (always), penetration depth, facet id, proxy, and the force without shading")
        .choices = kChannels;
    output.choice<&OutputSpec::compression>("compression", "\"zip\"", kCompressions,
                                            "how the EXR is compressed; all but pxr24 keep every bit");
    output.choice<&OutputSpec::pixel>("pixel", "\"float\"", kPixelTypes,
                                      "32 or 16 bits a sample; half is refused where a value would overflow");
    Table(keys, "run")
        .add(ValueKind::choice, "precision", "\"f32\"", store_precision,
             "the arithmetic that forces are evaluated in; auto: f64 where a mesh has parts too thin for f32 (explore, "
             "field, score and Python), else f32; so is what names none")
        .choices = kPrecisions;
}

} // namespace

std::vector<Key> make_keys() {
    std::vector<Key> keys;
    for (const auto add :
         {add_surface, add_force, add_friction, add_grid, add_paths, add_hand, add_compare, add_output})
        add(keys);
    return keys;
}

} // namespace forceshade

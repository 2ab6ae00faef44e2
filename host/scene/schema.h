// The schema: every key of a scene or study in one table, from which parsing, checks, resolved text and help are made.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/value.h"

namespace forceshade {

struct Scene;
struct Value;

enum class ValueKind { quantity, unit, number, integer, choice, choices, file, digest, text, boolean };
enum class Sign { any, not_negative, positive };

/// What a scene's surface or texture is, as far as it decides which keys apply. A bit each.
enum Form : std::uint32_t {
    kFormBump = 1,
    kFormCylinderBump = 2,
    kFormMapCylinder = 4,
    kFormMapDip = 8,
    kFormMapSine = 16,
    kFormMapGaussian = 32,
    kFormMapFile = 64,
    kFormMesh = 128,
    kFormVibration = 256, // of a texture, perhaps besides that of a height map
};

inline constexpr std::uint32_t kFormBumps = kFormBump | kFormCylinderBump;

// In the order of SurfaceKind, of MapFunction, of which the last is no function but a file, of CompareKind, and of
// PathKind.
inline constexpr std::array<std::string_view, 4> kSurfaceKinds{"bump", "cylinder_bump", "height_map", "mesh"};
inline constexpr std::array<std::string_view, 4> kMapFunctions{"cylinder", "dip", "sine", "gaussian"};
inline constexpr std::array<std::string_view, 4> kCompareKinds{"sphere", "cylinder", "plane", "mesh"};
inline constexpr std::array<std::string_view, 8> kPathKinds{"strokes", "raster",      "circle",       "spiral",
                                                            "taps",    "random_walk", "minimum_jerk", "recorded"};

/// What decides whether a key applies: nothing, the surface's form, the texture's form, the shading of such a surface,
/// the kind of the paths, whether a hand moves the probe, the shape of [compare], the task of [experiment], or whether
/// there is friction.
enum class Subject { none, surface, texture, shading, paths, hand, compare, task, friction };

/// Optional key attributes.
struct KeyTraits {
    std::uint32_t forms =
        0; // bits of Form, or 1 << PathKind or CompareKind, that it applies to, if the subject has forms
    Sign sign = Sign::any;         // of a quantity or number
    std::string_view example = {}; // as TOML, where there is no default
    std::string_view choice = {};  // of keys of a table that share this, those with another option replace each other
    int option = 0;
    std::uint64_t smallest = 1; // of an integer
    bool one_for_all = false;   // one value may stand for all components
    bool closed_loop = false;   // of a key of paths: applies in closed loop only
};

struct Key : KeyTraits {
    std::string_view table;
    std::string_view name;
    ValueKind kind;
    std::string_view default_text; // as TOML; empty: none
    std::string_view doc;
    void (*set)(Scene&, const Value&); // null: of another table than a scene's
    Subject subject = Subject::none;
    Dimension dimension = Dimension::length; // of a quantity
    std::uint64_t largest = 0;               // of an integer
    std::span<const std::string_view> choices = {};
    std::uint32_t count = 1;  // components
    bool axis = true;         // a list where one value may stand is a sweep axis
    bool spread_part = false; // "speed.mean" and the like: what "speed" may be as a table

    /// "surface.radius"
    std::string path() const;
};

/// The selectors' outcome for one case.
struct Forms {
    std::uint32_t surface = kFormBump;
    std::uint32_t texture = 0; // 0: no texture
    bool reference_shading = false;
    std::uint32_t paths = 0; // 1 << PathKind; 0: no paths
    bool closed_loop = false;
    bool hand = false;         // a hand moves the probe
    std::uint32_t compare = 0; // 1 << CompareKind; 0: no [compare]
    bool friction = false;
    friend bool operator==(const Forms&, const Forms&) = default;
};

/// All keys, tables together, in canonical order: made once by make_keys (keys.cpp).
std::span<const Key> schema_keys();
std::vector<Key> make_keys();

/// The key of a file's digest, or the file's of a digest: "surface.sha256" of "surface.file", "vibration_sha256" of
/// "vibration".
std::string digest_name(std::string_view file);
std::string file_name(std::string_view digest);

/// The index in schema_keys() of "table.name", or -1.
int find_key(std::string_view path);

/// The index of a key that exists.
inline std::size_t key_index(std::string_view path) {
    return static_cast<std::size_t>(find_key(path));
}

bool applies(const Key& key, const Forms& forms);

/// `kind "height_map" with function "sine"`.
std::string describe_forms(const Key& key, const Forms& forms);

/// What a key applies to: `kind bump`, `function sine or gaussian`; empty if to everything.
std::string describe_applicability(const Key& key);

/// `length`, `integer`, `list of choices`.
std::string type_name(const Key& key);

/// What may stand there: choices, a range, or a unit.
std::string describe_values(const Key& key);

/// A value that may stand there: the default where the schema has no better one.
std::string_view example_of(const Key& key);

/// The schema as TOML with comments: each key with its default, unit or choices, and meaning. It parses as the default
/// scene.
std::string schema_text();

/// A part of that: a text as lines of comment, and a key with a value below its meaning, commented out unless `given`.
std::string comment_text(std::string text);
std::string key_text(const Key& key, std::string_view literal, bool given);

// Scenes to start from, which work as they stand.

inline constexpr std::array<std::string_view, 5> kStarters{"bump", "mesh", "paths", "live", "experiment"};

/// The unit, m, cm, mm or um, in which `across` is nearest to what a hand holds, 0.1 m. Models without a size, 1 to 3
/// across, get cm.
std::string_view unit_for_a_hand(double across);

/// A scene with comments, its keys explained in the schema's words. `what`: one of kStarters; of an experiment only the
/// stimuli. `mesh`: the file's name as the scene names it, `unit` that of its numbers. `scene`: what the commands in
/// its first lines call it.
std::string starter_scene(std::string_view what, std::string_view mesh, std::string_view unit, std::string_view scene);

} // namespace forceshade

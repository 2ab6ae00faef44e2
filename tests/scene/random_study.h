// Random studies as TOML text, most of them valid, for property tests.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <rapidcheck.h>

namespace forceshade::test {

struct RandomKey {
    const char* path;
    std::vector<std::string> values; // as TOML
};

inline const std::vector<RandomKey>& random_keys() {
    static const std::vector<RandomKey> keys{
        {"surface.kind", {"\"bump\"", "\"cylinder_bump\"", "\"height_map\"", "\"mesh\""}},
        {"surface.width", {"\"1 in\"", "\"0.1 \u00b5m\"", "\"25.4 mm\"", "\"3e-2 m\""}},
        {"surface.radius", {"\"600 mil\"", "\"15.24mm\"", "\"1 m\"", "\"1e7 m\"", "\"+.6 in\""}},
        {"surface.facets", {"1", "2", "1000000", "100000000"}},
        {"surface.facet_spacing", {"\"equal_arc\"", "\"equal_x\""}},
        {"surface.function", {"\"cylinder\"", "\"dip\"", "\"sine\"", "\"gaussian\""}},
        {"surface.file", {"\"u.exr\"", "\"v \u00e4 \\\" .png\""}},
        {"surface.size", {"[\"1 mm\", \"2 mm\"]", "[\"3 in\", \"1e-3 m\"]"}},
        {"surface.height", {"\"0 m\"", "\"-1 mm\"", "\"1e3 um\""}},
        {"surface.unit", {"\"m\"", "\"mm\"", "\"25 mil\""}},
        {"surface.normals", {"\"plain\"", "\"angle\""}},
        {"surface.inside", {"\"pseudonormal\"", "\"winding\""}},
        {"surface.transform.scale", {"1", "0.05", "1e-300", "7"}},
        {"surface.transform.rotate", {"[\"0 deg\", \"1 rad\", \"-90 deg\"]", "[\"1 deg\", \"0 rad\", \"0 deg\"]"}},
        {"surface.transform.translate", {"[\"0 m\", \"1 mm\", \"-1 km\"]"}},
        {"force.stiffness", {"\"1e-9 N/m\"", "\"1e12 N/m\"", "\"0.5 N/mm\"", "\"1 MN/m\"", "\"1 mN/m\""}},
        {"force.shading", {"\"none\"", "\"reference\"", "\"height_map\"", "\"morgenbesser\"", "\"two_pass\""}},
        {"force.depth", {"\"vertical\"", "\"normal\""}},
        {"force.reference", {"\"normal\"", "\"radial\""}},
        {"texture.stiffness", {"\"0 N/m\"", "\"0.2 N/mm\"", "\"7 kg/s^2\""}},
        {"texture.effect", {"\"force\"", "\"normal\""}},
        {"texture.function", {"\"cylinder\"", "\"dip\"", "\"sine\"", "\"gaussian\""}},
        {"texture.file", {"\"u.exr\"", "\"t.png\""}},
        {"texture.size", {"[\"1 mm\", \"2 mm\"]", "[\"3 in\", \"1e-3 m\"]"}},
        {"texture.height", {"\"0 m\"", "\"-1 mm\""}},
        {"texture.width", {"\"1 mm\"", "\"2 um\""}},
        {"texture.radius", {"\"1 mm\"", "\"1 km\""}},
        {"texture.vibration", {"\"m.xml\"", "\"n.xml\""}},
        {"texture.vibration_seed", {"0", "7"}},
        {"friction.coefficient", {"0.1", "0.3"}},
        {"friction.static_coefficient", {"0.3", "0.5"}},
        {"friction.stiffness", {"\"500 N/m\"", "\"1 N/mm\""}},
        {"grid.size", {"[1, 1, 1]", "[64, 16, 32]", "[5592405, 1, 1]"}},
        {"grid.samples", {"1", "128", "65536"}},
        {"grid.origin", {"[\"0 m\", \"0 m\", \"0 m\"]", "[\"1 km\", \"-1 km\", \"5 mil\"]"}},
        {"grid.spacing",
         {"\"1 nm\"", "[\"1 mm\", \"1 mm\", \"1 mm\"]", "[\"1 mm\"]", "[\"1 mm\", \"2 mm\", \"3 mm\"]"}},
        {"paths.kind", {"\"strokes\"", "\"raster\"", "\"taps\"", "\"random_walk\"", "\"recorded\""}},
        {"paths.file", {"\"p.csv\"", "\"q.csv\""}},
        {"paths.count", {"1", "1000000"}},
        {"paths.seed", {"0", "9223372036854775807"}},
        {"paths.rate", {"\"1 kHz\"", "\"10 Hz\""}},
        {"paths.loop", {"\"open\"", "\"closed\""}},
        {"paths.speed", {"\"1 m/s\"", "\"3 mm/s\""}},
        {"paths.speed.mean", {"\"1 m/s\"", "\"1 mm/s\""}},
        {"paths.speed.sd", {"\"1 m/s\"", "\"0 mm/s\""}},
        {"paths.speed.min", {"\"1 mm/s\""}},
        {"paths.speed.max", {"\"2 mm/s\""}},
        {"paths.depth", {"\"1 mm\"", "\"-1e-30 m\""}},
        {"paths.depth.min", {"\"1 mm\""}},
        {"paths.depth.max", {"\"1 m\""}},
        {"paths.press", {"\"1 N\"", "\"0 N\""}},
        {"paths.push", {"[\"1 N\", \"0 N\", \"-1 N\"]"}},
        {"paths.tremor.amplitude", {"\"0.1 mm\""}},
        {"paths.tremor.frequency", {"\"9 Hz\"", "\"12 Hz\""}},
        {"paths.centre", {"[\"1 mm\", \"0 m\"]", "[\"0 m\", \"0 m\"]"}},
        {"paths.length", {"\"0 m\"", "\"30 mm\""}},
        {"paths.lines", {"1", "16"}},
        {"paths.bound", {"\"1 m\""}},
        {"hand.mass", {"\"0.1 kg\"", "\"75 g\""}},
        {"hand.delay_samples", {"0", "1"}},
        {"output.channels", {"[\"force\"]", "[\"depth\"]", "[\"unshaded\", \"force\", \"facet\"]"}},
        {"output.compression", {"\"none\"", "\"zip1\"", "\"zip\"", "\"pxr24\""}},
        {"output.pixel", {"\"float\"", "\"half\""}},
        {"run.precision", {"\"f32\"", "\"f64\""}},
    };
    return keys;
}

inline int random_below(int limit) {
    return *rc::gen::inRange(0, limit);
}

// A value, or an axis of some. A scalar for grid.spacing has no place in an axis without brackets.
inline std::string random_value(const RandomKey& key) {
    const auto pick = [&] {
        return key.values[static_cast<std::size_t>(random_below(static_cast<int>(key.values.size())))];
    };
    std::string text = pick();
    const int more = std::max(0, random_below(5) - 2);
    const bool vector = key.values.back().front() == '[';
    const auto item = [&](const std::string& value) {
        return vector && value.front() != '[' ? "[" + value + "]" : value;
    };
    if (more == 0)
        return text;
    text = item(text);
    for (int i = 0; i < more; ++i)
        text += ", " + item(pick());
    return "[" + text + "]";
}

inline std::string random_layer(int keys) {
    std::string text;
    std::vector<std::string> given;
    for (int i = 0; i < keys; ++i) {
        const RandomKey& key =
            random_keys()[static_cast<std::size_t>(random_below(static_cast<int>(random_keys().size())))];
        if (std::find(given.begin(), given.end(), key.path) == given.end())
            text += std::string(key.path) + " = " + random_value(key) + "\n";
        given.emplace_back(key.path);
    }
    return text;
}

/// Mostly none. Scalars of a TOML string lose their quotes, as on a command line.
inline std::vector<std::pair<std::string, std::string>> random_overrides() {
    std::vector<std::pair<std::string, std::string>> overrides;
    const int count = std::max(0, random_below(5) - 2);
    for (int i = 0; i < count; ++i) {
        const RandomKey& key =
            random_keys()[static_cast<std::size_t>(random_below(static_cast<int>(random_keys().size())))];
        const std::string text = random_value(key);
        const bool quoted = text.front() == '"' && text.find('\\') == std::string::npos;
        overrides.emplace_back(key.path, quoted ? text.substr(1, text.size() - 2) : text);
    }
    return overrides;
}

inline std::string random_study() {
    std::string text = random_layer(random_below(7));
    const int variants = random_below(4);
    for (int i = 0; i < variants; ++i) {
        text += "[[variant]]\n";
        if (random_below(8) == 0)
            text += "texture = {}\n";
        if (random_below(8) == 0)
            text += "paths = {}\n";
        if (random_below(8) == 0)
            text += "hand = {}\n";
        text += random_layer(random_below(5));
    }
    return text;
}

} // namespace forceshade::test

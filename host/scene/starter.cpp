#include "host/scene/schema.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/scene/toml.h"

namespace forceshade {

namespace {

struct StarterKey {
    const char* path;
    std::string literal = {}; // empty: the default, and commented out
};

struct Starter {
    const char* what;
    const char* use; // {0}: the scene
    std::vector<StarterKey> keys;
    const char* rest = ""; // as it stands
};

Starter bump() {
    return {"A bump of flat facets that force shading makes feel round.",
            "forceshade field {0} --out bump.exr --also png",
            {{"surface.kind", "\"bump\""},
             {"surface.width", "\"1000 mil\""},
             {"surface.radius", "\"600 mil\""},
             {"surface.facets", "2"},
             {"force.stiffness", "\"1 N/mm\""},
             {"force.shading", "\"reference\""},
             {"force.depth"},
             {"grid.size", "[128, 16, 64]"},
             {"grid.origin", "[\"-25 mm\", \"-6 mm\", \"-10 mm\"]"},
             {"grid.spacing", "\"0.4 mm\""},
             {"output.channels", "[\"force\", \"depth\"]"}}};
}

Starter mesh(std::string_view file, std::string_view unit) {
    return {
        "A mesh whose vertex normals shade the forces. forceshade mesh FILE says its size and whether it has holes.",
        "forceshade field {0} --out mesh.exr --also png",
        {{"surface.kind", "\"mesh\""},
         {"surface.file", toml_string(file)},
         {"surface.unit", toml_string(unit)},
         {"surface.inside"},
         {"surface.transform.scale"},
         {"force.stiffness", "\"1 N/mm\""},
         {"force.shading", "\"mean_value\""},
         {"grid.samples", "64"},
         {"output.channels", "[\"force\", \"depth\"]"}}};
}

Starter paths() {
    return {"A hand that presses strokes a bump.",
            "forceshade explore {0} --out strokes.exr --also html",
            {{"surface.kind", "\"bump\""},
             {"surface.radius", "\"600 mil\""},
             {"surface.facets", "3"},
             {"force.stiffness", "\"1 N/mm\""},
             {"force.shading", "\"reference\""},
             {"paths.kind", "\"strokes\""},
             {"paths.count", "20"},
             {"paths.steps", "5000"},
             {"paths.rate", "\"1 kHz\""},
             {"paths.speed", "{ mean = \"20 mm/s\", sd = \"3 mm/s\" }"},
             {"paths.press", "\"1 N\""},
             {"paths.depth"},
             {"hand.mass", "\"0.1 kg\""},
             {"hand.damping", "\"1 N s/m\""},
             {"hand.grip_stiffness"}}};
}

Starter live() {
    return {"A bump to be felt on a device, or by a simulated hand. Here --watch reads it again whenever it is saved.",
            "forceshade live {0} --device sim --duration \"10 s\" --log felt.csv",
            {{"surface.kind", "\"bump\""},
             {"surface.radius", "\"600 mil\""},
             {"surface.facets", "3"},
             {"force.stiffness", "\"1 N/mm\""},
             {"force.shading", "\"reference\""},
             {"texture.stiffness", "\"0.2 N/mm\""},
             {"texture.function", "\"sine\""},
             {"texture.width", "\"2 mm\""},
             {"texture.height", "\"0.1 mm\""},
             {"paths.kind", "\"strokes\""},
             {"paths.speed", "\"50 mm/s\""},
             {"paths.press", "\"1 N\""}},
            "# [paths] moves the simulated hand alone; a person at a device needs none.\n"};
}

Starter experiment() {
    return {"The stimuli: a list is an axis, and each [[variant]] is crossed with the axes by itself.",
            "forceshade experiment run {0} --participant observer --subject 01 --out data",
            {{"surface.width", "\"1000 mil\""},
             {"surface.radius", "[\"600 mil\", \"1000 mil\"]"},
             {"force.stiffness", "\"1 N/mm\""}},
            "\n# The smooth shape, then facets without and with force shading.\n"
            "[[variant]]\nsurface.kind = \"cylinder_bump\"\n\n"
            "[[variant]]\nsurface.kind = \"bump\"\nsurface.facets = [1, 2, 3]\n"
            "force.shading = [\"none\", \"reference\"]\n"};
}

} // namespace

std::string_view unit_for_a_hand(double across) {
    constexpr double kHeld = 0.1; // m
    constexpr std::pair<std::string_view, double> kUnits[]{{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}};
    const auto off = [&](const auto& unit) { return std::abs(std::log(across * unit.second / kHeld)); };
    return across > 0 ? std::ranges::min_element(kUnits, {}, off)->first : kUnits[0].first;
}

std::string starter_scene(std::string_view what, std::string_view mesh_file, std::string_view unit,
                          std::string_view scene) {
    const Starter starter = what == "mesh"         ? mesh(mesh_file, unit)
                            : what == "paths"      ? paths()
                            : what == "live"       ? live()
                            : what == "experiment" ? experiment()
                                                   : bump();
    std::string text = comment_text(starter.what) +
                       fmt::format("#     {}\n", fmt::format(fmt::runtime(starter.use), scene)) +
                       comment_text("All keys: forceshade schema; one: forceshade schema surface.radius");
    std::string_view table;
    for (const StarterKey& one : starter.keys) {
        const Key& key = schema_keys()[key_index(one.path)];
        if (key.table != table)
            text += fmt::format("\n[{}]\n", key.table);
        table = key.table;
        const std::string_view example = key.example.empty() ? key.default_text : key.example;
        text += one.literal.empty() ? key_text(key, example, false) : key_text(key, one.literal, true);
    }
    return text + starter.rest;
}

} // namespace forceshade

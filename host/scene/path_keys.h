// Keys whose value may differ from path to path: "speed" as a quantity, or as a table with mean and sd, or min and max.
#pragma once

#include <array>
#include <vector>

#include "host/scene/scene.h"
#include "host/scene/schema.h"
#include "host/scene/value.h"

namespace forceshade {

/// The names of the five keys: "speed", "speed.mean", "speed.sd", "speed.min", "speed.max".
using SpreadNames = std::array<std::string_view, 5>;

/// What the five have in common; `choice` is the name under which they replace each other.
struct SpreadKey {
    SpreadNames names;
    std::string_view choice;
    std::string_view default_text, example, doc;
    std::uint32_t forms;
    Dimension dimension = Dimension::length;
    Sign sign = Sign::any;
};

/// `at` finds the spread in a scene.
template <Spread& (*at)(Scene&)> void add_spread_keys(std::vector<Key>& keys, const SpreadKey& spread) {
    Key key{.table = "paths",
            .name = spread.names[0],
            .kind = ValueKind::quantity,
            .default_text = spread.default_text,
            .doc = spread.doc,
            .set = [](Scene& s, const Value& v) { at(s) = fixed_spread(v.numbers.at(0)); },
            .subject = Subject::paths,
            .forms = spread.forms,
            .dimension = spread.dimension,
            .sign = spread.sign,
            .example = spread.example,
            .choice = spread.choice};
    keys.push_back(key);
    key.default_text = {};
    key.spread_part = true;
    const auto add = [&](std::size_t name, int option, std::string_view doc, void (*set)(Scene&, const Value&)) {
        key.name = spread.names[name];
        key.option = option;
        key.doc = doc;
        key.set = set;
        keys.push_back(key);
    };
    add(1, 1, "the mean of a normal distribution, beside sd", [](Scene& s, const Value& v) {
        at(s).shape = Spread::Shape::normal;
        at(s).value = v.numbers.at(0);
    });
    key.sign = Sign::not_negative;
    add(2, 1, "the standard deviation of a normal distribution, beside mean", [](Scene& s, const Value& v) {
        at(s).shape = Spread::Shape::normal;
        at(s).sd = v.numbers.at(0);
    });
    key.sign = spread.sign;
    add(3, 2, "the lower end of a uniform distribution, beside max", [](Scene& s, const Value& v) {
        at(s).shape = Spread::Shape::uniform;
        at(s).low = v.numbers.at(0);
    });
    add(4, 2, "the upper end of a uniform distribution, beside min", [](Scene& s, const Value& v) {
        at(s).shape = Spread::Shape::uniform;
        at(s).high = v.numbers.at(0);
    });
}

} // namespace forceshade

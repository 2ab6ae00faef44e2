#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"
#include "host/scene/setters.h"

namespace forceshade {

namespace {

// The device's defaults are those of the Phantom that the paper used, the grip's those of a relaxed hand.
void add_inertia(std::vector<Key>& keys) {
    keys.push_back({.table = "hand",
                    .name = "mass",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0.1 kg\"",
                    .doc = "that the hand moves at the device's tip (Massie & Salisbury 1994: the Phantom's apparent "
                           "mass is below 0.1 kg)",
                    .set = [](Scene& s, const Value& v) { s.hand.mass = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::mass,
                    .sign = Sign::positive});
    keys.push_back({.table = "hand",
                    .name = "damping",
                    .kind = ValueKind::quantity,
                    .default_text = "\"1 N s/m\"",
                    .doc = "of the device, against the world: a round value at which a wall of 2 N/mm is just stable "
                           "at 1 kHz by itself",
                    .set = [](Scene& s, const Value& v) { s.hand.damping = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::damping,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "grip_stiffness",
                    .kind = ValueKind::quantity,
                    .default_text = "\"500 N/m\"",
                    .doc = "of the spring that pulls the probe to its path; along z none with press or push. A round "
                           "value, of the size that is measured at fingertips (Hajian & Howe 1997)",
                    .set = [](Scene& s, const Value& v) { s.hand.grip_stiffness = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::stiffness,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "grip_damping",
                    .kind = ValueKind::quantity,
                    .default_text = "\"2 N s/m\"",
                    .doc = "of the grip, against its path's speed: likewise",
                    .set = [](Scene& s, const Value& v) { s.hand.grip_damping = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::damping,
                    .sign = Sign::not_negative});
}

void add_device(std::vector<Key>& keys) {
    keys.push_back({.table = "hand",
                    .name = "delay_samples",
                    .kind = ValueKind::integer,
                    .default_text = "0",
                    .doc = "from a position measured to its force displayed",
                    .set = [](Scene& s, const Value& v) { s.hand.delay_samples = v.integers.at(0); },
                    .subject = Subject::hand,
                    .largest = 1,
                    .smallest = 0});
    keys.push_back({.table = "hand",
                    .name = "quantisation",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0 m\"",
                    .doc = "step of the measured positions, 0 for none (a Phantom Premium's is nominally 0.03 mm)",
                    .set = [](Scene& s, const Value& v) { s.hand.quantisation = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "coulomb",
                    .kind = ValueKind::quantity,
                    .default_text = "\"0 N\"",
                    .doc = "dry friction of the device on each axis (Massie & Salisbury 1994: below 0.1 N)",
                    .set = [](Scene& s, const Value& v) { s.hand.coulomb = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::force,
                    .sign = Sign::not_negative});
    keys.push_back({.table = "hand",
                    .name = "max_force",
                    .kind = ValueKind::quantity,
                    .default_text = "\"8.5 N\"",
                    .doc = "the largest force that the device displays; larger ones keep their direction (a Phantom "
                           "Premium 1.5 has 8.5 N)",
                    .set = [](Scene& s, const Value& v) { s.hand.max_force = v.numbers.at(0); },
                    .subject = Subject::hand,
                    .dimension = Dimension::force,
                    .sign = Sign::positive});
}

} // namespace

void add_hand_keys(std::vector<Key>& keys) {
    add_inertia(keys);
    add_device(keys);
}

} // namespace forceshade

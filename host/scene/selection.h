// Which value each key has: layers merged, and one value chosen from each axis.
#pragma once

#include "host/scene/document.h"
#include "host/scene/scene.h"
#include "host/scene/schema.h"

#include <string>
#include <vector>

namespace forceshade {

/// By key: the entry that holds after later layers have replaced earlier ones; null where the other of function and
/// file holds.
struct Merged {
    std::vector<const Entry*> entries;
    bool texture = false;
};

/// The defaults, then the layers in turn. Null layers are skipped. The layers must outlive the result.
Merged merge(std::initializer_list<const Layer*> layers);

/// Every outcome of the selectors (kind, function or file, shading) that a merged layer allows.
std::vector<Forms> possible_forms(const Merged& merged);

/// True if the key applies to at least one of them.
bool applies_to_any(const Key& key, const std::vector<Forms>& forms);

/// By key: the value, or null where the key does not apply.
using Selection = std::vector<const Value*>;

/// Takes away the values of keys that do not apply.
void drop_inapplicable(Selection& selection, bool texture);

/// Equal text if and only if the selections give the same scene.
std::string identity(const Selection& selection);

Scene build_scene(const Selection& selection);

} // namespace forceshade

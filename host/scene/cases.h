// The cases of a study: layers merged, one value chosen from each axis, the scene that comes of it, checked and named.
#pragma once

#include <string>
#include <vector>

#include "host/scene/document.h"
#include "host/scene/scene.h"
#include "host/scene/schema.h"
#include "host/scene/study.h"

namespace forceshade {

/// By key: the entry that applies after later layers have replaced earlier ones; null where the other of function and
/// file applies.
struct Merged {
    std::vector<const Entry*> entries;
    std::vector<int> ranks; // of the layer that gave the entry; 0: a default
    Tables tables;          // that a layer gives
};

/// The defaults, then the layers in turn. Null layers are skipped. The layers must outlive the result.
Merged merge(std::initializer_list<const Layer*> layers);

/// Every outcome of the selectors (kind, function or file, shading) that a merged layer allows.
std::vector<Forms> possible_forms(const Merged& merged);

/// True if the key applies to at least one of them.
bool applies_to_any(const Key& key, const std::vector<Forms>& forms);

/// The layers of one variant with the base and the overrides, or of these alone.
struct Stack {
    const Layer* variant; // may be null
    Merged merged;
    std::vector<Forms> forms;
};

/// One for each variant, or one if there is none. The document must outlive them.
std::vector<Stack> stacks_of(const Document& document);

/// By key: the value, or null where the key does not apply.
using Selection = std::vector<const Value*>;

/// The first value of each entry.
Selection first_values(const Merged& merged);

/// True of the keys that decide which others apply.
bool is_selector(std::size_t key);

/// Takes away the values of keys that do not apply; `selection` is one choice of what the merged layers allow.
void drop_inapplicable(Selection& selection, const Merged& merged);

/// True if a mesh's grid is made from its box: `samples` was given no earlier than the grid's other keys.
bool grid_fits_mesh(const Merged& merged);

/// Equal text if and only if the selections give the same scene.
std::string identity(const Selection& selection);

Scene build_scene(const Selection& selection);

// Checks of a whole scene that no single key can make: the cylinder's shape, ranges of the arithmetic, the limits of a
// grid, and what fits together in [paths] and [hand].

/// Adds what is wrong to `errors`, each at the offending key's place, and warnings that are not there yet. Tables that
/// the document is not sure of are not checked.
void check_scene(const Scene& scene, const Selection& selection, const Document& document, Errors& errors,
                 std::vector<std::string>& warnings);

// Cases of a study by a pattern of their names, as `--only` gives it.

/// Throws UsageError: the pattern matches no case's name.
[[noreturn]] void refuse_pattern(const std::string& pattern, std::size_t cases, const std::string& first);

/// The cases whose name a shell pattern matches, in the study's order; they live as long as the study.
/// \throws UsageError if there is none.
std::vector<const Case*> cases_named(const Study& study, const std::string& pattern);

} // namespace forceshade

// The cases of a study: layers merged, one value chosen from each axis, the scene that comes of it, checked and named.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
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

// The cases of a study, listed and named without any of them being built: a part of 100 000 cases costs little more
// than its own.

/// A text's hash; equal for two texts by chance in one of 2^128 cases. Sums tell sets of texts apart.
struct TextHash {
    std::uint64_t low = 0, high = 0;

    TextHash& operator+=(const TextHash& other);
    friend bool operator==(const TextHash&, const TextHash&) = default;
};

/// One value chosen of each of a stack of layers' axes, for all choices; none of two that give the same scene.
/// Names say what varies over the study, in file order, safe as file names everywhere. Those that would be equal, or
/// equal but for upper and lower case, or too long, end in a hash of the case's values.
class CaseList {
public:
    /// `merged` and `axes`, of which the last varies fastest, must outlive the list. No more than 2^32 combinations.
    void add(const Merged& merged, const std::vector<const Entry*>& axes);
    /// After all were added. `order`: of keys (Document::order). \throws UsageError if two names are the same
    void name(const std::vector<std::size_t>& order);

    std::size_t size() const { return items_.size(); }
    Selection selection(std::size_t i) const;
    std::string name_of(std::size_t i) const;
    /// Whether no case before it has the same [surface] and [texture].
    bool first_of_surface(std::size_t i) const { return items_[i].first_of_surface; }
    /// What the name lists: ("kind", "bump"), ("radius", "600 mil"), ...
    std::vector<std::pair<std::string, std::string>> varied(std::size_t i) const;

private:
    struct Axis {
        const Entry* entry;
        std::size_t stride; // numbers from one value to the next
        std::vector<TextHash> identities;
        std::size_t digit(std::size_t number) const { return number / stride % entry->values.size(); }
    };
    /// What a name says of one key: one of its values' texts.
    struct Label {
        std::string name;                // of the key
        std::optional<std::size_t> axis; // of the part's; none: one value
        std::vector<std::string> values; // "600 mil"
        std::vector<std::string> texts;  // "_radius-600mil"
    };
    /// Choices to which the same keys apply: what decides that is chosen.
    struct Part {
        Selection first; // the first value of what else varies
        std::vector<Axis> axes;
        TextHash identity, surface; // of what does not vary; of that, what stands in [surface] and [texture]
        std::string kind;
        std::vector<Label> labels;
    };
    struct Item {
        std::uint32_t part, number;
        bool first_of_surface;
    };
    struct ByLowBits {
        std::size_t operator()(const TextHash& one) const { return one.low; }
    };

    Part part_of(const Merged& merged, const std::vector<Axis>& axes, const Selection& chosen) const;
    std::vector<std::size_t> varying_keys(const std::vector<std::size_t>& order) const;
    static std::size_t place_of(const Label& label, const Part& part, std::uint32_t number);
    std::string plain_name(const Item& item) const;

    std::vector<Part> parts_;
    std::vector<Item> items_;
    std::vector<bool> hashed_; // by item: the name ends in a hash
    std::unordered_set<TextHash, ByLowBits> seen_, surfaces_;
};

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

// The cases of a study, listed and named without any of them being built: a part of 100 000 cases costs little more
// than its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "host/scene/cases.h"

namespace forceshade {

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
        TextHash identity; // of what does not vary
        std::string kind;
        std::vector<Label> labels;
    };
    struct Item {
        std::uint32_t part, number;
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
    std::unordered_set<TextHash, ByLowBits> seen_;
};

} // namespace forceshade

#include "host/scene/cases.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "host/error.h"
#include "host/random.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

constexpr std::size_t kLongestName = 150; // bytes: room for an extension and a temporary's prefix under the usual 255
constexpr std::size_t kHashDigits = 12;

// FNV-1a: the same on every machine and in every run.
std::uint64_t hash(std::string_view text, std::uint64_t start = 0xcbf29ce484222325u) {
    for (const char c : text)
        start = (start ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return start;
}

TextHash text_hash(std::string_view text) {
    return {scrambled(hash(text)), scrambled(hash(text, 0x9e3779b97f4a7c15u))};
}

TextHash identity_hash(std::size_t key, const Value& value) {
    return text_hash(schema_keys()[key].path() + '=' + identity(value));
}

bool is_of_surface(std::size_t key) {
    return schema_keys()[key].table == "surface" || schema_keys()[key].table == "texture";
}

bool is_safe(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '+' || c == '-';
}

// "0.5 N/mm" -> "0.5N-mm", "1 µm" -> "1um".
std::string safe_text(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text.substr(i).starts_with("\u00b5") || text.substr(i).starts_with("\u03bc")) {
            result += 'u';
            ++i;
        } else if (text[i] == '/') {
            result += '-';
        } else if (text[i] != ' ' && text[i] != '\t') {
            result += is_safe(text[i]) ? text[i] : '_';
        }
    }
    return result;
}

// What is compared of a key: function and file are one choice, and a texture or comparison may be absent.
std::string compared(const Selection& selection, std::size_t key) {
    for (std::size_t other = 0; other < selection.size(); ++other)
        if (replaces(key, other) && !selection[key] && selection[other])
            return "other";
    if (selection[key])
        return identity(*selection[key]);
    const Key& info = schema_keys()[key];
    const bool texture = info.table == "texture" && (info.name == "function" || info.name == "file");
    return texture || info.path() == "compare.surface.kind" || info.path() == "friction.stiffness" ? "absent" : "";
}

// A key's last part; with its table where that would leave open which key is meant. A texture's and a comparison's keys
// always have theirs, those of paths if another table has a key of that name.
std::string label_of(std::size_t key, const std::vector<std::size_t>& varying) {
    const Key& info = schema_keys()[key];
    const auto same_name = [&](std::size_t other) {
        return other != key && schema_keys()[other].name == info.name && schema_keys()[other].table != "texture" &&
               schema_keys()[other].table != "friction";
    };
    const auto shared = [&](const Key& other) { return other.name == info.name && other.table != info.table; };
    const bool ambiguous = std::ranges::any_of(varying, same_name) ||
                           (info.table == "paths" && std::ranges::any_of(schema_keys(), shared));
    const bool full = ambiguous || info.table == "texture" || info.table == "compare" || info.table == "friction";
    return full ? info.path() : std::string(info.name);
}

std::string file_name_text(const Key& key, const Value& value) {
    if (key.kind == ValueKind::file)
        return std::filesystem::path(value.path).filename().string();
    return plain_text(value, key.kind == ValueKind::choices ? '+' : 'x');
}

} // namespace

TextHash& TextHash::operator+=(const TextHash& other) {
    low += other.low;
    high += other.high;
    return *this;
}

CaseList::Part CaseList::part_of(const Merged& merged, const std::vector<Axis>& axes, const Selection& chosen) const {
    Part part;
    part.first = chosen;
    drop_inapplicable(part.first, merged);
    for (const Axis& axis : axes)
        if (part.first[axis.entry->key] && !is_selector(axis.entry->key))
            part.axes.push_back(axis);
    for (std::size_t key = 0; key < part.first.size(); ++key)
        if (part.first[key] &&
            std::ranges::none_of(part.axes, [&](const Axis& one) { return one.entry->key == key; })) {
            const TextHash identity = identity_hash(key, *part.first[key]);
            part.identity += identity;
            if (is_of_surface(key))
                part.surface += identity;
        }
    return part;
}

void CaseList::add(const Merged& merged, const std::vector<const Entry*>& entries) {
    std::vector<Axis> axes, selectors;
    std::size_t count = 1, choices = 1;
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
        axes.push_back({*entry, count, {}});
        for (const Value& value : (*entry)->values)
            axes.back().identities.push_back(identity_hash((*entry)->key, value));
        count *= (*entry)->values.size();
        if (is_selector((*entry)->key)) {
            selectors.push_back(axes.back());
            choices *= (*entry)->values.size();
        }
    }
    const std::size_t first_part = parts_.size();
    for (std::size_t choice = 0; choice < choices; ++choice) {
        Selection chosen = first_values(merged);
        std::size_t rest = choice;
        for (const Axis& axis : selectors) {
            chosen[axis.entry->key] = &axis.entry->values[rest % axis.entry->values.size()];
            rest /= axis.entry->values.size();
        }
        parts_.push_back(part_of(merged, axes, chosen));
    }
    for (std::size_t number = 0; number < count; ++number) {
        std::size_t part = 0;
        for (std::size_t i = selectors.size(); i-- > 0;)
            part = part * selectors[i].entry->values.size() + selectors[i].digit(number);
        part += first_part;
        TextHash identity = parts_[part].identity, surface = parts_[part].surface;
        for (const Axis& axis : parts_[part].axes) {
            identity += axis.identities[axis.digit(number)];
            if (is_of_surface(axis.entry->key))
                surface += axis.identities[axis.digit(number)];
        }
        if (seen_.insert(identity).second)
            items_.push_back({static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(number),
                              surfaces_.insert(surface).second});
    }
}

Selection CaseList::selection(std::size_t i) const {
    const Part& part = parts_[items_[i].part];
    Selection selection = part.first;
    for (const Axis& axis : part.axes)
        selection[axis.entry->key] = &axis.entry->values[axis.digit(items_[i].number)];
    return selection;
}

// Keys whose value is not the same in all cases that have it, in file order, without the kind.
std::vector<std::size_t> CaseList::varying_keys(const std::vector<std::size_t>& order) const {
    std::vector<std::size_t> keys;
    for (const std::size_t key : order) {
        if (std::ranges::none_of(parts_, [key](const Part& part) { return part.first[key] != nullptr; }))
            continue;
        std::set<std::string> values;
        for (const Part& part : parts_) {
            if (const std::string text = compared(part.first, key); !text.empty())
                values.insert(text);
            for (const Axis& axis : part.axes)
                if (axis.entry->key == key)
                    for (const Value& value : axis.entry->values)
                        values.insert(identity(value));
        }
        if (values.size() > 1 && schema_keys()[key].path() != "surface.kind")
            keys.push_back(key);
    }
    return keys;
}

void CaseList::name(const std::vector<std::size_t>& order) {
    const std::vector<std::size_t> varying = varying_keys(order);
    const std::size_t kind = key_index("surface.kind"), shading = key_index("force.shading");
    for (Part& part : parts_) {
        part.kind = part.first[kind]->texts.front();
        for (const std::size_t key : varying) {
            // A cylinder has no shading to choose.
            if (!part.first[key] ||
                (key == shading && part.kind == kSurfaceKinds[std::size_t(SurfaceKind::cylinder_bump)]))
                continue;
            const auto axis = std::ranges::find(part.axes, key, [](const Axis& one) { return one.entry->key; });
            Label label{label_of(key, varying), {}, {}, {}};
            const auto add_value = [&](const Value& value) {
                label.values.push_back(file_name_text(schema_keys()[key], value));
                label.texts.push_back(fmt::format("_{}-{}", label.name, safe_text(label.values.back())));
            };
            if (axis == part.axes.end()) {
                add_value(*part.first[key]);
            } else {
                label.axis = static_cast<std::size_t>(axis - part.axes.begin());
                std::ranges::for_each(axis->entry->values, add_value);
            }
            part.labels.push_back(std::move(label));
        }
    }
    const auto lower_hash = [](const std::string& name) { return text_hash(lower_case(name)); };
    std::unordered_map<TextHash, std::size_t, ByLowBits> uses;
    uses.reserve(items_.size());
    for (const Item& item : items_)
        ++uses[lower_hash(plain_name(item))];
    hashed_.assign(items_.size(), false);
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const std::string name = plain_name(items_[i]);
        hashed_[i] = name.size() > kLongestName || uses[lower_hash(name)] > 1;
    }
    std::unordered_set<TextHash, ByLowBits> names;
    if (std::ranges::find(hashed_, true) != hashed_.end())
        for (std::size_t i = 0; i < items_.size(); ++i)
            if (!names.insert(lower_hash(name_of(i))).second)
                throw UsageError("two cases of the study have the name {}", name_of(i));
}

// Of the value that a choice has, in the label's list.
std::size_t CaseList::place_of(const Label& label, const Part& part, std::uint32_t number) {
    return label.axis ? part.axes[*label.axis].digit(number) : 0;
}

std::string CaseList::plain_name(const Item& item) const {
    const Part& part = parts_[item.part];
    std::string name = part.kind;
    for (const Label& label : part.labels)
        name += label.texts[place_of(label, part, item.number)];
    if (name.back() == '.') // Windows drops it
        name.back() = '_';
    return name;
}

std::string CaseList::name_of(std::size_t i) const {
    const std::string name = plain_name(items_[i]);
    if (!hashed_[i])
        return name;
    return fmt::format("{}_{}", name.substr(0, kLongestName - kHashDigits - 1),
                       fmt::format("{:016x}", hash(identity(selection(i)))).substr(16 - kHashDigits));
}

std::vector<std::pair<std::string, std::string>> CaseList::varied(std::size_t i) const {
    const Part& part = parts_[items_[i].part];
    std::vector<std::pair<std::string, std::string>> result{{"kind", part.kind}};
    for (const Label& label : part.labels)
        result.emplace_back(label.name, label.values[place_of(label, part, items_[i].number)]);
    return result;
}

} // namespace forceshade

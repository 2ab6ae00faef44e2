#include "host/scene/case_name.h"

#include "host/error.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

namespace forceshade {

namespace {

constexpr std::size_t kLongestName = 150; // bytes: room for an extension and a temporary's prefix under the usual 255
constexpr std::size_t kHashDigits = 12;

bool is_safe(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '+' || c == '-';
}

// "0.5 N/mm" -> "0.5N-mm", "1 µm" -> "1um".
std::string safe_text(std::string_view text) {
    static constexpr std::string_view kMicro[] = {"\u00b5", "\u03bc"};
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool micro = text.substr(i).starts_with(kMicro[0]) || text.substr(i).starts_with(kMicro[1]);
        if (micro) {
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

// FNV-1a: the same on every machine and in every run.
std::string hash_text(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash).substr(16 - kHashDigits);
}

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return text;
}

// The value that stands for a key in comparisons: function and file are one choice, and a texture may be absent.
std::string compared(const Selection& selection, std::size_t key) {
    for (std::size_t other = 0; other < selection.size(); ++other)
        if (replaces(key, other) && !selection[key] && selection[other])
            return "other";
    if (selection[key])
        return identity(*selection[key]);
    const Key& info = schema_keys()[key];
    return info.table == "texture" && (info.name == "function" || info.name == "file") ? "absent" : "";
}

// Keys whose value is not the same in all cases that have it, in file order, without the kind.
std::vector<std::size_t> varying_keys(const std::vector<Selection>& selections, const std::vector<std::size_t>& order) {
    std::vector<std::size_t> keys;
    for (const std::size_t key : order) {
        std::set<std::string> values;
        const auto has_key = [key](const Selection& selection) { return selection[key] != nullptr; };
        if (std::none_of(selections.begin(), selections.end(), has_key))
            continue;
        for (const Selection& selection : selections)
            if (const std::string text = compared(selection, key); !text.empty())
                values.insert(text);
        if (values.size() > 1 && schema_keys()[key].path() != "surface.kind")
            keys.push_back(key);
    }
    return keys;
}

// A key's last part; with its table where that would leave open which key is meant. A texture's keys always have
// theirs, those of paths if another table has a key of that name.
std::string label(std::size_t key, const std::vector<std::size_t>& varying) {
    const Key& info = schema_keys()[key];
    const auto same_name = [&](std::size_t other) {
        return other != key && schema_keys()[other].name == info.name && schema_keys()[other].table != "texture";
    };
    const auto shared = [&](const Key& other) { return other.name == info.name && other.table != info.table; };
    const auto keys = schema_keys();
    const bool ambiguous = std::any_of(varying.begin(), varying.end(), same_name) ||
                           (info.table == "paths" && std::any_of(keys.begin(), keys.end(), shared));
    return ambiguous || info.table == "texture" ? info.path() : std::string(info.name);
}

std::string file_name_text(const Key& key, const Value& value) {
    if (key.kind == ValueKind::file)
        return std::filesystem::path(value.path).filename().string();
    return plain_text(value, key.kind == ValueKind::choices ? '+' : 'x');
}

void fill_in(Case& one, const Selection& selection, const std::vector<std::size_t>& varying) {
    const auto kind = static_cast<std::size_t>(find_key("surface.kind"));
    const auto shading = static_cast<std::size_t>(find_key("force.shading"));
    one.varied.emplace_back("kind", selection[kind]->texts.front());
    one.name = one.varied.front().second;
    for (const std::size_t key : varying) {
        // A cylinder has no shading to choose.
        if (!selection[key] || (key == shading && one.scene.surface.kind == SurfaceKind::cylinder_bump))
            continue;
        const std::string text = file_name_text(schema_keys()[key], *selection[key]);
        one.varied.emplace_back(label(key, varying), text);
        one.name += fmt::format("_{}-{}", one.varied.back().first, safe_text(text));
    }
    if (one.name.back() == '.') // Windows drops it
        one.name.back() = '_';
}

} // namespace

void name_cases(std::vector<Case>& cases, const std::vector<Selection>& selections,
                const std::vector<std::size_t>& order) {
    const std::vector<std::size_t> varying = varying_keys(selections, order);
    std::map<std::string, int> uses;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        fill_in(cases[i], selections[i], varying);
        ++uses[lower_case(cases[i].name)];
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::string& name = cases[i].name;
        if (name.size() > kLongestName || uses[lower_case(name)] > 1)
            name = fmt::format("{}_{}", name.substr(0, kLongestName - kHashDigits - 1),
                               hash_text(identity(selections[i])));
        if (!names.insert(lower_case(name)).second)
            throw UsageError(fmt::format("two cases of the study have the name {}", name));
    }
}

} // namespace forceshade

#include "host/scene/schema.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/scene/scene.h"

namespace forceshade {

namespace {

std::string join_or(const std::vector<std::string_view>& names) {
    if (names.size() < 2)
        return fmt::format("{}", fmt::join(names, ""));
    return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// The names whose bits are set, `first` being the first one's.
std::vector<std::string_view> names_of(std::uint32_t forms, std::span<const std::string_view> names,
                                       std::uint32_t first) {
    std::vector<std::string_view> result;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (forms & (first << i))
            result.push_back(names[i]);
    return result;
}

std::vector<std::string_view> map_names(std::uint32_t forms) {
    std::vector<std::string_view> names = names_of(forms, kMapFunctions, kFormMapCylinder);
    if (forms & kFormMapFile)
        names.push_back("file");
    return names;
}

std::string describe_path_forms(const Key& key, const Forms& forms) {
    if (forms.paths == 0)
        return "a scene without [paths]";
    if (key.subject == Subject::paths && (key.forms & forms.paths) == 0)
        return fmt::format("kind \"{}\"", names_of(forms.paths, kPathKinds, 1).front());
    return "an open loop";
}

std::string describe_path_applicability(const Key& key) {
    const std::vector<std::string_view> kinds = names_of(key.forms, kPathKinds, 1);
    const std::string_view loop = key.closed_loop ? "a closed loop" : "";
    if (kinds.size() == kPathKinds.size())
        return std::string(loop);
    const auto recorded = static_cast<std::uint32_t>(PathKind::recorded);
    const std::string kind = kinds.size() + 1 == kPathKinds.size() && !(key.forms & (1u << recorded))
                                 ? "every kind but recorded"
                                 : fmt::format("kind {}", join_or(kinds));
    return loop.empty() ? kind : fmt::format("{} in {}", kind, loop);
}

} // namespace

std::string Key::path() const {
    return fmt::format("{}.{}", table, name);
}

std::span<const Key> schema_keys() {
    static const std::vector<Key> keys = make_keys();
    return keys;
}

std::string digest_name(std::string_view file) {
    constexpr std::string_view kFile = "file";
    return file.ends_with(kFile) ? fmt::format("{}sha256", file.substr(0, file.size() - kFile.size()))
                                 : fmt::format("{}_sha256", file);
}

std::string file_name(std::string_view digest) {
    constexpr std::string_view kOwn = "_sha256", kSha256 = "sha256";
    return digest.ends_with(kOwn) ? std::string(digest.substr(0, digest.size() - kOwn.size()))
                                  : fmt::format("{}file", digest.substr(0, digest.size() - kSha256.size()));
}

int find_key(std::string_view path) {
    const auto keys = schema_keys();
    const std::size_t dot = path.find('.');
    if (dot == std::string_view::npos)
        return -1;
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i].table == path.substr(0, dot) && keys[i].name == path.substr(dot + 1))
            return static_cast<int>(i);
    return -1;
}

bool applies(const Key& key, const Forms& forms) {
    switch (key.subject) {
    case Subject::none:
        return true;
    case Subject::surface:
        return (key.forms & forms.surface) != 0;
    case Subject::texture:
        return (key.forms & forms.texture) != 0;
    case Subject::shading:
        return (key.forms & forms.surface) != 0 && forms.reference_shading;
    case Subject::paths:
        return (key.forms & forms.paths) != 0 && (!key.closed_loop || forms.closed_loop);
    case Subject::hand:
        return forms.hand;
    case Subject::compare:
        return (key.forms & forms.compare) != 0;
    case Subject::task:
        return false; // of a scene
    case Subject::friction:
        return forms.friction;
    }
    return true;
}

std::string describe_forms(const Key& key, const Forms& forms) {
    if (key.subject == Subject::paths || key.subject == Subject::hand)
        return describe_path_forms(key, forms);
    if (key.subject == Subject::compare)
        return forms.compare == 0 ? "a scene without [compare]"
                                  : fmt::format("kind \"{}\"", names_of(forms.compare, kCompareKinds, 1).front());
    if (key.subject == Subject::friction)
        return "a scene without [friction]";
    const std::uint32_t form = key.subject == Subject::texture ? forms.texture : forms.surface;
    if (form == 0)
        return "a scene without [texture]";
    if (form == kFormVibration)
        return "a vibration without a height map";
    if (form == kFormMesh)
        return fmt::format("kind \"{}\"", kSurfaceKinds[3]);
    if (form & kFormBumps) {
        const auto kind = kSurfaceKinds[form == kFormBump ? 0 : 1];
        const bool shading = key.subject == Subject::shading && (key.forms & form);
        return fmt::format("kind \"{}\"{}", kind, shading ? " without shading \"reference\"" : "");
    }
    const std::string map = form & kFormMapFile ? "a file" : fmt::format("function \"{}\"", map_names(form).front());
    return key.subject == Subject::texture ? map : fmt::format("kind \"height_map\" with {}", map);
}

std::string describe_applicability(const Key& key) {
    if (key.subject == Subject::none || key.subject == Subject::friction)
        return "";
    if (key.subject == Subject::texture && (key.forms & kFormVibration))
        return key.forms == kFormVibration ? "a vibration" : "";
    if (key.subject == Subject::hand)
        return "a closed loop";
    if (key.subject == Subject::task)
        return "task compare";
    if (key.subject == Subject::paths)
        return describe_path_applicability(key);
    if (key.subject == Subject::compare) {
        const std::vector<std::string_view> kinds = names_of(key.forms, kCompareKinds, 1);
        return kinds.size() == kCompareKinds.size() ? "" : fmt::format("kind {}", join_or(kinds));
    }
    std::vector<std::string_view> kinds = names_of(key.forms, std::span(kSurfaceKinds).first(2), kFormBump);
    if (key.forms & kFormMesh)
        kinds.push_back(kSurfaceKinds[3]);
    const std::string maps = join_or(map_names(key.forms));
    if (key.subject == Subject::texture)
        return maps;
    if (key.subject == Subject::shading)
        return "kind bump with shading reference";
    const std::string plain = kinds.empty() ? "" : fmt::format("kind {}", join_or(kinds));
    const std::string map = maps.empty() ? "" : fmt::format("kind height_map with {}", maps);
    return plain.empty() || map.empty() ? plain + map : fmt::format("{}; {}", plain, map);
}

namespace {

constexpr std::size_t kLineWidth = 100;

// The key of a quantity that may differ from path to path: its parts replace it.
bool is_spread(const Key& key) {
    return !key.spread_part && !key.choice.empty() && key.choice == key.name;
}

std::string table_header(std::string_view table) {
    std::string_view remark;
    if (table == "texture")
        remark = "(L8, L9, L11; a scene without this table has none)";
    if (table == "friction")
        remark = "(L10, of paths and the live loop, on the CPU alone; a scene without this table has none)";
    if (table == "paths")
        remark = "(exploration paths; a scene without this table has none, one with it and without [grid] no field)";
    if (table == "compare")
        remark = "(a shape that forces are compared with; a scene without this table has none)";
    if (table == "hand")
        remark = "(what moves the probe along paths in closed loop)";
    return remark.empty() ? fmt::format("\n[{}]\n", table) : fmt::format("\n# [{}]    {}\n", table, remark);
}

} // namespace

std::string type_name(const Key& key) {
    constexpr const char* kNames[] = {"",     "",       "number", "integer", "choice", "list of choices",
                                      "file", "digest", "text",   "boolean"};
    if (key.kind == ValueKind::quantity || key.kind == ValueKind::unit)
        return fmt::format("{}{}", key.kind == ValueKind::unit ? "unit of " : "", dimension_info(key.dimension).name);
    return kNames[static_cast<std::size_t>(key.kind)];
}

std::string describe_values(const Key& key) {
    std::string text = type_name(key);
    if (!key.choices.empty())
        text = fmt::format("{}{}", key.kind == ValueKind::choices ? "a list of " : "", fmt::join(key.choices, " | "));
    else if (key.kind == ValueKind::integer)
        text = fmt::format("integer, {} to {}", key.smallest, key.largest);
    else if (key.kind == ValueKind::quantity || key.kind == ValueKind::number)
        text += key.sign == Sign::positive ? ", positive" : key.sign == Sign::not_negative ? ", not negative" : "";
    if (is_spread(key))
        text += fmt::format("; or {{ mean, sd }}: normal{}; or {{ min, max }}: uniform",
                            key.sign == Sign::any ? "" : ", drawn again until positive");
    if (key.count > 1)
        text += fmt::format("; {}{} values", key.one_for_all ? "1 or " : "", key.count);
    return text;
}

std::string_view example_of(const Key& key) {
    return key.example.empty() ? key.default_text : key.example;
}

std::string comment_text(std::string text) {
    std::string result;
    while (text.size() > kLineWidth) {
        const std::size_t cut = text.rfind(' ', kLineWidth);
        result += fmt::format("# {}\n", text.substr(0, cut));
        text.erase(0, cut + 1);
    }
    return result + fmt::format("# {}\n", text);
}

std::string key_text(const Key& key, std::string_view literal, bool given) {
    const std::string applicability = describe_applicability(key);
    return comment_text(fmt::format("{}: {}", key.name, key.doc)) +
           comment_text(fmt::format("    {}{}", describe_values(key),
                                    applicability.empty() ? "" : fmt::format(" ({})", applicability))) +
           fmt::format("{}{} = {}\n", given ? "" : "# ", key.name, literal);
}

std::string schema_text() {
    std::string result = comment_text(
        "Every key of a scene or study, with its default. A quantity is a number with a unit in a string; units are m, "
        "mil, in, g, s, Hz, N, J, rad, deg with SI prefixes, products (\"N s/m\"), quotients and powers.");
    result += comment_text("A list where one value may stand is a sweep axis (for a key that is a list itself, a list "
                           "of lists); axes cross. [[variant]] tables override keys (surface.kind = "
                           "\"cylinder_bump\"); each is swept by itself, and a case that comes twice runs once.");
    result += comment_text("A line that is commented out applies to another kind or function only.");
    std::string_view table;
    for (const Key& key : schema_keys()) {
        if (key.table != table)
            result += table_header(key.table);
        table = key.table;
        if (!key.spread_part)
            result += key_text(key, example_of(key), applies(key, Forms{}));
    }
    return result;
}

} // namespace forceshade

#include "host/scene/study.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"
#include "host/scene/cases.h"
#include "host/scene/document.h"

namespace forceshade {

namespace {

void set_literal(Case& one, std::string_view table, std::string_view name, std::string_view literal) {
    for (Setting& setting : one.settings)
        if (setting.table == table && setting.name == name)
            setting.literal = literal;
}

} // namespace

void set_precision(Case& one, Precision precision) {
    one.scene.precision = precision;
    set_literal(one, "run", "precision", precision == Precision::f64 ? "\"f64\"" : "\"f32\"");
}

void set_inside(Case& one, InsideTest inside) {
    one.scene.surface.mesh.inside = inside;
    set_literal(one, "surface", "inside", inside == InsideTest::winding ? "\"winding\"" : "\"pseudonormal\"");
}

namespace {

class StudyBuilder {
public:
    StudyBuilder(std::shared_ptr<const Document> document, bool one_scene, const CaseChoice& choice, Errors& errors)
        : document_(std::move(document)), one_scene_(one_scene), choice_(choice), errors_(errors),
          stacks_(stacks_of(*document_)) {
        study_.document = document_;
    }

    Study build() {
        errors_.attempt([&] { refuse_equal_file_names(); });
        for (const Stack& stack : stacks_)
            if (document_->sure_of({"surface", "grid"}))
                errors_.attempt([&] { refuse_two_grids(stack); });
        refuse_keys_of_no_case();
        if (one_scene_)
            refuse_sweep();
        for (const Stack& stack : stacks_)
            errors_.attempt([&] { cross(stack); });
        study_.all = list_.size();
        const bool sound = errors_.none();
        if (sound)
            list_.name(document_->order);
        for (const std::size_t i : sound ? chosen() : every(1))
            if (!errors_.enough())
                study_.cases.push_back(built(i));
        errors_.report();
        if (study_.cases.size() < study_.all) {
            constexpr std::size_t kSample = 100;
            for (const std::size_t i : every(std::max<std::size_t>(1, study_.all / kSample)))
                study_.sample.push_back(built(i));
            errors_.report();
        }
        return std::move(study_);
    }

private:
    const std::string& source() const { return document_->source; }

    // A mesh's grid is made from its box or given, not both in one place.
    void refuse_two_grids(const Stack& stack) const {
        const auto is_mesh = [](const Forms& one) { return one.surface == kFormMesh; };
        const auto samples = key_index("grid.samples");
        const Merged& merged = stack.merged;
        if (merged.ranks[samples] == 0 || !std::ranges::all_of(stack.forms, is_mesh))
            return;
        for (std::size_t key = 0; key < merged.ranks.size(); ++key)
            if (key != samples && schema_keys()[key].table == "grid" && merged.ranks[key] == merged.ranks[samples])
                fail(source(), merged.entries[key]->where,
                     "give \"samples\", which stands for size, origin and spacing, or \"{}\", not both",
                     schema_keys()[key].name);
    }

    // Results name files by their base name alone.
    void refuse_equal_file_names() const {
        std::map<std::string, std::string> path_of;
        for (const Layer* layer : document_->layers())
            for (const Entry& entry : layer->entries)
                for (const Value& value : entry.values) {
                    const std::string name = std::filesystem::path(value.path).filename().string();
                    if (const auto [known, added] = path_of.emplace(name, value.path);
                        !added && known->second != value.path)
                        fail(source(), value.where,
                             "two files are named \"{}\"; results name files without their folders, so rename one",
                             name);
                }
    }

    // A key that applies neither to the choices of its own layer nor to any case below it is a mistake, if its own
    // table makes the choice; elsewhere it is only useless. What a variant inherits and cannot use is dropped.
    void refuse_keys_of_no_case() {
        const auto check = [&](const Layer& layer, const std::vector<Forms>& own, const std::vector<Forms>& cases) {
            for (const Entry& entry : layer.entries) {
                const Key& key = schema_keys()[entry.key];
                if (applies_to_any(key, own) || applies_to_any(key, cases) || !is_sure_of(key))
                    continue;
                const std::string message = fmt::format("\"{}\" does not apply to {}; it applies to {}", key.name,
                                                        describe_forms(key, own.front()), describe_applicability(key));
                if (entry.where.line > 0 && key.subject != Subject::shading &&
                    (key.table == "surface" || key.table == "texture" || key.table == "paths" ||
                     key.table == "compare"))
                    errors_.attempt([&] { fail(source(), entry.where, message); });
                study_.warnings.push_back(location_prefix(source(), entry.where) + message);
            }
        };
        std::vector<Forms> all;
        for (const Stack& stack : stacks_) {
            all.insert(all.end(), stack.forms.begin(), stack.forms.end());
            if (stack.variant) {
                const auto own = possible_forms(merge({&document_->base, stack.variant}));
                check(*stack.variant, own, own);
            }
        }
        check(document_->base, possible_forms(merge({&document_->base})), all);
        check(document_->overrides, all, all);
    }

    // Whether it is known what the key applies to.
    bool is_sure_of(const Key& key) const {
        const bool of_paths = key.subject == Subject::paths || key.subject == Subject::hand;
        return document_->sure_of({key.table, of_paths ? "paths" : "surface", "force"});
    }

    std::vector<const Entry*> axes(const Stack& stack) const {
        std::vector<const Entry*> result;
        for (const std::size_t key : document_->order)
            if (const Entry* entry = stack.merged.entries[key];
                entry && entry->values.size() > 1 && applies_to_any(schema_keys()[key], stack.forms))
                result.push_back(entry);
        return result;
    }

    void refuse_sweep() {
        for (const Stack& stack : stacks_)
            for (const Entry* axis : axes(stack))
                errors_.attempt([&] {
                    fail(source(), axis->where,
                         "\"{}\" is a sweep axis of {} values; this takes one scene: leave one value, or use sweep",
                         schema_keys()[axis->key].path(), axis->values.size());
                });
        if (stacks_.size() > 1)
            errors_.attempt([&] {
                fail(source(), stacks_[1].variant->where,
                     "a second [[variant]]; this takes one scene: leave one, or use sweep");
            });
    }

    // Counts through all combinations, the last axis fastest.
    void cross(const Stack& stack) {
        const std::vector<const Entry*> axis_entries = axes(stack);
        std::size_t count = 1;
        for (const Entry* axis : axis_entries)
            if (__builtin_mul_overflow(count, axis->values.size(), &count) || count + combinations_ > kMostCases)
                fail(source(), axis->where, "the axes cross to more than {} cases; split the study", kMostCases);
        combinations_ += count;
        list_.add(stack.merged, axis_entries);
    }

    std::vector<std::size_t> every(std::size_t step) const {
        std::vector<std::size_t> result;
        for (std::size_t i = 0; i < list_.size(); i += step)
            result.push_back(i);
        return result;
    }

    std::vector<std::size_t> chosen() const {
        std::vector<std::size_t> matching = every(1), part;
        if (choice_.only != "*")
            std::erase_if(matching, [&](std::size_t i) {
                return fnmatch(choice_.only.c_str(), list_.name_of(i).c_str(), 0) != 0;
            });
        if (matching.empty() && list_.size() > 0)
            refuse_pattern(choice_.only, list_.size(), list_.name_of(0));
        for (std::size_t i = choice_.index - 1; i < matching.size(); i += choice_.count)
            part.push_back(matching[i]);
        return part;
    }

    /// Where it may be chosen it is single, unless something else is said once the mesh is known.
    static void settle_precision(const Selection& selection, Case& one) {
        const Value* precision = selection[key_index("run.precision")];
        const bool automatic = precision && precision->integers.at(0) == 2;
        one.chooses_precision = automatic || !precision || precision->where.is_default();
        if (automatic)
            set_precision(one, Precision::f32);
    }

    Case built(std::size_t i) {
        const Selection selection = list_.selection(i);
        Case one;
        one.scene = build_scene(selection);
        check_scene(one.scene, selection, *document_, errors_, study_.warnings);
        for (std::size_t key = 0; key < selection.size(); ++key)
            if (selection[key])
                one.settings.push_back(
                    {schema_keys()[key].table, schema_keys()[key].name, literal(schema_keys()[key], *selection[key])});
        settle_precision(selection, one);
        if (!errors_.none())
            return one;
        one.name = list_.name_of(i);
        one.varied = list_.varied(i);
        one.first_of_surface = list_.first_of_surface(i);
        return one;
    }

    std::shared_ptr<const Document> document_;
    bool one_scene_;
    CaseChoice choice_;
    Errors& errors_;
    std::vector<Stack> stacks_;
    Study study_;
    CaseList list_;
    std::size_t combinations_ = 0;
};

Study build_study(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                  std::span<const Override> overrides, bool one_scene, const ReadBeside& beside = {},
                  const CaseChoice& choice = {}) {
    Errors errors;
    auto document = std::make_shared<const Document>(read_document(text, source, folder.string(), overrides, errors));
    if (beside)
        errors.attempt([&] { beside(*document); });
    return StudyBuilder(std::move(document), one_scene, choice, errors).build();
}

} // namespace

Study parse_study(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                  std::span<const Override> overrides, const ReadBeside& beside, const CaseChoice& choice) {
    return build_study(text, source, folder, overrides, false, beside, choice);
}

Study read_study(const std::filesystem::path& path, std::span<const Override> overrides, const ReadBeside& beside,
                 const CaseChoice& choice) {
    const SceneText read = read_scene_text(path);
    return parse_study(read.text, read.source, read.folder, overrides, beside, choice);
}

Case parse_scene(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                 std::span<const Override> overrides, std::vector<std::string>* warnings) {
    Study study = build_study(text, source, folder, overrides, true);
    if (warnings)
        warnings->insert(warnings->end(), study.warnings.begin(), study.warnings.end());
    return std::move(study.cases.front());
}

std::optional<Case> stated_scene(const std::string& text) {
    try {
        return text.empty() ? std::nullopt : std::optional(parse_scene(text, "the stated scene"));
    } catch (const Error&) {
        return std::nullopt;
    }
}

Case read_scene(const std::filesystem::path& path, std::span<const Override> overrides,
                std::vector<std::string>* warnings) {
    const SceneText read = read_scene_text(path);
    return parse_scene(read.text, read.source, read.folder, overrides, warnings);
}

Study default_study(std::span<const Override> overrides, const CaseChoice& choice) {
    return parse_study(default_study_toml(), "built-in study", {}, overrides, {}, choice);
}

std::string_view default_study_toml() {
    return R"toml(# The study of Morgenbesser & Srinivasan 1996: seven bumps at three radii, one force-shaded plane among them,
# and the number of facets beyond the paper's three, shaded and unshaded.
[surface]
width = "1000 mil"
radius = ["600 mil", "1000 mil", "1400 mil"]

[force]
stiffness = "1 N/mm"
depth = "vertical"

[grid]
size = [256, 64, 128]
origin = ["-25 mm", "-6 mm", "-10 mm"]
spacing = "0.2 mm"

[[variant]]
surface.kind = "cylinder_bump"

[[variant]]
surface.kind = "bump"
surface.facets = [1, 2, 3]
force.shading = ["none", "reference"]

[[variant]]
surface.kind = "bump"
surface.facets = [4, 8, 16, 32, 64]
force.shading = ["none", "reference"]
)toml";
}

} // namespace forceshade

// Cases that are listed and named without being built, against all of them crossed one by one; and parts of a study
// against the whole.
#include "host/scene/cases.h"

#include <random>
#include <set>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/scene/study.h"

namespace forceshade {
namespace {

// Axes that apply to some kinds only, values given twice in other words, and variants with cases in common.
std::string random_study(std::mt19937& random) {
    const auto some = [&](std::vector<std::string> values) {
        std::ranges::shuffle(values, random);
        values.resize(1 + random() % values.size());
        std::string text = "[";
        for (const std::string& value : values)
            text += (text.size() > 1 ? ", " : "") + value;
        return text + "]";
    };
    std::string text =
        "[force]\nstiffness = " + some({"\"1 N/mm\"", "\"1000 N/m\"", "\"0.5 N/mm\"", "\"2 N/mm\""}) + "\n";
    for (int variants = 1 + int(random() % 3); variants > 0; --variants) {
        text += "[[variant]]\nsurface.radius = " + some({"\"600 mil\"", "\"15.24 mm\"", "\"1 in\""}) + "\n";
        switch (random() % 3) {
        case 0:
            text += "surface.kind = " + some({"\"bump\"", "\"cylinder_bump\""}) +
                    "\nsurface.facets = " + some({"1", "2", "7"}) + "\n";
            break;
        case 1:
            text += "surface.kind = \"bump\"\nforce.shading = " + some({"\"none\"", "\"reference\""}) +
                    "\npaths = { kind = " + some({"\"strokes\"", "\"circle\""}) +
                    ", loop = " + some({"\"open\"", "\"closed\""}) + " }\n";
            break;
        default:
            text += "surface.kind = \"height_map\"\nsurface.function = " +
                    some({"\"sine\"", "\"dip\"", "\"gaussian\"", "\"cylinder\""}) +
                    "\nsurface.height = " + some({"\"1 mm\"", "\"2 mm\""}) +
                    "\nforce.shading = " + some({"\"none\"", "\"height_map\""}) + "\n";
        }
    }
    return text;
}

// The scenes' identities, as crossing everything and leaving out what came before gives them.
std::vector<std::string> crossed(const Document& document) {
    std::vector<std::string> result;
    std::set<std::string> seen;
    for (const Layer& variant : document.variants) {
        const Merged merged = merge({&document.base, &variant, &document.overrides});
        std::vector<Selection> selections{first_values(merged)};
        for (const std::size_t key : document.order)
            if (const Entry* entry = merged.entries[key]) {
                std::vector<Selection> further;
                for (const Selection& selection : selections)
                    for (const Value& value : entry->values)
                        further.push_back(selection), further.back()[key] = &value;
                selections = further;
            }
        for (Selection& selection : selections) {
            drop_inapplicable(selection, merged);
            if (seen.insert(identity(selection)).second)
                result.push_back(identity(selection));
        }
    }
    return result;
}

TEST(CaseList, HasWhatCrossingAllAxesGives) {
    std::mt19937 random(7);
    std::size_t cases = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const std::string text = random_study(random);
        Errors errors;
        const Document document = read_document(text, "test", "", {}, errors);
        ASSERT_TRUE(errors.none()) << text;
        CaseList list;
        for (const Layer& variant : document.variants) {
            const Merged merged = merge({&document.base, &variant, &document.overrides});
            std::vector<const Entry*> axes;
            for (const std::size_t key : document.order)
                if (const Entry* entry = merged.entries[key]; entry && entry->values.size() > 1)
                    axes.push_back(entry);
            list.add(merged, axes);
        }
        list.name(document.order);
        std::vector<std::string> identities;
        std::set<std::string> names;
        for (std::size_t i = 0; i < list.size(); ++i) {
            identities.push_back(identity(list.selection(i)));
            names.insert(list.name_of(i));
        }
        EXPECT_EQ(identities, crossed(document)) << text;
        EXPECT_EQ(names.size(), list.size()) << text;
        cases += list.size();
    }
    EXPECT_GT(cases, 2000u);
}

TEST(CaseList, SaysWhichCaseIsTheFirstOfItsSurface) {
    const Study study = parse_study("[surface]\nkind = \"bump\"\nfacets = [1, 2]\n[force]\n"
                                    "stiffness = [\"1 N/mm\", \"2 N/mm\"]\nshading = [\"none\", \"reference\"]\n",
                                    "test");
    std::vector<bool> first;
    for (const Case& one : study.cases)
        first.push_back(one.first_of_surface);
    EXPECT_EQ(first, (std::vector{true, false, false, false, true, false, false, false}));
}

TEST(CaseList, GivesPartsThatAreTheWhole) {
    const Study whole = default_study();
    EXPECT_EQ(whole.all, 51u);
    for (const std::size_t parts : {1u, 4u, 60u}) {
        std::vector<std::string> names(whole.all);
        for (std::size_t part = 1; part <= parts; ++part) {
            const Study some = default_study({}, {.index = part, .count = parts});
            EXPECT_EQ(some.all, whole.all);
            for (std::size_t i = 0; i < some.cases.size(); ++i) {
                const std::size_t place = part - 1 + i * parts;
                names[place] = some.cases[i].name;
                EXPECT_EQ(resolved_toml(some.cases[i]), resolved_toml(whole.cases[place]));
                EXPECT_EQ(some.cases[i].varied, whole.cases[place].varied);
                EXPECT_EQ(some.cases[i].first_of_surface, whole.cases[place].first_of_surface);
            }
        }
        for (std::size_t i = 0; i < whole.all; ++i)
            EXPECT_EQ(names[i], whole.cases[i].name);
    }
    EXPECT_EQ(default_study({}, {.only = "*facets-64_*", .index = 2, .count = 3}).cases.size(), 2u);
    EXPECT_THROW(default_study({}, {.only = "none"}), UsageError);
}

} // namespace
} // namespace forceshade

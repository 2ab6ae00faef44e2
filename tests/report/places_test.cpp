// The viewer where its two cases do not lie at the same places.
#include "tests/report/page_test.h"

namespace forceshade::report {
namespace {

using namespace testing;

constexpr const char* kBump = "[surface]\nkind = \"bump\"\n";
constexpr const char* kMesh = "[surface]\nkind = \"mesh\"\nfile = \"a.off\"\n";
constexpr const char* kNoteOfDifference = "document.getElementById('note-d').textContent";
constexpr const char* kNoteOfReadout = "document.getElementById('read-note').textContent";

// Of what is drawn within the frame of a canvas: colours(id): how many there are.
constexpr const char* kLook = R"(
const FRAME = [46, 6, 10, 36];
function drawn(id) {
  const from = document.getElementById(id), [left, top, right, bottom] = FRAME;
  const copy = document.createElement("canvas"), [width, height] = [from.width - left - right, from.height - top - bottom];
  const context = copy.getContext("2d", { willReadFrequently: true }), counts = new Map();
  Object.assign(copy, { width, height });
  context.drawImage(from, -left, -top);
  const { data } = context.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    const colour = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
    counts.set(colour, (counts.get(colour) || 0) + 1);
  }
  return counts;
}
const colours = (id) => drawn(id).size;
// px: of a case's curve.
const line = (i) => document.querySelector("#profile-size g path[stroke^='var(--plot-s" + i + "']").getTotalLength();

// What is empty without a word, across every axis.
function silent() {
  const empty = [], text = (id) => document.getElementById(id).textContent;
  for (const axis of ["x", "z", "y"]) {
    document.getElementById("axis-" + axis).click();
    for (const pane of ["a", "b", "d"])
      if (colours("pane-" + pane) < 40 && !text("note-" + pane))
        empty.push(axis + ": picture " + pane);
    if (line(0) < 50)
      empty.push(axis + ": curve of A");
    const [a, b] = [0, 1].map((i) => document.getElementById("read-rows").children[i].children[1].textContent);
    if (a === "–" || (b === "–" && !text("read-note")))
      empty.push(axis + ": read-out " + a + " " + b);
  }
  return empty.join("; ");
}
)";

class Places : public ReportPage {
protected:
    static void SetUpTestSuite() {
        const std::array<std::uint64_t, 3> one_y{24, 1, 16};
        const double narrow = 1e-5;
        std::vector<CaseRecord> records;
        for (const SampleCase& one : std::initializer_list<SampleCase>{
                 {.name = "bump", .size = one_y, .first_y = 0, .y_spacing = narrow, .scene = kBump},
                 {.name = "mesh",
                 .size = one_y,
                 .strength = 2,
                 .first_y = 0.000435,
                 .y_spacing = narrow,
                 .scene = kMesh},
                 {.name = "other",
                 .size = one_y,
                 .strength = 3,
                 .first_y = 0.000435,
                 .y_spacing = narrow,
                 .scene = kMesh},
                 {.name = "far", .size = one_y, .strength = 4, .first_y = 0.0009, .y_spacing = narrow, .scene = kMesh},
                 {.name = "whole", .strength = 5},
                 {.name = "alike", .alike_in_y = true, .strength = 6},
                 {.name = "compared", .compared = true}})
            records.push_back(write_sample_case(folder_->path(), one));
        write_sample_manifest(folder_->path(), records);
        begin();
    }

    static void open(unsigned width = 1200, const std::string& before = {}) {
        ReportPage::open(width, false, kLook + before);
    }
    static void choose(const std::string& pane, const std::string& name) {
        browser_->set("#case-" + pane, "[...e.options].findIndex((one) => one.textContent === '" + name + "')");
        await_title(pane, name);
    }
    static void await_title(const std::string& pane, const std::string& name) {
        ASSERT_TRUE(
            browser_->wait_for("document.querySelector('#title-" + pane + " a').textContent === '" + name + "'"))
            << name;
    }
    static int count(const std::string& expression) { return browser_->evaluate(expression).get<int>(); }
    static int line_of_a() { return count("Math.round(line(0))"); }
    static int line_of_b() { return count("Math.round(line(1))"); }
};

TEST_F(Places, TheCursorGoesWithCasesOfAnotherY) {
    open();
    EXPECT_EQ(browser_->text(kSlice), "y = 0.4350 mm (1 of 1)") << "the mesh's: the bump is everywhere";
    choose("b", "bump");
    EXPECT_EQ(browser_->text(kSlice), "any y: no force depends on it");
    EXPECT_TRUE(says(browser_->text(kPlace), "y = 0 mm"));
    choose("a", "mesh");
    choose("b", "other");
    EXPECT_EQ(browser_->text(kSlice), "y = 0.4350 mm (1 of 1)");
    EXPECT_TRUE(says(browser_->text(kPlace), "y = 0.4350 mm"));
    EXPECT_NEAR(number(1), 1.5 * number(0), 1e-3 * number(1));
    EXPECT_NEAR(number(2), 0.5 * number(0), 4e-3 * number(2));
    EXPECT_GT(line_of_a(), 300);
    EXPECT_GT(line_of_b(), 200) << "dashed";
    EXPECT_GT(count("colours('pane-d')"), 40);
    EXPECT_EQ(browser_->text(kNoteOfDifference), "");
    EXPECT_EQ(browser_->text(kNoteOfReadout), "");
}

TEST_F(Places, WhatDoesNotDependOnYIsComparedAtAnyY) {
    open();
    for (const auto& [a, b, factor] : {std::tuple{"bump", "mesh", 2.0}, {"mesh", "bump", 0.5}, {"far", "alike", 1.5}}) {
        choose("a", a);
        choose("b", b);
        EXPECT_NEAR(number(1), factor * number(0), 1e-3 * number(1)) << a << b;
        EXPECT_GT(line_of_a(), 300) << a << b;
        EXPECT_GT(line_of_b(), 200) << a << b;
        EXPECT_GT(count("colours('pane-d')"), 40) << a << b;
        EXPECT_EQ(browser_->text(kNoteOfDifference), "") << a << b;
    }
}

TEST_F(Places, ErrorsAgainstAShapeAreShownWhereACaseHasThem) {
    open();
    choose("a", "compared");
    choose("b", "whole");
    browser_->set("#quantity", "'angle'");
    EXPECT_GT(count("colours('pane-a')"), 40);
    EXPECT_TRUE(says(browser_->text("document.getElementById('note-b').textContent"), "has no [compare]"));
    const double index = browser_->evaluate("(viewer.state.point[0] + 0.0115) / 0.001").get<double>();
    EXPECT_NEAR(number(0, 7), 2 * index, 0.02 * index) << "2 deg a sample along x";
    EXPECT_EQ(number(0, 8), -0.25);
    EXPECT_EQ(read(1, 7), "–");
    EXPECT_TRUE(says(browser_->text("document.getElementById('compared-note').textContent"), "against a sphere"));
}

TEST_F(Places, AFieldAlikeInYIsShownAtTheOthersY) {
    open();
    choose("a", "mesh");
    choose("b", "bump");
    browser_->click("#axis-x");
    browser_->drag("#pane-b", 60, 200, 0, 0);
    EXPECT_TRUE(says(browser_->text(kPlace), "y = 0.43"));
    EXPECT_NE(read(0), "–");
}

TEST_F(Places, AFieldAlikeInYIsSlicedAsTheOther) {
    open();
    choose("a", "alike");
    choose("b", "whole");
    const std::string slice = browser_->text(kSlice), a = read(0), b = read(1);
    EXPECT_TRUE(says(slice, " of 6)"));
    browser_->click("#slice-on");
    EXPECT_NE(browser_->text(kSlice), slice);
    EXPECT_EQ(read(0), a);
    EXPECT_NE(read(1), b);
    EXPECT_EQ(browser_->text(kNoteOfDifference), "");
}

TEST_F(Places, ThatAreApartAreToldInWords) {
    for (const unsigned width : {1200u, 600u}) {
        open(width);
        choose("a", "mesh");
        choose("b", "far");
        const std::string words = "These two cases have no common places: A has y = 0.4350 mm, B has y = 0.9000 mm.";
        EXPECT_EQ(browser_->text(kNoteOfDifference), words);
        EXPECT_EQ(browser_->text(kNoteOfReadout), words);
        EXPECT_TRUE(browser_->evaluate("document.getElementById('note-d').checkVisibility()").get<bool>());
        EXPECT_EQ(browser_->text("document.getElementById('scale-d').style.visibility"), "hidden");
        EXPECT_TRUE(says(browser_->text("document.getElementById('title-b').textContent"), "at y = 0.9000 mm"));
        EXPECT_GT(number(0), 0);
        EXPECT_EQ(read(1), "–");
        EXPECT_GT(line_of_a(), 200);
        EXPECT_EQ(line_of_b(), 0);
        EXPECT_LE(browser_->evaluate("document.documentElement.scrollWidth").get<unsigned>(), width);
        choose("b", "other");
        EXPECT_EQ(browser_->text(kNoteOfDifference), "") << "the words go with their cause";
        EXPECT_EQ(browser_->text(kNoteOfReadout), "");
        EXPECT_EQ(browser_->text("document.getElementById('scale-d').style.visibility"), "");
    }
}

TEST_F(Places, BetweenTheSlicesCanBeComparedTheOtherWayRound) {
    open();
    choose("a", "whole");
    choose("b", "mesh");
    EXPECT_EQ(browser_->text(kNoteOfDifference), "No sample of A in this slice is a place of B, which has y = 0.4350 "
                                                 "mm. With A and B exchanged they can be compared.");
    EXPECT_EQ(browser_->text(kNoteOfReadout), "B has no values here.");
    choose("a", "mesh");
    choose("b", "whole");
    EXPECT_EQ(browser_->text(kNoteOfDifference), "");
    EXPECT_GT(number(1), 0);
}

TEST_F(Places, StrokesOutsideAreMadeAnew) {
    open();
    choose("a", "whole");
    browser_->click("#axis-x");
    const std::string first = "document.getElementById('stroke-0-0').valueAsNumber", whole = browser_->text(first);
    choose("a", "far");
    EXPECT_EQ(browser_->text(first), "0.9");
    EXPECT_GT(line_of_a(), 200) << "a stroke within one y goes along z";
    choose("a", "whole");
    EXPECT_EQ(browser_->text(first), "0.9") << "one that lies inside stays";
    EXPECT_GT(line_of_a(), 200);
}

TEST_F(Places, KeysChooseAndRead) {
    open(600);
    browser_->evaluate("document.getElementById('case-a').focus()");
    browser_->press("ArrowDown");
    await_title("a", "mesh");
    browser_->press("Tab");
    EXPECT_EQ(browser_->text("document.activeElement.id"), "case-b");
    browser_->press("ArrowDown");
    await_title("b", "other");
    for (int i = 0; i < 20 && browser_->text("document.activeElement.id") != "pane-a"; ++i)
        browser_->press("Tab");
    const std::string place = browser_->text(kPlace);
    browser_->press("ArrowRight");
    EXPECT_NE(browser_->text(kPlace), place);
    EXPECT_NEAR(number(1), 1.5 * number(0), 1e-3 * number(1));
}

// Every two cases, across every axis, whatever is shown. What is shown in space would be drawn anew each time, slowly.
TEST_F(Places, NoPictureIsBlankWithoutWords) {
    open(1200, kNoWebGl);
    const std::vector<std::string> names{"bump", "mesh", "other", "far", "whole", "alike"};
    for (std::size_t a = 0; a < names.size(); ++a) {
        choose("a", names[a]);
        for (std::size_t b = a; b < names.size(); ++b) {
            choose("b", names[b]);
            EXPECT_EQ(browser_->text("silent()"), "") << names[a] << " and " << names[b];
        }
    }
}

} // namespace
} // namespace forceshade::report

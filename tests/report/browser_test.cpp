// The report as a reader meets it, in headless Chromium.
#include "tests/report/page_test.h"

namespace forceshade::report {
namespace {

using namespace testing;

constexpr const char* kPaneA = "document.getElementById('pane-a').toDataURL()";
constexpr const char* kPaneD = "document.getElementById('pane-d').toDataURL()";
constexpr const char* kProfile = "document.querySelector('#profile-size g path').getAttribute('d')";

class Page : public ReportPage {
protected:
    static void SetUpTestSuite() {
        write_sample_sweep(folder_->path());
        write_sample_study(folder_->path() / "energy");
        begin();
    }
};

TEST_F(Page, ShowsTheForcesOfBothCases) {
    open();
    EXPECT_EQ(browser_->text("document.getElementById('viewer-status').textContent"), "");
    EXPECT_EQ(browser_->text("document.querySelectorAll('.compared, [value=angle]').length"), "0")
        << "nothing to compare";
    EXPECT_EQ(browser_->text("document.getElementById('case-b').selectedOptions[0].textContent"),
              "bump_shading-reference");
    EXPECT_GT(number(0, 1), 0.0);
    EXPECT_NEAR(number(1, 1), 2 * number(0, 1), 1e-3 * number(1, 1)) << "the second case is twice as strong";
    EXPECT_NEAR(number(2, 1), number(0, 1), 2e-3 * number(0, 1));
    // Forces of the sample: (lean, 0.3 y, 1) times the depth.
    EXPECT_NEAR(number(0, 3) / number(0, 4), 0.6, 2e-3) << "y is the third sample of six";
}

TEST_F(Page, ClicksChangeTheSlice) {
    open();
    const std::string slice = browser_->text(kSlice), picture = browser_->text(kPaneA);
    EXPECT_EQ(slice, "y = −0.5000 mm (3 of 6)");
    browser_->click("#slice-on");
    EXPECT_EQ(browser_->text(kSlice), "y = 0.5000 mm (4 of 6)");
    EXPECT_NE(browser_->text(kPaneA), picture);
    browser_->click("#axis-z");
    EXPECT_EQ(browser_->text(kSlice).substr(0, 4), "z = ");
}

TEST_F(Page, KeysMoveSliceCursorAndStroke) {
    open();
    browser_->evaluate("document.getElementById('pane-a').focus()");
    std::string before = browser_->text(kSlice);
    browser_->press("PageUp");
    EXPECT_NE(browser_->text(kSlice), before);
    browser_->press("PageDown");
    EXPECT_EQ(browser_->text(kSlice), before);
    before = browser_->text(kPlace);
    browser_->press("ArrowRight");
    EXPECT_NE(browser_->text(kPlace), before);
    browser_->press("ArrowLeft");
    EXPECT_EQ(browser_->text(kPlace), before);
    const std::string profile = browser_->text(kProfile);
    browser_->press("1");
    EXPECT_NE(browser_->text(kProfile), profile);
    browser_->evaluate("document.getElementById('slice').focus()");
    before = browser_->text(kSlice);
    browser_->press("ArrowRight");
    EXPECT_NE(browser_->text(kSlice), before);
}

TEST_F(Page, FocusIsSeenAndReachesEverything) {
    open();
    browser_->evaluate("document.getElementById('case-a').focus()");
    std::string reached;
    for (int i = 0; i < 20; ++i) {
        browser_->press("Tab");
        EXPECT_NE(browser_->text("getComputedStyle(document.activeElement).outlineStyle"), "none");
        reached += browser_->text("document.activeElement.id") + " ";
    }
    EXPECT_TRUE(says(reached, "case-b ", "quantity ", "arrows ", "slice ", "pane-a ", "pane-b ", "pane-d "));
}

TEST_F(Page, BeginsWithThePairThatDiffersMostWhereAHandTouches) {
    open();
    const auto first = [&](const std::string& errors, const std::string& shading = "reference") {
        return browser_->text("Viewer.prototype.firstPair.call({ cases: [['a', 'none'], ['a', '" + shading +
                              "'], ['b', 'none'], ['b', '" + shading +
                              "']].map(([name, shading], i) => ({ name: name + '_shading-' + shading, error_deg: " +
                              errors + "[i] })) }).join()");
    };
    EXPECT_EQ(first("[1, 0, 5, 0]"), "2,3");
    EXPECT_EQ(first("[5, 0, 1, 0]"), "0,1");
    EXPECT_EQ(first("[1, 0, 5, 0]", "mean_value"), "2,3");
    EXPECT_EQ(first("[null, null, null, null]"), "0,1") << "of volumes that no sweep measured";
}

TEST_F(Page, CountsHaveNoTicksBetweenThem) {
    open();
    const auto ticks = [&](const std::string& values) {
        return browser_->text("ticksOf(d3.scaleLinear().domain([0.8, 3.2]), {}, 12, " + values + ").join()");
    };
    EXPECT_EQ(ticks("[1, 2, 3]"), "1,2,3");
    EXPECT_NE(ticks("[1, 2.5, 3]"), "1,2,3");
}

TEST_F(Page, TheStrokesEndsCanBeDragged) {
    open();
    const std::string profile = browser_->text(kProfile);
    const std::string end = "document.getElementById('stroke-0-0').value", before = browser_->text(end);
    // The first end: 12 % of the plot, which begins 46 px from the left, at the cursor's height.
    const double wide = browser_->evaluate("document.getElementById('pane-a').clientWidth").get<double>();
    const double high = browser_->evaluate("document.getElementById('pane-a').clientHeight").get<double>() - 42;
    const double part =
        browser_->evaluate("(Number(document.getElementById('stroke-0-1').value) + 4.25) / 8").get<double>();
    browser_->drag("#pane-a", 46 + 0.12 * (wide - 56), 6 + high * (1 - part), 60, -10);
    EXPECT_NE(browser_->text(end), before);
    EXPECT_NE(browser_->text(kProfile), profile);
}

TEST_F(Page, AStrokeFollowsTheSurfaceWhereThatIsKnown) {
    open();
    // A roof, 2 mm high over x = 0 and at 0 from 10 mm on; the ends of the stroke are at z = 0.
    const auto heights = [&](const std::string& state, const std::string& surface) {
        return browser_->text(
            "Object.assign(Object.create(Viewer.prototype), { surfaces: [{ nominal: { unit_m: 1e-3, "
            "x: [-10, 0, 10], z: [[0, 2, 0]] } }], a: { about: { surface: " +
            surface +
            ", origin_m: [0, 0, 0], spacing_m: [1, 1, 1], full: [2, 1, 2] } }, state: { axis: 1, "
            "point: [0, 0, 0], strokes: [null, [[-0.02, 0], [0.02, 0]], null], " +
            state + " } }).strokeLine.map(([, z]) => (1e3 * z).toFixed(2)).filter((_, i) => i % 75 === 0).join()");
    };
    EXPECT_EQ(heights("follows: true, depth: 1e-3", "0"), "-1.00,-1.00,1.00,-1.00,-1.00");
    EXPECT_EQ(heights("follows: true, depth: 0.5e-3", "0"), "-0.50,-0.50,1.50,-0.50,-0.50");
    EXPECT_EQ(heights("follows: false, depth: 1e-3", "0"), "0.00,0.00,0.00,0.00,0.00");
    EXPECT_EQ(heights("follows: true, depth: 1e-3", "undefined"), "0.00,0.00,0.00,0.00,0.00");
}

TEST_F(Page, ChoicesChangeThePictures) {
    open();
    const std::string picture = browser_->text(kPaneA), difference = browser_->text(kPaneD);
    for (const char* quantity : {"magnitude", "x", "y", "z"}) {
        browser_->set("#quantity", "'" + std::string(quantity) + "'");
        EXPECT_NE(browser_->text(kPaneA), picture) << quantity;
    }
    browser_->set("#case-b", "'0'");
    ASSERT_TRUE(browser_->wait_for("document.getElementById('title-b').textContent.includes('none')"));
    EXPECT_EQ(number(2, 1), 0) << "a case does not differ from itself";
    EXPECT_NE(browser_->text(kPaneD), difference);
}

TEST_F(Page, FiguresStayReadable) {
    const std::string figure = "document.querySelector('.answer figure')";
    const auto box = [&](const std::string& part, const std::string& side) {
        return browser_->evaluate(figure + part + ".getBoundingClientRect()." + side).get<double>();
    };
    const std::string picture = ".querySelector('svg')", caption = ".querySelector('figcaption')";
    for (const unsigned width : {360u, 600u, 800u, 801u, 1400u, 1680u}) {
        SCOPED_TRACE(width);
        open(width);
        EXPECT_LE(browser_->evaluate("document.documentElement.scrollWidth").get<unsigned>(), width);
        EXPECT_GE(box(picture + ".querySelector('.tick')", "height"), 10) << "px of a number at an axis";
        EXPECT_LE(box("", "right"), width);
        EXPECT_LE(box(caption, "right"), box("", "right"));
        EXPECT_LE(box(picture, "right"), box("", "right") + 0.5) << "all of it can be seen";
    }
}

// What a mark is, is told when it is pointed at; the rows that a figure shows can be saved.
TEST_F(Page, MarksSayWhatTheyAre) {
    open();
    const auto count = [&](const std::string& selector) {
        return browser_->evaluate("document.querySelectorAll('" + selector + "').length").get<std::size_t>();
    };
    EXPECT_GT(count(".mark"), 10u);
    EXPECT_EQ(count(".mark > title"), count(".mark"));
    EXPECT_FALSE(browser_->evaluate("[...document.querySelectorAll('.mark > title')].some((t) => !t.textContent)"));
    browser_->evaluate("window.saved = []; window.save = (name, address) => saved.push([name, address]); 0");
    browser_->evaluate("(() => { document.querySelectorAll('.answer .save').forEach((b) => b.click()); return 0; })()");
    ASSERT_TRUE(browser_->wait_for("saved.length === 3"));
    EXPECT_TRUE(browser_->evaluate("saved.some(([n, a]) => n.endsWith('.csv') && a.includes('%0A'))").get<bool>());
    EXPECT_TRUE(browser_->evaluate("saved.some(([n, a]) => n.endsWith('.svg') && a.includes('viewBox'))").get<bool>());
    EXPECT_TRUE(browser_
                    ->evaluate("saved.some(([n, a]) => n.endsWith('.png') && a.startsWith('data:image/png') && "
                               "a.length > 5000)")
                    .get<bool>());
}

// A mark that others know more of shows it when it is clicked or Enter is pressed on it, or it is chosen by name.
TEST_F(Page, PickingAMarkShowsItsLinkedFigures) {
    open();
    const auto title = [&](int i) {
        return browser_->text("document.querySelectorAll('.linked figure h4')[" + std::to_string(i) + "].textContent");
    };
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.linked figure').length"), 0);
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.answer .pick').length"), 2) << "the others have none";
    browser_->click(".answer .pick");
    EXPECT_EQ(title(0), "Where: none n=4");
    EXPECT_EQ(title(1), "How deep: none n=4");
    const std::string value = "d3.select('.linked .mark:last-child').datum().row.error";
    EXPECT_NEAR(browser_->evaluate(value).get<double>(), 0.75, 1e-9);
    const std::string ramp = "document.querySelector('.linked .ramp').textContent", before = browser_->text(ramp);
    browser_->evaluate("document.querySelectorAll('.answer .pick')[1].focus()");
    browser_->press("Enter");
    EXPECT_EQ(title(0), "Where: mean_value n=64");
    EXPECT_NEAR(browser_->evaluate(value).get<double>(), 0.15, 1e-9);
    EXPECT_EQ(browser_->text(ramp), before) << "colours mean the same of all marks";
    EXPECT_EQ(browser_->text("document.querySelector('.linked select').value"), "mean_value n=64");
    browser_->set(".linked select", "'none n=4'");
    EXPECT_EQ(title(1), "How deep: none n=4");
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.linked figure').length"), 2);
}

// Shading keeps the magnitude: between two samples whose directions differ a stroke must not show a notch.
TEST_F(Page, StrokesKeepTheMagnitudeBetweenSamples) {
    open();
    EXPECT_NEAR(
        browser_
            ->evaluate("(() => { const v = Object.create(Volume.prototype); Object.assign(v, { size: [2, 1, 1], "
                       "first: [0, 0, 0], pitch: [1, 1, 1], about: { size: [2, 1, 1] }, "
                       "components: [[3, -3], [0, 0], [4, 4]] }); return length(v.force([0.5, 0, 0])); })()")
            .get<double>(),
        5, 1e-6);
}

TEST_F(Page, PrintsWhole) {
    open(1200, true);
    browser_->evaluate("addEventListener('beforeprint', () => { window.folded = "
                       "document.querySelectorAll('details:not([open])').length; "
                       "window.cell = document.querySelector('#sweep- td').textContent; })");
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('#sweep- table').length"), 0)
        << "tables are drawn on demand";
    const std::string pdf = browser_->print();
    EXPECT_TRUE(pdf.starts_with("%PDF-"));
    EXPECT_GT(pdf.size(), 30'000u);
    EXPECT_EQ(browser_->evaluate("window.folded"), 0) << "tables are unfolded on paper";
    EXPECT_EQ(browser_->text("window.cell"), "bump_shading-none") << "and drawn";
    EXPECT_NE(browser_->evaluate("document.querySelectorAll('details:not([open])').length"), 0) << "and folded again";
}

TEST_F(Page, TellsWhereABrowserCannotUnpack) {
    browser_->open(folder_->path() / "report.html", 1200, false, "delete window.DecompressionStream");
    EXPECT_TRUE(browser_->wait_for("document.getElementById('viewer-status').textContent.includes('cannot unpack')"));
    EXPECT_TRUE(browser_->evaluate("document.getElementById('viewer-body').hidden").get<bool>());
}

TEST_F(Page, RunsNothingThatStandsInAFile) {
    const Folder folder;
    const std::string evil = "<img src=x onerror=pwned=1><!--<script>";
    std::vector<CaseRecord> records{write_sample_case(folder.path(), {.name = evil}),
                                    write_sample_case(folder.path(), {.name = "b"})};
    records[0].parameters = {{"shading", "</script><script>pwned=1</script>"}};
    write_sample_manifest(folder.path(), records);
    write_report(folder.path());
    browser_->open(folder.path() / "report.html");
    EXPECT_TRUE(browser_->wait_for("document.documentElement.dataset.viewer === 'ready'"));
    EXPECT_EQ(browser_->text("typeof pwned"), "undefined");
    EXPECT_TRUE(says(browser_->text("document.getElementById('title-a').textContent"), evil));
}

} // namespace
} // namespace forceshade::report

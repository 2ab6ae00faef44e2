#include "host/experiment/analysis.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/experiment/statistics.h"
#include "host/experiment/stroke.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/threads.h"

namespace forceshade::experiment {
namespace {

using study::cell;
using study::Cell;
using study::Column;
using study::Table;

constexpr const char* kPaperOrder[] = {"flat_unshaded", "two_poly_unshaded", "three_poly_unshaded", "cylinder",
                                       "flat_shaded",   "two_poly_shaded",   "three_poly_shaded"};

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

// As readers call a stimulus: "two facets shaded, 600", the radius in mil, or its name.
std::string label_of(const Case& stimulus) {
    std::string name = paper_name(stimulus);
    if (name.empty())
        return stimulus.name;
    if (const std::size_t poly = name.find("_poly"); poly != std::string::npos)
        name.replace(poly, 5, " facets");
    if (const std::size_t bare = name.find("_unshaded"); bare != std::string::npos)
        name.erase(bare);
    std::ranges::replace(name, '_', ' ');
    return fmt::format("{}, {:.0f}", name, stimulus.scene.surface.radius / kMil);
}

// Table 2: a row a condition, percent of answers with their intervals, all subjects and each.
Table answer_table(const Answers& data) {
    const ExperimentSpec& spec = data.experiment.spec;
    Table table{"answers", "Answers in percent, as the paper's Table 2", {}, {}};
    table.columns = {
        {"subject", "", "all, or which"}, {"condition", "", "stimulus"}, {"trials", "1", "with an answer"}};
    for (const Answer& answer : spec.answers) {
        table.columns.push_back({answer.name + "_percent", "%", "answers \"" + answer.label + "\""});
        table.columns.push_back({answer.name + "_from_percent", "%", "95 % interval of a share of trials (Jeffreys)"});
        table.columns.push_back({answer.name + "_to_percent", "%", "its upper end"});
        table.columns.push_back(
            {answer.name + "_subjects_from_percent", "%", "95 % interval over subjects (Student's t)"});
        table.columns.push_back({answer.name + "_subjects_to_percent", "%", "its upper end"});
    }
    std::vector<std::string> subjects = data.subjects();
    const auto add = [&](const std::string& subject, std::size_t condition) {
        const std::vector<double> counts = data.counts(condition, subject);
        const double all = sum_of(counts);
        if (all == 0)
            return;
        std::vector<Cell> row{subject.empty() ? "all" : subject, data.experiment.study.cases[condition].name, all};
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const Range trials = jeffreys(counts[i], all);
            row.insert(row.end(), {cell(100 * counts[i] / all), cell(100 * trials.low), cell(100 * trials.high)});
            std::vector<double> shares;
            for (const std::string& one : subjects)
                if (const auto own = data.counts(condition, one); sum_of(own) > 0)
                    shares.push_back(100 * own[i] / sum_of(own));
            const Range over = subject.empty() ? mean_interval(shares) : Range{NAN, NAN};
            row.insert(row.end(), {cell(over.low), cell(over.high)});
        }
        table.rows.push_back(std::move(row));
    };
    for (const std::size_t condition : shown_order(data.experiment))
        add("", condition);
    for (const std::string& subject : subjects)
        for (const std::size_t condition : shown_order(data.experiment))
            add(subject, condition);
    return table;
}

// A row a condition and answer, for heat maps: this data, the 1996 ones, and what the observer expects.
struct Share {
    std::string source, condition, answer;
    double percent;
};

std::vector<Share> shares_of_all(const Answers& data, const std::vector<ConditionAnswers>& felt,
                                 const ObserverParameters& observer) {
    const ExperimentSpec& spec = data.experiment.spec;
    std::vector<Share> shares;
    const std::vector<ConditionAnswers> printed = table_2();
    for (const std::size_t condition : shown_order(data.experiment)) {
        const Case& stimulus = data.experiment.study.cases[condition];
        const std::vector<double> counts = data.counts(condition);
        for (std::size_t i = 0; i < counts.size(); ++i)
            if (sum_of(counts) > 0)
                shares.push_back(
                    {"measured", label_of(stimulus), spec.answers[i].label, 100 * counts[i] / sum_of(counts)});
        if (!data.experiment.has_papers_answers())
            continue;
        for (const ConditionAnswers& row : printed)
            if (row.name == paper_name(stimulus) &&
                row.group == fmt::format("{:.0f} mil", stimulus.scene.surface.radius / kMil))
                for (std::size_t i = 0; i < kPictures; ++i)
                    shares.push_back({"1996", label_of(stimulus), spec.answers[i].label, 100 * row.answered[i]});
        const auto own = std::ranges::find(felt, stimulus.name, &ConditionAnswers::name);
        if (own != felt.end()) {
            const Shares expected = shares_of(own->signals, observer);
            for (std::size_t i = 0; i < kPictures; ++i)
                shares.push_back({"observer", label_of(stimulus), spec.answers[i].label, 100 * expected[i]});
        }
    }
    return shares;
}

// What a subject's answers to two groups of conditions differ by.
struct Contrast {
    std::string name;
    std::vector<std::size_t> more, less; /* conditions: that differ by what is tested alone */
};

bool is_shaded(const Case& one) {
    return one.scene.force.shading != Shading::none;
}

// Shaded against unshaded by facets, and the largest radius against the smallest of what is shaded; without catch
// trials, whose answers decided who is there.
std::vector<Contrast> contrasts_of(const Experiment& experiment) {
    const std::vector<Case>& cases = experiment.study.cases;
    std::vector<Contrast> contrasts;
    const auto named = [&](const std::string& name) -> Contrast& {
        const auto found = std::ranges::find(contrasts, name, &Contrast::name);
        return found != contrasts.end() ? *found : contrasts.emplace_back(Contrast{name, {}, {}});
    };
    double low = INFINITY, high = 0; // m: radii
    for (const Case& one : cases) {
        low = std::min(low, one.scene.surface.radius);
        high = std::max(high, one.scene.surface.radius);
    }
    for (std::size_t shaded = 0; shaded < cases.size(); ++shaded) {
        if (!is_shaded(cases[shaded]) || cases[shaded].scene.surface.kind != SurfaceKind::bump ||
            experiment.is_catch(cases[shaded].name))
            continue;
        Scene bare = cases[shaded].scene;
        bare.force.shading = Shading::none;
        for (std::size_t other = 0; other < cases.size(); ++other)
            if (cases[other].scene == bare && !experiment.is_catch(cases[other].name))
                for (const std::string& name :
                     {std::string("shaded against unshaded"),
                      "shaded against unshaded, " + numbers::counted(bare.surface.facets, "facet")}) {
                    named(name).more.push_back(shaded);
                    named(name).less.push_back(other);
                }
        if (low < high && (bare.surface.radius == low || bare.surface.radius == high)) {
            Contrast& radius = named(fmt::format("radius {:.0f} against {:.0f} mil, shaded", high / kMil, low / kMil));
            (bare.surface.radius == high ? radius.more : radius.less).push_back(shaded);
        }
    }
    std::erase_if(contrasts, [](const Contrast& one) { return one.more.empty() || one.less.empty(); });
    std::ranges::stable_sort(contrasts, {}, &Contrast::name);
    return contrasts;
}

struct Tested {
    std::string name;
    double difference = 0;       /* percentage points: mean over subjects */
    Range range;                 /* likewise */
    double p = 1, corrected = 1; /* of all contrasts (Holm) */
    double model_p = 1, model_corrected = 1;
    std::size_t subjects = 0;
};

std::vector<Tested> tests_of(const Answers& data, std::size_t answer) {
    std::vector<Tested> tests;
    const auto add = [&](const std::vector<std::size_t>& conditions, const std::string& subject, double& count,
                         double& all) {
        for (const std::size_t condition : conditions) {
            const std::vector<double> counts = data.counts(condition, subject);
            count += counts[answer];
            all += sum_of(counts);
        }
    };
    for (const Contrast& contrast : contrasts_of(data.experiment)) {
        std::vector<double> differences; // percentage points
        std::vector<SubjectCounts> counts;
        for (const std::string& subject : data.subjects()) {
            SubjectCounts& one = counts.emplace_back();
            add(contrast.more, subject, one.more, one.of_more);
            add(contrast.less, subject, one.less, one.of_less);
            if (one.of_more > 0 && one.of_less > 0)
                differences.push_back(100 * (one.more / one.of_more - one.less / one.of_less));
        }
        if (!differences.empty())
            tests.push_back({contrast.name, sum_of(differences) / double(differences.size()),
                             mean_interval(differences), sign_flip_p(differences), 1, likelihood_ratio_p(counts), 1,
                             differences.size()});
    }
    const auto correct = [&](double Tested::*p, double Tested::*corrected) {
        std::vector<double> all;
        std::ranges::transform(tests, std::back_inserter(all), p);
        const std::vector<double> by_holm = holm(all);
        for (std::size_t i = 0; i < tests.size(); ++i)
            tests[i].*corrected = by_holm[i];
    };
    correct(&Tested::p, &Tested::corrected);
    correct(&Tested::model_p, &Tested::model_corrected);
    return tests;
}

Table test_table(const std::vector<Tested>& tests, const std::string& answer) {
    return study::table_of<Tested>(
        "tests", fmt::format("Answers \"{}\" by condition, subjects as clusters", answer),
        {{{"contrast", "", "which conditions"}, &Tested::name},
         {{"difference_points", "%", "percentage points, mean over subjects"}, &Tested::difference},
         {{"from_points", "%", "95 % interval over subjects (Student's t); nothing with one"},
          [](const Tested& one) { return cell(one.range.low); }},
         {{"to_points", "%", "its upper end"}, [](const Tested& one) { return cell(one.range.high); }},
         {{"p", "1",
           "of a mean as far from 0 if each subject's sign were by chance, two sides; no less than 2^(1 - n)"},
          &Tested::p},
         {{"p_holm", "1", "corrected for the number of contrasts (Holm): of whichever is reported"},
          &Tested::corrected},
         {{"p_model", "1",
           "of the likelihood ratio of a beta-binomial model (subjects differ) against 999 experiments drawn from it "
           "without a difference; also of few subjects"},
          &Tested::model_p},
         {{"p_model_holm", "1", "corrected in the same way"}, &Tested::model_corrected},
         {{"subjects", "1", "n"}, [](const Tested& one) { return cell(double(one.subjects)); }}},
        tests);
}

Table stroke_table(const Answers& data) {
    Table table{"strokes", "How stimuli were stroked", {}, {}};
    table.columns = {{"condition", "", "stimulus"}, {"trials", "1", "with an answer"}};
    struct Measure {
        const char *name, *unit, *meaning;
        double (*of)(const TrialRow&);
    };
    constexpr Measure kMeasures[] = {
        {"reaction_s", "s", "from the stimulus to the answer",
         [](const TrialRow& row) { return row.outcome.reaction; }},
        {"contact_s", "s", "in contact", [](const TrialRow& row) { return row.outcome.contact; }},
        {"strokes", "1", "passes across the whole feature",
         [](const TrialRow& row) { return double(row.outcome.strokes); }},
        {"speed_m_per_s", "m/s", "mean in contact", [](const TrialRow& row) { return row.outcome.speed; }},
        {"press_N", "N", "mean vertical force in contact", [](const TrialRow& row) { return row.outcome.press; }},
        {"largest_force_N", "N", "displayed", [](const TrialRow& row) { return row.outcome.largest_force; }}};
    for (const Measure& measure : kMeasures) {
        table.columns.push_back({measure.name, measure.unit, std::string(measure.meaning) + ": median of the trials"});
        table.columns.push_back({std::string(measure.name) + "_25", measure.unit, "a quarter of the trials is less"});
        table.columns.push_back({std::string(measure.name) + "_75", measure.unit, "a quarter is more"});
    }
    for (const std::size_t condition : shown_order(data.experiment)) {
        const std::string& name = data.experiment.study.cases[condition].name;
        std::vector<const TrialRow*> rows;
        for (const TrialRow& row : data.rows)
            if (row.condition == name)
                rows.push_back(&row);
        if (rows.empty())
            continue;
        std::vector<Cell> cells{name, double(rows.size())};
        for (const Measure& measure : kMeasures) {
            std::vector<double> values;
            values.reserve(rows.size());
            for (const TrialRow* row : rows)
                values.push_back(measure.of(*row));
            for (const double share : {0.5, 0.25, 0.75})
                cells.push_back(cell(study::quantile(values, share)));
        }
        table.rows.push_back(std::move(cells));
    }
    return table;
}

// What is felt of each stimulus, in closed loop, and what was answered. Groups are radii.
std::vector<ConditionAnswers> felt_conditions(const Answers& data) {
    std::vector<ConditionAnswers> conditions;
    CasePreparation preparation;
    for (const std::size_t condition : shown_order(data.experiment)) {
        const PreparedCase stimulus = preparation.prepare(data.experiment.study.cases[condition]);
        const auto passes = passes_of(stimulus);
        const std::vector<double> counts = data.counts(condition);
        if (passes.empty() || sum_of(counts) == 0)
            continue;
        ConditionAnswers one{stimulus.one.name,
                             fmt::format("{:.4g} m", stimulus.one.scene.surface.radius),
                             passes[passes.size() / 2],
                             {},
                             sum_of(counts)};
        for (std::size_t i = 0; i < kPictures; ++i)
            one.answered[i] = counts[i] / one.trials;
        conditions.push_back(std::move(one));
    }
    return conditions;
}

struct Fit {
    std::string data, model;
    ObserverParameters parameters;
    double deviance = 0, left_out = 0, left_out_stimulus = 0; // 1
    std::vector<ConditionAnswers> rows;                       // what it was fitted to
};

// The observer, what it was before, and its rival, as tables name them.
constexpr std::pair<const char*, ObserverModel> kModels[] = {{"observer", ObserverModel::weber},
                                                             {"two noises", ObserverModel::two_noises},
                                                             {"rival", ObserverModel::base_kinks}};

Table fit_table(const std::vector<Fit>& fits) {
    using F = Fit;
    return study::table_of<F>(
        "observer", "The observer, fitted by maximum likelihood",
        {{{"data", "", "these, or Table 2 of 1996 (in the limit of a rigid surface)"}, &F::data},
         {{"model", "",
           "observer: one Weber fraction of force, 0.07, is both its noise and its threshold for level; two noises: "
           "both are fitted; rival: what is exactly level counts, and kinks at the base; row means: of other radii"},
          &F::model},
         {{"deviance", "1", "2 sum O ln(O / E), in sample"},
          [](const F& f) { return f.deviance > 0 ? cell(f.deviance) : Cell(); }},
         {{"left_out_deviance", "1", "each radius predicted by the others"},
          [](const F& f) { return f.left_out > 0 ? cell(f.left_out) : Cell(); }},
         {{"left_out_stimulus_deviance", "1", "each stimulus (1996: at all radii) predicted by the others"},
          [](const F& f) { return f.left_out_stimulus > 0 ? cell(f.left_out_stimulus) : Cell(); }}},
        fits);
}

Table parameter_table(const std::vector<Fit>& fits) {
    struct Row {
        const Fit* fit;
        FreeParameter parameter;
        double dispersion;
        double low, high;
    };
    std::vector<Row> rows;
    for (const Fit& fit : fits) {
        if (fit.rows.empty())
            continue;
        const ObserverRange range = bootstrapped(fit.rows, fit.parameters);
        for (const FreeParameter& one : free_parameters(fit.parameters.model))
            rows.push_back({&fit, one, range.dispersion, range.low.*one.member, range.high.*one.member});
    }
    return study::table_of<Row>(
        "parameters", "The observer's parameters",
        {{{"data", "", "as in observer"}, [](const Row& row) { return Cell(row.fit->data); }},
         {{"model", "", "as in observer"}, [](const Row& row) { return Cell(row.fit->model); }},
         {{"parameter", "", "1 each"}, [](const Row& row) { return Cell(row.parameter.name); }},
         {{"fitted", "1", "by maximum likelihood"},
          [](const Row& row) { return cell(row.fit->parameters.*row.parameter.member); }},
         {{"from", "1", "95 % of answers drawn anew from the fitted shares, as many as count"}, &Row::low},
         {{"to", "1", "its upper end"}, &Row::high},
         {{"dispersion", "1", "deviance over degrees of freedom, which divides the trials"}, &Row::dispersion},
         {{"what", "", "what it is"}, [](const Row& row) { return Cell(row.parameter.meaning); }}},
        rows);
}

bool has_several(const std::vector<ConditionAnswers>& rows, LeftOut group) {
    return std::ranges::any_of(rows, [&](const ConditionAnswers& row) { return row.*group != rows.front().*group; });
}

std::vector<Fit> fits_of(const std::vector<ConditionAnswers>& felt) {
    std::vector<Fit> fits;
    const auto add = [&](const std::string& name, const std::vector<ConditionAnswers>& rows) {
        for (const auto& [model, kind] : kModels) {
            const ObserverParameters best = fitted(rows, published_observer(kind));
            const auto left_out = [&](LeftOut group) {
                return has_several(rows, group) ? predicted_by_observer(rows, best, group).deviance : 0;
            };
            fits.push_back({name, model, best, deviance(rows, best), left_out(&ConditionAnswers::group),
                            left_out(&ConditionAnswers::name), rows});
        }
    };
    add("1996", table_2());
    fits.push_back({"1996", "row means", {}, 0, predicted_by_means(table_2()).deviance, 0, {}});
    if (!felt.empty())
        add("measured", felt);
    return fits;
}

// Stimuli that the observer and its rival expect different answers to.
Table prediction_table() {
    struct Row {
        std::string stimulus;
        Shares observer, other;
    };
    std::vector<Row> rows;
    for (const double radius : {600.0, 800.0, 1000.0, 1400.0, 2000.0})
        for (const unsigned facets : {0u, 1u, 2u, 3u, 4u, 5u})
            for (const bool shaded : {false, true})
                for (const Hold hold : {Hold::force, Hold::depth}) {
                    const bool printed = facets <= 3 && radius != 800 && radius != 2000 && hold == Hold::force;
                    if (printed || (facets == 0 && shaded) || (facets == 1 && !shaded))
                        continue;
                    const StrokeSignals signals = rigid_signals(radius * kMil, 1000 * kMil, facets, shaded, hold);
                    rows.push_back({(facets == 0 ? fmt::format("cylinder, {:.0f} mil", radius)
                                                 : fmt::format("{}, {:.0f} mil, {}", numbers::counted(facets, "facet"),
                                                               radius, shaded ? "shaded" : "unshaded")) +
                                        (hold == Hold::depth ? ", constant depth" : ""),
                                    shares_of(signals, ObserverParameters{}),
                                    shares_of(signals, published_observer(ObserverModel::base_kinks))});
                }
    std::vector<study::ColumnOf<Row>> columns{
        {{"stimulus", "", "of W = 1000 mil, never tested; pressed with a constant force but where it says depth"},
         &Row::stimulus}};
    for (std::size_t i = 0; i < kPictures; ++i)
        for (const bool other : {false, true})
            columns.push_back(
                {{fmt::format("{}_{}_percent", kPictureNames[i], other ? "rival" : "observer"), "%",
                  fmt::format("answers that the {} expects", other ? "rival" : "observer")},
                 [i, other](const Row& row) { return cell(100 * (other ? row.other : row.observer)[i]); }});
    columns.push_back({{"apart_points", "%", "half the sum of the differences: the largest comes first"},
                       [](const Row& row) { return Cell(apart(row.observer, row.other)); }});
    Table table = study::table_of<Row>("predictions", "What new data would decide", columns, rows);
    std::ranges::stable_sort(table.rows, [](const auto& a, const auto& b) {
        return std::get<double>(a.back()) > std::get<double>(b.back());
    });
    return table;
}

std::vector<study::Figure> figures_of(const std::vector<Tested>& tests, const std::string& smooth) {
    study::Figure shares =
        study::make_figure("shares", "Answers by stimulus",
                           "Percent of the answers to each stimulus (radius in mil). 1996: the paper's Table 2; "
                           "observer: what the model expects of a simulated hand's strokes.",
                           study::FigureKind::cells, "shares", {}, {"answer", ""}, {"condition", ""});
    shares.value = "percent";
    shares.value_label = "% of the answers";
    shares.value_limit = 100;
    shares.panels = "source";
    std::vector<study::Figure> figures{shares};
    if (!tests.empty()) {
        study::Figure& contrasts = figures.emplace_back(study::make_figure(
            "tests", fmt::format("How much more often \"{}\" is answered", smooth),
            "Means over subjects, with their 95 % intervals (Student's t).", study::FigureKind::bars, "tests", {},
            {"contrast", "contrast"}, {"difference_points", "difference / percentage points"}));
        contrasts.low = "from_points";
        contrasts.high = "to_points";
    }
    return figures;
}

std::string evidence_of(const Tested& test) {
    if (test.subjects < 2)
        return "one subject: neither an interval nor a test";
    const std::string range =
        fmt::format("95 % over subjects: {:.0f} to {:.0f} points", test.range.low, test.range.high);
    if (test.subjects < kLeastSubjects)
        return fmt::format("{}; sign flips of {} subjects cannot be significant, {} are the fewest; by a beta-binomial "
                           "model p = {:.2g}, corrected for all contrasts {:.2g}",
                           range, test.subjects, kLeastSubjects, test.model_p, test.model_corrected);
    return fmt::format(
        "{}; sign flips: p = {:.2g}, corrected for all contrasts {:.2g}; by a beta-binomial model {:.2g}, {:.2g}",
        range, test.p, test.corrected, test.model_p, test.model_corrected);
}

void add_findings(study::StudyData& data, const Answers& answers, const std::vector<Tested>& tests,
                  const std::vector<Fit>& fits, const std::string& smooth) {
    const std::string who =
        fmt::format("{}, {} trials", numbers::counted(answers.subjects().size(), "subject"), answers.rows.size());
    const auto add = [&](const std::string& name, const std::string& claim, const Tested& test) {
        data.findings.push_back({name,
                                 fmt::format(fmt::runtime(claim), smooth, std::abs(test.difference),
                                             test.difference < 0 ? "less often" : "more often"),
                                 "", test.name, who, evidence_of(test)});
    };
    for (const Tested& test : tests)
        if (test.name == "shaded against unshaded")
            add("shading",
                "Shaded bumps get the answer \"{}\" {:.0f} percentage points {} than the same bumps unshaded.", test);
    for (const Tested& test : tests)
        if (test.name.starts_with("radius"))
            add("radius",
                "Shaded bumps of the largest radius get the answer \"{}\" {:.0f} percentage points {} than those of "
                "the smallest.",
                test);
    const Fit *own = nullptr, *other = nullptr;
    for (const Fit& fit : fits)
        if (fit.data == "measured" && fit.model != "two noises")
            (fit.model == "rival" ? other : own) = &fit;
    if (own && other)
        data.findings.push_back(
            {"observer",
             fmt::format("Fitted to these answers the observer's deviance is {:.0f} and its rival's {:.0f}.",
                         own->deviance, other->deviance),
             "shares", "cues of a simulated hand's strokes over each stimulus", who,
             own->left_out > 0
                 ? fmt::format("radii left out in turn: {:.0f} and {:.0f}", own->left_out, other->left_out)
                 : "no radius can be left out"});
}

} // namespace

std::string paper_name(const Case& stimulus) {
    const SurfaceSpec& surface = stimulus.scene.surface;
    if (std::abs(surface.width - 1000 * kMil) > 1e-9)
        return "";
    if (surface.kind == SurfaceKind::cylinder_bump)
        return "cylinder";
    if (surface.kind != SurfaceKind::bump || surface.facets > 3)
        return "";
    constexpr const char* kNames[] = {"", "flat", "two_poly", "three_poly"};
    return fmt::format("{}_{}", kNames[surface.facets], is_shaded(stimulus) ? "shaded" : "unshaded");
}

std::vector<std::size_t> shown_order(const Experiment& experiment) {
    const std::vector<Case>& cases = experiment.study.cases;
    std::vector<std::size_t> order(cases.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    const auto place = [&](std::size_t i) {
        const auto known = std::ranges::find(kPaperOrder, paper_name(cases[i]));
        return std::pair(known - std::begin(kPaperOrder),
                         known == std::end(kPaperOrder) ? 0 : cases[i].scene.surface.radius);
    };
    std::ranges::stable_sort(order, {}, place);
    return order;
}

study::StudyData analyse(const Answers& answers) {
    const ExperimentSpec& spec = answers.experiment.spec;
    study::StudyData data;
    data.study = "classification";
    data.program = version();
    data.engine = "analysis";
    data.device = answers.rows.front().device;
    data.cores = most_threads();
    data.scene = resolved_toml(answers.experiment);
    std::string left_out =
        fmt::format("{} rows that do not count (practice, trials without an answer) are left out.", answers.left_out);
    if (!answers.excluded.empty())
        left_out += fmt::format(" Subjects left out by their catch trials, of which {:.3g} % are to be right: {}.",
                                100 * spec.catch_least, fmt::join(answers.excluded, ", "));
    if (spec.task == Task::compare) {
        data.study = "comparison";
        data.notes.push_back(left_out);
        add_comparisons(data, answers);
        data.tables.push_back(stroke_table(answers));
        data.tables.push_back(wide_table(answers));
        return data;
    }
    const bool papers = answers.experiment.has_papers_answers();
    const std::vector<ConditionAnswers> felt = papers ? felt_conditions(answers) : std::vector<ConditionAnswers>();
    const std::vector<Fit> fits = papers ? fits_of(felt) : std::vector<Fit>();
    const ObserverParameters published;
    data.tables.push_back(answer_table(answers));
    data.tables.push_back(study::table_of<Share>(
        "shares", "Answers by condition",
        {{{"source", "", "measured; 1996: Table 2; observer: with the parameters fitted to Table 2"}, &Share::source},
         {{"condition", "", "stimulus"}, &Share::condition},
         {{"answer", "", "as the participant reads it"}, &Share::answer},
         {{"percent", "%", "of the answers"}, &Share::percent}},
        shares_of_all(answers, felt, published)));
    const std::optional<std::size_t> smooth = smooth_answer(spec);
    const std::vector<Tested> tests = smooth ? tests_of(answers, *smooth) : std::vector<Tested>();
    const std::string smooth_label = smooth ? spec.answers[*smooth].label : "";
    if (!tests.empty())
        data.tables.push_back(test_table(tests, smooth_label));
    data.tables.push_back(stroke_table(answers));
    data.tables.push_back(wide_table(answers));
    if (papers) {
        data.tables.push_back(fit_table(fits));
        data.tables.push_back(parameter_table(fits));
        data.tables.push_back(prediction_table());
    }
    data.figures = figures_of(tests, smooth_label);
    add_findings(data, answers, tests, fits, smooth_label);
    data.notes = {
        left_out,
        fmt::format(
            "Intervals of shares take trials as independent (Jeffreys) or are of the subjects' means (Student's t); "
            "tests change the signs of whole subjects, so that of less than {} none can be significant, or hold a "
            "beta-binomial model, whose subjects differ, against itself without a difference.",
            kLeastSubjects)};
    if (papers) {
        data.notes.push_back(
            "The observer is a Poisson race of an edge on the crest against a level top, with three fitted numbers and "
            "a Weber fraction of force from the literature. Its structure was chosen after seeing all of Table 2, so "
            "what is left out tests its parameters, not its form; a rival with five, which takes kinks at the base for "
            "a facet's edges, fits Table 2 better (147 against 161) and predicts stimuli that are left out worse (615 "
            "against 181). Only new data decide: the table of predictions has stimuli on which they differ.");
        data.notes.push_back("The observer is fitted to cues of a simulated hand that strokes each stimulus as the "
                             "experiment says, not to what each subject did.");
    }
    return data;
}

} // namespace forceshade::experiment

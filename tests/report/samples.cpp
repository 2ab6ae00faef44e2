#include "tests/report/samples.h"

#include <cmath>

#include <fmt/format.h>

namespace forceshade::testing {
namespace {

using study::cell;
using study::Figure;
using study::FigureKind;
using study::Table;

Table error_time() {
    Table table{"points",
                "Error against time",
                {{"scheme", "", "which shading"},
                 {"name", "", "what is meant"},
                 {"n", "1", "facets"},
                 {"time_ratio", "1", "time per evaluation over the reference's"},
                 {"low", "1", "a quarter of the repeats are below"},
                 {"high", "1", "a quarter are above"},
                 {"error_max_deg", "deg", "largest error of direction"}},
                {}};
    const char* schemes[] = {"none", "morgenbesser", "barycentric", "mean_value"};
    for (int s = 0; s < 4; ++s)
        for (int n = 4; n <= 4096; n *= 4) {
            const double time = 0.04 * (s + 1) * std::pow(n, 0.1), error = 60 / std::pow(n, s < 2 ? 1 : 2) + 1e-5;
            table.rows.push_back({std::string(schemes[s]), fmt::format("{} n={}", schemes[s], n), cell(n), cell(time),
                                  cell(time * 0.9), cell(time * 1.2), cell(error)});
        }
    table.rows.push_back({std::string("exact"), std::string("f64"), cell(1), cell(1), cell(1), cell(1), cell(0)});
    return table;
}

Table loop() {
    Table table{"loop",
                "Stability",
                {{"K_N_per_m", "N/m", "stiffness"},
                 {"damping_N_s_per_m", "N s/m", "damping"},
                 {"state", "", "how the loop ends"},
                 {"growth", "1", "growth of the amplitude in a second"},
                 {"energy_J", "J", "energy given"}},
                {}};
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < 12; ++j) {
            const double k = 100 * std::pow(10, i / 6.0), b = 0.5 * j, ratio = k / (400 * (b + 0.5));
            table.rows.push_back({cell(k), cell(b),
                                  std::string(ratio < 1   ? "stable"
                                              : ratio < 2 ? "limit cycle"
                                                          : "unstable"),
                                  i == 3 && j == 3 ? cell(NAN) : cell(ratio), cell(std::log(ratio))});
        }
    return table;
}

Table critical() {
    Table table{"critical", "Closed form", {{"K", "N/m", ""}, {"b", "N s/m", ""}}, {}};
    for (int j = -2; j <= 30; ++j)
        table.rows.push_back({cell(400 * (0.2 * j + 0.5)), cell(0.2 * j)});
    return table;
}

// Of two points of error_time() what a map and a line show.
Table details() {
    Table table{"details",
                "Details",
                {{"name", "", ""}, {"place_mm", "mm", ""}, {"depth_mm", "mm", ""}, {"error", "1", ""}},
                {}};
    for (const char* name : {"none n=4", "mean_value n=64"})
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 3; ++j)
                table.rows.push_back(
                    {std::string(name), cell(i), cell(j), cell(0.01 * (1 + i * j) * (name[0] == 'n' ? 5 : 1))});
    return table;
}

Table energies() {
    Table table{"energies",
                "Energy",
                {{"surface", "", ""},
                 {"scheme", "", ""},
                 {"eta", "1", "work over effort"},
                 {"low", "1", ""},
                 {"high", "1", ""}},
                {}};
    const char* surfaces[] = {"bump of three facets", "sphere", "a surface whose name is much longer than others"};
    const char* schemes[] = {"none", "morgenbesser", "mean_value"};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double eta = j == 0 ? 2e-9 * (i + 1) : 0.02 * (i + 1) * j;
            table.rows.push_back(
                {std::string(surfaces[i]), std::string(schemes[j]), cell(eta), cell(eta * 0.8), cell(eta * 1.3)});
        }
    return table;
}

Figure figure(const char* name, const char* title, FigureKind kind, const char* table, study::FigureAxis x,
              study::FigureAxis y) {
    Figure f;
    f.name = name;
    f.title = title;
    f.caption = "How to read it, and what is to be seen.";
    f.kind = kind;
    f.table = table;
    f.x = std::move(x);
    f.y = std::move(y);
    return f;
}

void add_scatters(study::StudyData& data) {
    Figure f = figure("error_time", "Error of direction against time per evaluation, as a ratio to the reference",
                      FigureKind::scatter, "points", {"time_ratio", "time / reference", true},
                      {"error_max_deg", "largest error of direction / deg", true});
    f.series = "scheme";
    f.label = "name";
    f.pick = "name";
    f.linked = {"detail", "depth"};
    data.figures.push_back(f);
    f.pick = "";
    f.linked.clear();
    f.name = "order";
    f.x = {"n", "facets n", true};
    f.label = "";
    f.joined = true;
    f.curves = {{"points", {{"scheme", "none"}}, "n", "time_ratio", "expected order", true},
                {"points", {{"scheme", "barycentric"}}, "n", "high", "barycentric", false}};
    data.figures.push_back(f);
    f = figure("spread", "Times with their spread", FigureKind::scatter, "points", {"n", "facets n", false},
               {"time_ratio", "time / reference", false});
    f.series = "scheme";
    f.low = "low";
    f.high = "high";
    data.figures.push_back(f);
}

void add_maps(study::StudyData& data) {
    Figure f = figure("loop", "Where the loop is stable", FigureKind::cells, "loop",
                      {"K_N_per_m", "stiffness / (N/m)", true}, {"damping_N_s_per_m", "damping / (N s/m)", false});
    f.value = "state";
    f.value_label = "state";
    f.value_words = {"stable", "limit cycle", "unstable"};
    f.curves = {{"critical", {}, "K", "b", "closed form", false}};
    data.figures.push_back(f);
    f.name = "growth";
    f.value = "growth";
    f.value_label = "growth / 1";
    f.value_logarithmic = true;
    f.value_words.clear();
    data.figures.push_back(f);
    f.name = "energy";
    f.value = "energy_J";
    f.value_label = "energy / J";
    f.value_logarithmic = false;
    data.figures.push_back(f);
}

void add_linked(study::StudyData& data) {
    Figure f = figure("detail", "Where: none n=4", FigureKind::cells, "details", {"place_mm", "place / mm", false},
                      {"depth_mm", "depth / mm", false});
    f.where = {{"name", "none n=4"}};
    f.value = "error";
    f.value_label = "error";
    data.figures.push_back(f);
    f.name = "depth";
    f.title = "How deep: none n=4";
    f.kind = FigureKind::scatter;
    f.x = {"depth_mm", "depth / mm", false};
    f.y = {"error", "error", false};
    data.figures.push_back(f);
}

void add_bars(study::StudyData& data) {
    Figure f = figure("eta", "Energy over effort", FigureKind::bars, "energies", {"surface", "surface", false},
                      {"eta", "η = W / ∮|F·dl|", true});
    f.series = "scheme";
    f.low = "low";
    f.high = "high";
    data.figures.push_back(f);
    f.name = "eta_linear";
    f.y.logarithmic = false;
    f.x = {"scheme", "scheme", false};
    f.series = "surface";
    data.figures.push_back(f);
}

} // namespace

study::StudyData sample_study() {
    study::StudyData data;
    data.study = "energy";
    data.program = "0.1.0+sample";
    data.engine = "gpu";
    data.device = "a device";
    data.driver = "a driver";
    data.cpu = "a processor";
    data.cores = 2;
    data.quick = true;
    data.seconds = 12.5;
    data.notes = {"These numbers are made up."};
    data.tables = {error_time(), loop(), critical(), energies(), details()};
    add_scatters(data);
    add_maps(data);
    add_bars(data);
    add_linked(data);
    return data;
}

} // namespace forceshade::testing

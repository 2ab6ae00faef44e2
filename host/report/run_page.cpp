// The page of a run.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/paths/path_reader.h"
#include "host/report/report.h"
#include "host/report/sections.h"

namespace forceshade::report {
namespace {

constexpr std::size_t kMostShown = 2000; // samples of a run
constexpr std::uint64_t kMostPathsShown = 4;

struct RunSample {
    std::string path;
    double time; /* s, NaN where it is not known */
    glm::dvec3 at, force;
};

struct RunSamples {
    std::vector<RunSample> shown;
    std::size_t every = 1; /* of the file's, every which one is shown */
};

// Columns by their names; others are not read.
RunSamples samples_of_csv(const std::filesystem::path& file) {
    static constexpr const char* kColumns[] = {"path", "t", "x", "y", "z", "fx", "fy", "fz"};
    CsvReader csv(file);
    std::array<std::size_t, std::size(kColumns)> cells{};
    csv.next();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        while (cells[i] < csv.size() && csv.text(cells[i]) != kColumns[i])
            ++cells[i];
        if (cells[i] == csv.size())
            throw UsageError("{}: it has no column {}", file.string(), kColumns[i]);
    }
    RunSamples samples;
    for (std::size_t row = 0; csv.next(); ++row) {
        if (row % samples.every || csv.size() <= *std::ranges::max_element(cells))
            continue;
        std::array<double, cells.size()> values{};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::string_view text = csv.text(cells[i]);
            values[i] = NAN;
            std::from_chars(text.data(), text.data() + text.size(), values[i]);
        }
        samples.shown.push_back({"path " + std::string(csv.text(cells[0])),
                                 values[1],
                                 {values[2], values[3], values[4]},
                                 {values[5], values[6], values[7]}});
        if (samples.shown.size() == 2 * kMostShown) { // every second one goes
            for (std::size_t i = 1; i < kMostShown; ++i)
                samples.shown[i] = std::move(samples.shown[2 * i]);
            samples.shown.resize(kMostShown);
            samples.every *= 2;
        }
    }
    return samples;
}

RunSamples samples_of_exr(const std::filesystem::path& file) {
    const PathSamples read = read_paths(file, kMostPathsShown, kMostShown / kMostPathsShown);
    const double period = path_period(read.scene); /* s */
    RunSamples samples{{}, read.every_step};
    for (std::size_t i = 0; i < read.paths * read.steps; ++i) {
        const float *at = &read.position[3 * i], *force = &read.force[3 * i];
        if (std::isfinite(at[0]))
            samples.shown.push_back({fmt::format("path {}", i / read.steps),
                                     double(i % read.steps * read.every_step) * period,
                                     read.origin + glm::dvec3(at[0], at[1], at[2]),
                                     {force[0], force[1], force[2]}});
    }
    return samples;
}

// deg: from z towards x.
double direction_of(const RunSample& sample) {
    const glm::dvec3& force = sample.force;
    return force.x == 0 && force.z == 0 ? NAN : std::atan2(force.x, force.z) * 180 / std::numbers::pi;
}

} // namespace

void add_samples(study::StudyData& data, const std::filesystem::path& file) {
    const RunSamples samples = file.extension() == ".exr" ? samples_of_exr(file) : samples_of_csv(file);
    if (samples.every > 1)
        data.notes.push_back(
            fmt::format("One of {} samples is shown; {} has all.", samples.every, file.filename().string()));
    using R = RunSample;
    const auto place = [](int axis) { return [axis](const R& r) { return 1e3 * r.at[axis]; }; };
    data.tables.push_back(study::table_of<R>(
        "samples", "Samples",
        {{"path", "", "as in the file", &R::path},
         {"t_s", "s", "since the path began", &R::time},
         {"x_mm", "mm", "of the probe", place(0)},
         {"y_mm", "mm", "of the probe", place(1)},
         {"z_mm", "mm", "of the probe", place(2)},
         {"force_N", "N", "of the law", [](const R& r) { return std::hypot(r.force.x, r.force.y, r.force.z); }},
         {"direction_deg", "deg", "of the force in the x-z plane, from z towards x; empty without force",
          direction_of}},
        samples.shown));
    for (const auto& [over, x] :
         {std::pair("time", study::FigureAxis{"t_s", "time / s"}), {"place", {"x_mm", "x / mm"}}})
        for (const auto& [what, y] : {std::pair("Force", study::FigureAxis{"force_N", "force / N"}),
                                      {"Direction", {"direction_deg", "direction / deg, from z towards x"}},
                                      {"Position", {"z_mm", "z / mm"}}}) {
            data.figures.push_back(study::make_figure(fmt::format("{}-{}", y.column, over),
                                                      fmt::format("{} over {}", what, over), "",
                                                      study::FigureKind::scatter, "samples", {}, x, y, "path"));
            data.figures.back().joined = true;
        }
}

std::string run_page(const std::string& title, const std::vector<std::pair<std::string, std::string>>& terms,
                     const study::StudyData& data) {
    std::string notes;
    for (const std::string& note : data.notes)
        notes += fmt::format("<p class=\"note\">{}</p>\n", escaped(note));
    return page(title,
                fmt::format("<header>\n<h1>{}</h1>\n</header>\n<main>\n<section>\n{}{}<div class=\"figures\">"
                            "<div id=\"run-hero\"></div></div>\n<div class=\"figures\" id=\"run-figures\"></div>\n"
                            "<div id=\"run-tables\"></div>\n{}</section>\n</main>\n",
                            escaped(title), facts(terms), notes, page_data("run", data)),
                page_script(false));
}

} // namespace forceshade::report

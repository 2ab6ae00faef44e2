// The page of a run.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/paths/path_reader.h"
#include "host/report/report.h"
#include "host/report/sections.h"

namespace forceshade::report {
namespace {

constexpr std::size_t kMostShown = 2000;   // samples of a run that are drawn one by one
constexpr std::size_t kMostRead = 200'000; // that bands are of
constexpr std::uint64_t kMostPathsShown = 4, kMostPathsRead = 1000;
constexpr std::size_t kLeastOfBand = 5; // paths, and samples of a bin
constexpr std::size_t kBins = 100;

struct RunSample {
    std::uint64_t path; // its number in the file
    double time;        /* s, NaN where it is not known */
    glm::dvec3 at, force;
};

struct RunSamples {
    std::map<std::uint64_t, std::string> paths; /* names of those that are shown */
    std::vector<RunSample> shown;               /* of a few paths, evenly chosen */
    std::vector<RunSample> all;                 /* of all paths, more thinly */
    std::uint64_t paths_in_file = 0;
    bool timed = true;     // else a sample has its number along the path in place of its time
    std::size_t every = 1; /* of the file's samples of a path, every which one is shown */
};

// Keeps every second one.
void halve(std::vector<RunSample>& samples) {
    for (std::size_t i = 1; 2 * i < samples.size(); ++i)
        samples[i] = samples[2 * i];
    samples.resize((samples.size() + 1) / 2);
}

// Every which path is shown.
std::uint64_t path_stride(std::uint64_t paths) {
    return (paths + kMostPathsShown - 1) / kMostPathsShown;
}

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
    std::unordered_map<std::string, std::uint64_t> numbers;
    std::string name; // of the row's path
    std::uint64_t number = 0;
    for (std::size_t row = 0; csv.next(); ++row) {
        if (csv.size() <= *std::ranges::max_element(cells))
            continue;
        if (numbers.empty() || csv.text(cells[0]) != name) {
            name = csv.text(cells[0]);
            number = numbers.try_emplace(name, numbers.size()).first->second;
        }
        if (row % samples.every)
            continue;
        std::array<double, cells.size()> values{};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::string_view text = csv.text(cells[i]);
            values[i] = NAN;
            std::from_chars(text.data(), text.data() + text.size(), values[i]);
        }
        samples.all.push_back(
            {number, values[1], {values[2], values[3], values[4]}, {values[5], values[6], values[7]}});
        if (samples.all.size() == 2 * kMostRead) {
            halve(samples.all);
            samples.every *= 2;
        }
    }
    samples.paths_in_file = numbers.size();
    const std::uint64_t every_path = path_stride(samples.paths_in_file);
    for (const auto& [path, at] : numbers)
        if (at % every_path == 0)
            samples.paths[at] = "path " + path;
    std::ranges::copy_if(samples.all, std::back_inserter(samples.shown),
                         [&](const RunSample& sample) { return sample.path % every_path == 0; });
    for (; samples.shown.size() >= 2 * kMostShown; samples.every *= 2)
        halve(samples.shown);
    return samples;
}

RunSamples samples_of_exr(const std::filesystem::path& file) {
    RunSamples samples;
    const auto read = [&](std::uint64_t most_paths, std::size_t most, std::vector<RunSample>& into) {
        const PathSamples found = read_paths(file, most_paths, most / most_paths);
        const double period = path_period(found.scene); /* s */
        samples.timed = period > 0;
        samples.paths_in_file = found.paths_in_file;
        samples.every = found.every_step;
        for (std::size_t i = 0; i < found.paths * found.steps; ++i) {
            const float *at = &found.position[3 * i], *force = &found.force[3 * i];
            const std::uint64_t path = i / found.steps * found.every_path;
            samples.paths[path] = fmt::format("path {}", path);
            if (std::isfinite(at[0]))
                into.push_back({path,
                                double(i % found.steps * found.every_step) * (samples.timed ? period : 1),
                                found.origin + glm::dvec3(at[0], at[1], at[2]),
                                {force[0], force[1], force[2]}});
        }
    };
    read(kMostPathsRead, kMostRead, samples.all);
    read(kMostPathsShown, kMostShown, samples.shown);
    return samples;
}

// deg: from z towards x.
double direction_of(const RunSample& sample) {
    const glm::dvec3& force = sample.force;
    return force.x == 0 && force.z == 0 ? NAN : std::atan2(force.x, force.z) * 180 / std::numbers::pi;
}

double force_of(const RunSample& sample) {
    return std::hypot(sample.force.x, sample.force.y, sample.force.z);
}

// A number of a sample over which it is shown, or that is shown.
struct Shown {
    const char *name, *label, *column, *unit;
    double (*value)(const RunSample& sample);
};
constexpr Shown kOver[] = {{"time", "time / s", "t_s", "s", [](const RunSample& r) { return r.time; }},
                           {"place", "x / mm", "x_mm", "mm", [](const RunSample& r) { return 1e3 * r.at.x; }}};
// Of recorded paths in a file that has not their times.
constexpr Shown kNumber{"sample", "sample", "sample", "1", [](const RunSample& r) { return r.time; }};
constexpr Shown kValues[] = {{"Force", "force / N", "force_N", "N", force_of},
                             {"Direction", "direction / deg, from z towards x", "direction_deg", "deg", direction_of},
                             {"Position", "z / mm", "z_mm", "mm", [](const RunSample& r) { return 1e3 * r.at.z; }}};

// Median and 5th and 95th percentile of all samples in each of kBins equal parts of `over`; no rows if it has no width.
study::Table bands_of(const std::vector<RunSample>& samples, const Shown& over) {
    study::Table table{fmt::format("over_{}", over.name), fmt::format("All paths over {}", over.name), {}, {}};
    table.columns = {{over.column, over.unit, "middle of a part of the axis"},
                     {"samples", "1", "in this part, of all paths; where they are few the rest is empty"}};
    for (const Shown& value : kValues)
        for (const auto& [end, meaning] :
             {std::pair("p05_", "5th percentile of these"), {"median_", "their median"}, {"p95_", "95th percentile"}})
            table.columns.push_back({std::string(end) + value.column, value.unit, meaning});
    double low = INFINITY, high = -INFINITY;
    for (const RunSample& sample : samples) {
        low = std::fmin(low, over.value(sample));
        high = std::fmax(high, over.value(sample));
    }
    if (!(low < high))
        return table;
    std::vector<std::vector<const RunSample*>> bins(kBins);
    for (const RunSample& sample : samples)
        if (const double share = (over.value(sample) - low) / (high - low); share >= 0)
            bins[std::min(kBins - 1, static_cast<std::size_t>(share * double(kBins)))].push_back(&sample);
    for (std::size_t i = 0; i < kBins; ++i) {
        std::vector<study::Cell>& row = table.rows.emplace_back(
            std::vector<study::Cell>{low + (double(i) + 0.5) / double(kBins) * (high - low), bins[i].size()});
        for (const Shown& shown : kValues) {
            std::vector<double> values;
            for (const RunSample* sample : bins[i])
                if (const double value = shown.value(*sample); std::isfinite(value))
                    values.push_back(value);
            std::ranges::sort(values);
            for (const double share : {0.05, 0.5, 0.95})
                row.push_back(values.size() < kLeastOfBand ? study::Cell() : study::quantile(values, share));
        }
    }
    return table;
}

} // namespace

void add_samples(study::StudyData& data, const std::filesystem::path& file) {
    const RunSamples samples = file.extension() == ".exr" ? samples_of_exr(file) : samples_of_csv(file);
    const std::uint64_t paths = samples.paths_in_file, every_path = path_stride(paths);
    if (every_path > 1)
        data.notes.push_back(
            fmt::format("{} of {} paths are drawn one by one, with one of {} of their samples; {} has all.",
                        (paths + every_path - 1) / every_path, paths, samples.every, file.filename().string()));
    else if (samples.every > 1)
        data.notes.push_back(
            fmt::format("One of {} samples is shown; {} has all.", samples.every, file.filename().string()));
    const Shown& first = samples.timed ? kOver[0] : kNumber;
    using R = RunSample;
    std::vector<study::ColumnOf<R>> columns{
        {{"path", "", "as in the file"}, [&](const R& r) { return samples.paths.at(r.path); }},
        {{first.column, first.unit, samples.timed ? "since the path began" : "number along the path"}, first.value},
        {{"x_mm", "mm", "of the probe"}, kOver[1].value},
        {{"y_mm", "mm", "of the probe"}, [](const R& r) { return 1e3 * r.at.y; }},
        {{"z_mm", "mm", "of the probe"}, kValues[2].value},
        {{"force_N", "N", "of the law"}, kValues[0].value},
        {{"direction_deg", "deg", "of the force in the x-z plane, from z towards x; empty without force"},
         kValues[1].value}};
    data.tables.push_back(study::table_of<R>("samples", "Samples", columns, samples.shown));
    for (const Shown& over : {first, kOver[1]}) {
        if (paths >= kLeastOfBand)
            data.tables.push_back(bands_of(samples.all, over));
        for (const Shown& value : kValues) {
            study::Figure figure = study::make_figure(
                fmt::format("{}-{}", value.column, over.name), fmt::format("{} over {}", value.name, over.name), "",
                study::FigureKind::scatter, "samples", {}, {over.column, over.label}, {value.column, value.label},
                "path", "", {.joined = true});
            if (paths >= kLeastOfBand) {
                const std::string column = value.column;
                figure.curves.push_back({data.tables.back().name,
                                         {},
                                         over.column,
                                         "median_" + column,
                                         fmt::format("median of {} paths, and 5 to 95 %", paths),
                                         false,
                                         "p05_" + column,
                                         "p95_" + column});
            }
            data.figures.push_back(std::move(figure));
        }
    }
}

std::string run_page(const std::string& title, const std::vector<std::pair<std::string, std::string>>& terms,
                     const study::StudyData& data) {
    std::string notes;
    for (const std::string& note : data.notes)
        notes += fmt::format("<p class=\"note\">{}</p>\n", escaped(note));
    return page(title,
                fmt::format("<header>\n<h1>{}</h1>\n</header>\n<main>\n<section>\n{}{}<div class=\"figures\"><div "
                            "id=\"run-hero\"></div></div>\n<div class=\"figures\" id=\"run-figures\"></div>\n"
                            "<div id=\"run-tables\"></div>\n{}</section>\n</main>\n",
                            escaped(title), facts(terms), notes, page_data("run", data)),
                page_script(false));
}

} // namespace forceshade::report

// A sweep: its cases, their errors and times, what was left out, the files.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "host/output/files.h"
#include "host/report/sections.h"
#include "host/report/tables.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kMostCases = 3000;

// At most so many, as a page of more would not open.
std::vector<const CaseRecord*> listed(const Sweep& sweep, bool (*wanted)(const CaseRecord&)) {
    std::vector<const CaseRecord*> cases;
    for (const CaseRecord& one : sweep.cases)
        if (wanted(one) && cases.size() < kMostCases)
            cases.push_back(&one);
    return cases;
}

bool has_field(const CaseRecord& record) {
    return record.voxels > 0;
}
bool has_paths(const CaseRecord& record) {
    return record.paths.has_value();
}
bool any_case(const CaseRecord&) {
    return true;
}

std::string case_markup(const CaseRecord& record) {
    return escaped(record.name);
}

std::string milliseconds(double seconds) {
    return number_text(1e3 * seconds, 3);
}

// Keys that vary within the sweep, in the order in which they come.
std::vector<std::string> varied_keys(const Sweep& sweep) {
    std::vector<std::string> keys;
    for (const CaseRecord& record : sweep.cases)
        for (const auto& [key, value] : record.parameters)
            if (std::ranges::find(keys, key) == keys.end())
                keys.push_back(key);
    return keys;
}

std::string cases_table(const Sweep& sweep) {
    const std::vector<std::string> keys = varied_keys(sweep);
    std::vector<HtmlColumn> columns{{"case", "", "", false}};
    for (const std::string& key : keys)
        columns.push_back({key, "", "", false});
    for (const HtmlColumn& column :
         {HtmlColumn{"precision", "", "", false}, HtmlColumn{"voxels", "", "of the grid", true},
          HtmlColumn{"evaluated", "", "voxels that had to be computed", true},
          HtmlColumn{"largest force", "N", "", true},
          HtmlColumn{"largest error", "N", "against the oracle in double precision", true},
          HtmlColumn{"relative error", "", "of the largest force", true},
          HtmlColumn{"differing", "", "voxels whose bits are not the oracle's in the same precision", true},
          HtmlColumn{"beyond bound", "", "voxels further from the oracle than rounding allows", true}})
        columns.push_back(column);
    Rows rows;
    for (const CaseRecord* record : listed(sweep, has_field)) {
        std::vector<std::string> row{case_markup(*record)};
        for (const std::string& key : keys) {
            const auto found = std::ranges::find(record->parameters, key,
                                                 [](const auto& one) -> const std::string& { return one.first; });
            row.push_back(found == record->parameters.end() ? "" : escaped(found->second));
        }
        row.insert(row.end(), {escaped(record->precision), count_text(record->voxels), count_text(record->evaluated),
                               number_text(record->largest_force, 4), number_text(record->error.largest, 2),
                               number_text(record->error.relative(), 2), count_text(record->error.differing),
                               count_text(record->error.beyond)});
        rows.push_back(std::move(row));
    }
    return rows.empty() ? "" : html_table(columns, rows, "Cases");
}

std::string times_table(const Sweep& sweep) {
    std::vector<HtmlColumn> columns{{"case", "", "", false}};
    for (const auto& [name, meaning] :
         std::vector<std::pair<const char*, const char*>>{{"plan", "which voxels are visited"},
                                                          {"compile", "the kernel"},
                                                          {"upload", ""},
                                                          {"kernel", ""},
                                                          {"read back", "from the device"},
                                                          {"encode", "the volume"},
                                                          {"flush", "to disk"},
                                                          {"verify", "reading the volume back"},
                                                          {"hash", ""},
                                                          {"check", "against the oracle"}})
        columns.push_back({name, "ms", meaning, true});
    Rows rows;
    for (const CaseRecord* record : listed(sweep, has_field)) {
        const EngineTimes& engine = record->engine_times;
        const VolumeTimings& files = record->volume_times;
        rows.push_back({case_markup(*record)});
        for (const double seconds : {engine.plan, engine.compile, engine.upload, engine.kernel, engine.read_back,
                                     files.encode, files.flush, files.read_back, files.hash, files.check})
            rows.back().push_back(milliseconds(seconds));
    }
    return rows.empty() ? "" : folded("Time by stage", html_table(columns, rows, "Time by stage"));
}

std::string paths_table(const Sweep& sweep) {
    const std::vector<HtmlColumn> columns{{"case", "", "", false},
                                          {"paths", "", "", true},
                                          {"samples", "", "", true},
                                          {"in contact", "%", "of the samples", true},
                                          {"unstable", "", "paths that left their bound", true},
                                          {"largest force", "N", "", true},
                                          {"work", "J", "on the hand, sum over the paths", true},
                                          {"mean depth", "mm", "in contact", true},
                                          {"compared", "", "samples compared with the oracle", true},
                                          {"differing", "", "samples whose bits are not the oracle's", true},
                                          {"kernel", "ms", "", true}};
    Rows rows;
    for (const CaseRecord* record : listed(sweep, has_paths)) {
        const PathRecord& paths = *record->paths;
        const double share = paths.samples ? double(paths.in_contact) / double(paths.samples) : 0;
        rows.push_back({case_markup(*record), count_text(paths.paths), count_text(paths.samples),
                        number_text(100 * share, 3), count_text(paths.unstable), number_text(paths.largest_force, 4),
                        number_text(paths.work, 3), number_text(1e3 * paths.mean_depth, 3),
                        count_text(paths.error.samples), count_text(paths.error.differing),
                        milliseconds(paths.engine_times.kernel)});
    }
    return rows.empty() ? "" : "<h3>Paths</h3>\n" + html_table(columns, rows, "Paths");
}

// Cases with the same list together, lists in the order in which they come.
std::string left_out(const Sweep& sweep) {
    std::vector<std::pair<std::string, std::vector<std::string>>> groups;
    for (const CaseRecord* record : listed(sweep, any_case)) {
        const std::string list = fmt::format("{}", fmt::join(record->omitted, ", "));
        auto found = std::ranges::find(groups, list, [](const auto& one) -> const std::string& { return one.first; });
        if (found == groups.end())
            found = groups.insert(groups.end(), {list, {}});
        found->second.push_back(record->name);
    }
    std::string html = "<dl class=\"meanings\">\n";
    for (const auto& [list, names] : groups)
        html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", list.empty() ? "nothing" : escaped(list),
                            names.size() == sweep.cases.size() ? "all cases"
                                                               : escaped(fmt::format("{}", fmt::join(names, ", "))));
    return folded("What was left out, as no scene needed it", html + "</dl>\n");
}

std::string files_table(const std::filesystem::path& root, const Sweep& sweep) {
    const std::vector<HtmlColumn> columns{{"file", "", "", false}, {"size", "", "", true}, {"SHA-256", "", "", false}};
    Rows rows;
    for (const CaseRecord* record : listed(sweep, any_case))
        for (const FileRecord& file : record->files) {
            std::error_code ignored;
            const std::string path = below(sweep.folder, file.name);
            const bool there = is_plain_name(file.name) && std::filesystem::is_regular_file(root / path, ignored);
            rows.push_back({there ? link(path, file.name) : escaped(file.name) + " (missing)", size_text(file.bytes),
                            "<code>" + escaped(file.sha256.substr(0, 16)) + "…</code>"});
        }
    std::string links;
    for (const char* name : {"manifest.json", "summary.csv", "study.toml"}) {
        std::error_code ignored;
        if (std::filesystem::is_regular_file(root / below(sweep.folder, name), ignored))
            links += "<li>" + link(below(sweep.folder, name), name) + "</li>\n";
    }
    return "<h3>Files</h3>\n<ul class=\"files\">\n" + links + "</ul>\n" +
           folded(fmt::format("Volumes and pictures <small>{} files</small>", rows.size()),
                  html_table(columns, rows, "Files"));
}

} // namespace

std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep) {
    std::string html = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}", anchor(sweep), escaped(title(sweep)),
                                   sweep.findings.empty() ? "" : findings_list(anchor(sweep), sweep.findings));
    html += facts({{"Program", sweep.program.empty() ? "" : "forceshade " + sweep.program},
                   {"Device", sweep.device},
                   {"Driver", sweep.driver},
                   {"Processor", sweep.cores ? fmt::format("{}, {} cores", sweep.cpu, sweep.cores) : sweep.cpu},
                   {"Cases", sweep.cases.size() == sweep.cases_of_study
                                 ? fmt::format("all {}", sweep.cases_of_study)
                                 : fmt::format("{} of {}; the same sweep without --only computes the rest",
                                               sweep.cases.size(), sweep.cases_of_study)},
                   {"Last run", sweep.seconds > 0 ? duration_text(sweep.seconds) : ""}});
    if (sweep.cases.empty())
        return html + "<p>There is no case here that this program can read.</p>\n</section>\n";
    html += "<h3>Cases</h3>\n";
    if (sweep.cases.size() > kMostCases)
        html += fmt::format("<p>The tables show the first {} of {} cases; summary.csv has all.</p>\n",
                            count_text(kMostCases), count_text(sweep.cases.size()));
    return html + cases_table(sweep) + paths_table(sweep) + times_table(sweep) + left_out(sweep) +
           files_table(root, sweep) + "</section>\n";
}

} // namespace forceshade::report

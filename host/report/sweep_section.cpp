// A sweep: the facts of its manifest, its cases, their errors and times, what was left out, the files.
#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

std::vector<const CaseRecord*> with_field(const Sweep& sweep) {
    std::vector<const CaseRecord*> cases;
    for (const CaseRecord& record : sweep.cases)
        if (record.voxels > 0)
            cases.push_back(&record);
    return cases;
}

std::string agreement(const std::vector<const CaseRecord*>& cases) {
    std::uint64_t compared = 0, differing = 0, beyond = 0;
    for (const CaseRecord* one : cases) {
        compared += one->error.compared;
        differing += one->error.differing;
        beyond += one->error.beyond;
    }
    std::string text =
        fmt::format("Of {} voxels compared with the CPU oracle in the same precision, ", count_text(compared));
    if (compared == 0)
        return "No voxel was compared with the CPU oracle.";
    if (differing == 0)
        return cases.front()->engine.engine == "cpu" ? "" : text + "all are equal bit for bit.";
    text += fmt::format("{} differ{}", count_text(differing), differing == 1 ? "s" : "");
    return text + (beyond == 0 ? ", none by more than rounding allows."
                               : fmt::format(", {} of them by more than rounding allows: those volumes are not to be "
                                             "trusted.",
                                             count_text(beyond)));
}

std::string error(const std::vector<const CaseRecord*>& cases) {
    const CaseRecord& worst =
        **std::ranges::max_element(cases, {}, [](const CaseRecord* one) { return one->error.relative(); });
    if (worst.error.relative() == 0)
        return "No force differs from the oracle in double precision.";
    return fmt::format("The largest error against the oracle in double precision is {} of the case's largest force "
                       "({} N), in {}.",
                       number_text(worst.error.relative(), 2), number_text(worst.error.largest, 2), worst.name);
}

std::string force(const std::vector<const CaseRecord*>& cases) {
    const auto largest = [](const CaseRecord* one) { return one->largest_force; };
    const CaseRecord &most = **std::ranges::max_element(cases, {}, largest),
                     &least = **std::ranges::min_element(cases, {}, largest);
    if (most.largest_force == least.largest_force)
        return fmt::format("The largest force is {} N in every case.", number_text(most.largest_force, 3));
    return fmt::format("The largest force is {} N, in {}; the case whose largest is least, {}, reaches {} N.",
                       number_text(most.largest_force, 3), most.name, least.name, number_text(least.largest_force, 3));
}

std::string cost(const std::vector<const CaseRecord*>& cases) {
    const auto kernel = [](const CaseRecord* one) { return one->engine_times.kernel; };
    const CaseRecord &dearest = **std::ranges::max_element(cases, {}, kernel),
                     &cheapest = **std::ranges::min_element(cases, {}, kernel);
    if (kernel(&dearest) <= 0)
        return "";
    std::string text =
        fmt::format("The dearest case took {} ms to compute, {}", number_text(1e3 * kernel(&dearest), 3), dearest.name);
    if (cases.size() > 1 && kernel(&cheapest) > 0)
        text += fmt::format("; that is {} times the cheapest, {}", number_text(kernel(&dearest) / kernel(&cheapest), 2),
                            cheapest.name);
    return text + ".";
}

std::string left_out(const std::vector<const CaseRecord*>& cases) {
    std::uint64_t voxels = 0, evaluated = 0;
    for (const CaseRecord* one : cases) {
        voxels += one->voxels;
        evaluated += one->evaluated;
    }
    if (evaluated >= voxels)
        return "";
    return fmt::format("Only {} of {} voxels had to be evaluated ({} %); the others are copies or free space.",
                       count_text(evaluated), count_text(voxels),
                       number_text(100 * static_cast<double>(evaluated) / static_cast<double>(voxels), 2));
}

std::string paths(const Sweep& sweep) {
    std::uint64_t count = 0, unstable = 0, samples = 0;
    for (const CaseRecord& one : sweep.cases)
        if (one.paths) {
            count += one.paths->paths;
            unstable += one.paths->unstable;
            samples += one.paths->samples;
        }
    if (count == 0)
        return "";
    return fmt::format("{} paths with {} samples were followed; {} left {} bound.", count_text(count),
                       count_text(samples), unstable == 0 ? "none" : count_text(unstable),
                       unstable == 1 ? "its" : "their");
}
using Rows = std::vector<const CaseRecord*>;
using Columns = std::vector<study::ColumnOf<const CaseRecord*>>;
using R = const CaseRecord*;

constexpr std::size_t kMostCases = 3000; // a page of more would not open

study::Table cases_table(const Sweep& sweep, const Rows& rows) {
    Columns columns{{"case", "", "", &CaseRecord::name}};
    std::vector<std::string> keys; // that vary within the sweep, in the order in which they come
    for (const CaseRecord& record : sweep.cases)
        for (const auto& [key, value] : record.parameters)
            if (std::ranges::find(keys, key) == keys.end())
                keys.push_back(key);
    for (const std::string& key : keys)
        columns.push_back({{key, "", ""}, [key](R r) {
                               for (const auto& [name, value] : r->parameters)
                                   if (name == key)
                                       return study::Cell(value);
                               return study::Cell();
                           }});
    columns.insert(
        columns.end(),
        {{"precision", "", "", &CaseRecord::precision},
         {"voxels", "1", "of the grid", &CaseRecord::voxels},
         {"evaluated", "1", "voxels that had to be computed", &CaseRecord::evaluated},
         {"largest force", "N", "", &CaseRecord::largest_force},
         {"largest error", "N", "against the oracle in double precision", [](R r) { return r->error.largest; }},
         {"relative error", "1", "of the largest force", [](R r) { return r->error.relative(); }},
         {"differing", "1", "voxels whose bits are not the oracle's in the same precision",
          [](R r) { return r->error.differing; }},
         {"beyond bound", "1", "voxels further from the oracle than rounding allows",
          [](R r) { return r->error.beyond; }}});
    return study::table_of("cases", "Cases", columns, rows);
}

study::Table times_table(const Rows& rows) {
    Columns columns{{"case", "", "", &CaseRecord::name}};
    const auto add = [&](const char* name, const char* meaning, auto times, auto stage) {
        columns.push_back({{name, "ms", meaning}, [=](R r) { return 1e3 * r->*times.*stage; }});
    };
    const auto engine = &CaseRecord::engine_times;
    const auto files = &CaseRecord::volume_times;
    add("prepare", "images and meshes", engine, &EngineTimes::prepare);
    add("plan", "which voxels are visited", engine, &EngineTimes::plan);
    add("compile", "the kernel", engine, &EngineTimes::compile);
    add("upload", "", engine, &EngineTimes::upload);
    add("kernel", "", engine, &EngineTimes::kernel);
    add("read back", "from the device", engine, &EngineTimes::read_back);
    add("encode", "the volume", files, &VolumeTimings::encode);
    add("flush", "to disk", files, &VolumeTimings::flush);
    add("verify", "reading the volume back", files, &VolumeTimings::read_back);
    add("hash", "", files, &VolumeTimings::hash);
    add("check", "against the oracle", files, &VolumeTimings::check);
    return study::table_of("times", "Time by stage", columns, rows);
}

study::Table paths_table(const Rows& rows) {
    return study::table_of<R>(
        "paths", "Paths",
        {{"case", "", "", &CaseRecord::name},
         {"paths", "1", "", [](R r) { return r->paths->paths; }},
         {"samples", "1", "", [](R r) { return r->paths->samples; }},
         {"in contact", "%", "of the samples",
          [](R r) { return 100 * double(r->paths->in_contact) / std::max(1.0, double(r->paths->samples)); }},
         {"unstable", "1", "paths that left their bound", [](R r) { return r->paths->unstable; }},
         {"largest force", "N", "", [](R r) { return r->paths->largest_force; }},
         {"work", "J", "on the hand, sum over the paths", [](R r) { return r->paths->work; }},
         {"mean depth", "mm", "in contact", [](R r) { return 1e3 * r->paths->mean_depth; }},
         {"compared", "1", "samples compared with the oracle", [](R r) { return r->paths->error.samples; }},
         {"differing", "1", "samples whose bits are not the oracle's", [](R r) { return r->paths->error.differing; }},
         {"kernel", "ms", "", [](R r) { return 1e3 * r->paths->engine_times.kernel; }}},
        rows);
}

// What the page draws of it.
study::StudyData tables_of(const Sweep& sweep) {
    Rows fields, paths;
    for (const CaseRecord& record : sweep.cases)
        for (const auto& [rows, has] : {std::pair(&fields, record.voxels > 0), {&paths, record.paths.has_value()}})
            if (has && rows->size() < kMostCases)
                rows->push_back(&record);
    study::StudyData data;
    add_touch_figures(sweep, data);
    if (!fields.empty()) {
        data.tables.push_back(cases_table(sweep, fields));
        data.tables.push_back(times_table(fields));
    }
    if (!paths.empty())
        data.tables.push_back(paths_table(paths));
    return data;
}

// Cases with the same list together, lists in the order in which they come.
std::string omitted_list(const Sweep& sweep) {
    struct Group {
        std::string list, names;
        std::size_t cases = 0;
    };
    std::vector<Group> groups;
    for (std::size_t i = 0; i < sweep.cases.size(); ++i) {
        const std::string list = fmt::format("{}", fmt::join(sweep.cases[i].omitted, ", "));
        auto found = std::ranges::find(groups, list, &Group::list);
        if (found == groups.end())
            found = groups.insert(groups.end(), {list, ""});
        found->names += (found->cases++ == 0 ? "" : ", ") + sweep.cases[i].name;
    }
    std::string html = "<dl class=\"meanings\">\n";
    for (const Group& group : groups) {
        const std::string cases = group.cases == sweep.cases.size() ? "all cases"
                                  : sweep.cases.size() > kMostCases ? count_text(group.cases) + " cases"
                                                                    : escaped(group.names);
        html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", group.list.empty() ? "nothing" : escaped(group.list), cases);
    }
    return folded("What was left out, as no scene needed it", html + "</dl>\n");
}

} // namespace

std::vector<study::Finding> sweep_findings(const Sweep& sweep) {
    std::vector<study::Finding> findings;
    const auto add = [&](const char* name, const std::string& text) {
        if (!text.empty())
            findings.push_back({name, text});
    };
    add("touch", touch_finding(sweep));
    if (const std::vector<const CaseRecord*> cases = with_field(sweep); !cases.empty()) {
        add("agreement", agreement(cases));
        add("largest_error", error(cases));
        add("largest_force", force(cases));
        add("dearest_case", cost(cases));
        add("evaluated", left_out(cases));
    }
    add("paths", paths(sweep));
    return findings;
}

std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep) {
    const std::string id = anchor(sweep);
    std::string html =
        fmt::format("<section id=\"{0}\">\n<h2>{1}</h2>\n<div class=\"answer\"><div>{2}</div>"
                    "<div id=\"{0}-data-hero\"></div></div>\n<div class=\"figures\" "
                    "id=\"{0}-data-figures\"></div>\n",
                    id, escaped(title(sweep)), sweep.findings.empty() ? "" : findings_list(id, sweep.findings));
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
        return html + "<p>This folder has no case that this program can read.</p>\n</section>\n";
    if (sweep.cases.size() > kMostCases)
        html += fmt::format("<p>Tables and files are those of the first {} of {} cases; summary.csv has all.</p>\n",
                            count_text(kMostCases), count_text(sweep.cases.size()));
    std::string files;
    for (const char* name : {"manifest.json", "summary.csv", "study.toml"})
        files += file_link(root, sweep.folder, name);
    for (const CaseRecord& record : std::span(sweep.cases).first(std::min(sweep.cases.size(), kMostCases)))
        for (const FileRecord& file : record.files)
            files += file_link(root, sweep.folder, file.name, fmt::format(" <small>{}</small>", size_text(file.bytes)));
    return html + fmt::format("<div id=\"{}-data-tables\"></div>\n", id) + omitted_list(sweep) +
           folded("Files", "<ul class=\"files\">\n" + files + "</ul>\n") + page_data(id + "-data", tables_of(sweep)) +
           "</section>\n";
}

} // namespace forceshade::report

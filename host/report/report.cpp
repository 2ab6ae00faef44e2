#include "host/report/report.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/output/files.h"
#include "host/program.h"
#include "host/report/contents.h"
#include "host/report/page.h"
#include "host/report/sections.h"
#include "host/report/viewer_section.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

// Characters: a page that opens at once and can be sent by mail.
constexpr std::size_t kPageBudget = 2'450'000, kLeastForViewer = 300'000;

std::string entry(const std::string& id, const std::string& text) {
    return fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id, escaped(text));
}

std::string contents_list(const Contents& contents, bool viewer) {
    std::string html;
    if (!contents.troubles.empty())
        html += entry("troubles", "What is missing or damaged");
    for (const StudyPart& part : contents.studies)
        html += entry(anchor(part), title(part));
    if (viewer)
        html += entry("viewer", "Viewer");
    if (!contents.studies.empty() || !contents.sweeps.empty())
        html += entry("device", "My device");
    for (const Sweep& sweep : contents.sweeps)
        html += entry(anchor(sweep), title(sweep));
    return "<nav aria-label=\"Contents\">\n<ul>\n" + html + "</ul>\n</nav>\n";
}

// Of several studies the first finding of each, beside its figure, which the page draws.
std::string glance(const std::vector<StudyPart>& studies) {
    if (studies.size() < 2)
        return "";
    std::string html;
    for (const StudyPart& part : studies)
        if (!part.data.findings.empty())
            html += fmt::format("<div><h3><a href=\"#{0}\">{1}</a></h3><p>{2}</p><figure id=\"{0}-data-glance\" "
                                "data-figure=\"{3}\"></figure></div>\n",
                                anchor(part), escaped(title(part)), escaped(part.data.findings.front().text),
                                escaped(part.data.findings.front().figure));
    if (html.empty())
        return html;
    return "<section id=\"glance\">\n<h2>At a glance</h2>\n<div class=\"figures\">\n" + html + "</div>\n</section>\n";
}

std::string name_of(const std::filesystem::path& folder) {
    const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::string page_of(const std::string& name, const std::filesystem::path& folder, Contents& contents) {
    std::string studies, sweeps;
    for (const StudyPart& part : contents.studies)
        studies += study_section(folder, part);
    for (const Sweep& sweep : contents.sweeps)
        sweeps += sweep_section(folder, sweep);
    const std::size_t taken = studies.size() + sweeps.size() + page_script(true).size();
    const std::size_t room = kPageBudget - std::min(taken, kPageBudget - kLeastForViewer);
    const std::string viewer = viewer_section(folder, contents, contents.troubles, room);
    const std::string nothing = contents.studies.empty() && contents.sweeps.empty()
                                    ? "<p>There is no sweep and no study here that this program can read.</p>\n"
                                    : "";
    // The page fills it in.
    const std::string device = nothing.empty() ? "<section id=\"device\">\n<h2>My device</h2>\n</section>\n" : "";
    const std::string body =
        fmt::format("<header>\n<h1>{}</h1>\n<p>Haptic force fields with and without force shading. Written by "
                    "forceshade {}.</p>\n</header>\n",
                    escaped(name), escaped(version())) +
        contents_list(contents, !viewer.empty()) + "<main>\n" + troubles_section(contents.troubles) + nothing +
        glance(contents.studies) + studies + viewer + device + sweeps + "</main>\n";
    return page(name + " – forceshade", body, page_script(!viewer.empty()));
}

// Somebody else's report.html is left alone.
std::filesystem::path file_for(const std::filesystem::path& folder, Contents& contents) {
    const std::filesystem::path file = folder / "report.html", other = folder / "forceshade-report.html";
    if (!std::filesystem::exists(file) || is_page(file))
        return file;
    contents.troubles.push_back("report.html: it is none of this program's, so the report is forceshade-report.html");
    return other;
}

} // namespace

ReportResult write_report(const std::filesystem::path& folder) {
    Contents contents = read_contents(folder);
    if (contents.sweeps.empty() && contents.studies.empty() && contents.troubles.empty())
        contents.troubles.push_back("The folder holds no manifest.json of a sweep and no study.json of a study.");
    const std::string name = name_of(folder);
    ReportResult result{file_for(folder, contents), 0, {}};
    write_file_atomically(result.file, page_of(name, folder, contents));
    for (const StudyPart& part : contents.studies)
        result.findings += part.data.findings.size();
    for (const Sweep& sweep : contents.sweeps)
        result.findings += sweep.findings.size();
    result.troubles = contents.troubles;
    return result;
}

} // namespace forceshade::report

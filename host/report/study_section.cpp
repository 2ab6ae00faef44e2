// A study: what it was run on, its figures, tables and files.
#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/plot/plot.h"
#include "host/plot/xml_text.h"
#include "host/report/sections.h"
#include "host/report/tables.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

using plot::escaped;

bool is_there(const std::filesystem::path& root, const std::string& name) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(root / name, ignored);
}

// A link to a file of the study, if it is there: its absence is told already.
std::string file_link(const std::filesystem::path& root, const StudyPart& part, const std::string& name,
                      const std::string& remark = "") {
    const std::string path = below(part.folder, name);
    return is_plain_name(name) && is_there(root, path) ? "<li>" + link(path, name) + remark + "</li>\n" : "";
}

std::string run_facts(const study::StudyData& data) {
    return facts({{"Program", "forceshade " + data.program},
                  {"Engine", data.engine},
                  {"Device", data.device + (data.software ? " (software)" : "")},
                  {"Driver", data.driver},
                  {"Processor", data.cores ? fmt::format("{}, {} cores", data.cpu, data.cores) : data.cpu},
                  {"Form", data.quick ? "quick: coarse, to see that it works" : "full"},
                  {"Scene", data.scene.empty() ? "the study's own" : "the user's, below"},
                  {"Time", duration_text(data.seconds)}});
}

std::string figure_markup(const study::Figure& figure, const StudyPart& part, const std::filesystem::path& root) {
    const auto named = [&](const std::string& file) {
        const std::string path = below(part.folder, file);
        return is_plain_name(file) && is_there(root, path) ? link(path, file) : escaped(file);
    };
    return fmt::format("<figure>\n{}<figcaption>{} <small>Numbers: {}, picture: {}</small></figcaption>\n</figure>\n",
                       plot::svg_of(figure, part.data, false), escaped(figure.caption), named(figure.table + ".csv"),
                       named(figure.name + ".svg"));
}

std::string figures(const std::filesystem::path& root, const StudyPart& part, std::vector<std::string>& troubles) {
    std::string html;
    for (const study::Figure& figure : part.data.figures)
        try {
            html += figure_markup(figure, part, root);
        } catch (const Error& error) {
            troubles.push_back(fmt::format("{}: the figure {} cannot be drawn: {}", below(part.folder, "study.json"),
                                           figure.name, error.what()));
        }
    return html.empty() ? html : "<div class=\"figures\">\n" + html + "</div>\n";
}

std::string files(const std::filesystem::path& root, const StudyPart& part) {
    std::string html = file_link(root, part, "study.json");
    for (const FileRecord& file : part.data.files)
        html += file_link(root, part, file.name);
    for (const FileRecord& file : part.data.volumes)
        html += file_link(root, part, file.name, fmt::format(" <small>volume, {}</small>", size_text(file.bytes)));
    return "<h3>Files</h3>\n<ul class=\"files\">\n" + html + "</ul>\n";
}

} // namespace

std::string study_section(const std::filesystem::path& root, const StudyPart& part, std::vector<std::string>& troubles,
                          std::size_t most_rows) {
    const study::StudyData& data = part.data;
    std::string html =
        fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}", anchor(part), escaped(title(part)), run_facts(data));
    for (const std::string& note : data.notes)
        html += fmt::format("<p class=\"note\">{}</p>\n", escaped(note));
    html += figures(root, part, troubles);
    if (data.tables.empty())
        html += "<p>This study holds no table.</p>\n";
    else
        html += "<h3>Tables</h3>\n";
    for (const study::Table& table : data.tables)
        html += study_table(table, most_rows);
    if (!data.scene.empty())
        html += folded("The scene", "<pre>" + escaped(data.scene) + "</pre>\n");
    return html + files(root, part) + "</section>\n";
}

} // namespace forceshade::report

// A study: what it was run on, its figures, tables and files.
#include <fmt/format.h>

#include "host/error.h"
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

// A link to a file of the study; one that should be there and is not, is told.
std::string file_link(const std::filesystem::path& root, const StudyPart& part, const std::string& name,
                      std::vector<std::string>& troubles) {
    const std::string path = below(part.folder, name);
    if (is_plain_name(name) && is_there(root, path))
        return "<li>" + link(path, name) + "</li>\n";
    if (is_plain_name(name))
        troubles.push_back(path + ": it is missing");
    return "";
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
    const std::string file = below(part.folder, figure.name + ".svg");
    std::string links = fmt::format("Table: {}.csv", escaped(figure.table));
    if (is_plain_name(figure.table))
        links = "Numbers: " + link(below(part.folder, figure.table + ".csv"), figure.table + ".csv");
    if (is_plain_name(figure.name) && is_there(root, file))
        links += ", picture: " + link(file, figure.name + ".svg");
    return fmt::format("<figure>\n{}<figcaption>{} <small>{}</small></figcaption>\n</figure>\n",
                       plot::svg_of(figure, part.data, false), escaped(figure.caption), links);
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

std::string files(const std::filesystem::path& root, const StudyPart& part, std::vector<std::string>& troubles) {
    std::string html = file_link(root, part, "study.json", troubles);
    for (const study::Table& table : part.data.tables)
        html += file_link(root, part, table.name + ".csv", troubles);
    for (const FileRecord& file : part.data.volumes) // their absence is told already
        if (is_plain_name(file.name) && is_there(root, below(part.folder, file.name)))
            html += fmt::format("<li>{} <small>volume, {}</small></li>\n",
                                link(below(part.folder, file.name), file.name), size_text(file.bytes));
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
    return html + files(root, part, troubles) + "</section>\n";
}

} // namespace forceshade::report

#include "host/report/tables.h"

#include <fmt/format.h>

#include "host/report/words.h"

namespace forceshade::report {
namespace {} // namespace

std::string html_table(const std::vector<HtmlColumn>& columns, const std::vector<std::vector<std::string>>& rows,
                       const std::string& label) {
    std::string html = fmt::format("<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>"
                                   "<thead><tr>",
                                   escaped(label));
    for (const HtmlColumn& column : columns)
        html += fmt::format("<th scope=\"col\"{}{}>{}{}</th>", column.numbers ? " class=\"n\"" : "",
                            column.meaning.empty() ? "" : fmt::format(" title=\"{}\"", escaped(column.meaning)),
                            escaped(column.name),
                            column.unit.empty() ? "" : fmt::format("<small>{}</small>", escaped(column.unit)));
    html += "</tr></thead><tbody>\n";
    for (const std::vector<std::string>& row : rows) {
        html += "<tr>";
        for (std::size_t i = 0; i < row.size(); ++i)
            html += fmt::format("<td{}>{}</td>", columns[i].numbers ? " class=\"n\"" : "", row[i]);
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string folded(const std::string& heading, const std::string& body) {
    return fmt::format("<details><summary>{}</summary>\n{}</details>\n", heading, body);
}

} // namespace forceshade::report

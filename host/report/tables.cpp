#include "host/report/tables.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/plot/scale.h"
#include "host/plot/xml_text.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

using plot::escaped;

constexpr int kDigits = 5;
constexpr std::size_t kPaperRows = 60; /* of a table on paper, as report.css has it */

std::string cell_markup(const study::Cell& cell) {
    if (const double* number = std::get_if<double>(&cell))
        return plot::number_label(*number, kDigits);
    const std::string* word = std::get_if<std::string>(&cell);
    return word ? escaped(*word) : std::string("–");
}

std::string meanings(const study::Table& table) {
    std::string text;
    for (const study::Column& column : table.columns)
        if (!column.meaning.empty())
            text += fmt::format("<dt>{}</dt><dd>{}</dd>", escaped(column.name), escaped(column.meaning));
    return text.empty() ? text : "<dl class=\"meanings\">" + text + "</dl>\n";
}

} // namespace

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

std::string study_table(const study::Table& table, std::size_t most_rows) {
    std::vector<HtmlColumn> columns;
    for (const study::Column& column : table.columns)
        columns.push_back({column.name, column.unit == "1" ? "" : column.unit, column.meaning, !column.unit.empty()});
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < std::min(table.rows.size(), most_rows); ++i) {
        rows.emplace_back();
        for (const study::Cell& cell : table.rows[i])
            rows.back().push_back(cell_markup(cell));
    }
    std::string body = meanings(table) + html_table(columns, rows, table.title);
    if (rows.size() > kPaperRows)
        body =
            fmt::format("<div class=\"long\">{}</div>\n<p class=\"paper\">On paper these are the first {} of {} rows; "
                        "the CSV file holds all.</p>\n",
                        body, kPaperRows, count_text(table.rows.size()));
    if (table.rows.size() > most_rows)
        body += fmt::format("<p>These are the first {} of {} rows; the CSV file holds all.</p>\n",
                            count_text(most_rows), count_text(table.rows.size()));
    return folded(fmt::format("{} <small>{} row{}</small>", escaped(table.title.empty() ? table.name : table.title),
                              count_text(table.rows.size()), table.rows.size() == 1 ? "" : "s"),
                  body);
}

} // namespace forceshade::report

#include "host/report/sections.h"

#include <fmt/format.h>

#include "host/report/words.h"

namespace forceshade::report {

std::string plain_id(const std::string& name) {
    std::string id;
    for (const char c : name)
        id += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    return id;
}

std::string title(const StudyPart& part) {
    const std::string& name = part.data.study;
    std::string words = name == "error-time" ? "Error against run time"
                        : name == "omission" ? "What leaving out saves"
                                             : name;
    if (words[0] >= 'a' && words[0] <= 'z')
        words[0] -= 'a' - 'A';
    return part.folder.empty() || part.folder == name ? words : words + " (" + part.folder + ")";
}

std::string title(const Sweep& sweep) {
    return sweep.folder.empty() ? "Sweep" : "Sweep " + sweep.folder;
}

std::string anchor(const StudyPart& part) {
    return plain_id("study-" + part.folder + "-" + part.data.study);
}

std::string anchor(const Sweep& sweep) {
    return plain_id("sweep-" + sweep.folder);
}

std::string facts(const std::vector<std::pair<std::string, std::string>>& terms) {
    std::string html = "<dl class=\"facts\">\n";
    for (const auto& [term, what] : terms)
        if (!what.empty())
            html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(term), escaped(what));
    return html + "</dl>\n";
}

std::string troubles_section(const std::vector<std::string>& troubles) {
    if (troubles.empty())
        return "";
    std::string html = "<section id=\"troubles\" class=\"troubles\">\n<h2>What is missing or damaged</h2>\n<ul>\n";
    for (const std::string& trouble : troubles)
        html += fmt::format("<li>{}</li>\n", escaped(trouble));
    return html + "</ul>\n</section>\n";
}

} // namespace forceshade::report

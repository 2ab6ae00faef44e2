// Tables of the page.
#pragma once

#include <string>
#include <vector>

namespace forceshade::report {

struct HtmlColumn {
    std::string name, unit, meaning; /* plain text */
    bool numbers = true;
};

/// Rows are markup. Wide tables scroll by themselves; what is folded opens by a click, and always on paper.
std::string html_table(const std::vector<HtmlColumn>& columns, const std::vector<std::vector<std::string>>& rows,
                       const std::string& label);

/// A heading that unfolds `body`, both markup.
std::string folded(const std::string& heading, const std::string& body);

} // namespace forceshade::report

// The page and its parts, as markup.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// The scripts of a page: `in_space` those that draw in 3D, too.
std::string page_script(bool in_space);

/// A page around `body`, markup, with styles, the script, and a policy that lets no other code run or load.
std::string page(const std::string& title, const std::string& body, const std::string& script);

/// What the studies press, cut across: unshaded and shaded.
std::string surfaces_drawing();

/// A heading that unfolds `body`, both markup.
std::string folded(const std::string& heading, const std::string& body, bool open = false);

/// The findings of a study or a sweep: a sentence each, with the place, the condition and the interval.
std::string findings_list(const std::string& id, const std::vector<study::Finding>& findings);

/// A link to a file of a folder below the root, if it is there: its absence is reported elsewhere.
std::string file_link(const std::filesystem::path& root, const std::string& folder, const std::string& name,
                      const std::string& remark = "");

/// Missing, damaged and foreign files; may be empty.
std::string troubles_section(const std::vector<std::string>& troubles);

/// What the page draws into the elements ID-hero, ID-figures and ID-tables: figures, and their tables and others that
/// are not too long, as JSON in a script of that id.
std::string page_data(const std::string& id, const study::StudyData& data);

/// A study: findings next to the first figure, the other figures, methods, tables and files.
std::string study_section(const std::filesystem::path& root, const StudyPart& part);

/// Of the studies' own surfaces: what each scheme costs and gives, in one table; empty without error-time.
std::string verdict_section(const Contents& contents);

/// Cases of a sweep: errors, times, what was left out, files.
std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep);

/// Errors where a hand touches, over what the sweep varies most: a table and two figures, if something varies.
void add_touch_figures(const Sweep& sweep, study::StudyData& data);
/// The same in a sentence; empty without such errors.
std::string touch_finding(const Sweep& sweep);

/// The findings of a sweep, a sentence each, computed from the cases alone; may be empty.
std::vector<study::Finding> sweep_findings(const Sweep& sweep);

/// The interactive viewer of force volumes: their data, packed into the page, and the place it draws in. Empty where
/// neither a sweep nor a study has a volume that can be read; one that cannot is added to the troubles. Volumes are
/// thinned until all fit into `budget` characters, and the page says so.
std::string viewer_section(const std::filesystem::path& root, const Contents& contents,
                           std::vector<std::string>& troubles, std::size_t budget);

/// For headings and links within the page: "study-energy", "sweep-NAME".
std::string anchor(const StudyPart& part);
std::string anchor(const Sweep& sweep);
std::string title(const StudyPart& part);
std::string title(const Sweep& sweep);

/// "Run on DEVICE ...": two columns of terms and their values.
std::string facts(const std::vector<std::pair<std::string, std::string>>& terms);

} // namespace forceshade::report

// What a page is made of: the contents of a results folder, text as markup, and the page's parts.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/numbers.h"
#include "host/output/record.h"
#include "host/study/study_data.h"

namespace forceshade::report {

using namespace numbers;

// The contents of a results folder: sweeps and studies, and the parts that cannot be understood.

struct Sweep {
    std::string folder; /* below the report's: "", "NAME" or "NAME/NAME" */
    std::string program, device, driver, cpu;
    unsigned cores = 0;
    double seconds = 0; /* of the last run that computed something */
    std::size_t cases_of_study = 0;
    std::vector<CaseRecord> cases;
    std::vector<study::Finding> findings;
};

struct StudyPart {
    std::string folder; /* below the report's */
    study::StudyData data;
};

struct Contents {
    std::vector<Sweep> sweeps;
    std::vector<StudyPart> studies;    /* with their findings computed anew */
    std::vector<std::string> troubles; /* a sentence each, beginning with the file */
};

/// Looks into the folder, the folders below it, and those below folders that hold no results themselves. \throws
/// IoError if the folder does not exist.
Contents read_contents(const std::filesystem::path& folder);

/// "sub/name", or "name" right in the report's folder.
std::string below(const std::string& folder, const std::string& name);

// Text, links and data as markup. Everything that comes from a file is escaped here.

/// Text as it stands in HTML; bytes that are not UTF-8 and characters that HTML may not have are replaced.
std::string escaped(std::string_view text);

/// JSON within a <script>: its text cannot end the element.
std::string script_text(const nlohmann::ordered_json& json);

/// A path below the report's folder as a relative address, without another scheme, host or query.
std::string address(std::string_view path);

/// Bytes within text.
std::string base64(std::string_view bytes);

/// <a href="address">text</a>
std::string link(std::string_view path, std::string_view text);

// The page and its parts, as markup.

/// The scripts of a page: `in_space` those that draw in 3D, too.
std::string page_script(bool in_space);

/// A page around `body`, markup, with styles, the script, and a policy that lets no other code run or load.
std::string page(const std::string& title, const std::string& body, const std::string& script);

/// A heading that unfolds `body`, both markup.
std::string folded(const std::string& heading, const std::string& body, bool open = false);

/// Begins the section of a study or a sweep: `answer`, markup, next to the first figure, then the other figures, both
/// of the data ID-data.
std::string section_start(const std::string& id, const std::string& title, const std::string& answer);

/// The findings of a study or a sweep: a sentence each, with the place, the condition and the interval.
std::string findings_list(const std::string& id, std::span<const study::Finding> findings);

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
/// HTML: the studies' surfaces.
std::string surfaces_drawing();

/// Cases of a sweep: errors, times, what was left out, files.
std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep);

/// What [compare] says, over what the sweep varies most: a table and two figures, if something varies.
void add_compare_figures(const Sweep& sweep, study::StudyData& data);
/// Errors where a hand touches, over what the sweep varies most: a table and two figures, if something varies.
void add_touch_figures(const Sweep& sweep, study::StudyData& data);
/// What the paths of the cases meet, over what the sweep varies most: a table, and figures of force, work and, with
/// [compare], direction, if something varies.
void add_path_figures(const Sweep& sweep, study::StudyData& data);
/// The findings of a sweep, a sentence each, computed from the cases alone; may be empty.
std::vector<study::Finding> sweep_findings(const Sweep& sweep);

/// For headings and links within the page: "study-energy", "sweep-NAME".
std::string anchor(const StudyPart& part);
std::string anchor(const Sweep& sweep);
std::string title(const StudyPart& part);
std::string title(const Sweep& sweep);

/// "Run on DEVICE ...": two columns of terms and their values.
std::string facts(const std::vector<std::pair<std::string, std::string>>& terms);

// The volumes' data for the page: forces thinned and packed, the surface as sheets of heights, and some paths.

struct SampledVolume {
    std::array<std::uint64_t, 3> full{};   /* samples in the file */
    std::array<std::uint64_t, 3> stride{}; /* of the file's samples, every which one along x, y, z is here */
    std::array<std::uint64_t, 3> size{};   /* samples here */
    std::array<double, 3> origin{};        /* m, of the first sample */
    std::array<double, 3> spacing{};       /* m, of the file */
    bool alike_in_y = false;               /* one y stands for all */
    std::vector<float> force;              /* N: x, y, z of each sample, x fastest */
    std::vector<float> angle{}, error{};   /* deg, N: from the shape of [compare], empty without one; NaN deeper
                                              than compare.depth, and out of contact */
    std::string scene{};                   /* the resolved TOML; empty where the file names none */
};

/// At most `most` samples (at least one). \throws IoError for a file that cannot be read.
SampledVolume sample_volume(const std::filesystem::path& path, std::uint64_t most);

/// Vectors of `components`, or numbers, as halves of the power of two that the largest component does not exceed; each
/// half less the one before it along a row of `width`; high bytes, then low bytes; compressed by zlib.
struct PackedValues {
    std::string bytes;
    double scale = 1; /* in the values' unit */
};
PackedValues pack_values(std::span<const float> values, std::size_t components, std::uint64_t width);

/// {nominal, smooth}: the surface that depth is measured from, and the shape that shading imitates, if any,
/// each {unit_m, x: [...], z: [[...], ...]}: whole numbers of the unit, rows evenly along the volume's y, one row where
/// y does not matter. Null of a mesh or a map from a file, which volumes do not hold, and of a scene of another
/// version.
nlohmann::ordered_json surface_data(const SampledVolume& volume);

/// The loop of the scene: {mass, damping, grip, delay, period, stiffness} in SI; null where the scene does not say.
nlohmann::ordered_json loop_data(const std::string& scene);

/// What a loop is on, by the name that readers know.
struct NamedScene {
    std::string name, scene;   /* resolved TOML */
    std::string weak_places{}; /* study::weak_places_text(), if it is known already */
};

/// "My device", which the page fills in: of the first of `scenes` that says so the loop to begin with, and the places
/// of their surfaces where any hand's loop is the least stable; without one the page takes the paper's bump.
std::string device_section(std::vector<NamedScene> scenes);

/// s: between samples of a scene's paths; NaN where it does not say, as of recorded ones.
double path_period(const std::string& scene);

/// Some paths, thinned until they take no more than about `budget` characters: {size: [samples, paths], rate_Hz of the
/// samples here (absent of recorded ones), scale: {NAME: N or m}}, and `force`, `position` and, if stored, `proxy` as
/// pack_values packs. \throws IoError as read_paths.
struct PackedPaths {
    nlohmann::ordered_json about;
    std::vector<std::pair<std::string, std::string>> vectors;
};
PackedPaths pack_paths(const std::filesystem::path& path, std::size_t budget);

/// The interactive viewer of force volumes: their data, packed into the page, and the place it draws in. Empty where
/// neither a sweep nor a study has a volume that can be read; one that cannot is added to the troubles. Volumes are
/// thinned until all fit into `budget` characters, and the page says so. Adds their scenes to `shown`.
std::string viewer_section(const std::filesystem::path& root, const Contents& contents,
                           std::vector<std::string>& troubles, std::size_t budget, std::vector<NamedScene>& shown);

} // namespace forceshade::report

#include "host/report/report.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/picture/canvas.h"
#include "host/program.h"
#include "host/report/sections.h"
#include "host/spelling.h"
#include "report_assets.h"

namespace forceshade::report {
namespace {

constexpr std::string_view kGenerator = "<meta name=\"generator\" content=\"forceshade\">";

// As a policy names a script.
std::string digest(const std::string& text) {
    const std::string hex = sha256_of(text);
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    return "sha256-" + base64(bytes);
}

// True for a file that begins as such a page does.
bool is_page(const std::filesystem::path& path) {
    try {
        std::string beginning(4096, '\0');
        beginning.resize(ReadableFile(path).read_some(0, std::as_writable_bytes(std::span(beginning))));
        return beginning.find(kGenerator) != std::string::npos;
    } catch (const IoError&) {
        return false;
    }
}

// Characters: a page that opens at once and can be sent by mail.
constexpr std::size_t kPageBudget = 2'450'000, kLeastForViewer = 300'000;

std::string entry(const std::string& id, const std::string& text) {
    return fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id, escaped(text));
}

// Of renderers of the user's own, and nothing else.
bool is_score(const Contents& contents) {
    return contents.sweeps.empty() && contents.studies.size() == 1 && contents.studies.front().data.study == "score";
}

// A part of the page; without a title it is not in the contents.
struct PagePart {
    std::string id, title, html;
};

std::string contents_list(const std::vector<PagePart>& parts) {
    std::string html;
    for (const PagePart& part : parts)
        if (!part.title.empty())
            html += entry(part.id, part.title);
    return "<nav aria-label=\"Contents\">\n<ul>\n" + html + "</ul>\n</nav>\n";
}

// The text of the finding, as the study wrote it; `otherwise` without it.
std::string sentence_of(const Contents& contents, const char* study, const char* finding, const char* otherwise) {
    for (const StudyPart& part : contents.studies)
        for (const study::Finding& one : part.data.findings)
            if (part.data.study == study && one.name == finding)
                return one.text;
    return otherwise;
}

// What shading is, with its benefit and cost where no table of shadings follows; of a score what is measured.
std::string opening(const Contents& contents, bool table_follows) {
    if (is_score(contents))
        return "<p id=\"opening\">Forces of renderers along the same strokes, held against the oracle: how far they "
               "are from its forces, which contacts they lose, what they add in vibration, and how long an update "
               "takes.</p>\n";
    std::string buys_and_costs;
    if (!table_follows)
        buys_and_costs =
            sentence_of(contents, "error-time", "shading",
                        "Edges are felt less; what that costs in time, 'forceshade study error-time' measures.") +
            " " +
            sentence_of(contents, "stability", "loop_shading",
                        "Such a force has no potential: a closed stroke can give the hand energy, and a loop may come "
                        "to rest only at lower stiffness.");
    return fmt::format(
        "<p id=\"opening\">Force shading turns the force on a polyhedron, whose direction jumps from facet to facet, "
        "towards that on the smooth shape (Morgenbesser and Srinivasan 1996, here the paper). {}</p>\n",
        escaped(buys_and_costs));
}

// Whether one of the words, between commas, stands in a text in lower case: by itself, or in the plural.
bool has_word(std::string_view text, std::string_view words) {
    const auto ends = [&](std::size_t at) {
        return at >= text.size() || (std::isalnum(static_cast<unsigned char>(text[at])) == 0 && text[at] != '_');
    };
    const std::size_t comma = words.find(", ");
    const std::string word = lower_case(words.substr(0, comma));
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; ++at)
        if (const std::size_t end = at + word.size();
            (at == 0 || ends(at - 1)) && (ends(end) || (text[end] == 's' && ends(end + 1))))
            return true;
    return comma != std::string_view::npos && has_word(text, words.substr(comma + 2));
}

// The terms that the page assumes, of those that occur in its text.
std::string words_section(std::string_view page) {
    static constexpr std::pair<const char*, const char*> kWords[]{
        {"oracle", "the scene's own law as the processor computes it, which other forces are held against; on a mesh a "
                   "god-object"},
        {"rim", "where the smooth shape itself has an edge: the foot of the bump"},
        {"RMS", "root mean square: the square root of the mean of the squares"},
        {"god-object", "the probe's stand-in on a mesh (also: proxy): it stays on the surface while the probe is "
                       "pressed in, and the force pulls the probe to it"},
        {"height map", "a surface given by its height over x and y"},
        {"look-up volume", "forces computed beforehand on a grid, between which a loop interpolates"},
        {"octree, adaptive", "a look-up volume of bricks that are finer where reading between samples errs most"},
        {"narrow band", "a look-up volume that holds bricks of samples near the surface alone"},
        {"trilinear", "between eight samples, linear along each axis"},
        {"tricubic", "between 64 samples, cubic along each axis"},
        {"tessellation", "the facets that stand for a smooth shape, and where they lie"},
        {"bootstrap", "an interval from drawing the same measurements again, with repetition"},
        {"front", "the methods than which no other is both faster and closer"},
        {"crest", "the highest place of a shape, where the surface turns away on both sides"},
        {"hollow", "the lowest place of a shape, where the surface turns upwards on both sides"},
        {"winding number", "how often a mesh goes around a point: inside it is above one half, also where the mesh has "
                           "holes"},
        {"virtual coupling", "a spring, and perhaps a damper, between the device and the probe that the law sees"},
        {"K_crit", "the stiffness up to which a loop on a flat wall comes to rest"},
        {"Z-width", "the range of stiffness and damping that a device can display without becoming unstable"},
        {"limit cycle", "a swing that neither grows nor dies out"},
        {"quantisation limit cycle", "a swing that the steps of the measured position keep up, of one step at most"},
        {"lag", "the time constant with which a device's force follows the one that it is given"},
        {"kernel", "a program that a Vulkan device runs for many voxels or paths at a time"},
        {"reference", "shading of the bump: the direction of the cylinder that its facets stand for"},
        {"none", "no shading: the direction is the facet's normal"},
        {"barycentric", "shading of a mesh: vertex normals, averaged with the weights of the place within its "
                        "triangle; the size of the force stays"},
        {"morgenbesser",
         "shading of a mesh as in the paper: vertex normals, weighted by the distances from a facet's corners"},
        {"K·d", "stiffness times depth: the size of the force"},
        {"passive", "gives no energy, whatever hand holds the device"},
        {"hold", "the direction that a hand presses in; the grip's spring acts across it"},
        {"mean_value", "shading of a mesh: vertex normals, averaged with Floater's weights for facets of any number of "
                       "corners; the size of the force stays"},
        {"two_pass",
         "shading of a mesh by Ruspini 1997: the force grows with the angle by which it is turned, without a bound"},
        {"rest", "a loop comes to rest if its swing dies out after a small disturbance"},
        {"closed stroke", "of the probe: out at one depth and back at another, to where it began"},
        {"gain, effort", "the energy that a closed stroke gives the hand, and the integral of |F dl| along it"},
        {"loop", "of control: the position is sampled, the force computed and played, over and over"},
        {"hint", "the triangles that a god-object's update found about its proxy, from which the next one begins"},
        {"quantum", "the step of a device's measured position"},
        {"boundary", "places within a fortieth of the deepest press from the surface, where contact begins"},
        {"k_g", "stiffness of the grip, with which a hand holds the probe across its press"},
        {"f_c", "dry friction of the device"},
        {"linearised loop", "the loop for displacements so small that the force changes in proportion to them"},
        {"curl", "the work round a small closed path over its area: where it is not 0 the force has no potential"},
        {"pop-through",
         "the probe comes out on the other side: the force does not come back in this contact, or is turned round"},
        {"drop-out", "a contact of the oracle in which the force is lost for a while"},
        {"phantom", "a force in the air: where the oracle has no contact"}};
    const std::string text = lower_case(page);
    std::string words;
    for (const auto& [word, meaning] : kWords)
        if (has_word(text, word))
            words += fmt::format("<dt>{}</dt><dd>{}</dd>\n", word, meaning);
    return words.empty() ? words
                         : "<section id=\"words\">\n" +
                               folded("Words", "<dl class=\"meanings\">\n" + words + "</dl>\n", true) + "</section>\n";
}

// Of several studies the first finding of each, next to its figure, which the page draws.
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

// What the folder holds.
std::string heading(const Contents& contents) {
    if (contents.sweeps.empty() && contents.studies.empty())
        return "Report";
    if (is_score(contents))
        return "Renderers, scored";
    const char* const studies = contents.studies.size() > 1 ? "Studies" : "Study";
    const char* const sweeps = contents.sweeps.size() > 1 ? "Sweeps" : "Sweep";
    return contents.sweeps.empty()    ? fmt::format("{} of force shading", studies)
           : contents.studies.empty() ? fmt::format("{} of force fields", sweeps)
                                      : "Studies and sweeps of force fields";
}

// In their order: findings first, and the words that they use once, after the first of them.
std::vector<PagePart> parts_of(const std::filesystem::path& folder, Contents& contents) {
    if (contents.studies.empty() && contents.sweeps.empty())
        return {{"troubles", "What is missing or damaged", troubles_section(contents.troubles)},
                {"", "", "<p>This folder has no sweep and no study that this program can read.</p>\n"}};
    std::vector<PagePart> studies, sweeps;
    std::vector<NamedScene> scenes;
    std::size_t taken = page_script(true).size();
    std::string text(is_score(contents) ? "" : assets::studies_js); // of the page, but for volumes
    for (const StudyPart& part : contents.studies) {
        taken += studies.emplace_back(PagePart{anchor(part), title(part), study_section(folder, part)}).html.size();
        if (!part.data.scene.empty() || !part.data.weak_places.empty())
            scenes.push_back({"the scene of study " + (part.folder.empty() ? part.data.study : part.folder),
                              part.data.scene, part.data.weak_places});
    }
    for (const Sweep& sweep : contents.sweeps)
        taken += sweeps.emplace_back(PagePart{anchor(sweep), title(sweep), sweep_section(folder, sweep)}).html.size();
    const std::size_t room = kPageBudget - std::min(taken, kPageBudget - kLeastForViewer);
    const PagePart viewer{"viewer", "Viewer", viewer_section(folder, contents, contents.troubles, room, scenes)};
    const PagePart verdict{"verdict", "", verdict_section(contents)};
    PagePart device{"device", "My device", is_score(contents) ? "" : device_section(scenes)};
    for (const auto* some : {&studies, &sweeps})
        for (const PagePart& part : *some)
            text += part.html;
    PagePart words{"words", "Words", words_section(text + verdict.html)};

    std::vector<PagePart> parts;
    const auto add = [&](const PagePart& part) {
        if (!part.html.empty())
            parts.push_back(part);
        return !part.html.empty();
    };
    const auto add_once = [&](PagePart& part) { add(std::exchange(part, {})); };
    add({"troubles", "What is missing or damaged", troubles_section(contents.troubles)});
    if (add(verdict)) {
        add_once(device);
        add_once(words);
    }
    if (add({"glance", "", glance(contents.studies)}))
        add_once(words);
    for (const PagePart& study : studies) {
        add(study);
        add_once(words);
    }
    for (const PagePart& sweep : sweeps)
        add(sweep);
    add(viewer);
    add_once(words);
    add_once(device);
    return parts;
}

std::string page_of(const std::string& name, const std::filesystem::path& folder, Contents& contents) {
    const std::vector<PagePart> parts = parts_of(folder, contents);
    const auto has = [&](const char* id) { return std::ranges::count(parts, id, &PagePart::id) > 0; };
    std::string body =
        fmt::format("<header>\n<h1>{}</h1>\n<p>Haptic force fields with and without force shading. Folder {}, written "
                    "by forceshade {}.</p>\n</header>\n",
                    heading(contents), escaped(name), escaped(version()));
    if (!contents.studies.empty() || !contents.sweeps.empty())
        body += opening(contents, has("verdict"));
    body += contents_list(parts) + "<main>\n";
    for (const PagePart& part : parts)
        body += part.html;
    return page(name + " – forceshade", body + "</main>\n", page_script(has("viewer")));
}

// A report.html of another program stays.
std::filesystem::path file_for(const std::filesystem::path& folder, Contents& contents) {
    const std::filesystem::path file = folder / "report.html", other = folder / "forceshade-report.html";
    if (!std::filesystem::exists(file) || is_page(file))
        return file;
    contents.troubles.push_back("report.html: another program wrote it, so the report is forceshade-report.html");
    return other;
}

} // namespace

std::string page_script(bool in_space) {
    std::string text = fmt::format("const KNOWN_SERIES = {};\n", picture::known_series_json());
    for (const std::string_view part : {assets::d3_js, assets::colours_js, assets::figures_js, assets::studies_js})
        text += part;
    if (in_space)
        for (const std::string_view part : {assets::three_js, assets::orbit_js})
            text += part;
    for (const std::string_view part :
         {assets::volume_js, assets::pane_js, assets::solids_js, assets::space_js, assets::viewer_js})
        text += part;
    return text;
}

std::string page(const std::string& title, const std::string& body, const std::string& script) {
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
    html += fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
                        "'unsafe-inline'; img-src data:; script-src '{}'; base-uri 'none'; form-action 'none'\">\n",
                        digest(script));
    html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<meta name=\"color-scheme\" content=\"light dark\">\n" +
            std::string(kGenerator) + "\n<link rel=\"icon\" href=\"data:,\">\n";
    html +=
        fmt::format("<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n", escaped(title), assets::report_css);
    return html + body + "<script>" + script + "</script>\n</body>\n</html>\n";
}

ReportResult write_report(const std::filesystem::path& folder) {
    const Stage stage("writing the report");
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

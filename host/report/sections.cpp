// Markup, and a study: its findings next to the figure that shows them; how it was measured, its tables and files.
// Figures and tables are drawn by the page, out of the study's data.
#include "host/report/sections.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>

#include "host/output/json.h"
#include "host/spelling.h"
#include "host/study/study_data.h"

namespace forceshade::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool is_no_character(std::string_view sequence) {
    if (sequence.size() == 1)
        return static_cast<std::uint8_t>(sequence[0]) < 0x20 && sequence != "\t" && sequence != "\n" &&
               sequence != "\r";
    return sequence == "\xEF\xBF\xBE" || sequence == "\xEF\xBF\xBF";
}

constexpr std::pair<char, std::string_view> kEntities[] = {
    {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};

constexpr std::size_t kMostRows = 3000; // of a table that no figure shows; the CSV file has all

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

std::string files(const std::filesystem::path& root, const StudyPart& part) {
    std::string html = file_link(root, part.folder, "study.json");
    for (const FileRecord& file : part.data.files)
        html += file_link(root, part.folder, file.name);
    for (const FileRecord& file : part.data.volumes)
        html += file_link(root, part.folder, file.name,
                          fmt::format(" <small>volume, {}</small>", size_text(double(file.bytes))));
    return folded("Files", "<ul class=\"files\">\n" + html + "</ul>\n");
}

std::string plain_id(const std::string& name) {
    std::string id;
    for (const char c : name)
        id += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    return id;
}

} // namespace

std::string escaped(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const std::string_view sequence = text.substr(0, length ? length : 1);
        const auto* const found = std::ranges::find(kEntities, sequence[0], [](const auto& one) { return one.first; });
        if (length == 0 || is_no_character(sequence))
            result += kReplacement;
        else
            result += found != std::end(kEntities) ? found->second : sequence;
        text.remove_prefix(sequence.size());
    }
    return result;
}

std::string address(std::string_view path) {
    std::string text;
    for (const char c : path) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           std::string_view("-._~").find(c) != std::string_view::npos ||
                           (c == '/' && !text.empty()); // two at the beginning lead to another host
        text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return text;
}

std::string link(std::string_view path, std::string_view text) {
    return fmt::format("<a href=\"{}\">{}</a>", address(path), escaped(text));
}

std::string base64(std::string_view bytes) {
    std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0'); // and the 0 that is written behind it
    const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
    text.resize(static_cast<std::size_t>(
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), from, static_cast<int>(bytes.size()))));
    return text;
}

std::string script_text(const Json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
        text += c == '<' ? "\\u003c" : std::string(1, c);
    return text;
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

std::string folded(const std::string& heading, const std::string& body, bool open) {
    return fmt::format("<details{}><summary>{}</summary>\n{}</details>\n", open ? " open=\"\"" : "", heading, body);
}

std::string file_link(const std::filesystem::path& root, const std::string& folder, const std::string& name,
                      const std::string& remark) {
    const std::string path = below(folder, name);
    std::error_code ignored;
    return is_plain_name(name) && std::filesystem::is_regular_file(root / path, ignored)
               ? "<li>" + link(path, name) + remark + "</li>\n"
               : "";
}

std::string page_data(const std::string& id, const study::StudyData& data) {
    Json all = Json::parse(study::data_json(data)), json;
    json["figures"] = all["figures"];
    json["tables"] = Json::array();
    for (std::size_t i = 0; i < data.tables.size(); ++i) {
        const bool drawn =
            std::ranges::find(data.figures, data.tables[i].name, &study::Figure::table) != data.figures.end();
        if (drawn || data.tables[i].rows.size() <= kMostRows)
            json["tables"].push_back(std::move(all["tables"][i]));
    }
    return fmt::format("<script type=\"application/json\" class=\"study\" id=\"{}\">{}</script>\n", id,
                       script_text(json));
}

std::string findings_list(const std::string& id, std::span<const study::Finding> findings) {
    std::string html;
    for (const study::Finding& finding : findings) {
        std::string when;
        for (const std::string* one : {&finding.place, &finding.condition, &finding.interval})
            if (!one->empty())
                when += (when.empty() ? "" : "; ") + *one;
        html += fmt::format("<li id=\"{}-{}\">{}{}</li>\n", id, plain_id(finding.name), escaped(finding.text),
                            when.empty() ? "" : "<small>" + escaped(when) + "</small>");
    }
    return html.empty() ? "<p>This gives no findings.</p>\n" : "<ol class=\"findings\">\n" + html + "</ol>\n";
}

std::string section_start(const std::string& id, const std::string& title, const std::string& answer) {
    return fmt::format("<section id=\"{0}\">\n<h2>{1}</h2>\n<div class=\"answer\"><div>{2}</div><div "
                       "id=\"{0}-data-hero\"></div></div>\n<div class=\"figures\" id=\"{0}-data-figures\"></div>\n",
                       id, escaped(title), answer);
}

std::string study_section(const std::filesystem::path& root, const StudyPart& part) {
    const study::StudyData& data = part.data;
    const std::string id = anchor(part);
    std::string method = run_facts(data);
    for (const std::string& note : data.notes)
        method += fmt::format("<p class=\"note\">{}</p>\n", escaped(note));
    if (!data.scene.empty())
        method += "<pre>" + escaped(data.scene) + "</pre>\n";
    std::string html = section_start(id, title(part), findings_list(id, data.findings));
    html += folded("How it was measured", method);
    if (data.tables.empty())
        html += "<p>This study holds no table.</p>\n";
    html += fmt::format("<div id=\"{}-data-tables\"></div>\n", id) + files(root, part);
    return html + page_data(id + "-data", data) + "</section>\n";
}

} // namespace forceshade::report

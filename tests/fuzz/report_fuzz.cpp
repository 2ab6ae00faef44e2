// The page of a folder whose manifest.json or study.json is the input: no markup of the input survives. Its tags are
// those of the page of a folder with the same words made harmless.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "host/output/files.h"
#include "host/output/json.h"
#include "host/report/report.h"
#include "host/report/sections.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::require;

/// Tags and their attributes' names, as a strict reader of HTML finds them.
class Markup {
public:
    explicit Markup(std::string_view html) : html_(html) {
        while (!html_.empty())
            read_one();
    }
    const std::string& tags() const { return tags_; }

private:
    void read_one() {
        if (html_[0] == '<')
            read_tag();
        else if (html_[0] == '&')
            read_entity();
        else {
            const char c = html_[0];
            require(c != '>' && (static_cast<unsigned char>(c) >= ' ' || c == '\n' || c == '\t' || c == '\r'),
                    "the character {} stands in the text", static_cast<int>(c));
            html_.remove_prefix(1);
        }
    }
    void read_entity() {
        for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"})
            if (html_.starts_with(entity)) {
                html_.remove_prefix(entity.size());
                return;
            }
        require(false, "an entity that the program does not write: {}", html_.substr(0, 20));
    }
    std::string_view take_name() {
        std::size_t length = 0;
        while (length < html_.size() &&
               (std::islower(static_cast<unsigned char>(html_[length])) ||
                std::isdigit(static_cast<unsigned char>(html_[length])) || html_[length] == '-'))
            ++length;
        const std::string_view name = html_.substr(0, length);
        html_.remove_prefix(length);
        return name;
    }
    void read_tag() {
        html_.remove_prefix(1);
        const bool end = html_.starts_with('/');
        html_.remove_prefix(end);
        const std::string_view name = take_name();
        require(!name.empty(), "a tag without a name: {}", html_.substr(0, 20));
        tags_ += fmt::format("<{}{}", end ? "/" : "", name);
        while (html_.starts_with(' ')) {
            html_.remove_prefix(1);
            const std::string_view attribute = take_name();
            require(html_.starts_with("=\""), "the attribute {} has no quotes", attribute);
            html_.remove_prefix(2);
            const std::size_t length = html_.find('"');
            require(length != std::string_view::npos, "the attribute {} does not end", attribute);
            check_attribute(attribute, html_.substr(0, length));
            tags_ += fmt::format(" {}", attribute);
            html_.remove_prefix(length + 1);
        }
        require(html_.starts_with('>'), "the tag {} does not end", name);
        html_.remove_prefix(1);
        tags_ += ">\n";
        if (name == "script" && !end)
            skip_script();
    }
    static void check_attribute(std::string_view name, std::string_view value) {
        require(value.find_first_of("<>") == std::string_view::npos, "{} holds markup: {}", name, value);
        require(!name.starts_with("on") && name != "style" && name != "src", "there is an attribute {}", name);
        if (name == "href") // an address below the page, or a place of it
            require(value.find(':') == std::string_view::npos && !value.starts_with("//"), "a link leads to {}", value);
    }
    void skip_script() {
        const std::size_t length = html_.find('<');
        require(html_.substr(std::min(length, html_.size())).starts_with("</script>"), "a script holds markup");
        require(Json::accept(html_.substr(0, length)), "a script is no JSON");
        html_.remove_prefix(length);
    }

    std::string_view html_;
    std::string tags_;
};

std::string harmless_words(std::string_view text) {
    std::string result;
    for (const char c : text) {
        const bool plain =
            std::isalnum(static_cast<unsigned char>(c)) || std::string_view(" -_./").find(c) != std::string_view::npos;
        result += plain ? std::string(1, c) : fmt::format("x{:02x}", static_cast<unsigned char>(c));
    }
    return result;
}

/// The same with every text, also those of keys, changed.
template <typename Change> Json with_texts(const Json& json, const Change& change, const Change& change_key) {
    if (json.is_string())
        return change(json.get_ref<const std::string&>());
    if (json.is_array()) {
        Json result = Json::array();
        for (const Json& one : json)
            result.push_back(with_texts(one, change, change_key));
        return result;
    }
    if (json.is_object()) {
        Json result = Json::object();
        for (const auto& [key, value] : json.items())
            result[change_key(key)] = key == "kind" ? value : with_texts(value, change, change_key); // a figure's
        return result;
    }
    return json;
}

Json harmless(const Json& json) {
    const std::function<std::string(const std::string&)> change = harmless_words;
    return with_texts(json, change, change);
}

Json hostile(const Json& json) {
    const std::function<std::string(const std::string&)> change =
                                                             [](const std::string&text) {
                                                                 return text + "<i a=\"b\">&'";
                                                             },
                                                         keep = [](const std::string&key) { return key; };
    return with_texts(json, change, keep);
}

/// Without the spaces that do not break.
std::string plain(std::string text) {
    for (std::size_t at = text.find("\u00a0"); at != text.npos; at = text.find("\u00a0"))
        text.erase(at, 2);
    return text;
}

/// Counts, sizes and durations of any magnitude mean what they are of.
void check_numbers(std::uint64_t number) {
    const std::string count = report::count_text(number);
    require(plain(count) == std::to_string(number) && count.front() != '\xC2', "{} is written as {}", number, count);
    const double bytes = static_cast<double>(number);
    std::istringstream size(report::size_text(bytes));
    double value = 0;
    std::string unit;
    size >> value >> unit;
    constexpr std::array kUnits{"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    const auto power = std::ranges::find(kUnits, unit) - kUnits.begin();
    const double one = std::pow(1000.0, static_cast<double>(power));
    require(std::abs(value * one - bytes) <= 0.005 * bytes && (power == 0 || value >= 1) && value < 1000,
            "{} bytes are {} {}", number, value, unit);
    const double seconds = bytes / 1000;
    std::istringstream words(report::duration_text(seconds));
    double sum = 0, resolution = 1;
    while (words >> value >> unit) {
        sum += value * (unit == "h" ? 3600 : unit == "min" ? 60 : 1);
        resolution = unit == "h" ? 60 : resolution;
        require(unit == "h" || value <= 60, "{} s are {}", seconds, report::duration_text(seconds));
    }
    require(seconds > 1e9 || std::abs(sum - seconds) <= resolution, "{} s are {}", seconds,
            report::duration_text(seconds));
}

/// What a sweep is said to have left out follows from its cases.
void check_findings(const report::Sweep& sweep) {
    double voxels = 0, evaluated = 0;
    for (const CaseRecord& record : sweep.cases)
        if (record.voxels > 0) {
            voxels += static_cast<double>(record.voxels);
            evaluated += static_cast<double>(record.evaluated);
        }
    const bool is_told = std::ranges::find(sweep.findings, "evaluated", &study::Finding::name) != sweep.findings.end();
    require(is_told == (evaluated < voxels) || !(voxels < 1e15 && evaluated < 1e15),
            "{} of {} voxels are evaluated, which is told: {}", evaluated, voxels, is_told);
    for (const study::Finding& finding : sweep.findings) {
        double some = 0, all = 0, per_cent = 0;
        if (finding.name == "evaluated" && voxels < 1e15 && evaluated < 1e15 &&
            finding.text.find("\u00d7") == std::string::npos &&
            std::sscanf(plain(finding.text).c_str(), "Only %lf of %lf voxels had to be evaluated (%lf %%)", &some, &all,
                        &per_cent) == 3)
            require(some == evaluated && all == voxels && std::abs(per_cent / 100 - some / all) <= 0.06 * some / all,
                    "{} of {} voxels are evaluated: {}", evaluated, voxels, finding.text);
    }
}

/// Where a column of a sweep's table has its numbers from, and by how much they are multiplied: its unit.
struct Source {
    std::string_view table, column, place;
    double factor = 1;
};
constexpr Source kSources[] = {{"cases", "voxels", "/voxels"},
                               {"cases", "evaluated", "/voxels_evaluated"},
                               {"cases", "largest force", "/largest_force_N"},
                               {"cases", "largest error", "/oracle/largest_error_N"},
                               {"cases", "relative error", "/oracle/relative_error"},
                               {"cases", "differing", "/oracle/voxels_differing"},
                               {"cases", "beyond bound", "/oracle/voxels_beyond_bound"},
                               {"times", "prepare", "/seconds/prepare", 1e3},
                               {"times", "plan", "/seconds/plan", 1e3},
                               {"times", "compile", "/seconds/compile", 1e3},
                               {"times", "upload", "/seconds/upload", 1e3},
                               {"times", "kernel", "/seconds/kernel", 1e3},
                               {"times", "read back", "/seconds/read_back", 1e3},
                               {"times", "encode", "/seconds/encode", 1e3},
                               {"times", "flush", "/seconds/flush", 1e3},
                               {"times", "verify", "/seconds/verify", 1e3},
                               {"times", "hash", "/seconds/hash", 1e3},
                               {"times", "check", "/seconds/check", 1e3},
                               {"paths", "paths", "/paths/paths"},
                               {"paths", "samples", "/paths/samples"},
                               {"paths", "unstable", "/paths/unstable"},
                               {"paths", "largest force", "/paths/largest_force_N"},
                               {"paths", "work", "/paths/work_J"},
                               {"paths", "mean depth", "/paths/mean_depth_m", 1e3},
                               {"paths", "compared", "/paths/oracle/samples_compared"},
                               {"paths", "differing", "/paths/oracle/samples_differing"},
                               {"paths", "kernel", "/paths/seconds/kernel", 1e3}};

/// The tables that the page holds have the numbers of the cases' records.
void check_tables(const report::Sweep& sweep, const std::string& html) {
    const std::size_t script = html.find("<script type=\"application/json\"");
    if (script == html.npos)
        return;
    const std::size_t begin = html.find('>', script) + 1;
    const Json data = Json::parse(html.substr(begin, html.find('<', begin) - begin));
    std::vector<Json> fields, paths; // the records that have them
    for (const CaseRecord& record : sweep.cases) {
        const Json json = Json::parse(record_json(record));
        if (record.voxels > 0)
            fields.push_back(json);
        if (record.paths)
            paths.push_back(json);
    }
    for (const Json& table : data.at("tables"))
        for (std::size_t column = 0; column < table.at("columns").size(); ++column)
            for (const Source& source : kSources) {
                if (table["name"] != source.table || table["columns"][column]["name"] != source.column)
                    continue;
                const Json& cells = table.at("cells").at(column);
                const std::vector<Json>& records = source.table == "paths" ? paths : fields;
                for (std::size_t row = 0; row < records.size(); ++row) {
                    const Json& cell =
                        cells.is_object() ? cells["of"][cells["at"].at(row).get<std::size_t>()] : cells.at(row);
                    const Json& from = records[row].at(Json::json_pointer(std::string(source.place)));
                    const double expected = from.is_number() ? from.get<double>() * source.factor : NAN;
                    require(!std::isfinite(expected) || (cell.is_number() && std::abs(cell.get<double>() - expected) <=
                                                                                 1e-12 * std::abs(expected)),
                            "{} of {} is {}, not {}", source.column, source.table, cell.dump(), expected);
                }
            }
}

/// JSON is read unless it is deeper than 32 levels or has an object of more than 1000 members. (The library takes a NUL
/// for the end of the text; what comes after it is no JSON.)
void check_json(const std::string& text, const Json& json) {
    const std::function<std::size_t(const Json&)> depth = [&](const Json& one) {
        std::size_t most = 0;
        for (const Json& part : one)
            most = std::max(most, part.is_structured() ? depth(part) : 0);
        return most + 1;
    };
    if (json.is_structured() && text.find('\0') == text.npos && depth(json) <= 32 &&
        std::ranges::count(text, ':') <= 1000)
        require(parse_json(text) == json, "JSON is refused, or is read as other JSON");
}

/// The pages of a folder.
class Pages {
public:
    /// The whole page's title and body, of a folder whose two parts hold this file.
    std::string page(const char* name, const std::string& text) const {
        for (const char* part : {"a", "b"}) {
            std::filesystem::create_directories(path_ / part);
            std::ofstream(path_ / part / name, std::ios::binary) << text;
        }
        const std::string html = read_file(report::write_report(path_).file);
        std::filesystem::remove_all(path_ / "a");
        std::filesystem::remove_all(path_ / "b");
        std::filesystem::remove(path_ / "report.html");
        const std::size_t body = html.find("<body>") + 6;
        return html.substr(body, html.rfind("<script>") - body);
    }
    /// The body of the page of a folder that holds this file alone.
    std::string body(const char* name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        const report::Contents contents = report::read_contents(path_);
        std::string html = report::troubles_section(contents.troubles);
        for (const report::Sweep& sweep : contents.sweeps) {
            check_findings(sweep);
            const std::string section = report::sweep_section(path_, sweep);
            check_tables(sweep, section);
            html += section;
        }
        for (const report::StudyPart& part : contents.studies)
            html += report::study_section(path_, part);
        std::filesystem::remove(path_ / name);
        return html;
    }

private:
    fuzz::Folder folder_;
    const std::filesystem::path& path_ = folder_.path();
};

// Which words a page explains depends on the words that it has.
std::string without_words(std::string page) {
    const std::size_t begin = std::min(page.find("<section id=\"words\">"), page.size());
    return page.erase(begin, page.find("</section>", begin) - begin);
}

void check_page(const std::string& text) {
    static const Pages folder;
    const Json json = Json::parse(text, nullptr, false);
    check_json(text, json);
    const char* const name = json.is_object() && json.contains("study") ? "study.json" : "manifest.json";
    const std::string html = folder.body(name, text);
    const Markup markup(html);
    if (json.is_discarded())
        return;
    const std::string tame_text = harmless(json).dump(), tame = folder.body(name, tame_text);
    static unsigned inputs = 0;
    if (inputs++ < 40 || inputs % 64 == 0) // it takes long
        require(Markup(without_words(folder.page(name, text))).tags() ==
                    Markup(without_words(folder.page(name, tame_text))).tags(),
                "the whole page's tags depend on the input's characters");
    require(Markup(tame).tags() == markup.tags(), "the page's tags depend on the input's characters:\n{}\n---\n{}",
            html, tame);
}

void check_words(std::string_view text) {
    const std::string escaped = report::escaped(text);
    require(Markup(escaped).tags().empty(), "escaped text holds tags");
    Markup(report::link(text, text));
    require(Json::accept("\"" + escaped + "\"") || text.find_first_of("\\\t\r\n\x7f") != std::string_view::npos,
            "escaped text is no UTF-8");
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    forceshade::check_words(text.substr(0, 64));
    for (std::uint64_t number = std::hash<std::string_view>{}(text), i = 0; i < 8; ++i, number *= 0x9E3779B97F4A7C15u) {
        forceshade::check_numbers(number >> number % 64);
        forceshade::check_numbers(std::uint64_t{1} << number % 64);
    }
    forceshade::check_page(std::string(text));
    if (const auto json = forceshade::Json::parse(text, nullptr, false); !json.is_discarded())
        forceshade::check_page(
            forceshade::hostile(json).dump(-1, ' ', false, forceshade::Json::error_handler_t::replace));
    return 0;
}

#include "host/report/page.h"

#include <span>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/reading.h"
#include "host/picture/colours.h"
#include "host/report/base64.h"
#include "host/report/words.h"
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

} // namespace

bool is_page(const std::filesystem::path& path) {
    try {
        std::string beginning(4096, '\0');
        beginning.resize(ReadableFile(path).read_some(0, std::as_writable_bytes(std::span(beginning))));
        return beginning.find(kGenerator) != std::string::npos;
    } catch (const IoError&) {
        return false;
    }
}

std::string page_script(bool in_space) {
    std::string text = fmt::format("const KNOWN_SERIES = {};\n", picture::known_series_json());
    for (const std::string_view part :
         {assets::d3_js, assets::colours_js, assets::figures_js, assets::studies_js, assets::device_js})
        text += part;
    if (in_space)
        for (const std::string_view part : {assets::three_js, assets::orbit_js})
            text += part;
    for (const std::string_view part : {assets::volume_js, assets::pane_js, assets::solids_js, assets::space_js,
                                        assets::viewer_js, assets::controls_js, assets::start_js})
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

} // namespace forceshade::report

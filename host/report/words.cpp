#include "host/report/words.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>

#include "host/picture/canvas.h"
#include "host/picture/ticks.h"

namespace forceshade::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool is_no_character(std::string_view sequence) {
    if (sequence.size() == 1)
        return static_cast<std::uint8_t>(sequence[0]) < 0x20 && sequence != "\t" && sequence != "\n" &&
               sequence != "\r";
    return sequence == "\xEF\xBF\xBE" || sequence == "\xEF\xBF\xBF";
}

std::string_view entity(char c) {
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\'':
        return "&#39;";
    default:
        return {};
    }
}

} // namespace

std::string escaped(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = picture::character_length(text);
        const std::string_view sequence = text.substr(0, length ? length : 1);
        if (length == 0 || is_no_character(sequence))
            result += kReplacement;
        else if (const std::string_view replaced = entity(sequence[0]); !replaced.empty())
            result += replaced;
        else
            result += sequence;
        text.remove_prefix(sequence.size());
    }
    return result;
}

std::string count_text(std::uint64_t count) {
    std::string text = fmt::format("{}", count);
    for (std::size_t i = text.size(); i > 3;) {
        i -= 3;
        text.insert(i, "\u00a0");
    }
    return text;
}

std::string duration_text(double seconds) {
    if (!(seconds >= 0) || seconds > 1e9)
        return "an unknown time";
    if (seconds < 60)
        return picture::trimmed(seconds, seconds < 10 ? 1 : 0) + " s";
    const auto whole = static_cast<std::uint64_t>(std::lround(seconds));
    if (whole < 3600)
        return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string size_text(std::uint64_t bytes) {
    static constexpr std::array<const char*, 4> kUnits{"B", "KiB", "MiB", "GiB"};
    double size = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; size >= 1024 && unit + 1 < kUnits.size(); ++unit)
        size /= 1024;
    return fmt::format("{} {}", picture::trimmed(size, unit == 0 || size >= 100 ? 0 : 1), kUnits[unit]);
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

std::string number_text(double value, int digits) {
    if (value == 0)
        return "0";
    if (!std::isfinite(value))
        return "no number";
    const double rounded = std::stod(fmt::format("{:.{}e}", value, digits - 1));
    const int decimals = std::max(0, digits - 1 - picture::decade(std::fabs(rounded)));
    return picture::number_label(rounded, picture::needed_decimals(rounded, decimals));
}

std::string script_text(const nlohmann::ordered_json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace))
        text += c == '<' ? "\\u003c" : std::string(1, c);
    return text;
}

} // namespace forceshade::report

#include "host/report/words.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>

#include "host/picture/canvas.h"

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

std::string script_text(const nlohmann::ordered_json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace))
        text += c == '<' ? "\\u003c" : std::string(1, c);
    return text;
}

} // namespace forceshade::report

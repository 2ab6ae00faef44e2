#include "host/report/words.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/picture/quantity.h"
#include "host/plot/xml_text.h"

namespace forceshade::report {

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
                           std::string_view("-._~/").find(c) != std::string_view::npos;
        text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return text;
}

std::string link(std::string_view path, std::string_view text) {
    return fmt::format("<a href=\"{}\">{}</a>", address(path), plot::escaped(text));
}

} // namespace forceshade::report

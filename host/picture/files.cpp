#include "host/picture/files.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/output/files.h"

namespace forceshade::picture {

bool Endings::add(std::string_view name) {
    for (const auto& [known, wanted] : {std::pair("png", &png), {"svg", &svg}, {"pdf", &pdf}})
        if (name == known)
            return *wanted = true;
    return false;
}

std::vector<std::string> names_with(const std::string& stem, const Endings& endings) {
    std::vector<std::string> names;
    for (const auto& [wanted, ending] : {std::pair(endings.png, ".png"), {endings.svg, ".svg"}, {endings.pdf, ".pdf"}})
        if (wanted)
            names.push_back(stem + ending);
    return names;
}

std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture) {
    std::vector<FileRecord> records;
    for (const std::string& name : names_with(stem.filename().string(), endings)) {
        const std::string vectors = name.ends_with(".svg")   ? picture.drawing->svg()
                                    : name.ends_with(".pdf") ? picture.drawing->pdf()
                                                             : "";
        const auto bytes = vectors.empty() ? std::as_bytes(std::span(picture.png)) : std::as_bytes(std::span(vectors));
        write_file_atomically(stem.parent_path() / name, bytes);
        records.push_back({name, sha256_of(bytes), bytes.size()});
    }
    return records;
}

void read_size(const std::string& text, Look& look) {
    constexpr int kLeast = 400, kMost = 8000; // pixels
    const std::size_t x = text.find('x');
    const auto number = [&](std::string_view digits) {
        int value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size() || value < kLeast || value > kMost)
            throw UsageError(fmt::format("--size {}: write a width in pixels, or WIDTHxHEIGHT, each from {} to {}",
                                         text, kLeast, kMost));
        return value;
    };
    look.width = number(std::string_view(text).substr(0, x));
    look.most_height = x == std::string::npos ? 0 : number(std::string_view(text).substr(x + 1));
}

void refuse_unused(const Endings& endings, bool as_by_default) {
    if (!endings.any() && !as_by_default)
        throw UsageError("there is no picture to draw so: add --also png, svg or pdf");
}

Quantity quantity_named(const std::string& name) {
    const auto found = std::ranges::find(kQuantityNames, name);
    if (found == kQuantityNames.end())
        throw UsageError(fmt::format("--quantity {}: there are {}", name, fmt::join(kQuantityNames, ", ")));
    return static_cast<Quantity>(found - kQuantityNames.begin());
}

} // namespace forceshade::picture

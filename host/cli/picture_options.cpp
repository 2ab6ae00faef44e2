#include "host/cli/picture_options.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/scene/quantity.h"

namespace forceshade {

namespace {

// "1200" or "1200x800".
void read_size(const std::string& text, picture::Look& look) {
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

} // namespace

void describe_look(Options& options, picture::Look& look) {
    options.optional("--title TEXT", look.title, "of the pictures; by default what they show, in words");
    options.read(
        "--size PIXELS", [&look](const std::string& text) { read_size(text, look); },
        "of the pictures in pixels: a width, or WIDTHxHEIGHT; by default 1400, as high as they need");
}

void refuse_unused(const picture::Endings& endings, bool as_by_default) {
    if (!endings.any() && !as_by_default)
        throw UsageError("these options need a picture: add --also png, svg or pdf");
}

picture::Quantity quantity_named(const std::string& name) {
    const auto found = std::ranges::find(picture::kQuantityNames, name);
    if (found == picture::kQuantityNames.end())
        throw UsageError(fmt::format("--quantity {}: there are {}", name, fmt::join(picture::kQuantityNames, ", ")));
    return static_cast<picture::Quantity>(found - picture::kQuantityNames.begin());
}

void read_slice(const std::string& text, const GridSpec& grid, picture::SliceChoice& slice) {
    const auto axis = std::string_view("xyz").find(text.front());
    if (axis == std::string_view::npos || (text.size() > 1 && text[1] != '='))
        throw UsageError(fmt::format("--slice {}: write x, y or z, or as in \"y=2 mm\" where", text));
    slice.axis = axis;
    if (text.size() == 1)
        return;
    slice.at = parse_quantity(text.substr(2), Dimension::length);
    const double low = grid.origin[axis], high = low + grid.spacing[axis] * static_cast<double>(grid.size[axis] - 1);
    if (const double border = grid.spacing[axis] / 2; !(*slice.at >= low - border && *slice.at <= high + border))
        throw UsageError(fmt::format("--slice {}: the grid goes from {} = {:.6g} mm to {:.6g} mm", text, text.front(),
                                     low * 1e3, high * 1e3));
}

} // namespace forceshade

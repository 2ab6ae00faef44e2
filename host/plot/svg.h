// SVG as text, element by element. Coordinates in px, y downwards.
#pragma once

#include <string>
#include <string_view>

namespace forceshade::plot {

/// "12.3", never with an exponent, a decimal comma or a negative zero.
std::string px(double value);

struct Box {
    double x = 0, y = 0, width = 0, height = 0;
    double right() const { return x + width; }
    double bottom() const { return y + height; }
};

/// True if the boxes have a point in common.
bool overlap(const Box& a, const Box& b);

enum class Anchor { start, middle, end };

struct TextStyle {
    std::string_view classes = "t";
    Anchor anchor = Anchor::start;
    double size = 12;  /* px */
    double rotate = 0; /* degrees clockwise about the text's point */
};

class Svg {
public:
    void line(double x1, double y1, double x2, double y2, std::string_view classes);
    /// Filled and stroked as its classes say; `tooltip` unescaped, empty for none.
    void rect(const Box& box, std::string_view classes, std::string_view tooltip = {}, std::string_view extra = {});
    void path(std::string_view d, std::string_view classes, std::string_view tooltip = {}, std::string_view extra = {});
    /// The point is on the baseline.
    void text(double x, double y, std::string_view text, const TextStyle& style = {});
    /// As it is.
    void raw(std::string_view markup) { body_ += markup; }

    const std::string& body() const { return body_; }

private:
    void close(std::string_view element, std::string_view tooltip);

    std::string body_;
};

} // namespace forceshade::plot

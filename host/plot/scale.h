// From numbers to places along an axis, and its ticks. Words are the whole numbers 0, 1, ...
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace forceshade::plot {

struct Tick {
    double value = 0;
    std::string label; /* empty: a small tick without one */
};

/// A number for readers: "0.25", "−3", "1.5×10⁻⁷" (up to `digits` significant digits).
std::string number_label(double value, int digits = 4);

/// The range that a set of numbers needs: a little more than it, from zero on where that is near, never empty. Numbers
/// that a logarithmic axis has no place for are left out.
struct Range {
    double low = 0, high = 1;
};
Range range_of(const std::vector<double>& values, bool logarithmic);

class Scale {
public:
    Scale() = default;
    /// high > low, and low > 0 where logarithmic.
    Scale(Range range, bool logarithmic) : range_(range), logarithmic_(logarithmic) {}
    /// A place for each word, in this order.
    explicit Scale(std::vector<std::string> words);

    void place(double first, double last) { first_ = first, last_ = last; } /* px of low and high */
    bool has(double value) const { return !logarithmic_ || value > 0; }
    /// px; beyond the axis for numbers beyond the range. The number must have a place.
    double at(double value) const;
    /// Where the number lies between low (0) and high (1).
    double fraction(double value) const;
    double value_at(double fraction) const;

    /// About `most` labels at round numbers; all words.
    std::vector<Tick> ticks(std::size_t most) const;

    const Range& range() const { return range_; }
    bool logarithmic() const { return logarithmic_; }
    bool of_words() const { return !words_.empty(); }

private:
    std::vector<Tick> decade_ticks(int first, int last, std::size_t most) const;
    std::vector<Tick> ticks_within_decades(int first, int last) const;
    std::vector<Tick> round_ticks(std::size_t most) const;

    Range range_;
    bool logarithmic_ = false;
    std::vector<std::string> words_;
    double first_ = 0, last_ = 1;
};

} // namespace forceshade::plot

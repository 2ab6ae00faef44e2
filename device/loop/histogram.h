// How often a time occurred, counted as it passes: bins at most a thirty-second of their own value wide.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace forceshade::device {

/// Of times in ns, from 0 on. Adding neither allocates nor fails; 15 KiB.
class Histogram {
public:
    static constexpr unsigned kFine = 5; // bits below the leading one that a bin tells apart
    static constexpr std::size_t kBins = (64 - kFine + 1) << kFine;

    void add(std::int64_t time) noexcept {
        const std::uint64_t value = time > 0 ? static_cast<std::uint64_t>(time) : 0;
        ++bins_[bin_of(value)];
        ++count_;
        sum_ += static_cast<double>(value);
        largest_ = value > largest_ ? value : largest_;
    }

    std::uint64_t count() const noexcept { return count_; }
    std::uint64_t largest() const noexcept { return largest_; }                                  /* ns */
    double mean() const noexcept { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; } /* ns */

    /// The least upper end of a bin, ns, that this share of the times does not exceed; never more than the largest.
    double quantile(double share) const noexcept {
        const double wanted = share * static_cast<double>(count_);
        std::uint64_t seen = 0;
        for (std::size_t bin = 0; bin < kBins; ++bin) {
            seen += bins_[bin];
            if (bins_[bin] > 0 && static_cast<double>(seen) >= wanted) {
                const auto end = static_cast<double>(begin_of(bin + 1));
                return end < static_cast<double>(largest_) ? end : static_cast<double>(largest_);
            }
        }
        return 0;
    }

    std::uint64_t bin(std::size_t index) const noexcept { return bins_[index]; }

    /// The least value, ns, of a bin, of which the last one's end is 2^64.
    static constexpr std::uint64_t begin_of(std::size_t bin) noexcept {
        if (bin < (std::size_t(2) << kFine))
            return bin;
        const std::size_t power = (bin >> kFine) - 1;
        if (power >= 64 - kFine)
            return ~std::uint64_t(0);
        return ((std::uint64_t(1) << kFine) + (bin & ((std::size_t(1) << kFine) - 1))) << power;
    }

    static constexpr std::size_t bin_of(std::uint64_t value) noexcept {
        if (value < (std::uint64_t(1) << kFine))
            return static_cast<std::size_t>(value);
        const auto power = static_cast<unsigned>(std::bit_width(value)) - 1 - kFine;
        return (std::size_t(power + 1) << kFine) + ((value >> power) & ((std::uint64_t(1) << kFine) - 1));
    }

private:
    std::array<std::uint64_t, kBins> bins_{};
    std::uint64_t count_ = 0, largest_ = 0;
    double sum_ = 0;
};

} // namespace forceshade::device

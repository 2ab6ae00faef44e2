#include "compute/groups.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace forceshade::compute {
namespace {

constexpr int kTriesOfSize = 3;

struct Kept {
    std::uint64_t kernel;
    std::uint32_t size, zero;
};

} // namespace

GroupSizes::GroupSizes(std::uint32_t most, double after, std::span<const std::byte> kept) : most_(most), after_(after) {
    for (std::size_t at = 0; at + sizeof(Kept) <= kept.size(); at += sizeof(Kept)) {
        Kept one{};
        std::memcpy(&one, kept.data() + at, sizeof(one));
        if (one.size <= most && std::ranges::find(kGroups, one.size) != kGroups.end())
            trials_[one.kernel].chosen = one.size;
    }
}

std::size_t GroupSizes::sizes() const {
    return static_cast<std::size_t>(std::ranges::upper_bound(kGroups, most_) - kGroups.begin());
}

std::uint32_t GroupSizes::usual(std::uint64_t kernel, std::uint32_t wanted) const {
    const auto found = trials_.find(kernel);
    return found != trials_.end() && found->second.chosen != 0 ? found->second.chosen : std::min(wanted, most_);
}

std::uint32_t GroupSizes::next(std::uint64_t kernel, std::uint32_t wanted) {
    if (!std::isfinite(after_) || sizes() < 2)
        return std::min(wanted, most_);
    Trial& trial = trials_[kernel];
    return trial.chosen != 0 || trial.spent < after_ ? usual(kernel, wanted) : kGroups[trial.turn++ % sizes()];
}

void GroupSizes::add(std::uint64_t kernel, std::uint32_t size, std::uint64_t work, double seconds) {
    const auto found = trials_.find(kernel);
    if (found == trials_.end() || found->second.chosen != 0 || work == 0)
        return;
    Trial& trial = found->second;
    const bool begun = trial.spent >= after_;
    trial.spent += seconds;
    if (work > 2 * trial.most) { // smaller dispatches say nothing of larger ones
        trial.tried = {};
        trial.most = work;
    }
    const auto which = static_cast<std::size_t>(std::ranges::find(kGroups, size) - kGroups.begin());
    if (!begun || which >= sizes() || 2 * work < trial.most)
        return;
    const double unit = seconds / static_cast<double>(work);
    trial.fastest[which] = trial.tried[which]++ == 0 ? unit : std::min(trial.fastest[which], unit);
    choose(trial);
}

void GroupSizes::choose(Trial& trial) const {
    const auto tried = std::span(trial.tried).first(sizes());
    const auto fastest = std::span(trial.fastest).first(sizes());
    if (std::ranges::all_of(tried, [](int times) { return times >= kTriesOfSize; }))
        trial.chosen = kGroups[static_cast<std::size_t>(std::ranges::min_element(fastest) - fastest.begin())];
}

std::vector<std::byte> GroupSizes::kept() const {
    std::vector<Kept> all;
    for (const auto& [kernel, trial] : trials_)
        if (trial.chosen != 0)
            all.push_back({kernel, trial.chosen, 0});
    const auto bytes = std::as_bytes(std::span(all));
    return {bytes.begin(), bytes.end()};
}

} // namespace forceshade::compute

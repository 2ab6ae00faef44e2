#include "host/study/stability/loop_map_findings.h"

#include <fmt/format.h>

namespace forceshade::study {
namespace {

struct Count {
    std::size_t all = 0, right = 0;
    double percent() const { return 100.0 * static_cast<double>(right) / static_cast<double>(all); }
};

// Loops with rounding and no delay whose K is passive by its damping.
struct Rounded {
    Count held;    /* friction is enough, and they come to rest */
    Count chatter; /* it is not, and they do not */
};

Rounded rounded_loops(const Table& maps, bool on_plane) {
    Rounded rounded;
    for (std::size_t row = 0; row < maps.rows.size(); ++row) {
        const auto number = [&](const char* column) { return maps.number(row, column).value_or(0); };
        const double quantum = 1e-6 * number("quantum_um"), stiffness = number("stiffness_N_per_m");
        const bool passive = stiffness <= 2 * number("damping_N_s_per_m") * number("rate_Hz");
        if ((maps.word(row, "surface") == "plane") != on_plane || !(quantum > 0) || number("delay_ms") > 0 || !passive)
            continue;
        const bool stable = maps.word(row, "state") == "stable",
                   enough = stiffness <= 2 * number("friction_N") / quantum;
        Count& count = enough ? rounded.held : rounded.chatter;
        ++count.all;
        count.right += stable == enough;
    }
    return rounded;
}

} // namespace

std::string friction_finding(const Table& maps) {
    const auto [held, chatter] = rounded_loops(maps, true);
    if (held.all == 0 || chatter.all == 0)
        return "";
    const bool all = held.right == held.all;
    std::string text = fmt::format(
        "With rounded positions, {} of {} loops on the plane within K <= min(2 b / T, 2 f_c / quantum) come to rest{}; "
        "where friction is less than that and damping is not, {:.3g} % of {} chatter on",
        all ? "all" : fmt::format("{}", held.right), held.all,
        all ? "" : ", so that the condition does not hold for all", chatter.percent(), chatter.all);
    const Count others = rounded_loops(maps, false).held;
    if (others.all > 0)
        text += others.right == others.all
                    ? fmt::format("; so do all of {} within it on other surfaces come to rest", others.all)
                    : fmt::format("; on other surfaces it is no promise: {} of {} within it do not come to rest",
                                  others.all - others.right, others.all);
    return text + ".";
}

} // namespace forceshade::study

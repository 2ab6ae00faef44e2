#include "device/session/open_device.h"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "device/dhd/dhd.h"
#include "device/haply/haply.h"
#include "device/hd/hd.h"
#include "device/loop/live_loop.h"
#include "device/replay/replay.h"
#include "device/sim/sim.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/scene/nearest.h"

namespace forceshade::device {
namespace {

constexpr double kUsualRate = 1000; /* Hz */

// The rate of a recording, as far as clocks and rounding leave it: samples at 10 kHz may lie 99.9 us apart.
double rounded_rate(double recorded) {
    constexpr double kOff = 0.02;
    for (const double end : {kSlowestRate, kFastestRate})
        if (std::abs(recorded - end) <= kOff * end)
            return end;
    return recorded;
}

OpenDevice open_sim(const PreparedCase& prepared, std::optional<double> rate, double ramp) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    const double chosen = rate ? *rate : paths ? paths->rate : kUsualRate;
    constexpr double kMost = 1e9; // samples
    const double still = ramp > 0 ? std::min(std::ceil(ramp * chosen) + 1, kMost) : 0;
    return {make_sim(prepared, chosen, static_cast<std::uint64_t>(still)), chosen};
}

OpenDevice open_replay(std::string_view file) {
    if (file.empty())
        throw UsageError("--device replay: which file? replay:FILE.csv");
    OpenDevice open{make_replay(std::string(file)), kUsualRate};
    if (const double recorded = rate_of(*open.back_end); recorded > 0)
        open.rate = rounded_rate(recorded);
    open.warning = warning_of(*open.back_end);
    return open;
}

} // namespace

OpenDevice open_device(const std::string& name, const PreparedCase& prepared, std::optional<double> rate, double ramp) {
    const std::size_t colon = name.find(':');
    const std::string_view kind = std::string_view(name).substr(0, colon);
    const std::string_view further =
        colon == std::string::npos ? std::string_view() : std::string_view(name).substr(colon + 1);
    if (kind == "sim" && colon == std::string::npos)
        return open_sim(prepared, rate, ramp);
    if (kind == "replay")
        return open_replay(further);
    if (kind == "haply")
        return {open_haply(parse_haply(further)), kUsualRate};
    if (kind == "dhd")
        return {open_dhd(further), kUsualRate};
    if (kind == "hd")
        return {open_hd(further), kUsualRate};
    const std::array<std::string, 5> kinds{"sim", "replay", "haply", "dhd", "hd"};
    if (kind == "sim")
        throw UsageError(fmt::format("--device {}: sim takes nothing further", name));
    throw UsageError(fmt::format("--device {}: there are {}{}", name, kDeviceNames, did_you_mean(kind, kinds)));
}

} // namespace forceshade::device

#include "host/record/path_record.h"

#include <fmt/format.h>

namespace forceshade {

double PathRecord::steps_per_second() const {
    const double seconds = engine_times.upload + engine_times.kernel + engine_times.read_back;
    return seconds > 0 ? double(samples) / seconds : 0;
}

std::string complaint(const PathRecord& record, const std::string& name, const std::string& device) {
    if (!record.error.passed())
        return fmt::format("{}: {} of {} samples and the metrics of {} of {} paths compared are further from the CPU "
                           "oracle than rounding allows on {} ({}); it is not to be trusted (forceshade validate tells "
                           "more)",
                           name, record.error.beyond, record.error.samples, record.error.metrics, record.error.paths,
                           device, record.error.first);
    if (record.unfinished > 0)
        return fmt::format("{}: at {} of {} samples the proxy did not come to rest within its limit of steps; their "
                           "forces are not to be trusted",
                           name, record.unfinished, record.samples);
    return {};
}

} // namespace forceshade

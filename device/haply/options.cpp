#include <fmt/format.h>

#include "device/haply/address.h"
#include "device/haply/haply.h"

namespace forceshade::device {
namespace {

void set(HaplyOptions& options, std::string_view key, std::string_view value) {
    using Dialect = HaplyOptions::Dialect;
    if (value.empty())
        throw UsageError(fmt::format("haply: '{}' has no value: ?device=04BA&dialect=values", key));
    if (key == "device")
        options.device_id = value;
    else if (key == "dialect" && value == "vector")
        options.dialect = Dialect::vector;
    else if (key == "dialect" && value == "values")
        options.dialect = Dialect::values;
    else if (key == "dialect")
        throw UsageError(fmt::format("haply: the dialect is vector or values, not '{}'", value));
    else
        throw UsageError(fmt::format("haply: unknown option '{}': there are device and dialect", key));
}

} // namespace

HaplyOptions parse_haply(std::string_view after_colon) {
    HaplyOptions options;
    const std::size_t mark = after_colon.find('?');
    const std::string_view url = after_colon.substr(0, mark);
    if (!url.empty())
        options.url = url;
    parse_address(options.url); // to complain now
    if (mark == std::string_view::npos)
        return options;
    std::string_view query = after_colon.substr(mark + 1);
    while (true) {
        const std::size_t end = query.find('&');
        const std::string_view pair = query.substr(0, end);
        const std::size_t equals = pair.find('=');
        set(options, pair.substr(0, equals), equals == std::string_view::npos ? "" : pair.substr(equals + 1));
        if (end == std::string_view::npos)
            return options;
        query = query.substr(end + 1);
    }
}

} // namespace forceshade::device

#include "host/scene/location.h"

#include "host/error.h"

#include <fmt/format.h>

namespace forceshade {

std::string location_prefix(std::string_view source, Location location) {
    return location.line == 0 ? fmt::format("{}: ", source)
                              : fmt::format("{}:{}:{}: ", source, location.line, location.column);
}

void fail(std::string_view source, Location location, const std::string& message) {
    throw UsageError(location_prefix(source, location) + message);
}

} // namespace forceshade

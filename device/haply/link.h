// The thread that talks to the service: connects, keeps the lock-step of commands and answers, reconnects.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "device/haply/address.h"
#include "device/haply/exchange.h"
#include "device/haply/haply.h"

namespace forceshade::device {

struct LinkOptions {
    Address address;
    std::string device_id;
    HaplyOptions::Dialect dialect = HaplyOptions::Dialect::vector; // not by_version
    std::chrono::milliseconds wait{3000};                          // for the service to take up a connection
    std::chrono::milliseconds patience{100};                       // for an answer, after which it counts as lost
};

/// Talks until `exchange.stopping`; then takes leave within 200 ms, with a last command without force. Throws nothing.
void run_link(Exchange& exchange, const LinkOptions& options) noexcept;

} // namespace forceshade::device

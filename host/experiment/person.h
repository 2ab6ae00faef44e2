// A person at a device: the live loop, a page that asks for the answer, a page for the operator.
#pragma once

#include <cstdint>
#include <memory>

#include "device/session/session.h"
#include "host/experiment/run.h"

namespace forceshade::experiment {

struct PersonOptions {
    device::SessionOptions session; /* device, origin, rate and limits; the rest is not used */
    std::uint16_t port = 0;         /* of the pages; 0: any that is free */
};

/// Opens the device and serves the pages, whose addresses go to stderr. The force is zero but for the time in which a
/// stimulus is felt: it comes up once the probe is free of contact, and is switched off when the page is closed.
/// \throws UsageError, IoError, DeviceAbsent.
std::unique_ptr<Participant> make_person(const Experiment& experiment, const PersonOptions& options);

} // namespace forceshade::experiment

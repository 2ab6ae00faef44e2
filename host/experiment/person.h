// A person at a device: the live loop, a page that asks for the answer, a page for the operator.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device/session/session.h"
#include "host/experiment/run.h"

namespace forceshade::experiment {

struct PersonOptions {
    device::SessionOptions session; /* device, mapping, rate and limits; the rest is not used */
    std::uint16_t port = 0;         /* of the pages; 0: any that is free */
    std::vector<unsigned> buttons;  /* of the device, one for each answer; empty: answers are the page's keys alone */
    std::string check;              /* of the device, JSON as device::check_json; empty: none was made */
};

/// Opens the device and serves the pages, whose addresses go to stderr. The force is zero but for the time in which a
/// stimulus is felt: it comes up once the probe is free of contact, and is switched off when the page is closed.
/// \throws UsageError, IoError, DeviceAbsent; UsageError for a check of another device or mapping, Error for one that
/// failed.
std::unique_ptr<Participant> make_person(const Experiment& experiment, const PersonOptions& options);

} // namespace forceshade::experiment

// Vulkan devices: the list, why one is refused, and the one that is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "compute/float_controls.h"

namespace forceshade::compute {

/// What went wrong on or with a device, in words for the user.
class DeviceError : public std::runtime_error {
public:
    enum class Kind { no_such_device, out_of_memory, device_lost, unfinished, unsupported, differs_in_parts };
    DeviceError(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    Kind kind() const noexcept { return kind_; }

private:
    Kind kind_;
};

/// A device as the driver describes it.
struct DeviceReport {
    std::uint32_t index = 0; /* as listed, from 0 */
    std::string name;
    std::string uuid;   /* 32 hex digits */
    std::string type;   /* "software", "integrated", "discrete", "virtual" or "other" */
    std::string driver; /* name and version */
    std::string api;    /* Vulkan version, "1.3.230" */
    bool software = false;
    bool f64 = false;                    /* double precision in kernels */
    bool int64 = false;                  /* 64-bit integers in kernels: stores travel in pairs */
    FloatControls single{}, twice{};     /* kernels ask for these of floats and of doubles */
    bool nearest = false;                /* its quotients and roots of floats are the nearest: software's are */
    std::uint64_t memory = 0;            /* bytes of the largest device-local heap */
    std::uint64_t buffer_range = 0;      /* bytes that one storage buffer may span */
    std::uint32_t group_invocations = 0; /* most of a work group */
    std::uint32_t group_count = 0;       /* most work groups of a dispatch */
    std::uint32_t subgroup = 0;          /* invocations; informative, not assumed */
    std::vector<std::string> refusals;   /* why this device cannot run the kernels; empty if it can */
};

/// Every Vulkan device and, for each, why it cannot be used. Empty if the loader finds none.
/// \throws DeviceError (no_such_device) without a Vulkan loader.
std::vector<DeviceReport> list_devices();

/// False if this machine offers no graphics hardware to programs, so that list_devices could find software devices
/// alone; takes no time.
bool may_have_hardware();

/// Picks a device from a list. `wanted` is a part of the name (any case), a UUID, an index, or empty: then the first
/// discrete device that is not refused, else the first integrated one, then other hardware, then a software device.
/// `needs_f64` refuses devices without double precision. \throws DeviceError (no_such_device) with the list and the
/// reasons.
const DeviceReport& choose_device(const std::vector<DeviceReport>& devices, const std::string& wanted, bool needs_f64);

struct DeviceOptions {
    std::string wanted; /* as in choose_device */
    bool needs_f64 = false;
    bool through_double = false;         /* kernels as for a device whose quotients and roots of floats may be off */
    bool validation = false;             /* core, synchronization, best practices; messages in validation_messages() */
    bool gpu_assisted = false;           /* with validation: accesses of kernels are checked, too, which is slow */
    std::span<const std::byte> cache;    /* of an earlier run on this device; ignored where it does not fit */
    double try_groups_after = 0.25;      /* s of a kernel: from then on it tries sizes of work groups (groups.h) */
    bool try_groups_on_software = false; /* where they run alike */
};

/// A device, open, with one compute queue.
class Device {
public:
    explicit Device(const DeviceOptions& options = {});
    ~Device();
    Device(Device&&) noexcept;
    Device& operator=(Device&&) noexcept;

    const DeviceReport& report() const;
    /// The messages of the validation layers so far; empty unless asked for.
    std::vector<std::string> validation_messages() const;
    /// What a later run on this device need not find again: pipelines, and sizes of work groups.
    std::vector<std::byte> cache() const;

    struct Implementation;
    Implementation& implementation() { return *implementation_; }

private:
    std::unique_ptr<Implementation> implementation_;
};

} // namespace forceshade::compute

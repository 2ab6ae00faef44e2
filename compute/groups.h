// Sizes of work groups. No result depends on them, so that a kernel's own dispatches try them out on a device.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace forceshade::compute {

inline constexpr std::array<std::uint32_t, 4> kGroups{32, 64, 128, 256}; /* invocations */

/// What the kernels of a device take. Once a kernel has run for long enough that it matters, its dispatches take the
/// sizes in turn; after some of each, the size of the fastest one stays.
class GroupSizes {
public:
    GroupSizes() = default;
    /// Sizes up to `most`; they are tried after `after` s of a kernel's time, not finite: never. `kept`: what another
    /// process found on this device (below); ignored where it is none.
    GroupSizes(std::uint32_t most, double after, std::span<const std::byte> kept);

    /// Of a kernel that takes `wanted` as long as nothing better is known.
    std::uint32_t usual(std::uint64_t kernel, std::uint32_t wanted) const;
    /// The same of its next dispatch, by which a size may be tried.
    std::uint32_t next(std::uint64_t kernel, std::uint32_t wanted);
    /// What a dispatch of `work` units took, s.
    void add(std::uint64_t kernel, std::uint32_t size, std::uint64_t work, double seconds);

    /// The sizes that were found.
    std::vector<std::byte> kept() const;

private:
    struct Trial {
        double spent = 0;         // s
        std::uint64_t turn = 0;   // of the sizes
        std::uint64_t most = 0;   // work of a dispatch
        std::uint32_t chosen = 0; // 0: not yet
        std::array<int, kGroups.size()> tried{};
        std::array<double, kGroups.size()> fastest{}; // s a unit of work
    };
    void choose(Trial& trial) const;
    std::size_t sizes() const; // of kGroups, up to the most

    std::uint32_t most_ = kGroups.front();
    double after_ = 0; // s
    std::map<std::uint64_t, Trial> trials_;
};

} // namespace forceshade::compute

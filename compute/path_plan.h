// How many steps of paths one dispatch takes. Arithmetic only: no device is touched.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// What a step of a path asks of a kernel.
struct StepWork {
    std::uint64_t iterations = 1; /* most that its loops go round in a step, the loop over steps included */
    std::uint64_t cost = 1;       /* in the time of an open-loop step over a bump */
    std::uint64_t bytes = 0;      /* that a sample takes in all buffers of a dispatch */
};

/// The work of a step over an analytic surface; `facets` of a bump, `real_size` in bytes.
StepWork step_work(const layout::Features& law, const layout::PathFeatures& features, std::uint64_t facets,
                   std::size_t real_size);

/// Bytes that one sample takes in the channels, layout::kChannel...
std::uint64_t path_sample_bytes(layout::uint channels, std::size_t real_size);

/// Steps of one dispatch over so many paths, at least 1: no more than a driver lets a loop go round, than a slow device
/// takes within about a second, or than fit into `chunk_bytes`.
std::uint32_t steps_of_dispatch(const StepWork& work, std::uint64_t paths, std::uint64_t steps,
                                std::uint64_t chunk_bytes);

} // namespace forceshade::compute

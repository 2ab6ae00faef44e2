// A scene's forces sampled over a volume.
#pragma once

#include <vector>

#include "host/prepare/prepared_case.h"
#include "host/study/error_time/volume.h"

namespace forceshade::study::error_time {

/// What stands at a volume's samples.
template <typename T> struct Sampled {
    std::vector<T> forces;            /* N, 3 a sample */
    std::vector<layout::uint> facets; /* id, layout::kNoFacet out of contact */
};

/// By the CPU oracle on all cores.
template <typename T> Sampled<T> sampled(const PreparedCase& prepared, const VolumeGrid& grid);

extern template Sampled<float> sampled<float>(const PreparedCase&, const VolumeGrid&);
extern template Sampled<double> sampled<double>(const PreparedCase&, const VolumeGrid&);

} // namespace forceshade::study::error_time

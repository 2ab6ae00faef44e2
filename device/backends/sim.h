// A hand that holds a device, stepped exactly (laws: sampled stability), in place of real ones.
#pragma once

#include <cstdint>
#include <memory>

#include "device/backends/back_end.h"

namespace forceshade {
struct PreparedCase;
}

namespace forceshade::device {

/// The closed loop of host/reference/path_step.h in double precision: the hand follows path 0 of the scene's [paths],
/// and each force written takes it one sample on. A scene without paths: strokes across the feature, pressing 1 N, at
/// 100 mm/s; one whose paths are open: as closed. A recorded path is followed to its end, where the hand rests. A
/// hand that loses its path by more than `paths.bound`, having fallen off a mesh or been thrown off, begins again.
/// `rate`, Hz: samples a second, in place of the scene's. `still`: samples for which the hand holds still when it
/// begins, while the force may come up. \throws UsageError, IoError as ScenePaths.
std::unique_ptr<BackEnd> make_sim(PreparedCase prepared, double rate, std::uint64_t still = 0);

} // namespace forceshade::device

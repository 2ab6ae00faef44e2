// The table of L7 and the orders that go with it, by this program.
#pragma once

#include "host/study/error_time/measured.h"

namespace forceshade::study::error_time {

/// Names of shadings in the table's order.
inline constexpr const char* kPatchShadings[] = {"none", "morgenbesser", "barycentric", "mean_value"};

/// The table's meshes, one after the other; all their shadings.
std::size_t patch_meshes();
std::vector<PatchRow> patch_rows(std::size_t mesh);

/// RMS direction errors, deg, by shading, of the cylinder's patch of so many cells over |x|, |y| <= 3/8.
std::vector<double> patch_rms(unsigned cells);

} // namespace forceshade::study::error_time

// Generated paths that cannot be what the scene says at its rate.
#pragma once

#include <string>
#include <vector>

#include "host/paths/region.h"

namespace forceshade {

/// Which key, how many paths, and what would be right: paths that go half a round a sample or more, so that they seem
/// to go slower or back; paths so slow that whole phases of 2^-32 rounds (of a spiral also of its way out and back) a
/// sample miss their speed by more than a hundredth; frequencies of half the rate or more. Of more than 65 536 paths
/// the first so many are looked at.
std::vector<std::string> pace_warnings(const PathsSpec& paths, const PathRegion& region);

} // namespace forceshade

// Memory that a test frees stays with its program: fields of some MB are compared by the thousand, and pages that the
// system has to give and clear anew take longer than the comparison.
#include <malloc.h>

namespace {

constexpr int kMiB = 1 << 20; // bytes
[[maybe_unused]] const int kInHeap = ::mallopt(M_MMAP_THRESHOLD, 32 * kMiB);
[[maybe_unused]] const int kStays = ::mallopt(M_TRIM_THRESHOLD, 2047 * kMiB);
[[maybe_unused]] const int kGrowsBy = ::mallopt(M_TOP_PAD, 64 * kMiB);

} // namespace

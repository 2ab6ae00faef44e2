// Memory that a test frees stays with its program: fields of some MB are compared by the thousand, and pages that the
// system has to give and clear anew take longer than the comparison.
#include <malloc.h>

namespace {

constexpr int kMiB = 1 << 20; // bytes
[[maybe_unused]] const int kInHeap = ::mallopt(M_MMAP_THRESHOLD, 32 * kMiB);
[[maybe_unused]] const int kStays = ::mallopt(M_TRIM_THRESHOLD, 2047 * kMiB);
// Far less than what memory_test leaves: a heap that cannot grow by that much does not grow at all.
[[maybe_unused]] const int kGrowsBy = ::mallopt(M_TOP_PAD, 8 * kMiB);

} // namespace

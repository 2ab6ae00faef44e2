// Large blocks of memory in huge pages, where the system has them on request: a mesh of a million triangles fills some
// hundred MB, whose pages of 4 KiB take as long as the work on them.
#include <cstdlib>
#include <new>

#include <malloc.h>
#include <sys/mman.h>

namespace {

constexpr std::size_t kPage = 2u << 20; // bytes
// Blocks of a page or more have a mapping each, which ends when they are freed: in the heap they would leave gaps. What
// smaller ones free stays, up to 32 MiB, for the next ones.
[[maybe_unused]] const int kMapped = ::mallopt(M_MMAP_THRESHOLD, kPage);
[[maybe_unused]] const int kStays = ::mallopt(M_TRIM_THRESHOLD, 16 * kPage);

} // namespace

void* operator new(std::size_t size) {
    if (size < kPage) {
        if (void* block = std::malloc(size > 0 ? size : 1))
            return block;
        throw std::bad_alloc();
    }
    const std::size_t whole = (size + kPage - 1) / kPage * kPage;
    void* block = whole < size ? nullptr : std::aligned_alloc(kPage, whole);
    if (!block)
        throw std::bad_alloc();
    ::madvise(block, whole, MADV_HUGEPAGE); // which may be refused
    return block;
}

void operator delete(void* block) noexcept {
    std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}

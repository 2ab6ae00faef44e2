// Large blocks of memory in huge pages, where the system has them on request: a mesh of a million triangles fills some
// hundred MB, whose pages of 4 KiB take as long as the work on them.
#include <cstdlib>
#include <new>

#include <sys/mman.h>

void* operator new(std::size_t size) {
    constexpr std::size_t kLarge = 2u << 20, kPage = 2u << 20; // bytes
    if (size < kLarge) {
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

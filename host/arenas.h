// The allocator's arenas, for processes that lock their memory.
#pragma once

#include <malloc.h>

namespace forceshade {

/// Threads that begin from now on share few arenas: one of a thread's own maps 64 MB, which count as locked.
inline void share_arenas() noexcept {
    constexpr int kArenas = 2;
    ::mallopt(M_ARENA_MAX, kArenas);
}

} // namespace forceshade

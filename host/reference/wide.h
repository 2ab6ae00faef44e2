// Loops over several numbers at once, in a version for each kind of processor, of which the loader picks one: same
// operations, same bits. A FS_WIDE function has external linkage and is not a template; functions that it calls have to
// be FS_INLINE.
#pragma once

// GCC's alone; the sanitizers do not know what the loader does.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define FS_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FS_WIDE
#endif
#define FS_INLINE [[gnu::always_inline]] inline

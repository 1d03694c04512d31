#pragma once

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace vesalius {

/// Makes this process keep memory that it frees, so that the pictures of one frame reuse that of the previous frame.
/// Otherwise the C library returns up to 5 MB per frame to the system and requests it again. Programs that process many
/// frames call it once at their start. It has no effect if the C library is not glibc.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kMost = 512 * 1024 * 1024;
  mallopt(M_TRIM_THRESHOLD, kMost);
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);
#endif
}

}  // namespace vesalius

#pragma once

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace vesalius {

/// From now on this process keeps the memory that it frees: the pictures of one frame are those of the next, where else
/// the C library gives up to 5 MB a frame back to the system and asks for them anew. For programs that look at many
/// frames, once at their start; does nothing where the C library is not glibc.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kMost = 512 * 1024 * 1024;
  mallopt(M_TRIM_THRESHOLD, kMost);
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);
#endif
}

}  // namespace vesalius

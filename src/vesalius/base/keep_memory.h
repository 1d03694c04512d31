#pragma once

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace vesalius {

/// Makes this process keep the memory that it frees, so that the pictures of one frame use that of the frame before;
/// otherwise the C library gives up to 5 MB a frame back to the system and asks for it anew. Programs that look at many
/// frames call it once at their start. It does nothing where the C library is not glibc.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kMost = 512 * 1024 * 1024;
  mallopt(M_TRIM_THRESHOLD, kMost);
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);
#endif
}

}  // namespace vesalius

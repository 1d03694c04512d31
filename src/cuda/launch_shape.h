#pragma once

namespace vesalius::gpu {

/// How many threads run a kernel: `blocks_x` times `blocks_y` blocks.
struct LaunchShape {
  unsigned blocks_x = 1;
  unsigned blocks_y = 1;
  unsigned threads = 256;  ///< threads of a block
};

/// Returns how many blocks have room for so many threads: at least 1.
constexpr unsigned blocks_for(unsigned threads, unsigned of_block) {
  const unsigned blocks = (threads + of_block - 1) / of_block;
  return blocks > 0 ? blocks : 1;
}

/// Most threads of a block: what every card of the last fifteen years can do.
inline constexpr unsigned kMostThreads = 1024;
/// A warp: fewer would leave lanes idle.
inline constexpr unsigned kLeastThreads = 32;

}  // namespace vesalius::gpu

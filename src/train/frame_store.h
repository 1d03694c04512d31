#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "train/huge_buffer.h"
#include "vesalius/camera.h"
#include "vesalius/forest.h"
#include "vesalius/image.h"
#include "vesalius/tree_walk.h"

namespace vesalius {

/// Depth of many frames, of any sizes and cameras, in memory for random access: tiles of 8x4 pixels, 64 bytes, so that
/// the probes around a pixel touch few cache lines. Read from any thread; add from one.
class FrameStore {
 public:
  explicit FrameStore(const FeatureConvention& convention) : convention_(convention) {}

  /// One frame as the split search reads it. Pixel (u, v) is at
  /// tiles[((v >> 2) * tiles_per_row + (u >> 3)) * 32 + (v & 3) * 8 + (u & 7)].
  struct View {
    const std::uint16_t* tiles;  ///< aligned to 64 bytes; four bytes more than the tiles may be read
    std::int32_t width, height;  ///< pixels
    std::int32_t tiles_per_row;
    OffsetScaler scaler;

    std::uint16_t depth_mm(int u, int v) const {
      return tiles[(static_cast<std::size_t>(v >> 2) * static_cast<std::size_t>(tiles_per_row) +
                    static_cast<std::size_t>(u >> 3)) *
                       32 +
                   static_cast<std::size_t>((v & 3) * 8 + (u & 7))];
    }
  };

  /// Returns the frame's index. Throws Error for a depth image that is not of the camera's size or larger than 32767
  /// pixels a side.
  std::size_t add(const Camera& camera, const DepthImage& depth);

  std::size_t size() const { return views_.size(); }
  const View& operator[](std::size_t frame) const { return views_[frame]; }
  const FeatureConvention& convention() const { return convention_; }

  /// Bytes of depth held.
  std::size_t bytes() const { return bytes_; }
  /// Bytes that a frame of this size takes.
  static std::size_t frame_bytes(int width, int height);

 private:
  std::uint16_t* allocate(std::size_t bytes);

  FeatureConvention convention_;
  std::vector<HugeBuffer> blocks_;
  std::size_t used_ = 0;  ///< bytes of the last block
  std::vector<View> views_;
  std::size_t bytes_ = 0;
};

}  // namespace vesalius

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "train/depth_tiles.h"
#include "train/huge_buffer.h"
#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {

/// Holds the depth of many frames, of any sizes and cameras, packed in memory. Any thread may read; one thread at a
/// time may add, while no other reads.
class FrameStore {
 public:
  explicit FrameStore(const FeatureConvention& convention) : convention_(convention) {}

  /// One frame, of which any pixel can be read without unpacking the rest.
  struct View {
    PackedTiles depth;
    std::size_t bytes = 0;  ///< from depth.row_starts on
    OffsetScaler scaler;
  };

  /// Adds a frame and returns its index. Throws Error for a depth image that is not of the camera's size or has more
  /// than 32767 pixels a side.
  std::size_t add(const Camera& camera, const DepthImage& depth);

  std::size_t size() const { return views_.size(); }
  const View& operator[](std::size_t frame) const { return views_[frame]; }
  const FeatureConvention& convention() const { return convention_; }

  /// Bytes of depth held.
  std::size_t bytes() const { return bytes_; }
  /// Returns the bytes that a frame takes.
  static std::size_t frame_bytes(const DepthImage& depth);
  /// Returns the most bytes that a frame of this size takes, whatever it shows.
  static std::size_t most_frame_bytes(int width, int height);

 private:
  std::byte* allocate(std::size_t bytes);

  FeatureConvention convention_;
  std::vector<HugeBuffer> blocks_;
  std::size_t used_ = 0;  ///< bytes of the last block
  std::vector<View> views_;
  std::size_t bytes_ = 0;
};

/// One frame unpacked, as the split search reads it.
struct TiledDepth {
  TileGrid grid{};
  /// Readings as unpack_tiles leaves them, with holes as the convention has it. After the last tile stands what a probe
  /// outside the picture reads.
  const std::uint16_t* tiles = nullptr;
  OffsetScaler scaler;

  /// Returns the depth of a pixel inside the frame, a hole as the convention has it.
  std::uint16_t depth_mm(int u, int v) const {
    return tiles[grid.tile_of(u, v) * TileGrid::kPixels + TileGrid::in_tile(u, v)];
  }
};

/// Unpacks frames and keeps the last one, since samples come ordered by frame. Each thread has its own.
class FrameUnpacker {
 public:
  explicit FrameUnpacker(const FrameStore& frames) : frames_(frames) {}
  /// Returns a frame, which stays valid until another one is asked for.
  const TiledDepth& operator()(std::size_t frame);

 private:
  const FrameStore& frames_;
  std::size_t frame_ = 0;
  std::optional<TiledDepth> unpacked_;  ///< of `frame_`
  std::vector<std::uint16_t> tiles_;
};

}  // namespace vesalius

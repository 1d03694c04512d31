#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/samples/depth_tiles.h"
#include "train/samples/huge_buffer.h"
#include "vesalius/camera.h"
#include "vesalius/forest.h"
#include "vesalius/forest/tree_walk.h"
#include "vesalius/image.h"

namespace vesalius {

/// Holds the depth of many frames, of any sizes and cameras, packed in memory. Any thread may read; one thread at a
/// time may add, while no other reads.
class FrameStore {
 public:
  explicit FrameStore(const FeatureConvention& convention) : convention_(convention) {}

  /// A frame, any pixel of which can be read without unpacking the rest.
  struct View {
    PackedTiles depth;
    std::size_t bytes = 0;  ///< bytes from depth.row_starts on
    OffsetScaler scaler;
  };

  /// Adds a frame and returns its index. Throws Error if the depth image and the camera differ in size or a side has
  /// more than 32767 pixels.
  std::size_t add(const Camera& camera, const DepthImage& depth);
  /// Adds a frame by the words that pack_tiles made of its depth. Throws Error as `add` does.
  std::size_t add_packed(const Camera& camera, std::span<const std::uint32_t> words);

  /// A frame within a block of memory: its words begin at byte `at`, a multiple of 4.
  struct InBlock {
    Camera camera;
    std::size_t at = 0;
    std::size_t words = 0;
  };
  /// Takes a block with frames where they lie in it. Throws Error as `add` does, or if a frame is not in the block.
  void add_block(HugeBuffer block, std::span<const InBlock> frames);

  std::size_t size() const { return views_.size(); }
  const View& operator[](std::size_t frame) const { return views_[frame]; }
  const Camera& camera(std::size_t frame) const { return cameras_[frame]; }
  /// Returns the words that pack_tiles made of a frame's depth.
  std::span<const std::uint32_t> words(std::size_t frame) const {
    return {views_[frame].depth.row_starts, views_[frame].bytes / sizeof(std::uint32_t)};
  }
  const FeatureConvention& convention() const { return convention_; }

  /// Returns the memory of all depth in bytes.
  std::size_t bytes() const { return bytes_; }
  /// Returns the memory of a frame in bytes.
  static std::size_t frame_bytes(const DepthImage& depth);
  /// Returns the largest memory, in bytes, of any frame of this size.
  static std::size_t most_frame_bytes(int width, int height);

 private:
  std::byte* allocate(std::size_t bytes);
  void add_view(const Camera& camera, std::span<const std::uint32_t> words);

  FeatureConvention convention_;
  std::vector<HugeBuffer> blocks_;
  std::size_t used_ = 0;  ///< used bytes of the last block
  std::vector<View> views_;
  std::vector<Camera> cameras_;
  std::size_t bytes_ = 0;
};

/// An unpacked frame as the split search reads it.
struct TiledDepth {
  TileGrid grid{};
  /// The readings as unpack_tiles writes them, with holes as the convention says. After the last tile is the value of a
  /// probe outside the picture.
  const std::uint16_t* tiles = nullptr;
  OffsetScaler scaler;

  /// Returns the depth of a pixel inside the frame, or for a hole the convention's value.
  std::uint16_t depth_mm(int u, int v) const {
    return tiles[grid.tile_of(u, v) * TileGrid::kPixels + TileGrid::in_tile(u, v)];
  }
};

/// Unpacks frames and keeps the last one, since samples are ordered by frame. Each thread needs its own.
class FrameUnpacker {
 public:
  explicit FrameUnpacker(const FrameStore& frames) : frames_(frames) {}
  /// Returns a frame, which is valid until another one is requested.
  const TiledDepth& operator()(std::size_t frame);

 private:
  const FrameStore& frames_;
  std::size_t frame_ = 0;
  std::optional<TiledDepth> unpacked_;  ///< the unpacked `frame_`
  std::vector<std::uint16_t> tiles_;
};

/// Prefetches the next frame's depth, a few cache lines with every sample of the current frame, because unpacking it
/// would otherwise wait for memory. Results do not depend on it.
class FramePrefetcher {
 public:
  FramePrefetcher(const FrameStore& frames, std::span<const TrainingSample> samples);

  /// Prefetches; called before sample `index` is read. Indices increase by one.
  void step(std::size_t index);

 private:
  void enter_frame(std::size_t index);

  const FrameStore& frames_;
  std::span<const TrainingSample> samples_;
  std::size_t frame_end_ = 0;  ///< first sample of the next frame
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  std::size_t bytes_per_sample_ = 0;
};

}  // namespace vesalius

#include "train/frame_store.h"

#include <algorithm>
#include <string>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kTileWidth = 8, kTileHeight = 4;
constexpr std::size_t kTileBytes = 64;
constexpr std::size_t kBlockBytes = std::size_t{64} << 20U;
constexpr std::size_t kReadBeyond = 64;  ///< a gather reads four bytes for two
constexpr int kLargestSide = 32767;

std::size_t tiles_along(int pixels, int tile) { return static_cast<std::size_t>((pixels + tile - 1) / tile); }

}  // namespace

std::size_t FrameStore::frame_bytes(int width, int height) {
  return tiles_along(width, kTileWidth) * tiles_along(height, kTileHeight) * kTileBytes;
}

std::uint16_t* FrameStore::allocate(std::size_t bytes) {
  if (blocks_.empty() || used_ + bytes + kReadBeyond > blocks_.back().size()) {
    blocks_.emplace_back(std::max(kBlockBytes, bytes + kReadBeyond));
    used_ = 0;
  }
  std::byte* at = blocks_.back().data() + used_;
  used_ += bytes;
  bytes_ += bytes;
  return reinterpret_cast<std::uint16_t*>(at);
}

std::size_t FrameStore::add(const Camera& camera, const DepthImage& depth) {
  if (depth.width() != camera.width || depth.height() != camera.height) {
    throw Error("training: depth is " + std::to_string(depth.width()) + "x" + std::to_string(depth.height()) +
                ", its camera " + std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  if (depth.empty() || depth.width() > kLargestSide || depth.height() > kLargestSide) {
    throw Error("training: a frame has " + std::to_string(depth.width()) + "x" + std::to_string(depth.height()) +
                " pixels, expected 1 to " + std::to_string(kLargestSide) + " a side");
  }
  const auto per_row = static_cast<std::int32_t>(tiles_along(depth.width(), kTileWidth));
  std::uint16_t* tiles = allocate(frame_bytes(depth.width(), depth.height()));
  for (int v = 0; v < depth.height(); ++v) {
    const std::size_t row = static_cast<std::size_t>(v / kTileHeight) * static_cast<std::size_t>(per_row);
    for (int u = 0; u < depth.width(); ++u) {
      const std::size_t tile = row + static_cast<std::size_t>(u / kTileWidth);
      tiles[tile * kTileWidth * kTileHeight +
            static_cast<std::size_t>((v % kTileHeight) * kTileWidth + u % kTileWidth)] = depth(u, v);
    }
  }
  views_.push_back({tiles, depth.width(), depth.height(), per_row, OffsetScaler(convention_, camera)});
  return views_.size() - 1;
}

}  // namespace vesalius

#include "train/frame_store.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{64} << 20U;

std::size_t whole_lines(std::size_t bytes) { return (bytes + kLineBytes - 1) / kLineBytes * kLineBytes; }

}  // namespace

std::size_t FrameStore::frame_bytes(const DepthImage& depth) {
  return whole_lines(pack_tiles(depth).size() * sizeof(std::uint32_t));
}

std::size_t FrameStore::most_frame_bytes(int width, int height) {
  const TileGrid grid{width, height};
  const std::size_t headers = grid.rows() + grid.tiles();
  return whole_lines((headers + 4) * sizeof(std::uint32_t) + grid.tiles() * TileGrid::kPixels * sizeof(std::uint16_t));
}

std::byte* FrameStore::allocate(std::size_t bytes) {
  if (blocks_.empty() || used_ + bytes > blocks_.back().size()) {
    blocks_.emplace_back(std::max(kBlockBytes, bytes));
    used_ = 0;
  }
  std::byte* at = blocks_.back().data() + used_;
  used_ += bytes;
  bytes_ += bytes;
  return at;
}

std::size_t FrameStore::add(const Camera& camera, const DepthImage& depth) {
  if (depth.width() != camera.width || depth.height() != camera.height) {
    throw Error("training: depth is " + std::to_string(depth.width()) + "x" + std::to_string(depth.height()) +
                ", its camera " + std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  if (depth.empty() || depth.width() > kLargestTiledSide || depth.height() > kLargestTiledSide) {
    throw Error("training: a frame has " + std::to_string(depth.width()) + "x" + std::to_string(depth.height()) +
                " pixels, expected 1 to " + std::to_string(kLargestTiledSide) + " a side");
  }
  const std::vector<std::uint32_t> words = pack_tiles(depth);
  const std::size_t bytes = words.size() * sizeof(std::uint32_t);
  std::byte* at = allocate(whole_lines(bytes));
  std::memcpy(at, words.data(), bytes);
  const PackedTiles tiles = packed_tiles({depth.width(), depth.height()}, reinterpret_cast<const std::uint32_t*>(at));
  views_.push_back({tiles, bytes, OffsetScaler(convention_, camera)});
  return views_.size() - 1;
}

const TiledDepth& FrameUnpacker::operator()(std::size_t frame) {
  if (unpacked_ && frame == frame_) return *unpacked_;
  const FrameStore::View& view = frames_[frame];
  const std::size_t pixels = view.depth.grid.tiles() * TileGrid::kPixels;
  if (tiles_.size() < pixels + 1) tiles_.resize(pixels + 1);
  unpack_tiles(view.depth, frames_.convention().hole_mm, tiles_.data());
  tiles_[pixels] = frames_.convention().outside_mm;
  frame_ = frame;
  return unpacked_.emplace(TiledDepth{view.depth.grid, tiles_.data(), view.scaler});
}

}  // namespace vesalius

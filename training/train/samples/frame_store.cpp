#include "train/samples/frame_store.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{64} << 20U;

void expect_size(int width, int height) {
  if (width > 0 && height > 0 && width <= kLargestTiledSide && height <= kLargestTiledSide) return;
  throw Error("training: a frame has " + std::to_string(width) + "x" + std::to_string(height) +
              " pixels, expected 1 to " + std::to_string(kLargestTiledSide) + " a side");
}

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
  expect_size(depth.width(), depth.height());
  return add_packed(camera, pack_tiles(depth));
}

std::size_t FrameStore::add_packed(const Camera& camera, std::span<const std::uint32_t> words) {
  expect_size(camera.width, camera.height);
  std::byte* at = allocate(whole_lines(words.size_bytes()));
  std::memcpy(at, words.data(), words.size_bytes());
  add_view(camera, {reinterpret_cast<const std::uint32_t*>(at), words.size()});
  return views_.size() - 1;
}

void FrameStore::add_view(const Camera& camera, std::span<const std::uint32_t> words) {
  const PackedTiles tiles = packed_tiles({camera.width, camera.height}, words.data());
  views_.push_back({tiles, words.size_bytes(), OffsetScaler(convention_, camera)});
  cameras_.push_back(camera);
}

void FrameStore::add_block(HugeBuffer block, std::span<const InBlock> frames) {
  for (const InBlock& frame : frames) {
    expect_size(frame.camera.width, frame.camera.height);
    if (frame.at % sizeof(std::uint32_t) != 0 || frame.at > block.size() ||
        frame.words > (block.size() - frame.at) / sizeof(std::uint32_t)) {
      throw Error("training: a frame is not in its block");
    }
  }
  blocks_.push_back(std::move(block));
  used_ = blocks_.back().size();
  for (const InBlock& frame : frames) {
    add_view(frame.camera, {reinterpret_cast<const std::uint32_t*>(blocks_.back().data() + frame.at), frame.words});
    bytes_ += whole_lines(frame.words * sizeof(std::uint32_t));
  }
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

FramePrefetcher::FramePrefetcher(const FrameStore& frames, std::span<const TrainingSample> samples)
    : frames_(frames), samples_(samples) {}

void FramePrefetcher::step(std::size_t index) {
  if (index >= frame_end_) enter_frame(index);
  const char* stop = next_ + std::min(bytes_per_sample_, static_cast<std::size_t>(end_ - next_));
  for (; next_ < stop; next_ += kLineBytes) __builtin_prefetch(next_, 0, 2);
}

void FramePrefetcher::enter_frame(std::size_t index) {
  const std::uint32_t frame = samples_[index].frame;
  const auto rest = samples_.subspan(index);
  const auto end = std::ranges::find_if(rest, [&](const TrainingSample& each) { return each.frame != frame; });
  frame_end_ = index + (end - rest.begin());
  next_ = end_ = nullptr;
  bytes_per_sample_ = 0;
  const auto count = double(frame_end_ - index);
  if (end == rest.end()) return;
  const FrameStore::View& view = frames_[end->frame];
  next_ = reinterpret_cast<const char*>(view.depth.row_starts);
  end_ = next_ + view.bytes;
  const std::size_t bytes = static_cast<std::size_t>(double(end_ - next_) / count);
  bytes_per_sample_ = (bytes / kLineBytes + 1) * kLineBytes;
}

}  // namespace vesalius

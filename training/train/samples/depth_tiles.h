#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "vesalius/image.h"

namespace vesalius {

/// The layout of a frame whose depth is kept in tiles of 8x4 pixels, so that the probes around a pixel touch few of
/// them.
struct TileGrid {
  static constexpr int kWidth = 8, kHeight = 4, kPixels = kWidth * kHeight;

  std::int32_t width = 0, height = 0;  ///< size of the frame in pixels

  std::int32_t per_row() const { return (width + kWidth - 1) / kWidth; }
  std::int32_t rows() const { return (height + kHeight - 1) / kHeight; }
  std::size_t tiles() const { return static_cast<std::size_t>(per_row()) * static_cast<std::size_t>(rows()); }
  std::size_t tile_of(int u, int v) const {
    return static_cast<std::size_t>(v / kHeight) * static_cast<std::size_t>(per_row()) +
           static_cast<std::size_t>(u / kWidth);
  }
  static std::size_t in_tile(int u, int v) { return static_cast<std::size_t>((v % kHeight) * kWidth + u % kWidth); }
};

/// Tiles packed without loss, to somewhat more than half of 16 bits a pixel. A pixel's code is its depth above a base
/// just below the tile's nearest reading, in 4, 8 or 16 bits as the tile's furthest reading needs; code 0 is a hole.
/// The first pixel's code is in the lowest bits.
struct PackedTiles {
  TileGrid grid;
  const std::uint32_t* row_starts = nullptr;  ///< start of each row of tiles, in chunks
  const std::uint32_t* headers = nullptr;     ///< for each tile a word that base_mm, code_bits and chunk_in_row decode
  const std::uint8_t* chunks = nullptr;       ///< kChunk bytes each, one after the other in the order of the tiles

  static constexpr std::size_t kChunk = 16;
  static std::uint32_t base_mm(std::uint32_t header) { return header & 0xFFFFU; }
  static std::size_t code_bits(std::uint32_t header) { return std::size_t{4} << (header >> 16U & 3U); }
  static std::size_t chunk_in_row(std::uint32_t header) { return header >> 18U; }

  /// Returns the depth of a pixel inside the frame, 0 for a hole.
  std::uint16_t depth_mm(int u, int v) const;
};

/// Largest side of a frame in pixels.
constexpr int kLargestTiledSide = 32767;

/// Packs `depth`, which has at most kLargestTiledSide pixels a side. Returns words that `packed_tiles` reads; the last
/// of them is there for reads beyond the end.
std::vector<std::uint32_t> pack_tiles(const DepthImage& depth);
PackedTiles packed_tiles(TileGrid grid, const std::uint32_t* words);

/// Writes all readings to `tiles`, TileGrid::kPixels for each tile: pixel (u, v) goes to tile_of(u, v) * kPixels +
/// in_tile(u, v), a hole as `hole_mm`. The readings are the same from every instruction set.
void unpack_tiles(const PackedTiles& packed, std::uint16_t hole_mm, std::uint16_t* tiles);

inline std::uint16_t PackedTiles::depth_mm(int u, int v) const {
  const std::uint32_t header = headers[grid.tile_of(u, v)];
  const std::size_t bits = code_bits(header);
  const std::size_t begin = TileGrid::in_tile(u, v) * bits;
  std::uint16_t word = 0;
  std::memcpy(&word, chunks + kChunk * (row_starts[v / TileGrid::kHeight] + chunk_in_row(header)) + begin / 8, 2);
  const std::uint32_t code = (static_cast<std::uint32_t>(word) >> (begin % 8)) & ((1U << bits) - 1);
  return static_cast<std::uint16_t>(code != 0 ? base_mm(header) + code : 0U);
}

}  // namespace vesalius

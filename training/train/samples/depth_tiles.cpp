#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "train/samples/depth_tiles.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>

#include "train/samples/depth_tiles.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<std::uint16_t, 16>;
using Bytes = hn::Rebind<std::uint8_t, Lanes>;
using Uint16 = hn::Vec<Lanes>;

class TileUnpacker {
 public:
  explicit TileUnpacker(std::uint16_t hole_mm) : hole_(hn::Set(Lanes(), hole_mm)) {}

  /// Unpacks codes of 8 bits.
  HWY_INLINE void FromBytes(std::uint32_t base_mm, const std::uint8_t* HWY_RESTRICT codes,
                            std::uint16_t* HWY_RESTRICT tile) const {
    const Lanes d;
    for (std::size_t i = 0; i < TileGrid::kPixels; i += hn::Lanes(d)) {
      Store(base_mm, hn::PromoteTo(d, hn::LoadU(Bytes(), codes + i)), tile + i);
    }
  }
  HWY_INLINE void FromNibbles(std::uint32_t base_mm, const std::uint8_t* HWY_RESTRICT codes,
                              std::uint16_t* HWY_RESTRICT tile) const {
    alignas(64) std::uint8_t bytes[TileGrid::kPixels];
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < TileGrid::kPixels / 2; ++i) {
      bytes[2 * i] = codes[i] & 15U;
      bytes[2 * i + 1] = codes[i] >> 4U;
    }
#else
    const hn::Full128<std::uint8_t> d;
    const hn::Full128<std::uint16_t> pairs;
    const auto both = hn::LoadU(d, codes);
    const auto nibble = hn::Set(d, 15);
    const auto even = hn::And(both, nibble);
    const auto odd = hn::And(hn::BitCast(d, hn::ShiftRight<4>(hn::BitCast(pairs, both))), nibble);
    hn::Store(hn::InterleaveLower(d, even, odd), d, bytes);
    hn::Store(hn::InterleaveUpper(d, even, odd), d, bytes + 16);
#endif
    FromBytes(base_mm, bytes, tile);
  }
  HWY_INLINE void FromWords(std::uint32_t base_mm, const std::uint8_t* HWY_RESTRICT codes,
                            std::uint16_t* HWY_RESTRICT tile) const {
    const Lanes d;
    const auto* words = reinterpret_cast<const std::uint16_t*>(codes);
    for (std::size_t i = 0; i < TileGrid::kPixels; i += hn::Lanes(d)) {
      Store(base_mm, hn::LoadU(d, words + i), tile + i);
    }
  }

 private:
  HWY_INLINE void Store(std::uint32_t base_mm, Uint16 codes, std::uint16_t* to) const {
    const Lanes d;
    const Uint16 mm = hn::Add(codes, hn::Set(d, static_cast<std::uint16_t>(base_mm)));
    hn::StoreU(hn::IfThenElse(hn::Eq(codes, hn::Zero(d)), hole_, mm), d, to);
  }

  Uint16 hole_;
};

void UnpackTiles(const PackedTiles& packed, std::uint16_t hole_mm, std::uint16_t* HWY_RESTRICT tiles) {
  const TileUnpacker unpacker(hole_mm);
  const std::uint8_t* codes = packed.chunks;
  const std::size_t count = packed.grid.tiles();
  for (std::size_t t = 0; t < count; ++t, tiles += TileGrid::kPixels) {
    const std::uint32_t base_mm = PackedTiles::base_mm(packed.headers[t]);
    const std::size_t bits = PackedTiles::code_bits(packed.headers[t]);
    if (bits == 8) {
      unpacker.FromBytes(base_mm, codes, tiles);
    } else if (bits == 4) {
      unpacker.FromNibbles(base_mm, codes, tiles);
    } else {
      unpacker.FromWords(base_mm, codes, tiles);
    }
    codes += bits * TileGrid::kPixels / 8;
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {
namespace {

HWY_EXPORT(UnpackTiles);

using Tile = std::array<std::uint16_t, TileGrid::kPixels>;

/// Reads a tile. Pixels outside the frame are holes.
Tile read_tile(const DepthImage& depth, int left, int top) {
  Tile tile{};
  for (int v = top; v < std::min(top + TileGrid::kHeight, depth.height()); ++v) {
    for (int u = left; u < std::min(left + TileGrid::kWidth, depth.width()); ++u) {
      tile[TileGrid::in_tile(u, v)] = depth(u, v);
    }
  }
  return tile;
}

/// Returns the base of a tile's codes; 0 for a tile of holes.
int code_base(const Tile& tile) {
  int nearest = 0;
  for (const int mm : tile) {
    if (mm != 0 && (nearest == 0 || mm < nearest)) nearest = mm;
  }
  return std::max(nearest - 1, 0);
}

void append_codes(const Tile& tile, int base, int bits, std::vector<std::uint8_t>& chunks) {
  const std::size_t begin = chunks.size();
  chunks.resize(begin + tile.size() * static_cast<std::size_t>(bits) / 8, 0);
  for (std::size_t i = 0; i < tile.size(); ++i) {
    const unsigned code = tile[i] != 0 ? tile[i] - static_cast<unsigned>(base) : 0U;
    const std::size_t bit = i * static_cast<std::size_t>(bits);
    std::uint8_t* at = &chunks[begin + bit / 8];
    *at = static_cast<std::uint8_t>(*at | code << (bit % 8));
    if (bits == 16) at[1] = static_cast<std::uint8_t>(code >> 8U);
  }
}

std::size_t first_chunk_word(TileGrid grid) {
  const std::size_t before = static_cast<std::size_t>(grid.rows()) + grid.tiles();
  return (before + 3) / 4 * 4;
}

}  // namespace

std::vector<std::uint32_t> pack_tiles(const DepthImage& depth) {
  const TileGrid grid{depth.width(), depth.height()};
  std::vector<std::uint32_t> words;
  words.reserve(first_chunk_word(grid));
  std::vector<std::uint32_t> headers;
  std::vector<std::uint8_t> chunks;
  for (int row = 0; row < grid.rows(); ++row) {
    const std::size_t start = chunks.size() / PackedTiles::kChunk;
    words.push_back(static_cast<std::uint32_t>(start));
    for (int column = 0; column < grid.per_row(); ++column) {
      const Tile tile = read_tile(depth, column * TileGrid::kWidth, row * TileGrid::kHeight);
      const int base = code_base(tile);
      const int furthest = std::max<int>(*std::ranges::max_element(tile), base);
      const int log_nibbles = furthest - base < 16 ? 0 : furthest - base < 256 ? 1 : 2;
      headers.push_back(static_cast<std::uint32_t>(base) | static_cast<std::uint32_t>(log_nibbles) << 16U |
                        static_cast<std::uint32_t>(chunks.size() / PackedTiles::kChunk - start) << 18U);
      append_codes(tile, base, 4 << log_nibbles, chunks);
    }
  }
  words.insert(words.end(), headers.begin(), headers.end());
  words.resize(first_chunk_word(grid) + chunks.size() / sizeof(std::uint32_t) + 1, 0);
  std::ranges::copy(chunks, reinterpret_cast<std::uint8_t*>(words.data() + first_chunk_word(grid)));
  return words;
}

PackedTiles packed_tiles(TileGrid grid, const std::uint32_t* words) {
  return {grid, words, words + grid.rows(), reinterpret_cast<const std::uint8_t*>(words + first_chunk_word(grid))};
}

void unpack_tiles(const PackedTiles& packed, std::uint16_t hole_mm, std::uint16_t* tiles) {
  HWY_DYNAMIC_DISPATCH(UnpackTiles)(packed, hole_mm, tiles);
}

}  // namespace vesalius
#endif

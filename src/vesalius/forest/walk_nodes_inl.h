// The functions by which the kernel reads nodes of PackedTree, for each instruction set. Only walk_kernels.cpp includes
// this file.

// Highway's guard: once for each target.
#if defined(VESALIUS_WALK_NODES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VESALIUS_WALK_NODES_INL_H
#undef VESALIUS_WALK_NODES_INL_H
#else
#define VESALIUS_WALK_NODES_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstring>

#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/walk_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR  // a lane of 32 bits has no halves there
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBlock = WalkPixels::kBlock;

// Capped, so that a block holds a whole number of vectors.
using Lanes = hn::CappedTag<std::int32_t, 16>;
using ULanes = hn::RebindToUnsigned<Lanes>;
using Halves = hn::Repartition<std::int16_t, Lanes>;
using UHalves = hn::RebindToUnsigned<Halves>;
using Int32 = hn::Vec<Lanes>;
using Int16 = hn::Vec<Halves>;

static_assert(std::endian::native == std::endian::little, "two words are read as one, two halves as a word");

/// The low halves of `low`, the high halves of `high`.
HWY_INLINE Int16 Halved(Int32 high, Int32 low) {
  return hn::OddEven(hn::BitCast(Halves(), high), hn::BitCast(Halves(), low));
}

/// a.low * b.low + a.high * b.high of every lane.
HWY_INLINE Int32 Dot(Int16 a, Int16 b) {
  const Lanes d;
  Int32 odd = hn::Zero(d);
  const Int32 even = hn::ReorderWidenMulAccumulate(d, a, b, hn::Zero(d), odd);
  return hn::RearrangeToOddPlusEven(even, odd);
}

HWY_INLINE Int16 SetHalves(int high, int low) {
  const auto half = [](int value) -> std::uint32_t { return static_cast<std::uint16_t>(value); };
  return hn::BitCast(Halves(), hn::Set(ULanes(), half(high) << 16U | half(low)));
}

/// A block of pixels on its way down.
struct Block {
  alignas(64) std::array<std::int32_t, kBlock> at;        ///< node, in bytes from the root
  alignas(64) std::array<std::int32_t, 4 * kBlock> node;  ///< its words, as the format keeps them
  alignas(64) std::array<std::int32_t, kBlock> base_u, base_v;
  alignas(64) std::array<std::int32_t, kBlock> first, second;  ///< where the probes are, in bytes from pixel (0, 0)
  alignas(64) std::array<std::uint32_t, kBlock> seen;          ///< what they read, the first in the low half
};

struct Node {
  Int32 u1, v1, u2, v2;
};

/// Nodes of two words.
class Compact {
 public:
  static constexpr int kLogBytes = 3;

  explicit Compact(const PackedTree& tree)
      : link_bits_(tree.link_bits),
        link_mask_(hn::BitCast(Lanes(), hn::Set(ULanes(), (1U << static_cast<unsigned>(tree.link_bits)) - 1))) {}

  static HWY_INLINE void Fetch(const char* HWY_RESTRICT nodes, Block& b) {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::memcpy(&b.node[2 * i], nodes + static_cast<std::uint32_t>(b.at[i]), 8);
    }
  }
  static HWY_INLINE Node Offsets(const Block& b, std::size_t i) {
    const Lanes d;
    const Int32 bytes = hn::ConcatEven(d, hn::Load(d, &b.node[2 * i + hn::Lanes(d)]), hn::Load(d, &b.node[2 * i]));
    const Int32 byte = hn::Set(d, 255);
    return {hn::And(bytes, byte), hn::And(hn::ShiftRight<8>(bytes), byte), hn::And(hn::ShiftRight<16>(bytes), byte),
            hn::BitCast(d, hn::ShiftRight<24>(hn::BitCast(ULanes(), bytes)))};
  }
  HWY_INLINE void Choice(const Block& b, std::size_t i, Int32& threshold, Int32& link) const {
    const Lanes d;
    const Int32 word = hn::ConcatOdd(d, hn::Load(d, &b.node[2 * i + hn::Lanes(d)]), hn::Load(d, &b.node[2 * i]));
    threshold = hn::ShiftRightSame(word, link_bits_);
    link = hn::And(word, link_mask_);
  }
  /// Pixel, rounding and bias of the offsets in one number: what remains is a product, a sum and a shift.
  static HWY_INLINE Int32 Base(Int32 pixel, Int32 scale) {
    const Int32 half = hn::Set(Lanes(), 32768);
    return hn::Sub(hn::Add(hn::ShiftLeft<16>(pixel), half), hn::ShiftLeft<7>(scale));
  }
  static HWY_INLINE Int16 Place(Int32 base_u, Int32 base_v, Int32 move_u, Int32 move_v) {
    return Halved(hn::Add(base_v, move_v), hn::ShiftRight<16>(hn::Add(base_u, move_u)));
  }

 private:
  int link_bits_;
  Int32 link_mask_;
};

/// Nodes of four words.
class Wide {
 public:
  static constexpr int kLogBytes = 4;

  explicit Wide(const PackedTree& /*tree*/) {}

  static HWY_INLINE void Fetch(const char* HWY_RESTRICT nodes, Block& b) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const char* HWY_RESTRICT node = nodes + static_cast<std::uint32_t>(b.at[i]);
      for (std::size_t w = 0; w < 4; ++w) std::memcpy(&b.node[w * kBlock + i], node + 4 * w, 4);
    }
  }
  static HWY_INLINE Node Offsets(const Block& b, std::size_t i) {
    const Lanes d;
    const Int32 first = hn::Load(d, &b.node[i]);
    const Int32 second = hn::Load(d, &b.node[kBlock + i]);
    return {hn::ShiftRight<16>(hn::ShiftLeft<16>(first)), hn::ShiftRight<16>(first),
            hn::ShiftRight<16>(hn::ShiftLeft<16>(second)), hn::ShiftRight<16>(second)};
  }
  HWY_INLINE void Choice(const Block& b, std::size_t i, Int32& threshold, Int32& link) const {
    threshold = hn::Load(Lanes(), &b.node[2 * kBlock + i]);
    link = hn::Load(Lanes(), &b.node[3 * kBlock + i]);
  }
  static HWY_INLINE Int32 Base(Int32 pixel, Int32 /*scale*/) { return pixel; }
  /// A coordinate below 2^14 and a distance within 2^15 add up to at most 49151 and at least -32768, which as unsigned
  /// 16 bits is beyond any border.
  static HWY_INLINE Int16 Place(Int32 base_u, Int32 base_v, Int32 move_u, Int32 move_v) {
    const Int32 half = hn::Set(Lanes(), 32768);
    const Int32 u = hn::Add(base_u, hn::ShiftRight<16>(hn::Add(move_u, half)));
    const Int32 v = hn::Add(base_v, hn::ShiftRight<16>(hn::Add(move_v, half)));
    return Halved(hn::ShiftLeft<16>(v), u);
  }
};

#endif
}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

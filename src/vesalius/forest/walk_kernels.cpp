#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/forest/walk_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstring>

#include "vesalius/forest/feature.h"
#include "vesalius/forest/walk_kernels.h"
#include "vesalius/forest/walk_nodes_inl.h"

// A block of pixels goes down a level in four steps: its nodes are read, its probes placed, their depths read, the
// children chosen. Arithmetic is done on vectors. Memory is read by plain loads, all of a block's in a row, so that
// many are under way at once; gather instructions took up to twice the time of the whole (docs/performance.md).

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // a lane of 32 bits has no halves

struct Node {
  int du1, dv1, du2, dv2;
  std::int32_t threshold;
  std::uint32_t link;
};

Node Read(const PackedTree& tree, const std::uint32_t* words) {
  if (tree.wide) {
    const auto low = [&](int w) { return static_cast<std::int16_t>(words[w]); };
    const auto high = [&](int w) { return static_cast<std::int16_t>(words[w] >> 16U); };
    return {low(0), high(0), low(1), high(1), static_cast<std::int32_t>(words[2]), words[3]};
  }
  const auto byte = [&](unsigned i) { return int(words[0] >> (8 * i) & 255U) - 128; };
  return {byte(0),
          byte(1),
          byte(2),
          byte(3),
          static_cast<std::int32_t>(words[1]) >> tree.link_bits,
          words[1] & ((1U << static_cast<unsigned>(tree.link_bits)) - 1)};
}

void WalkPixelsOn(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves) {
  const auto words_per_node = static_cast<std::size_t>(tree.words_per_node());
  const auto read = [&](int u, int v) -> int {
    const std::size_t in_u = std::min(static_cast<unsigned>(u), static_cast<unsigned>(depth.border_u()));
    const std::size_t in_v = std::min(static_cast<unsigned>(v), static_cast<unsigned>(depth.border_v()));
    return depth.values()[in_v * static_cast<std::size_t>(depth.stride()) + in_u];
  };
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto column = [&](WalkPixels::Column c) { return pixels.column(c)[i]; };
    const OffsetScale scale{column(WalkPixels::kScaleU), column(WalkPixels::kScaleV)};
    const ProbeRange range{static_cast<std::int16_t>(column(WalkPixels::kLow)),
                           static_cast<std::int16_t>(column(WalkPixels::kHigh))};
    const std::uint32_t* words = tree.words.data();
    for (Node n = Read(tree, words); n.link != 0; n = Read(tree, words)) {
      const int difference = feature(column(WalkPixels::kU), column(WalkPixels::kV), scale, range, n, read);
      words = tree.words.data() + (2 * std::size_t{n.link} + (difference > n.threshold ? 1 : 0)) * words_per_node;
    }
    leaves[i] = words[0];
  }
}

#else

template <class Format>
class Walker {
 public:
  Walker(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels)
      : format_(tree),
        pixels_(pixels),
        nodes_(reinterpret_cast<const char*>(tree.words.data())),
        values_(reinterpret_cast<const char*>(depth.values())),
        border_(hn::BitCast(UHalves(), SetHalves(depth.border_v(), depth.border_u()))),
        value_bytes_(SetHalves(2 * depth.stride(), 2)),
        levels_(tree.levels) {}

  /// From the root to the leaves: those of pixels `begin` to `begin` + kBlock - 1.
  void Run(std::size_t begin, std::uint32_t* leaves) {
    begin_ = begin;
    Start();
    for (int level = 0; level < levels_; ++level) {
      Format::Fetch(nodes_, b_);
      PlaceProbes();
      ReadProbes();
      if (Descend()) break;
    }
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::memcpy(&leaves[begin + i], nodes_ + static_cast<std::uint32_t>(b_.at[i]), sizeof(leaves[0]));
    }
  }

 private:
  HWY_INLINE Int32 Column(WalkPixels::Column c, std::size_t i) const {
    return hn::LoadU(Lanes(), pixels_.column(c) + begin_ + i);
  }

  void Start() {
    const Lanes d;
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      hn::Store(Format::Base(Column(WalkPixels::kU, i), Column(WalkPixels::kScaleU, i)), d, &b_.base_u[i]);
      hn::Store(Format::Base(Column(WalkPixels::kV, i), Column(WalkPixels::kScaleV, i)), d, &b_.base_v[i]);
      hn::Store(hn::Zero(d), d, &b_.at[i]);
    }
  }

  /// Unsigned, what is left of or above the picture is huge: one minimum brings all outside to the border.
  HWY_INLINE Int32 Offset(Int16 place) const {
    return Dot(hn::BitCast(Halves(), hn::Min(hn::BitCast(UHalves(), place), border_)), value_bytes_);
  }

  HWY_INLINE void PlaceProbes() {
    const Lanes d;
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      const Node n = Format::Offsets(b_, i);
      const Int32 scale_u = Column(WalkPixels::kScaleU, i), scale_v = Column(WalkPixels::kScaleV, i);
      const Int32 u = hn::Load(d, &b_.base_u[i]), v = hn::Load(d, &b_.base_v[i]);
      hn::Store(Offset(Format::Place(u, v, hn::Mul(n.u1, scale_u), hn::Mul(n.v1, scale_v))), d, &b_.first[i]);
      hn::Store(Offset(Format::Place(u, v, hn::Mul(n.u2, scale_u), hn::Mul(n.v2, scale_v))), d, &b_.second[i]);
    }
  }

  HWY_INLINE void ReadProbes() {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::uint16_t first = 0, second = 0;
      std::memcpy(&first, values_ + b_.first[i], sizeof(first));
      std::memcpy(&second, values_ + b_.second[i], sizeof(second));
      b_.seen[i] = first | static_cast<std::uint32_t>(second) << 16U;
    }
  }

  /// Pixels in a leaf stay there. Whether all are in one.
  HWY_INLINE bool Descend() {
    const Lanes d;
    const Int16 minus = SetHalves(-1, 1);
    Int32 links = hn::Zero(d);
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      const Int16 low = hn::BitCast(Halves(), Column(WalkPixels::kLow, i));
      const Int16 high = hn::BitCast(Halves(), Column(WalkPixels::kHigh, i));
      const Int16 seen = hn::BitCast(Halves(), hn::Load(ULanes(), &b_.seen[i]));
      const Int32 feature = Dot(hn::Min(hn::Max(seen, low), high), minus);
      Int32 threshold, link;
      format_.Choice(b_, i, threshold, link);
      const Int32 step = hn::IfThenElseZero(hn::Gt(feature, threshold), hn::Set(d, 1 << Format::kLogBytes));
      const Int32 child = hn::Or(hn::ShiftLeft<Format::kLogBytes + 1>(link), step);
      hn::Store(hn::IfThenElse(hn::Eq(link, hn::Zero(d)), hn::Load(d, &b_.at[i]), child), d, &b_.at[i]);
      links = hn::Or(links, link);
    }
    return hn::AllTrue(d, hn::Eq(links, hn::Zero(d)));
  }

  Format format_;
  const WalkPixels& pixels_;
  const char* nodes_;
  const char* values_;
  hn::Vec<UHalves> border_;
  Int16 value_bytes_;
  int levels_;
  std::size_t begin_ = 0;
  Block b_;
};

template <class Format>
void WalkAll(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves) {
  Walker<Format> walker(tree, depth, pixels);
  for (std::size_t begin = 0; begin < pixels.size(); begin += kBlock) walker.Run(begin, leaves);
}

void WalkPixelsOn(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves) {
  if (tree.wide) {
    WalkAll<Wide>(tree, depth, pixels, leaves);
  } else {
    WalkAll<Compact>(tree, depth, pixels, leaves);
  }
}

#endif

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(WalkPixelsOn);

void walk_pixels(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves) {
  HWY_DYNAMIC_DISPATCH(WalkPixelsOn)(tree, depth, pixels, leaves);
}

}  // namespace vesalius
#endif

// Highway leaves AVX-512 with VNNI out of what it compiles for unless it is asked.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/network/convolve_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "vesalius/network/convolve_kernels.h"

// Output channels lie in the lanes. A few pixels' sums stay in registers while the window's values go by, a group of
// them at a time: they are copied to all lanes and multiplied with the weights of the group, which all pixels share.
// A row of a window lies together in memory, so that a window of 3x3 is three runs of values.

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<std::int32_t>;
using Int32 = hn::Vec<Lanes>;
using Floats = hn::RebindToFloat<Lanes>;
using Float = hn::Vec<Floats>;
constexpr int kLanes = int(hn::MaxLanes(Lanes()));

#undef VESALIUS_AVX512
#define VESALIUS_AVX512 (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3)
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL

using Narrow = std::uint8_t;
using Weight = std::int8_t;

/// Adds to every lane the products of four values and four weights. Highway 1.0.3 has no name for the instruction, and
/// its flags for the compiler do not allow the intrinsic.
HWY_INLINE Int32 AddProducts(Int32 sum, Int32 values, Int32 weights) {
  asm("vpdpbusd %2, %1, %0" : "+v"(sum.raw) : "v"(values.raw), "v"(weights.raw));
  return sum;
}

#else

using Narrow = std::int16_t;
using Weight = std::int16_t;

/// Adds to every lane the products of two values and two weights.
HWY_INLINE Int32 AddProducts(Int32 sum, Int32 values, Int32 weights) {
#if HWY_TARGET == HWY_SCALAR  // a lane of 32 bits has no halves
  const auto low = [](Int32 x) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(x)); };
  const auto high = [](Int32 x) { return hn::ShiftRight<16>(x); };
  return hn::Add(sum, hn::Add(hn::Mul(low(values), low(weights)), hn::Mul(high(values), high(weights))));
#else
  const Lanes d;
  const hn::Repartition<std::int16_t, Lanes> halves;
  Int32 odd = hn::Zero(d);
  const Int32 even =
      hn::ReorderWidenMulAccumulate(d, hn::BitCast(halves, values), hn::BitCast(halves, weights), hn::Zero(d), odd);
  return hn::Add(sum, hn::RearrangeToOddPlusEven(even, odd));
#endif
}

#endif

constexpr int kGroupBytes = 4;
constexpr int kGroup = kGroupBytes / int(sizeof(Narrow));
/// Pixels whose sums are in registers, of which there are 32 or 16: the number that wastes less of a row.
constexpr int kMany = VESALIUS_AVX512 ? 10 : 5;
constexpr int kFewer = VESALIUS_AVX512 ? 8 : 4;
static_assert(2 * kMany <= kReadAhead);

/// Windows of some pixels, one beside the other.
struct WindowShape {
  std::ptrdiff_t step_bytes;  ///< from one window to the next
  std::ptrdiff_t row_bytes;
  int rows;
  int groups;  ///< of values in a row of a window
};

/// Writes the sums of kPixels windows for the channels of kCount vectors, pixel after pixel.
template <int kPixels, int kCount>
HWY_NOINLINE void SumWindows(const WindowShape& shape, const std::uint8_t* corner,
                             const std::int32_t* HWY_RESTRICT weights, std::int32_t* HWY_RESTRICT to) {
  const Lanes d;
  Int32 sums[kPixels * kCount];
#pragma GCC unroll 32
  for (Int32& sum : sums) sum = hn::Zero(d);
  const std::ptrdiff_t step = shape.step_bytes, three = 3 * step;
  for (int row = 0; row < shape.rows; ++row) {
    // Pixels 0 and 5 have pointers, what is between is reached by the addresses that an instruction can have.
    const std::uint8_t* first = corner + row * shape.row_bytes;
    const std::uint8_t* fifth = first + 5 * step;
    for (int g = 0; g < shape.groups; ++g) {
      Int32 w[kCount];
#pragma GCC unroll 2
      for (int v = 0; v < kCount; ++v, weights += kLanes) w[v] = hn::Load(d, weights);
#pragma GCC unroll 16
      for (int p = 0; p < kPixels; ++p) {
        const std::ptrdiff_t ahead = p % 5 == 3 ? three : (p % 5) * step;
        std::int32_t group = 0;
        std::memcpy(&group, (p < 5 ? first : fifth) + ahead, sizeof(group));
        const Int32 values = hn::Set(d, group);
#pragma GCC unroll 2
        for (int v = 0; v < kCount; ++v) sums[p * kCount + v] = AddProducts(sums[p * kCount + v], values, w[v]);
      }
      first += kGroupBytes;
      fifth += kGroupBytes;
    }
  }
#pragma GCC unroll 32
  for (int i = 0; i < kPixels * kCount; ++i) hn::Store(sums[i], d, to + i * kLanes);
}

class ConvolverOn final : public Convolver {
 public:
  explicit ConvolverOn(Convolution convolution)
      : c_(std::move(convolution)), row_values_(c_.side * RoundUp(c_.inputs, kChannelStep)) {
    const int padded = RoundUp(c_.outputs, kLanes);
    c_.scale.resize(static_cast<std::size_t>(padded));
    c_.offset.resize(c_.scale.size());
    weights_ =
        hwy::AllocateAligned<std::int32_t>(c_.scale.size() * static_cast<std::size_t>(c_.side * row_values_ / kGroup));
    std::int32_t* to = weights_.get();
    for (int channel = 0; channel < padded; channel += 2 * kLanes) {
      blocks_.push_back({channel, std::min(2 * kLanes, padded - channel), to});
      to = Pack(blocks_.back(), to);
    }
    c_.weights = {};
  }

  int narrow_bytes() const override { return int(sizeof(Narrow)); }

  void run(const PictureView& in, const PictureView* added, int begin, int end, const PictureView& out) const override {
    const auto run_blocks = [&](auto result, auto more) {
      using Result = decltype(result);
      using More = decltype(more);
      for (const Block& block : blocks_) {  // its weights stay in the nearest cache while the rows go by
        const auto run =
            block.count == kLanes ? &ConvolverOn::Run<Result, More, 1> : &ConvolverOn::Run<Result, More, 2>;
        (this->*run)(block, in, added == nullptr ? out : *added, begin, end, out);
      }
    };
    const auto run_adding = [&](auto result) {
      if (added == nullptr) return run_blocks(result, Nothing());
      if (added->wide) return run_blocks(result, std::int16_t());
      return run_blocks(result, Narrow());
    };
    if (out.wide) return run_adding(std::int16_t());
    return run_adding(Narrow());
  }

 private:
  struct Nothing {};
  /// Output channels whose sums are made together.
  struct Block {
    int channel;  ///< the first
    int count;    ///< those of one or two vectors
    const std::int32_t* weights;
  };

  static int RoundUp(int n, int step) { return (n + step - 1) / step * step; }

  /// Writes a block's weights in the order in which they are read; those of channels that are not there are 0.
  std::int32_t* Pack(const Block& block, std::int32_t* to) const {
    const int padded_inputs = row_values_ / c_.side;
    for (int i = 0; i < c_.side * row_values_; i += kGroup) {
      for (int output = block.channel; output < block.channel + block.count; ++output) {
        Weight group[kGroup] = {};
        for (int k = 0; k < kGroup; ++k) {
          const int place = output * c_.side * c_.side + (i + k) / padded_inputs, input = (i + k) % padded_inputs;
          if (input >= c_.inputs || output >= c_.outputs) continue;
          group[k] = Weight{c_.weights[static_cast<std::size_t>(place * c_.inputs + input)]};
        }
        std::memcpy(to++, group, sizeof(group));
      }
    }
    return to;
  }

  /// Pictures are copies: the compiler cannot know that results do not lie there.
  template <class Result, class More, int kCount>
  void Run(const Block& block, PictureView in, PictureView added, int begin, int end, PictureView out) const {
    const Lanes d;
    const Floats df;
    HWY_ALIGN std::int32_t sums[kMany * kCount * hn::MaxLanes(d)];
    Float scale[kCount], offset[kCount];
    int there[kCount];
#pragma GCC unroll 2
    for (int v = 0; v < kCount; ++v) {
      const int channel = block.channel + v * kLanes;
      scale[v] = hn::LoadU(df, &c_.scale[channel]);
      offset[v] = hn::LoadU(df, &c_.offset[channel]);
      there[v] = std::min(kLanes, c_.outputs - channel);
    }
    const Float added_scale = hn::Set(df, c_.added_scale);
    const Float low = hn::Set(df, c_.wide ? -32768.F : 0.F), high = hn::Set(df, c_.wide ? 32767.F : 255.F);
    const Float rounder = hn::Set(df, 12582912.F);  // 1.5 * 2^23, beside which singles have no fractions
    const bool many = RoundUp(out.width, kMany) <= RoundUp(out.width, kFewer);
    const auto sum = many ? &SumWindows<kMany, kCount> : &SumWindows<kFewer, kCount>;
    const int pixels = many ? kMany : kFewer, reach = c_.side / 2, halved = added.width < out.width ? 1 : 0;
    const WindowShape shape{c_.stride * in.pixel_bytes, in.row_bytes, c_.side, row_values_ / kGroup};
    const std::int32_t* weights = block.weights;
    for (int y = begin; y < end; ++y) {
      for (int x = 0, p = pixels; x < out.width; ++x, ++p) {
        if (p == pixels) {
          sum(shape, in.at(x * c_.stride - reach, y * c_.stride - reach), weights, sums);
          p = 0;
        }
        Result* to = reinterpret_cast<Result*>(out.at(x, y)) + block.channel;
        const More* more = reinterpret_cast<const More*>(added.at(x >> halved, y >> halved)) + block.channel;
#pragma GCC unroll 2
        for (int v = 0; v < kCount; ++v, to += kLanes, more += kLanes) {
          Float value = hn::ConvertTo(df, hn::Load(d, &sums[(p * kCount + v) * kLanes]));
          value = hn::Add(hn::Mul(value, scale[v]), offset[v]);
          if constexpr (!std::is_same_v<More, Nothing>) {
            const auto all = hn::PromoteTo(d, LoadFirst(hn::Rebind<More, Lanes>(), more, there[v]));
            value = hn::Add(value, hn::Mul(hn::ConvertTo(df, all), added_scale));
          }
          value = hn::Add(hn::Min(hn::Max(value, low), high), rounder);
          const Int32 rounded = hn::Sub(hn::BitCast(d, value), hn::BitCast(d, rounder));
          StoreFirst(hn::Rebind<Result, Lanes>(), rounded, to, there[v]);
        }
      }
    }
  }

  template <class D>
  static HWY_INLINE hn::Vec<D> LoadFirst(D d, const hn::TFromD<D>* from, int count) {
#if VESALIUS_AVX512  // masks leave alone what they leave out
    return hn::MaskedLoad(hn::FirstN(d, static_cast<std::size_t>(count)), d, from);
#else
    if (count == kLanes) return hn::LoadU(d, from);
    HWY_ALIGN hn::TFromD<D> all[hn::MaxLanes(d)] = {};
    std::copy_n(from, count, all);
    return hn::Load(d, all);
#endif
  }

  template <class D>
  static HWY_INLINE void StoreFirst(D d, Int32 values, hn::TFromD<D>* to, int count) {
    const hn::Vec<D> v = hn::DemoteTo(d, values);
#if VESALIUS_AVX512  // masks leave alone what they leave out
    hn::BlendedStore(v, hn::FirstN(d, static_cast<std::size_t>(count)), d, to);
#else
    if (count == kLanes) return hn::StoreU(v, d, to);
    HWY_ALIGN hn::TFromD<D> all[hn::MaxLanes(d)];
    hn::Store(v, d, all);
    std::copy_n(all, count, to);
#endif
  }

  Convolution c_;   ///< without weights, scales and offsets padded to whole vectors
  int row_values_;  ///< in a row of a window
  hwy::AlignedFreeUniquePtr<std::int32_t[]> weights_;
  std::vector<Block> blocks_;
};

std::unique_ptr<const Convolver> MakeConvolver(const Convolution& convolution) {
  return std::make_unique<ConvolverOn>(convolution);
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(MakeConvolver);

std::unique_ptr<const Convolver> Convolver::make(const Convolution& convolution) {
  return HWY_DYNAMIC_DISPATCH(MakeConvolver)(convolution);
}

}  // namespace vesalius
#endif

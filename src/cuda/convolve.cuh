#pragma once

// A convolution of a network: sums in integers, whose order is free, then the operations of
// vesalius/network/convolve_kernels.cpp in their order.

#include "cuda/gpu.h"
#include "cuda/kernels.h"

namespace vesalius::gpu {

/// Adds up the windows of pixels from `x` on of row `y`, for the channels of a group, whose weights these are.
GPU_FUNCTION void sum_windows(const ConvolveArguments& a, int x, int y, const FourWords* weights, int groups,
                              std::int32_t (&sums)[kConvolvePixels][kConvolveChannels]) {
  const int pairs = a.in.room / kReadChannels;
  for (int v = y * a.stride - a.side / 2, row = 0; row < a.side; ++row, ++v) {
    const bool row_inside = v >= 0 && v < a.in.height;
    const auto* of_row = reinterpret_cast<const TwoWords*>(a.in.narrow + a.in.place(0, row_inside ? v : 0));
    for (int column = 0; column < a.side; ++column) {
      int from[kConvolvePixels];  // in the row; below 0 outside
      GPU_UNROLL for (int p = 0; p < kConvolvePixels; ++p) {
        const int u = (x + p) * a.stride + column - a.side / 2;
        from[p] = row_inside && u < a.in.width ? u * pairs : -1;
      }
      for (int pair = 0; pair < pairs; ++pair) {
        TwoWords values[kConvolvePixels];
        GPU_UNROLL for (int p = 0; p < kConvolvePixels; ++p) {
          values[p] = from[p] >= 0 ? of_row[from[p] + pair] : TwoWords{{a.outside_word, a.outside_word}};
        }
        GPU_UNROLL for (int half = 0; half < 2; ++half, weights += groups) {
          const FourWords of = *weights;
          GPU_UNROLL for (int i = 0; i < kConvolvePixels * kConvolveChannels; ++i) {
            const int p = i / kConvolveChannels, k = i % kConvolveChannels;
            sums[p][k] = add_products(sums[p][k], values[p].word[half], of.word[k]);
          }
        }
      }
    }
  }
}

/// Makes results of a pixel's sums for the channels from `first` on.
GPU_FUNCTION void write_results(const ConvolveArguments& a, int x, int y, int first, const std::int32_t* sums) {
  const int halved = a.added.width < a.out.width ? 1 : 0;
  const std::size_t to = a.out.place(x, y), more = a.added.place(x >> halved, y >> halved);
  const float low = a.out.wide != nullptr ? -32768.F : 0.F, high = a.out.wide != nullptr ? 32767.F : 255.F;
  GPU_UNROLL for (int k = 0; k < kConvolveChannels; ++k) {
    const int c = first + k;
    if (c >= a.outputs) continue;
    float value = float(sums[k]) * a.scale[c] + a.offset[c];
    if (a.added.wide != nullptr) value = value + float(a.added.wide[more + c]) * a.added_scale;
    if (a.added.narrow != nullptr) value = value + float(a.added.narrow[more + c]) * a.added_scale;
    value = value > low ? value : low;
    const std::int32_t result = nearest(value < high ? value : high);
    if (a.out.wide != nullptr) {
      a.out.wide[to + c] = static_cast<std::int16_t>(result);
    } else {
      a.out.narrow[to + c] = static_cast<std::uint8_t>(result);
    }
  }
}

/// Neighbouring threads have neighbouring groups of channels: they read weights together, and the same values.
GPU_KERNEL void run_kernel(const ConvolveArguments a) {
  const int groups = (a.outputs + kConvolveChannels - 1) / kConvolveChannels, y = int(block_y());
  GPU_LAST_PHASE(thread) {
    const int i = int(block_x() * threads_in_block() + thread), group = i % groups, x = i / groups * kConvolvePixels;
    if (x >= a.out.width) continue;
    std::int32_t sums[kConvolvePixels][kConvolveChannels] = {};
    sum_windows(a, x, y, a.weights + group, groups, sums);
    GPU_UNROLL for (int p = 0; p < kConvolvePixels; ++p) {
      if (x + p < a.out.width) write_results(a, x + p, y, group * kConvolveChannels, sums[p]);
    }
  }
}

}  // namespace vesalius::gpu

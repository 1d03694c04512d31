#pragma once

// The kernels, in the words of gpu.h. Those that share a text with the processor's side include it (feature.h); the
// others do the same operations in the same order wherever order shows in the result, and are tested for equal bits.

#include "cuda/convolve.cuh"
#include "cuda/gpu.h"
#include "cuda/kernels.h"
#include "cuda/launch_shape.h"
#include "cuda/logit_shares.cuh"
#include "vesalius/forest/feature.h"

namespace vesalius::gpu {

/// The pixel of a thread that goes over all pictures. Coordinates are beyond the pictures for threads too many.
struct PixelAt {
  int u = 0, v = 0, picture = 0;
  std::uint32_t index = 0;  ///< among all pixels
};

GPU_FUNCTION bool find_pixel(const Pictures& pictures, unsigned block, unsigned thread, unsigned threads, PixelAt& at) {
  const auto pixels = static_cast<std::uint32_t>(pictures.width * pictures.height);
  at.index = block * threads + thread;
  if (at.index >= pixels * static_cast<std::uint32_t>(pictures.count)) return false;
  const std::uint32_t inside = at.index % pixels;
  at.picture = int(at.index / pixels);
  at.u = int(inside % static_cast<std::uint32_t>(pictures.width));
  at.v = int(inside / static_cast<std::uint32_t>(pictures.width));
  return true;
}

GPU_FUNCTION const std::uint16_t* depth_of(const Pictures& pictures, int picture) {
  return pictures.depth + static_cast<std::size_t>(picture) * static_cast<std::size_t>(pictures.height) *
                              static_cast<std::size_t>(pictures.stride);
}

GPU_FUNCTION int depth_at(const Pictures& pictures, int picture, int u, int v) {
  return depth_of(
      pictures,
      picture)[static_cast<std::size_t>(v) * static_cast<std::size_t>(pictures.stride) + static_cast<std::size_t>(u)];
}

/// The place of a pixel among all, as sums and masks have them.
GPU_FUNCTION std::size_t place_of(const Pictures& pictures, int picture, int u, int v) {
  return (static_cast<std::size_t>(picture) * static_cast<std::size_t>(pictures.height) + static_cast<std::size_t>(v)) *
             static_cast<std::size_t>(pictures.width) +
         static_cast<std::size_t>(u);
}

/// A block counts its pixels before it takes room for all of them, so that cards add to the whole count once a block.
GPU_KERNEL void run_kernel(const SelectArguments a) {
  constexpr std::uint32_t kNotListed = 0xFFFFFFFFU;
  GPU_SHARED(std::uint32_t, found, 2);  // how many; where their room begins
  GPU_SHARED(std::uint32_t, slots, kMostThreads);
  const int columns = (a.pictures.width + a.step - 1) / a.step, rows = (a.pictures.height + a.step - 1) / a.step;
  const Pictures grid{nullptr, columns, rows, a.pictures.count, columns};
  GPU_PHASE(thread) {
    if (thread == 0) found[0] = 0;
  }
  GPU_PHASE(thread) {
    slots[thread] = kNotListed;
    PixelAt at;
    if (!find_pixel(grid, block_x(), thread, threads_in_block(), at)) continue;
    const int u = at.u * a.step, v = at.v * a.step;
    const std::size_t place = place_of(a.pictures, at.picture, u, v);
    if (depth_at(a.pictures, at.picture, u, v) == 0 || a.done[place] != 0) continue;
    a.done[place] = 1;
    slots[thread] = add(&found[0], std::uint32_t{1});
  }
  GPU_PHASE(thread) {
    if (thread == 0 && found[0] > 0) found[1] = add(a.asked.count, found[0]);
  }
  GPU_LAST_PHASE(thread) {
    if (slots[thread] == kNotListed) continue;
    PixelAt at;
    find_pixel(grid, block_x(), thread, threads_in_block(), at);
    const int u = at.u * a.step, v = at.v * a.step;
    const int depth_mm = depth_at(a.pictures, at.picture, u, v);
    const OffsetUnits unit = a.units[at.picture];
    a.asked.pixels[found[1] + slots[thread]] = {static_cast<std::uint16_t>(u), static_cast<std::uint16_t>(v),
                                                static_cast<std::uint32_t>(at.picture), offset_scale(unit.u, depth_mm),
                                                offset_scale(unit.v, depth_mm)};
  }
}

/// An inner node; a link of 0 is a leaf, whose index is in `word`.
struct WalkNode {
  int du1, dv1, du2, dv2;
  std::int32_t threshold_mm;
  std::uint32_t link;
};

/// Nodes of two words (PackedTree).
struct CompactNodes {
  static constexpr std::uint32_t kWords = 2;
  static GPU_FUNCTION WalkNode read(const std::uint32_t* words, std::uint32_t link_bits) {
    const auto w = *reinterpret_cast<const TwoWords*>(words);
    return {int(w.word[0] & 255U) - 128,
            int(w.word[0] >> 8U & 255U) - 128,
            int(w.word[0] >> 16U & 255U) - 128,
            int(w.word[0] >> 24U) - 128,
            static_cast<std::int32_t>(w.word[1]) >> link_bits,
            w.word[1] & ((1U << link_bits) - 1U)};
  }
};

/// Nodes of four words.
struct WideNodes {
  static constexpr std::uint32_t kWords = 4;
  static GPU_FUNCTION WalkNode read(const std::uint32_t* words, std::uint32_t /*link_bits*/) {
    const auto w = *reinterpret_cast<const FourWords*>(words);
    return {static_cast<std::int16_t>(w.word[0]), static_cast<std::int16_t>(w.word[0] >> 16U),
            static_cast<std::int16_t>(w.word[1]), static_cast<std::int16_t>(w.word[1] >> 16U),
            static_cast<std::int32_t>(w.word[2]), w.word[3]};
  }
};

template <class Nodes>
GPU_FUNCTION std::uint32_t walk_tree(const WalkArguments& a, const AskedPixel& pixel, const TreePlace& tree) {
  const std::uint16_t* depth = depth_of(a.pictures, int(pixel.picture));
  const auto width = static_cast<unsigned>(a.pictures.width), height = static_cast<unsigned>(a.pictures.height);
  const auto read = [&](int u, int v) -> int {
    if (static_cast<unsigned>(u) >= width || static_cast<unsigned>(v) >= height) return a.outside_mm;
    const int mm = depth[static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(a.pictures.stride) +
                         static_cast<std::uint32_t>(u)];
    return mm != 0 ? mm : a.hole_mm;
  };
  const OffsetScale scale{pixel.scale_u, pixel.scale_v};
  const ProbeRange range = probe_range(depth_at(a.pictures, int(pixel.picture), pixel.u, pixel.v), a.clip_mm);
  const std::uint32_t* root = a.words + tree.word;
  const std::uint32_t* words = root;
  for (WalkNode node = Nodes::read(words, tree.link_bits); node.link != 0; node = Nodes::read(words, tree.link_bits)) {
    const std::uint32_t right = feature(pixel.u, pixel.v, scale, range, node, read) > node.threshold_mm ? 1 : 0;
    words = root + static_cast<std::size_t>(2 * node.link + right) * Nodes::kWords;
  }
  return tree.leaf + words[0];
}

GPU_KERNEL void run_kernel(const WalkArguments a) {
  const std::uint32_t asked = *a.asked.count;
  const TreePlace tree = a.trees[block_y()];
  GPU_LAST_PHASE(thread) {
    const std::uint32_t i = block_x() * threads_in_block() + thread;
    if (i >= asked) continue;
    const AskedPixel pixel = a.asked.pixels[i];
    a.leaves[static_cast<std::size_t>(block_y()) * a.most_asked + i] =
        tree.link_bits != 0 ? walk_tree<CompactNodes>(a, pixel, tree) : walk_tree<WideNodes>(a, pixel, tree);
  }
}

GPU_KERNEL void run_kernel(const AddArguments a) {
  const std::uint32_t asked = *a.asked.count;
  GPU_LAST_PHASE(thread) {
    const std::uint32_t i = block_x() * threads_in_block() + thread;
    if (i >= asked) continue;
    const AskedPixel pixel = a.asked.pixels[i];
    std::uint16_t* sums =
        a.sums + place_of(a.pictures, int(pixel.picture), pixel.u, pixel.v) * static_cast<std::size_t>(a.classes);
    for (int t = 0; t < a.trees; ++t) {
      const std::size_t leaf = a.reached[static_cast<std::size_t>(t) * a.most_asked + i];
      const std::uint8_t* label = a.leaves + leaf * 2 * kLeafClasses;
      for (int k = 0; k < kLeafClasses; ++k) {
        std::uint16_t& sum = sums[label[k]];
        sum = static_cast<std::uint16_t>(sum + label[kLeafClasses + k]);
      }
    }
  }
}

/// Each group is taken relative to its own largest logit. Largest ones and sums are found as integers, whose order does
/// not matter.
GPU_KERNEL void run_kernel(const LogitArguments a) {
  using G = LogitGroups;
  constexpr unsigned kMostPixels = kMostThreads / kLogitLanes;
  GPU_SHARED(float, values, kSharedLogits);
  GPU_SHARED(std::int32_t, tops, kMostPixels * G::kCount);
  GPU_SHARED(std::int32_t, fixed, kMostPixels * G::kCount);
  GPU_SHARED(float, scales, kMostPixels* G::kCount);
  GPU_SHARED(float, turn_scale, kMostPixels);
  const auto pixels = static_cast<unsigned>(a.pixels_in_block), places = static_cast<unsigned>(a.places);
  const std::uint32_t asked = *a.asked.count;
  const std::uint32_t first = block_x() * pixels;
  if (first >= asked) return;
  const auto here = static_cast<unsigned>(asked - first < pixels ? asked - first : pixels);
  GPU_PHASE(thread) {
    for (unsigned i = thread; i < pixels * G::kCount; i += threads_in_block()) {
      tops[i] = ordered(G::kAbsent);
      fixed[i] = 0;
    }
  }
  GPU_PHASE(thread) {
    const unsigned pixel = thread / kLogitLanes;
    if (pixel >= here) continue;
    for (unsigned p = thread % kLogitLanes * 4; p < places; p += 4 * kLogitLanes) {
      int sums[4] = {0, 0, 0, 0};
      for (int t = 0; t < a.trees; ++t) {
        const std::uint32_t leaf = a.reached[static_cast<std::size_t>(t) * a.most_asked + first + pixel];
        // A leaf ends with zeros, so there are four more wherever there is one.
        const auto four =
            *reinterpret_cast<const std::int32_t*>(a.logits + static_cast<std::size_t>(leaf) * a.leaf_bytes + p);
        for (int k = 0; k < 4; ++k) sums[k] += static_cast<std::int8_t>(four >> (8 * k));
      }
      for (unsigned k = 0; k < 4 && p + k < places; ++k) {
        const float value = float(sums[k]) * a.unit;
        values[pixel * places + p + k] = value;
        raise(&tops[pixel * G::kCount + a.groups[p + k]], ordered(value));
      }
    }
  }
  GPU_PHASE(thread) {
    const unsigned pixel = thread / kLogitLanes;
    if (pixel >= here) continue;
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      const unsigned group = pixel * G::kCount + a.groups[p];
      const float power = power_below(values[pixel * places + p], tops[group]);
      values[pixel * places + p] = power;
      add(&fixed[group], nearest(power * G::kFixed));
    }
  }
  GPU_PHASE(thread) {
    if (thread % kLogitLanes != 0 || thread / kLogitLanes >= here) continue;
    const unsigned group = thread / kLogitLanes * G::kCount;
    float top[G::kCount];
    for (unsigned g = 0; g < G::kCount; ++g) top[g] = unordered(tops[group + g]);
    scale_groups(top, &fixed[group], a.headings > 0, &scales[group]);
  }
  GPU_PHASE(thread) {
    const unsigned pixel = thread / kLogitLanes;
    if (pixel >= here) continue;
    const AskedPixel at = a.asked.pixels[first + pixel];
    std::uint16_t* sums =
        a.sums + place_of(a.pictures, int(at.picture), at.u, at.v) * static_cast<std::size_t>(a.classes);
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      const float share = values[pixel * places + p] * scales[pixel * G::kCount + a.groups[p]];
      values[pixel * places + p] = share;
      if (p < static_cast<unsigned>(a.classes)) sums[p] = static_cast<std::uint16_t>(share * a.whole + 0.5F);
    }
  }
  if (a.turns == nullptr) return;
  GPU_PHASE(thread) {
    if (thread % kLogitLanes != 0 || thread / kLogitLanes >= here) continue;
    const unsigned pixel = thread / kLogitLanes;
    float body = 1e-30F;
    for (auto p = static_cast<unsigned>(a.classes); p < places; ++p) body += values[pixel * places + p];
    turn_scale[pixel] = 65535.F / body;
  }
  GPU_LAST_PHASE(thread) {
    const unsigned pixel = thread / kLogitLanes;
    if (pixel >= here) continue;
    const AskedPixel at = a.asked.pixels[first + pixel];
    const auto classes = static_cast<unsigned>(a.classes), turns = places - classes;
    std::uint16_t* out = a.turns + place_of(a.pictures, int(at.picture), at.u, at.v) * turns;
    for (unsigned i = thread % kLogitLanes; i < turns; i += kLogitLanes) {
      const float turn = values[pixel * places + classes + i] * turn_scale[pixel] + 0.5F;
      out[i] = static_cast<std::uint16_t>(turn < 65535.F ? turn : 65535.F);
    }
  }
}

enum GateState : std::uint8_t { kGateNoReading = 0, kGateSure = 1, kGateUnsure = 3 };

GPU_FUNCTION int gate_columns(const Pictures& pictures) { return (pictures.width + kGateStep - 1) / kGateStep; }
GPU_FUNCTION int gate_rows(const Pictures& pictures) { return (pictures.height + kGateStep - 1) / kGateStep; }

GPU_KERNEL void run_kernel(const GateArguments a) {
  const int columns = gate_columns(a.pictures);
  const Pictures grid{nullptr, columns, gate_rows(a.pictures), a.pictures.count, columns};
  GPU_LAST_PHASE(thread) {
    PixelAt at;
    if (!find_pixel(grid, block_x(), thread, threads_in_block(), at)) continue;
    const int u = at.u * kGateStep, v = at.v * kGateStep;
    GateState state = kGateNoReading;
    if (depth_at(a.pictures, at.picture, u, v) != 0) {
      const std::size_t behind = (place_of(a.pictures, at.picture, u, v) + 1) * static_cast<std::size_t>(a.classes);
      state = a.sums[behind - 1] >= a.enough ? kGateSure : kGateUnsure;
    }
    a.states[at.index] = state;
  }
}

GPU_FUNCTION bool is_shut(const SettleArguments& a, const PixelAt& at) {
  const int columns = gate_columns(a.pictures), rows = gate_rows(a.pictures);
  const std::uint8_t* states =
      a.states + static_cast<std::size_t>(at.picture) * static_cast<std::size_t>(columns * rows);
  const int left = at.u / kGateStep, above = at.v / kGateStep;
  int right = (at.u + kGateStep - 1) / kGateStep, below = (at.v + kGateStep - 1) / kGateStep;
  right = right < columns ? right : columns - 1;
  below = below < rows ? below : rows - 1;
  return (states[above * columns + left] | states[above * columns + right] | states[below * columns + left] |
          states[below * columns + right]) == kGateSure;
}

/// Returns the place of that grid pixel around which is nearest in depth; `none` if there is none (nearest_on_grid).
GPU_FUNCTION std::size_t nearest_grid_pixel(const Pictures& pictures, const PixelAt& at, std::size_t none) {
  const int z = depth_at(pictures, at.picture, at.u, at.v);
  int least = kGuideMm + 1;
  std::size_t found = none;
  for (int v = at.v - at.v % kGateStep; v < at.v + kGateStep && v < pictures.height; v += kGateStep) {
    for (int u = at.u - at.u % kGateStep; u < at.u + kGateStep && u < pictures.width; u += kGateStep) {
      const int mm = depth_at(pictures, at.picture, u, v);
      const int apart = mm > z ? mm - z : z - mm;
      if (mm == 0 || apart >= least) continue;
      least = apart;
      found = place_of(pictures, at.picture, u, v);
    }
  }
  return found;
}

/// First each thread finds where its pixel's sums come from, then the block copies them, neighbouring threads
/// neighbouring classes.
GPU_KERNEL void run_kernel(const SettleArguments a) {
  constexpr std::size_t kNone = ~std::size_t{0};
  GPU_SHARED(std::size_t, from, kMostThreads);
  GPU_PHASE(thread) {
    from[thread] = kNone;
    PixelAt at;
    if (!find_pixel(a.pictures, block_x(), thread, threads_in_block(), at)) continue;
    a.settled[at.index] = 0;
    if (a.done[at.index] != 0 || depth_at(a.pictures, at.picture, at.u, at.v) == 0 || !is_shut(a, at)) continue;
    from[thread] = nearest_grid_pixel(a.pictures, at, kNone);
    const std::uint8_t settled = from[thread] != kNone ? 1 : 0;
    a.settled[at.index] = settled;
    a.done[at.index] = settled;
  }
  const auto classes = static_cast<unsigned>(a.classes);
  GPU_LAST_PHASE(thread) {
    for (unsigned i = thread; i < threads_in_block() * classes; i += threads_in_block()) {
      const std::size_t source = from[i / classes];
      if (source == kNone) continue;
      const std::size_t to = static_cast<std::size_t>(block_x()) * threads_in_block() + i / classes;
      a.sums[to * classes + i % classes] = a.sums[source * classes + i % classes];
    }
  }
}

/// The classes of a pixel one by one, and two by two where there is an even number. The halves of a sum of two stay
/// below 2^16, as `bits` sees to.
struct OneClass {
  using Value = std::uint16_t;
  static constexpr std::uint32_t kClasses = 1;
  static GPU_FUNCTION std::uint32_t without(std::uint32_t x, int bits) { return x >> bits; }
  static GPU_FUNCTION std::uint32_t mean(std::uint32_t sum, std::uint32_t count, int bits) {
    return sum / count << bits;
  }
};
struct TwoClasses {
  using Value = std::uint32_t;
  static constexpr std::uint32_t kClasses = 2;
  static GPU_FUNCTION std::uint32_t without(std::uint32_t x, int bits) {
    return x >> bits & (0xFFFFU >> bits) * 0x10001U;
  }
  static GPU_FUNCTION std::uint32_t mean(std::uint32_t sum, std::uint32_t count, int bits) {
    return (sum & 0xFFFFU) / count << bits | ((sum >> 16U) / count << bits) << 16U;
  }
};

/// The lane of a pixel takes every kMeanLanes-th of the pixel's values.
template <class Classes, class Neighbours>
GPU_FUNCTION void mean_of_pixel(const MeanArguments& a, const PixelAt& at, unsigned lane, unsigned first,
                                unsigned count, const Neighbours& neighbours) {
  using Value = typename Classes::Value;
  const std::uint32_t values = static_cast<std::uint32_t>(a.classes) / Classes::kClasses;
  const auto* all = reinterpret_cast<const Value*>(a.sums);
  const Value* picture = all + place_of(a.pictures, at.picture, 0, 0) * values;
  const Value* own = all + static_cast<std::size_t>(at.index) * values;
  Value* out = reinterpret_cast<Value*>(a.means) + static_cast<std::size_t>(at.index) * values;
  const bool settled = a.settled != nullptr && a.settled[at.index] != 0;
  const bool reads = depth_at(a.pictures, at.picture, at.u, at.v) != 0;
  for (std::uint32_t c = lane; c < values; c += kMeanLanes) {
    if (settled || !reads) {
      out[c] = settled ? own[c] : Value{0};
      continue;
    }
    std::uint32_t sum = 0, near = 0;
    for (unsigned n = 0; n < count; ++n) {
      const std::int32_t place = neighbours[first + n];
      if (place < 0) continue;
      sum += Classes::without(picture[static_cast<std::size_t>(place) * values + c], a.bits);
      ++near;
    }
    out[c] = static_cast<Value>(Classes::mean(sum, near, a.bits));
  }
}

/// First the block finds which neighbours count, then neighbouring threads add up neighbouring classes.
GPU_KERNEL void run_kernel(const MeanArguments a) {
  GPU_SHARED(std::int32_t, neighbours, kSharedNeighbours);  // within the picture, or below 0; [pixel][neighbour]
  const auto pixels = static_cast<unsigned>(a.pixels_in_block), side = static_cast<unsigned>(2 * a.each_way + 1);
  GPU_PHASE(thread) {
    for (unsigned i = thread; i < pixels * side * side; i += threads_in_block()) {
      const unsigned neighbour = i % (side * side);
      std::int32_t place = -1;
      PixelAt at;
      if (find_pixel(a.pictures, block_x(), i / (side * side), pixels, at)) {
        const int u = at.u + (int(neighbour % side) - a.each_way) * a.spacing;
        const int v = at.v + (int(neighbour / side) - a.each_way) * a.spacing;
        if (u >= 0 && v >= 0 && u < a.pictures.width && v < a.pictures.height) {
          const int mm = depth_at(a.pictures, at.picture, u, v);
          const int apart = mm - depth_at(a.pictures, at.picture, at.u, at.v);
          if (mm != 0 && apart <= a.gate_mm && -apart <= a.gate_mm) place = v * a.pictures.width + u;
        }
      }
      neighbours[i] = place;
    }
  }
  GPU_LAST_PHASE(thread) {
    const unsigned pixel = thread / kMeanLanes, count = side * side;
    PixelAt at;
    if (pixel >= pixels || !find_pixel(a.pictures, block_x(), pixel, pixels, at)) continue;
    if (a.classes % 2 == 0) {
      mean_of_pixel<TwoClasses>(a, at, thread % kMeanLanes, pixel * count, count, neighbours);
    } else {
      mean_of_pixel<OneClass>(a, at, thread % kMeanLanes, pixel * count, count, neighbours);
    }
  }
}

constexpr std::uint8_t kNoLabel = 255;  // kBackground

GPU_FUNCTION std::int64_t weight_of(const ChoiceArguments& a, const std::uint16_t* sums, int c) {
  return sums[c] * (c < a.parts ? a.part_weight : a.background_weight);
}

GPU_KERNEL void run_kernel(const ChooseAloneArguments arguments) {
  GPU_LAST_PHASE(thread) {
    const ChoiceArguments& a = arguments.choice;
    PixelAt at;
    if (!find_pixel(a.pictures, block_x(), thread, threads_in_block(), at)) continue;
    std::uint8_t label = kNoLabel, unsure = 0;
    if (a.settled != nullptr && a.settled[at.index] != 0 && a.classes > a.parts) {
      label = static_cast<std::uint8_t>(a.parts);
    } else if (depth_at(a.pictures, at.picture, at.u, at.v) != 0) {
      const std::uint16_t* sums = a.sums + at.index * static_cast<std::size_t>(a.classes);
      std::int64_t first = 0, second = 0;
      for (int c = 0; c < a.classes; ++c) {
        const std::int64_t weight = weight_of(a, sums, c);
        if (weight > first) {
          second = first;
          first = weight;
          label = static_cast<std::uint8_t>(c);
        } else if (weight > second) {
          second = weight;
        }
      }
      unsure = second > 0 && first - second < a.margin ? 1 : 0;
    }
    a.first[at.index] = label;
    arguments.unsure[at.index] = unsure;
  }
}

GPU_FUNCTION int count_neighbours(const ChoiceArguments& a, const PixelAt& at, int label) {
  int count = 0;
  for (int v = at.v - 1; v <= at.v + 1; ++v) {
    for (int u = at.u - 1; u <= at.u + 1; ++u) {
      if (u < 0 || v < 0 || u >= a.pictures.width || v >= a.pictures.height || (u == at.u && v == at.v)) continue;
      if (a.first[place_of(a.pictures, at.picture, u, v)] == label) ++count;
    }
  }
  return count;
}

GPU_KERNEL void run_kernel(const AskNeighboursArguments arguments) {
  GPU_LAST_PHASE(thread) {
    const ChoiceArguments& a = arguments.choice;
    PixelAt at;
    if (!find_pixel(a.pictures, block_x(), thread, threads_in_block(), at)) continue;
    int label = a.first[at.index];
    if (arguments.unsure[at.index] != 0) {
      const std::uint16_t* sums = a.sums + at.index * static_cast<std::size_t>(a.classes);
      std::int64_t rival = weight_of(a, sums, label) - a.margin + 1;
      rival = rival > 1 ? rival : 1;
      int most = count_neighbours(a, at, label);
      for (int c = 0; c < a.classes; ++c) {
        if (weight_of(a, sums, c) < rival) continue;
        const int count = count_neighbours(a, at, c);
        if (count <= most) continue;
        most = count;
        label = c;
      }
    }
    arguments.labels[at.index] = label < a.parts ? static_cast<std::uint8_t>(label) : kNoLabel;
  }
}

}  // namespace vesalius::gpu

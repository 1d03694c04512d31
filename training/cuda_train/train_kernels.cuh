#pragma once

// The kernels of training, in the words of gpu.h. What they write is made of integers that add up in any order, or of
// floats that one thread computes as the processor does.

#include "cuda/gpu.h"
#include "cuda/kernels.h"
#include "cuda/launch_shape.h"
#include "cuda/logit_shares.cuh"
#include "cuda_train/train_kernels.h"
#include "vesalius/forest/feature.h"

namespace vesalius::gpu {

/// Returns the depth of a pixel inside a frame (PackedTiles::depth_mm).
GPU_FUNCTION int tiled_depth(const std::uint32_t* words, const FrameInfo& frame, int u, int v) {
  const auto per_row = static_cast<std::uint32_t>((frame.width + 7) / 8);
  const auto rows = static_cast<std::uint32_t>((frame.height + 3) / 4);
  const std::uint32_t header =
      words[rows + static_cast<std::uint32_t>(v / 4) * per_row + static_cast<std::uint32_t>(u / 8)];
  const auto* chunks = reinterpret_cast<const std::uint8_t*>(words + (rows + per_row * rows + 3) / 4 * 4);
  const std::uint32_t bits = 4U << (header >> 16U & 3U);
  const std::uint32_t begin = static_cast<std::uint32_t>(v % 4 * 8 + u % 8) * bits;
  const std::uint8_t* at = chunks + 16 * (static_cast<std::size_t>(words[v / 4]) + (header >> 18U)) + begin / 8;
  std::uint32_t code = at[0];
  if (bits == 16) code |= static_cast<std::uint32_t>(at[1]) << 8U;
  code = code >> begin % 8 & ((1U << bits) - 1U);
  return code != 0 ? int((header & 0xFFFFU) + code) : 0;
}

template <class Offsets>
GPU_FUNCTION int feature_at(const TiledFrames& frames, const SamplePixel& sample, SampleScale scale,
                            const Offsets& offsets) {
  const FrameInfo frame = frames.frames[sample.frame - frames.first];
  const std::uint32_t* words = frames.words + frame.word;
  const auto read = [&](int u, int v) -> int {
    if (u < 0 || v < 0 || u >= frame.width || v >= frame.height) return frames.outside_mm;
    const int mm = tiled_depth(words, frame, u, v);
    return mm != 0 ? mm : frames.hole_mm;
  };
  return feature(sample.u, sample.v, OffsetScale{scale.u, scale.v}, probe_range(sample.depth_mm, frames.clip_mm),
                 offsets, read);
}

GPU_FUNCTION std::uint32_t global_thread(unsigned thread) { return block_x() * threads_in_block() + thread; }

GPU_KERNEL void run_kernel(const ScaleArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t i = global_thread(thread);
    if (i >= a.samples.count) continue;
    const SamplePixel sample = a.samples.pixels[i];
    const FrameInfo& frame = a.frames.frames[sample.frame - a.frames.first];
    a.scales[i] = {offset_scale(frame.unit_u, sample.depth_mm), offset_scale(frame.unit_v, sample.depth_mm)};
  }
}

GPU_KERNEL void run_kernel(const RelabelArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t i = global_thread(thread);
    if (i < a.samples && a.node_of[i] >= 0) a.node_of[i] = a.node_of_child[a.node_of[i]];
  }
}

GPU_KERNEL void run_kernel(const FillArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t i = global_thread(thread);
    if (i < a.count) a.values[i] = a.value;
  }
}

/// Returns the last node that begins at or before `at`. `begin_of(n)` rises with n.
template <class BeginOf>
GPU_FUNCTION std::int32_t node_at(std::int32_t nodes, std::uint32_t at, const BeginOf& begin_of) {
  std::int32_t low = 0, high = nodes - 1;
  while (low < high) {
    const std::int32_t middle = (low + high + 1) / 2;
    if (begin_of(middle) <= at) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/// Of a node's samples the one with rank r is counted if r * counted / size is less than that of r + 1
/// (tree_shard.cpp): the j-th counted one is the first whose next rank times counted reaches (j + 1) * size.
GPU_KERNEL void run_kernel(const RowsArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t row = global_thread(thread);
    if (row >= a.rows) continue;
    const std::int32_t n = node_at(a.node_count, row, [&](std::int32_t i) { return a.nodes[i].row_begin; });
    const RowNode node = a.nodes[n];
    std::int64_t rank = row - node.row_begin;
    if (node.counted == node.size) {
      rank += node.first_rank;
    } else {
      const std::int64_t j = rank + node.first_rank * node.counted / node.size;
      rank = ((j + 1) * node.size + node.counted - 1) / node.counted - 1;
    }
    const std::uint32_t sample = a.order[node.begin + static_cast<std::uint32_t>(rank - node.first_rank)];
    a.row_of[sample] = row + 1;
    a.labels[row] = a.samples.pixels[sample].label;
  }
}

/// The candidates' offsets of a node, by columns.
struct CandidateOffsets {
  int du1, dv1, du2, dv2;
};

/// Samples are taken in the order of their frames, whatever their node: blocks that run at the same time read the same
/// frames, which the caches hold meanwhile.
GPU_KERNEL void run_kernel(const EvaluateArguments a) {
  const auto padded = static_cast<unsigned>(a.padded), side_by_side = threads_in_block() / padded;
  GPU_LAST_PHASE(thread) {
    const unsigned candidate = thread % padded;
    if (thread / padded >= side_by_side) continue;
    for (auto i = thread / padded; i < static_cast<unsigned>(a.samples_in_block); i += side_by_side) {
      const std::uint32_t s = block_x() * static_cast<unsigned>(a.samples_in_block) + i;
      if (s >= a.samples.count || a.row_of[s] == 0) continue;
      const std::int16_t* column =
          a.offsets + static_cast<std::size_t>(a.node_of[s] - a.group_begin) * 4 * padded + candidate;
      const CandidateOffsets offsets{column[0], column[padded], column[2 * padded], column[3 * padded]};
      int value = feature_at(a.frames, a.samples.pixels[s], a.samples.scales[s], offsets);
      value = value < -32768 ? -32768 : value > 32767 ? 32767 : value;
      a.values[static_cast<std::size_t>(a.row_of[s] - 1) * padded + candidate] = static_cast<std::int16_t>(value);
    }
  }
}

GPU_KERNEL void run_kernel(const RangesArguments a) {
  GPU_SHARED(std::int32_t, negated_low, kMostCandidates);
  GPU_SHARED(std::int32_t, high, kMostCandidates);
  GPU_SHARED(std::int32_t, counts, kMostClasses);
  const RowChunk chunk = a.rows.chunks[block_x()];
  const auto padded = static_cast<unsigned>(a.rows.padded), classes = static_cast<unsigned>(a.classes);
  GPU_PHASE(thread) {
    for (unsigned i = thread; i < padded; i += threads_in_block()) negated_low[i] = high[i] = -32768;
    for (unsigned i = thread; i < classes; i += threads_in_block()) counts[i] = 0;
  }
  GPU_PHASE(thread) {
    const unsigned side_by_side = threads_in_block() / padded, candidate = thread % padded;
    if (thread / padded >= side_by_side) continue;
    std::int32_t least_negated = -32768, most = -32768;
    for (unsigned r = thread / padded; r < chunk.rows; r += side_by_side) {
      const std::int32_t value = a.rows.values[static_cast<std::size_t>(chunk.first_row + r) * padded + candidate];
      least_negated = -value > least_negated ? -value : least_negated;
      most = value > most ? value : most;
      if (candidate == 0) add(&counts[a.rows.labels[chunk.first_row + r]], 1);
    }
    raise(&negated_low[candidate], least_negated);
    raise(&high[candidate], most);
  }
  GPU_LAST_PHASE(thread) {
    const std::size_t of_node = static_cast<std::size_t>(chunk.node) * padded;
    for (unsigned i = thread; i < padded; i += threads_in_block()) {
      raise(a.negated_low + of_node + i, negated_low[i]);
      raise(a.high + of_node + i, high[i]);
    }
    for (unsigned i = thread; i < classes; i += threads_in_block()) {
      if (counts[i] != 0) add(a.class_counts + static_cast<std::size_t>(chunk.node) * classes + i, counts[i]);
    }
  }
}

/// Two candidates' counts are the halves of a number: none exceeds 16 bits, so neither runs over into the other. Where
/// a block's shared memory has no room for all classes it counts some of them after the others.
GPU_KERNEL void run_kernel(const CountArguments a) {
  constexpr unsigned kPairs = 4;
  GPU_SHARED(std::uint32_t, counts, kSharedCounts);
  const RowChunk chunk = a.rows.chunks[block_x()];
  const CountNode node = a.histograms.nodes[chunk.node];
  const auto padded = static_cast<unsigned>(a.rows.padded), bins = static_cast<unsigned>(node.bins);
  const unsigned first = block_y() * 2 * kPairs;
  const unsigned room = kSharedCounts / (bins * kPairs), classes = static_cast<unsigned>(node.classes);
  const std::size_t of_node = static_cast<std::size_t>(chunk.node) * padded;
  for (unsigned begin = 0; begin < classes; begin += room) {
    const unsigned end = begin + room < classes ? begin + room : classes;
    const unsigned cells = (end - begin) * bins * kPairs;
    GPU_PHASE(thread) {
      for (unsigned i = thread; i < cells; i += threads_in_block()) counts[i] = 0;
    }
    GPU_PHASE(thread) {
      for (unsigned i = thread; i < chunk.rows * 2 * kPairs; i += threads_in_block()) {
        const unsigned candidate = first + i % (2 * kPairs);
        const std::size_t row = chunk.first_row + i / (2 * kPairs);
        const unsigned label =
            a.class_of[static_cast<std::size_t>(chunk.node) * static_cast<unsigned>(a.classes) + a.rows.labels[row]];
        if (label < begin || label >= end) continue;
        const int above = a.rows.values[row * padded + candidate] - a.low[of_node + candidate];
        const unsigned twice = 2U * static_cast<unsigned>(above < 32767 ? above : 32767);
        const unsigned bin = twice * a.factor[of_node + candidate] >> 16U;
        add(&counts[((label - begin) * bins + bin) * kPairs + i % (2 * kPairs) / 2], i % 2 == 0 ? 1U : 65536U);
      }
    }
    // No barrier: a thread clears for the next pass what it reads here.
    GPU_LAST_PHASE(thread) {
      for (unsigned i = thread; i < cells; i += threads_in_block()) {
        if (counts[i] == 0) continue;
        const std::size_t to = node.first +
                               (static_cast<std::size_t>(begin) * bins + i / kPairs) * (kMostCandidates / 2) +
                               first / 2 + i % kPairs;
        add(a.histograms.counts + to, counts[i]);
      }
    }
  }
}

GPU_FUNCTION std::int32_t count_of(const std::uint32_t* counts, std::size_t cell, unsigned candidate) {
  const std::uint32_t pair = counts[cell * (kMostCandidates / 2) + candidate / 2];
  return static_cast<std::int32_t>(candidate % 2 == 0 ? pair & 0xFFFFU : pair >> 16U);
}

/// A thread for each candidate adds up the entropies of all classes for every bin, which are integers; then it looks
/// for the largest gain (scan_bins).
GPU_KERNEL void run_kernel(const BestArguments a) {
  constexpr std::int32_t kNothing = -2147483647 - 1;
  GPU_SHARED(std::int32_t, sums, kMostBins * kMostCandidates);
  GPU_SHARED(std::int32_t, lefts, kMostBins * kMostCandidates);
  GPU_SHARED(std::int32_t, scores, kMostCandidates);
  GPU_SHARED(std::int32_t, found, kMostCandidates);
  GPU_SHARED(std::int32_t, best, 2);
  const CountNode node = a.histograms.nodes[block_x()];
  const std::uint32_t* counts = a.histograms.counts + node.first;
  const auto bins = static_cast<unsigned>(node.bins), classes = static_cast<unsigned>(node.classes);
  GPU_PHASE(thread) {
    for (unsigned c = thread; c < kMostCandidates; c += threads_in_block()) {
      scores[c] = kNothing;
      found[c] = 0;
      if (c >= static_cast<unsigned>(a.candidates)) continue;
      std::int32_t total = 0;
      for (unsigned b = 0; b < bins; ++b) sums[b * kMostCandidates + c] = lefts[b * kMostCandidates + c] = 0;
      for (unsigned k = 0; k < classes; ++k) {
        const std::int32_t all = a.totals[node.totals + k];
        total += all;
        std::int32_t left = 0;
        for (unsigned b = 0; b + 1 < bins; ++b) {
          left += count_of(counts, static_cast<std::size_t>(k) * bins + b, c);
          sums[b * kMostCandidates + c] += a.entropy[left] + a.entropy[all - left];
          lefts[b * kMostCandidates + c] += left;
        }
      }
      for (unsigned b = 0; b + 1 < bins; ++b) {
        const std::int32_t left = lefts[b * kMostCandidates + c], right = total - left;
        const std::int32_t score = sums[b * kMostCandidates + c] - a.entropy[left] - a.entropy[right];
        if (left < node.least || right < node.least || score <= scores[c]) continue;
        scores[c] = score;
        found[c] = static_cast<std::int32_t>(b);
      }
    }
  }
  GPU_PHASE(thread) {
    if (thread != 0) continue;
    BestOfNode chosen{-1, 0, kNothing};
    for (unsigned c = 0; c < static_cast<unsigned>(a.candidates); ++c) {
      if (scores[c] > chosen.score) chosen = {static_cast<std::int32_t>(c), found[c], scores[c]};
    }
    best[0] = chosen.candidate;
    best[1] = chosen.bin;
    a.best[block_x()] = chosen;
  }
  GPU_LAST_PHASE(thread) {
    for (unsigned k = thread; k < classes; k += threads_in_block()) {
      std::int32_t below = 0;
      for (std::int32_t b = 0; best[0] >= 0 && b < best[1]; ++b) {
        below += count_of(counts, static_cast<std::size_t>(k) * bins + static_cast<unsigned>(b),
                          static_cast<unsigned>(best[0]));
      }
      a.below[node.totals + k] = below;
    }
  }
}

GPU_KERNEL void run_kernel(const CollectArguments a) {
  const RowChunk chunk = a.rows.chunks[block_x()];
  const Interval interval = a.intervals[chunk.node];
  GPU_LAST_PHASE(thread) {
    for (unsigned r = thread; r < chunk.rows; r += threads_in_block()) {
      const std::size_t row = chunk.first_row + r;
      const std::int16_t value =
          a.rows.values[row * static_cast<unsigned>(a.rows.padded) + static_cast<unsigned>(interval.candidate)];
      if (value <= interval.above || value > interval.last) continue;
      a.found[add(a.count, std::uint32_t{1})] = {chunk.node, value, a.rows.labels[row], 0};
    }
  }
}

GPU_KERNEL void run_kernel(const RouteArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t s = global_thread(thread);
    if (s >= a.samples.count || a.node_of[s] < 0) continue;
    const PlainNode split = a.splits[a.node_of[s]];
    const SamplePixel sample = a.samples.pixels[s];
    const bool right =
        split.divided != 0 && feature_at(a.frames, sample, a.samples.scales[s], split) > split.threshold_mm;
    const std::int32_t child = 2 * a.node_of[s] + (right ? 1 : 0);
    a.node_of[s] = child;
    add(a.counts + static_cast<std::size_t>(child) * static_cast<unsigned>(a.classes) + sample.label, std::uint32_t{1});
  }
}

/// Calls `use(node, sample, goes_right)` for the samples of a thread, in their order.
template <class Use>
GPU_FUNCTION void for_moves(const Moves& a, unsigned thread, const Use& use) {
  const std::uint32_t begin = global_thread(thread) * kMoveRun;
  for (std::uint32_t q = begin; q < begin + kMoveRun && q < a.samples; ++q) {
    const std::int32_t n = node_at(a.node_count, q, [&](std::int32_t i) { return a.nodes[i].level_begin; });
    const std::uint32_t sample = a.order[a.nodes[n].begin + (q - a.nodes[n].level_begin)];
    use(a.nodes[n], q, sample, (a.node_of[sample] & 1) != 0);
  }
}

GPU_KERNEL void run_kernel(const CountRightArguments a) {
  GPU_SHARED(std::uint32_t, sum, 1);
  GPU_PHASE(thread) {
    if (thread == 0) sum[0] = 0;
  }
  GPU_PHASE(thread) {
    std::uint32_t right = 0;
    for_moves(a.moves, thread,
              [&](const MoveNode&, std::uint32_t, std::uint32_t, bool goes_right) { right += goes_right ? 1 : 0; });
    if (right > 0) add(&sum[0], right);
  }
  GPU_LAST_PHASE(thread) {
    if (thread == 0) a.of_block[block_x()] = sum[0];
  }
}

/// How many samples before one go right is a sum over the blocks before, the block's threads before and the thread's
/// own before; those of the threads by doubling distances.
GPU_KERNEL void run_kernel(const MoveArguments a) {
  GPU_SHARED(std::uint32_t, sums,
             2 * kMostThreads);  // of the threads up to one; read from one half, written to the other
  const unsigned threads = threads_in_block();
  GPU_PHASE(thread) {
    std::uint32_t right = 0;
    for_moves(a.moves, thread,
              [&](const MoveNode&, std::uint32_t, std::uint32_t, bool goes_right) { right += goes_right ? 1 : 0; });
    sums[thread] = right;
  }
  unsigned from = 0;
  for (unsigned distance = 1; distance < threads; distance *= 2) {
    const unsigned to = kMostThreads - from;
    GPU_PHASE(thread) {
      sums[to + thread] = sums[from + thread] + (thread >= distance ? sums[from + thread - distance] : 0);
    }
    from = to;
  }
  GPU_LAST_PHASE(thread) {
    std::uint32_t right = a.before_block[block_x()] + (thread > 0 ? sums[from + thread - 1] : 0);
    for_moves(a.moves, thread, [&](const MoveNode& node, std::uint32_t q, std::uint32_t sample, bool goes_right) {
      const std::uint32_t of_node = right - node.right_before;
      a.order[goes_right ? node.right + of_node : node.left + (q - node.level_begin) - of_node] = sample;
      right += goes_right ? 1 : 0;
    });
  }
}

GPU_KERNEL void run_kernel(const FindLeavesArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t s = global_thread(thread);
    if (s >= a.samples.count) continue;
    const SamplePixel sample = a.samples.pixels[s];
    const SampleScale scale = a.samples.scales[s];
    std::int32_t at = a.node_count > 0 ? 0 : -1;
    while (at >= 0) {
      const PlainNode node = a.nodes[at];
      at = feature_at(a.frames, sample, scale, node) <= node.threshold_mm ? node.left : node.right;
    }
    a.leaves[s] = static_cast<std::uint32_t>(-1 - at);
  }
}

/// Returns what a sample weighs (SampleWeights::of).
GPU_FUNCTION std::int32_t weight_of(const LeafLabels& a, const SamplePixel& sample) {
  constexpr std::int32_t kUnit = 64;
  return a.of_class[sample.label] * (sample.heading < a.weighted_headings ? a.of_heading[sample.heading] : kUnit);
}

/// Returns the first place of the headings of a part's side.
GPU_FUNCTION int first_turn(const LeafLabels& a, int label) { return a.classes + a.groups[label] * a.headings; }

GPU_KERNEL void run_kernel(const LeafWeightsArguments a) {
  GPU_LAST_PHASE(thread) {
    const std::uint32_t s = global_thread(thread);
    if (s >= a.samples.count) continue;
    const SamplePixel sample = a.samples.pixels[s];
    std::uint64_t* row = a.weights + static_cast<std::size_t>(a.leaves[s]) * static_cast<unsigned>(a.labels.places);
    const auto weight = static_cast<std::uint64_t>(weight_of(a.labels, sample));
    add(row + sample.label, weight);
    if (sample.heading < a.labels.headings) add(row + first_turn(a.labels, sample.label) + sample.heading, weight);
  }
}

GPU_FUNCTION bool is_in_portion(const GradientArguments& a, std::uint32_t s) {
  return s < a.samples.count && (a.samples.pixels[s].frame + a.first_frame) % a.portions == a.portion;
}

/// As leaf_shard.cpp computes it: the softmax of a sample's logits as in the kernel of labelling, then for each logit
/// the weight of the truth minus that of its share.
GPU_KERNEL void run_kernel(const GradientArguments a) {
  using G = LogitGroups;
  constexpr unsigned kMostSamples = kMostThreads / kLogitLanes;
  GPU_SHARED(float, values, kSharedLogits);
  GPU_SHARED(std::int32_t, tops, kMostSamples * G::kCount);
  GPU_SHARED(std::int32_t, fixed, kMostSamples * G::kCount);
  GPU_SHARED(float, scales, kMostSamples* G::kCount);
  GPU_SHARED(float, of_side, kMostSamples);
  const auto samples = static_cast<unsigned>(a.samples_in_block), places = static_cast<unsigned>(a.labels.places);
  const std::uint32_t first = block_x() * samples;
  GPU_PHASE(thread) {
    for (unsigned i = thread; i < samples * G::kCount; i += threads_in_block()) {
      tops[i] = ordered(G::kAbsent);
      fixed[i] = 0;
    }
  }
  GPU_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (i >= samples || !is_in_portion(a, first + i)) continue;
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      std::int32_t sum = 0;
      for (int t = 0; t < a.trees; ++t) {
        const std::size_t leaf = a.first_leaf[t] + a.leaves[static_cast<std::size_t>(t) * a.samples.count + first + i];
        sum += a.logits[leaf * static_cast<unsigned>(a.stride) + p];
      }
      const float value = float(sum) * a.unit;
      values[i * places + p] = value;
      raise(&tops[i * G::kCount + a.labels.groups[p]], ordered(value));
    }
  }
  GPU_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (i >= samples || !is_in_portion(a, first + i)) continue;
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      const unsigned group = i * G::kCount + a.labels.groups[p];
      const float power = power_below(values[i * places + p], tops[group]);
      values[i * places + p] = power;
      add(&fixed[group], nearest(power * G::kFixed));
    }
  }
  GPU_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (thread % kLogitLanes != 0 || i >= samples || !is_in_portion(a, first + i)) continue;
    float top[G::kCount];
    for (unsigned g = 0; g < G::kCount; ++g) top[g] = unordered(tops[i * G::kCount + g]);
    scale_groups(top, &fixed[i * G::kCount], a.labels.headings > 0, &scales[i * G::kCount]);
  }
  GPU_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (i >= samples || !is_in_portion(a, first + i)) continue;
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      values[i * places + p] = values[i * places + p] * scales[i * G::kCount + a.labels.groups[p]];
    }
  }
  GPU_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (thread % kLogitLanes != 0 || i >= samples || !is_in_portion(a, first + i)) continue;
    const SamplePixel sample = a.samples.pixels[first + i];
    const int turn = first_turn(a.labels, sample.label < a.labels.parts ? sample.label : 0);
    float sum = 0.F;
    const int begin = sample.label < a.labels.parts ? turn : a.labels.classes;
    for (int h = 0; h < a.labels.headings; ++h) sum += values[i * places + static_cast<unsigned>(begin + h)];
    of_side[i] = sum;
    const std::int32_t weight = weight_of(a.labels, sample);
    const float share = values[i * places + sample.label];
    const std::int64_t likelihood =
        static_cast<std::int64_t>(nearest(logarithm(share > 1e-9F ? share : 1e-9F) * 4096.F)) * weight;
    add(a.likelihood, static_cast<std::uint64_t>(likelihood));
    add(a.weight, static_cast<std::uint64_t>(weight));
  }
  GPU_LAST_PHASE(thread) {
    const unsigned i = thread / kLogitLanes;
    if (i >= samples || !is_in_portion(a, first + i)) continue;
    const SamplePixel sample = a.samples.pixels[first + i];
    const float weight = float(weight_of(a.labels, sample)) * a.scale;
    const bool part = sample.label < a.labels.parts;
    const int turns = part ? first_turn(a.labels, sample.label) : -1;
    for (unsigned p = thread % kLogitLanes; p < places; p += kLogitLanes) {
      const float share = values[i * places + p];
      const int heading = int(p) - turns;
      float truth = p == sample.label ? 1.F : 0.F;
      if (p >= static_cast<unsigned>(a.labels.classes)) {
        truth = 0.F;
        if (part && heading >= 0 && heading < a.labels.headings) {
          constexpr std::uint8_t kNoHeading = 255;
          truth = sample.heading == kNoHeading ? share / (of_side[i] > 1e-30F ? of_side[i] : 1e-30F)
                                               : (heading == sample.heading ? 1.F : 0.F);
        }
      }
      const std::int32_t gradient = rounded(weight * (truth - share));
      if (gradient == 0) continue;
      for (int t = 0; t < a.trees; ++t) {
        const std::size_t leaf = a.first_leaf[t] + a.leaves[static_cast<std::size_t>(t) * a.samples.count + first + i];
        add(a.gradients + leaf * static_cast<unsigned>(a.stride) + p, gradient);
      }
    }
  }
}

}  // namespace vesalius::gpu

#include "train/split_candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "train/messages/training_messages.h"

namespace vesalius {
namespace {

constexpr std::uint64_t kSharedStream = 0xFFFFFFFF00000000ULL;

int all_candidates(const SplitOptions& options) {
  return options.shared_features > 0 ? options.shared_features : options.candidates;
}

struct Probe {
  std::int16_t du = 0, dv = 0;
};

Probe draw_probe(const FeatureConvention& convention, const SplitOptions& options, Random& random) {
  const double furthest = std::min<double>(
      double(options.max_offset_m) * convention.reference_focal_px / convention.offset_unit, kMaxOffset);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double share = options.half_normal ? std::min(std::abs(random.normal(0.0, 1.0 / 3.0)), 1.0) : random.uniform();
  return {static_cast<std::int16_t>(std::lround(furthest * share * std::cos(angle))),
          static_cast<std::int16_t>(std::lround(furthest * share * std::sin(angle)))};
}

}  // namespace

CandidateTable::CandidateTable(int candidates)
    : count(candidates), padded((candidates + kLanes - 1) / kLanes * kLanes), offsets(4 * padded, 0) {}

void CandidateTable::set(int index, const TreeNode& node) {
  std::int16_t* column = offsets.data() + index;
  column[0] = node.du1;
  column[padded] = node.dv1;
  column[2 * padded] = node.du2;
  column[3 * padded] = node.dv2;
}

TreeNode CandidateTable::node(int index) const {
  const std::int16_t* column = offsets.data() + index;
  TreeNode node;
  node.du1 = column[0];
  node.dv1 = column[padded];
  node.du2 = column[2 * padded];
  node.dv2 = column[3 * padded];
  return node;
}

CandidateTable draw_candidates(const FeatureConvention& convention, const SplitOptions& options, int count,
                               Random& random) {
  CandidateTable table(count);
  for (int i = 0; i < count; ++i) {
    const Probe first = draw_probe(convention, options, random);
    TreeNode node;
    node.du1 = first.du;
    node.dv1 = first.dv;
    // A probe at the pixel itself shows what is in front of it or behind it (Shotton et al. 2011).
    if (random.uniform() >= double(options.one_sided)) {
      const Probe second = draw_probe(convention, options, random);
      node.du2 = second.du;
      node.dv2 = second.dv;
    }
    table.set(i, node);
  }
  return table;
}

CandidateTable node_candidates(const FeatureConvention& convention, const GrowTreeOptions& options, int tree,
                               std::uint32_t number, int block) {
  const bool shared = options.split.shared_features > 0;
  const std::uint64_t node = (static_cast<std::uint64_t>(tree) << 32U) | number;
  Random random(static_cast<std::uint64_t>(options.seed) + (static_cast<std::uint64_t>(block) << 32U),
                shared ? kSharedStream : node);
  return draw_candidates(convention, options.split, block_candidates(options.split, block), random);
}

int candidate_blocks(const SplitOptions& options) {
  return (all_candidates(options) + kBlockCandidates - 1) / kBlockCandidates;
}

int block_candidates(const SplitOptions& options, int block) {
  return std::min(all_candidates(options) - block * kBlockCandidates, kBlockCandidates);
}

}  // namespace vesalius

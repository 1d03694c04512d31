#include "bench/gpu/count_reads.h"

#include <algorithm>
#include <array>
#include <vector>

#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {
namespace {

constexpr std::size_t kWarp = 32;
constexpr std::uint64_t kSector = 32;

struct Pixel {
  int u = 0, v = 0;
};

/// Different numbers among those of one group.
class Distinct {
 public:
  void add(std::uint64_t number) { numbers_.push_back(number); }
  std::size_t take() {
    std::ranges::sort(numbers_);
    const auto end = std::ranges::unique(numbers_).begin();
    const auto count = static_cast<std::size_t>(end - numbers_.begin());
    numbers_.clear();
    return count;
  }

 private:
  std::vector<std::uint64_t> numbers_;
};

void walk_group(const Tree& tree, std::uint64_t node_bytes, const FeatureConvention& convention,
                const OffsetScaler& scaler, const DepthImage& depth, const Pixel* pixels, std::size_t count,
                std::vector<std::uint8_t>& touched, WalkReads& reads) {
  std::array<std::int32_t, kWarp> at{};
  std::array<std::uint64_t, kWarp> place{};  // of the node in the packed tree: children are neighbours
  at.fill(tree.nodes.empty() ? ~0 : 0);
  Distinct nodes, first, second;
  for (;;) {
    bool goes_on = false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t sector = place[i] * node_bytes / kSector;
      if (at[i] < 0) continue;  // what it reads of its leaf is in the sector that it has just read
      goes_on = true;
      nodes.add(sector);
      touched[sector] = 1;
      const TreeNode& node = tree.nodes[at[i]];
      const OffsetScale scale = scaler.at(depth(pixels[i].u, pixels[i].v));
      const auto probe = [&](int du, int dv, Distinct& into) {
        const int u = probe_place(pixels[i].u, du, scale.u), v = probe_place(pixels[i].v, dv, scale.v);
        if (depth.contains(u, v)) into.add(2 * (std::uint64_t(v) * depth.width() + u) / kSector);
      };
      probe(node.du1, node.dv1, first);
      probe(node.du2, node.dv2, second);
      ++reads.nodes;
      const std::int32_t next = step(tree, at[i], depth, convention, scale, pixels[i].u, pixels[i].v);
      place[i] = 2 * (std::uint64_t(at[i]) + 1) + (next == node.right ? 1 : 0);
      at[i] = next;
    }
    if (!goes_on) return;
    ++reads.warp_levels;
    reads.node_sectors += nodes.take();
    reads.probe_sectors += first.take() + second.take();
  }
}

}  // namespace

WalkReads count_reads(const Forest& forest, const DepthImage& depth, const Camera& camera, const Mask& settled) {
  WalkReads reads;
  const OffsetScaler scaler(forest.convention, camera);
  std::vector<Pixel> pixels;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) != 0 && (settled.empty() || settled(u, v) == 0)) pixels.push_back({u, v});
    }
  }
  reads.pixels = pixels.size();
  for (const Tree& tree : forest.trees) {
    const PackedTree packed = pack(tree, forest.convention);
    const std::uint64_t node_bytes = 4U * static_cast<unsigned>(packed.words_per_node());
    std::vector<std::uint8_t> touched(packed.words.size() * 4 / kSector + 2, 0);
    for (std::size_t i = 0; i < pixels.size(); i += kWarp) {
      walk_group(tree, node_bytes, forest.convention, scaler, depth, pixels.data() + i,
                 std::min(kWarp, pixels.size() - i), touched, reads);
    }
    reads.forest_bytes += packed.words.size() * 4;
    reads.touched_bytes += kSector * static_cast<std::uint64_t>(std::ranges::count(touched, 1));
    reads.logit_bytes += packed.logits.size() * sizeof(PackedTree::LogitLine);
  }
  return reads;
}

}  // namespace vesalius

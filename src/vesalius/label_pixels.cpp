#include "vesalius/label_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vesalius/parallel.h"
#include "vesalius/tree_walk.h"
#include "vesalius/walk_kernels.h"

namespace vesalius {
namespace {

constexpr int kRowGrain = 8;

/// Weighted posteriors of one pixel in fixed point, so that every platform chooses alike.
class Weights {
 public:
  Weights(const LabelChoice& choice, const LabelOptions& options)
      : person_(std::lround(options.person_weight * kOne)),
        background_(std::lround(options.background_weight * kOne)),
        parts_(choice.part_count) {}

  std::int64_t operator()(const std::uint16_t* sums, int c) const {
    return sums[c] * static_cast<std::int64_t>(c < parts_ ? person_ : background_);
  }
  static constexpr float kOne = 1024.F;

 private:
  long person_;
  long background_;
  int parts_;
};

/// What a pixel would take by itself, and the lowest weighted posterior that still rivals it.
struct Candidate {
  std::uint8_t best = kBackground;
  bool unsure = false;
  std::int64_t near_best = 0;
};

Candidate best_class(const std::uint16_t* sums, int classes, const Weights& weight, std::int64_t margin) {
  std::int64_t first = 0;
  std::int64_t second = 0;
  int best = -1;
  for (int c = 0; c < classes; ++c) {
    const std::int64_t p = weight(sums, c);
    if (p > first) {
      second = first;
      first = p;
      best = c;
    } else if (p > second) {
      second = p;
    }
  }
  if (best < 0) return {};
  return {static_cast<std::uint8_t>(best), second > 0 && first - second < margin,
          std::max<std::int64_t>(1, first - margin + 1)};
}

/// How many of the eight neighbours have each label.
std::array<std::uint8_t, 256> count_neighbours(const LabelImage& labels, int u, int v) {
  std::array<std::uint8_t, 256> count{};
  for (int nv = v - 1; nv <= v + 1; ++nv) {
    for (int nu = u - 1; nu <= u + 1; ++nu) {
      if ((nu != u || nv != v) && labels.contains(nu, nv)) ++count[labels(nu, nv)];
    }
  }
  return count;
}

void add_leaf(const TreeLeaf& leaf, std::uint16_t* sums) {
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    sums[leaf.label[k]] = static_cast<std::uint16_t>(sums[leaf.label[k]] + leaf.probability[k]);
  }
}

/// Sums of the rows' pixels, which are still zero.
void label_rows(const std::vector<PackedTree>& trees, const PaddedDepth& depth, const WalkPixels& pixels,
                Posteriors& out) {
  const std::size_t stride = pixels.padded_size();
  std::vector<std::uint32_t> leaves(trees.size() * stride);
  for (std::size_t t = 0; t < trees.size(); ++t) walk_pixels(trees[t], depth, pixels, leaves.data() + t * stride);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::uint16_t* sums = out.at(pixels.column(WalkPixels::kU)[i], pixels.column(WalkPixels::kV)[i]);
    for (std::size_t t = 0; t < trees.size(); ++t) add_leaf(trees[t].leaves[leaves[t * stride + i]], sums);
  }
}

/// The same one pixel after the other, for pictures of any size.
void label_rows_plainly(const Forest& forest, const std::vector<PackedTree>& packed, const DepthImage& depth, int begin,
                        int end, const OffsetScaler& scaler, Posteriors& out) {
  for (int v = begin; v < end; ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0) continue;
      for (std::size_t t = 0; t < packed.size(); ++t) {
        const Tree& tree = forest.trees[t];
        const TreeLeaf& leaf = walk(tree, depth, forest.convention, scaler.at(depth(u, v)), u, v);
        add_leaf(packed[t].leaves[static_cast<std::size_t>(&leaf - tree.leaves.data())], out.at(u, v));
      }
    }
  }
}

}  // namespace

void visit_options(const std::string& prefix, LabelOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "background-weight", o.background_weight,
                 {"", 0.0, 100.0, "Factor on the background's posterior; above 1 finds fewer and thinner people."});
  visitor.option(prefix + "person-weight", o.person_weight,
                 {"", 0.0, 100.0, "Factor on the posteriors of all body parts."});
  visitor.option(prefix + "unsure-margin", o.unsure_margin,
                 {"", 0.0, 1.0, "Where the two best labels' probabilities differ by less, neighbours decide."});
}

ForestLabeller::ForestLabeller(Forest forest) : forest_(std::move(forest)) {
  check(forest_);
  distributions_ = vesalius::has_distributions(forest_);
  packed_.resize(forest_.trees.size());
  parallel_for(static_cast<int>(packed_.size()), [&](int t) {
    const auto i = static_cast<std::size_t>(t);
    packed_[i] = pack(forest_.trees[i], forest_.convention);
  });
}

Posteriors ForestLabeller::label(const DepthImage& depth, const Camera& camera) const {
  Posteriors out{depth.width(), depth.height(), forest_.class_count(), static_cast<int>(forest_.trees.size()), {}};
  out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
  const OffsetScaler scaler(forest_.convention, camera);
  if (std::max(depth.width(), depth.height()) > PaddedDepth::kMaxSide) {
    parallel_ranges(depth.height(), kRowGrain,
                    [&](int begin, int end) { label_rows_plainly(forest_, packed_, depth, begin, end, scaler, out); });
    return out;
  }
  const PaddedDepth padded(depth, forest_.convention);
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    label_rows(packed_, padded, WalkPixels(depth, begin, end, scaler, forest_.convention), out);
  });
  return out;
}

LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options) {
  const Weights weight(choice, options);
  const int classes = choice.part_count + (choice.has_background && choice.prior == nullptr ? 1 : 0);
  const auto margin = static_cast<std::int64_t>(
      std::ceil(static_cast<double>(options.unsure_margin) * 255.0 * posteriors.trees * Weights::kOne));
  const auto may_have_part = [&](int u, int v) {
    return depth(u, v) != 0 && (choice.prior == nullptr || (*choice.prior)(u, v) != 0);
  };
  // Inner numbering while choosing: the background is class part_count.
  LabelImage first(depth.width(), depth.height(), kBackground);
  Mask unsure(depth.width(), depth.height(), 0);
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (!may_have_part(u, v)) continue;
        const Candidate c = best_class(posteriors.at(u, v), classes, weight, margin);
        first(u, v) = c.best;
        unsure(u, v) = c.unsure ? 1 : 0;
      }
    }
  });
  LabelImage out(depth.width(), depth.height(), kBackground);
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        std::uint8_t label = first(u, v);
        if (unsure(u, v) != 0) {
          const std::uint16_t* sums = posteriors.at(u, v);
          const std::int64_t rival = best_class(sums, classes, weight, margin).near_best;
          const auto count = count_neighbours(first, u, v);
          for (int c = 0; c < classes; ++c) {
            if (weight(sums, c) >= rival && count[static_cast<std::size_t>(c)] > count[label]) {
              label = static_cast<std::uint8_t>(c);
            }
          }
        }
        out(u, v) = label < choice.part_count ? label : kBackground;
      }
    }
  });
  return out;
}

}  // namespace vesalius

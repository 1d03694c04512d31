#include "vesalius/forest/label_pixels.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/error.h"
#include "vesalius/forest/background_gate.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/top_two.h"
#include "vesalius/forest/tree_walk.h"
#include "vesalius/forest/walk_kernels.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// The weighted posteriors of one pixel.
class Weights {
 public:
  Weights(const LabelChoice& choice, const ChoiceWeights& weights) : weights_(weights), parts_(choice.part_count) {}

  std::int64_t operator()(const std::uint16_t* sums, int c) const {
    return c < parts_ ? of_part(sums[c]) : of_background(sums[c]);
  }
  std::int64_t of_part(std::uint16_t sum) const { return sum * weights_.part; }
  std::int64_t of_background(std::uint16_t sum) const { return sum * weights_.background; }
  std::int64_t margin() const { return weights_.margin; }

 private:
  ChoiceWeights weights_;
  int parts_;
};

/// Returns how many of the eight neighbours have a label.
int count_neighbours(const LabelImage& labels, int u, int v, std::uint8_t label) {
  int count = 0;
  for (int nv = v - 1; nv <= v + 1; ++nv) {
    for (int nu = u - 1; nu <= u + 1; ++nu) {
      if ((nu != u || nv != v) && labels.contains(nu, nv) && labels(nu, nv) == label) ++count;
    }
  }
  return count;
}

/// Chooses the labels of one picture (section 4.3): first for every pixel by itself, then for the uncertain ones by
/// their neighbours. Until the end the background is class part_count.
class Chooser {
 public:
  Chooser(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice, const LabelOptions& options)
      : posteriors_(posteriors),
        depth_(depth),
        choice_(choice),
        weight_(choice, choice_weights(options, posteriors.whole)),
        classes_(choice.prior == nullptr ? posteriors.classes : choice.part_count),
        box_(choice.box != nullptr ? *choice.box : Box{0, 0, depth.width(), depth.height()}),
        first_(depth.width(), depth.height(), kBackground),
        unsure_(depth.width(), depth.height(), 0) {}

  LabelImage run() {
    parallel_ranges(box_.height, kRowGrain, [&](int begin, int end) {
      std::vector<std::uint8_t> skip(static_cast<std::size_t>(box_.width));
      std::vector<TopTwo> parts(skip.size());
      for (int v = box_.v + begin; v < box_.v + end; ++v) choose_alone(v, skip, parts);
    });
    LabelImage out(depth_.width(), depth_.height(), kBackground);
    parallel_ranges(box_.height, kRowGrain, [&](int begin, int end) {
      const auto part = [parts = choice_.part_count](std::uint8_t c) { return c < parts ? c : kBackground; };
      for (int v = box_.v + begin; v < box_.v + end; ++v) {
        const std::uint8_t *first = first_.row(v) + box_.u, *unsure = unsure_.row(v) + box_.u,
                           *last = unsure + box_.width;
        std::uint8_t* to = out.row(v) + box_.u;
        std::transform(first, first + box_.width, to, part);
        for (const std::uint8_t* at = unsure; (at = std::find(at, last, std::uint8_t{1})) != last; ++at) {
          to[at - unsure] = part(ask_neighbours(box_.u + int(at - unsure), v));
        }
      }
    });
    return out;
  }

 private:
  /// `skip` becomes 1 where no part is possible; elsewhere `parts` receives the two best parts.
  void choose_alone(int v, std::vector<std::uint8_t>& skip, std::vector<TopTwo>& parts) {
    const std::uint16_t* depth = depth_.row(v) + box_.u;
    const std::uint8_t* prior = choice_.prior != nullptr ? choice_.prior->row(v) + box_.u : nullptr;
    const bool rivalled = classes_ > choice_.part_count;
    const std::uint8_t* settled =
        rivalled && !posteriors_.settled.empty() ? posteriors_.settled.row(v) + box_.u : nullptr;
    std::transform(depth, depth + box_.width, skip.begin(), [](std::uint16_t mm) { return std::uint8_t(mm == 0); });
    const auto or_none = [](std::uint8_t is, std::uint8_t other) { return std::uint8_t(is | (other == 0)); };
    const auto or_any = [](std::uint8_t is, std::uint8_t other) { return std::uint8_t(is | (other != 0)); };
    if (prior != nullptr) std::transform(skip.begin(), skip.end(), prior, skip.begin(), or_none);
    if (settled != nullptr) {
      std::transform(skip.begin(), skip.end(), settled, skip.begin(), or_any);
      const auto background = static_cast<std::uint8_t>(choice_.part_count);
      std::uint8_t* first = first_.row(v) + box_.u;
      std::transform(settled, settled + box_.width, first,
                     [=](std::uint8_t is) { return is != 0 ? background : kBackground; });
    }
    find_top_two(posteriors_.at(box_.u, v), static_cast<std::size_t>(posteriors_.classes), choice_.part_count,
                 skip.data(), box_.width, parts.data());
    for (std::size_t i = 0; i < skip.size(); ++i) {
      if (skip[i] != 0) continue;
      const int u = box_.u + int(i);
      choose_between(parts[i], rivalled ? posteriors_.at(u, v)[choice_.part_count] : std::uint16_t{0}, first_(u, v),
                     unsure_(u, v));
    }
  }

  /// Chooses the best part or the background, whichever has more weight; on a tie the part.
  void choose_between(const TopTwo& parts, std::uint16_t background_sum, std::uint8_t& label,
                      std::uint8_t& unsure) const {
    const std::int64_t part = weight_.of_part(parts.first);
    const std::int64_t background = weight_.of_background(background_sum);
    const std::int64_t first = std::max(part, background);
    if (first == 0) return;
    label = static_cast<std::uint8_t>(background > part ? choice_.part_count : parts.best);
    const std::int64_t second = std::max(std::min(part, background), weight_.of_part(parts.second));
    unsure = second > 0 && first - second < weight_.margin() ? 1 : 0;
  }

  /// Returns that one of the nearly best classes which most neighbours have.
  std::uint8_t ask_neighbours(int u, int v) const {
    const std::uint16_t* sums = posteriors_.at(u, v);
    std::uint8_t label = first_(u, v);
    const std::int64_t rival = std::max<std::int64_t>(1, weight_(sums, label) - weight_.margin() + 1);
    int most = count_neighbours(first_, u, v, label);
    for (int c = 0; c < classes_; ++c) {
      if (weight_(sums, c) < rival) continue;
      const int count = count_neighbours(first_, u, v, static_cast<std::uint8_t>(c));
      if (count <= most) continue;
      most = count;
      label = static_cast<std::uint8_t>(c);
    }
    return label;
  }

  const Posteriors& posteriors_;
  const DepthImage& depth_;
  const LabelChoice& choice_;
  Weights weight_;
  int classes_;
  Box box_;
  LabelImage first_;
  Mask unsure_;
};

void add_leaf(const TreeLeaf& leaf, std::uint16_t* sums) {
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    sums[leaf.label[k]] = static_cast<std::uint16_t>(sums[leaf.label[k]] + leaf.probability[k]);
  }
}

/// Clears rows just before they are written, so that they are in the cache.
void clear_rows(int begin, int end, Posteriors& out) { std::fill(out.at(0, begin), out.at(0, end), std::uint16_t{0}); }

/// The trees as pixels walk them, and how their leaves are read.
struct PackedForest {
  FeatureConvention convention;
  float logit_unit = 0.F;
  LogitLayout layout;  ///< where leaves have logits
  std::vector<PackedTree> trees;

  bool has_logits() const { return logit_unit > 0.F; }
};

/// Finds the posteriors of pixels whose leaves, [tree][pixel], are known.
void read_logits(const PackedForest& forest, const WalkPixels& pixels, const std::vector<std::uint32_t>& leaves,
                 Posteriors& out) {
  constexpr std::size_t kAhead = 4;  // leaves are all over the memory: they are on their way before they are read
  const std::vector<PackedTree>& trees = forest.trees;
  const std::size_t stride = pixels.padded_size();
  LogitReader reader(forest.layout, forest.logit_unit, int(trees.size()));
  std::vector<const std::int8_t*> of_pixel(trees.size() * (kAhead + 1));
  for (std::size_t i = 0; i < pixels.size() + kAhead; ++i) {
    if (i < pixels.size()) {
      const std::int8_t** next = of_pixel.data() + i % (kAhead + 1) * trees.size();
      for (std::size_t t = 0; t < trees.size(); ++t) {
        next[t] = trees[t].logits_of(leaves[t * stride + i]);
        hwy::Prefetch(next[t]);
      }
    }
    if (i < kAhead) continue;
    const std::size_t here = i - kAhead;
    const int u = pixels.column(WalkPixels::kU)[here], v = pixels.column(WalkPixels::kV)[here];
    reader.read(of_pixel.data() + here % (kAhead + 1) * trees.size(), out.at(u, v), out.turns_at(u, v));
  }
}

/// Finds the posteriors of pixels, which are still zero.
void label_rows(const PackedForest& forest, const PaddedDepth& depth, const WalkPixels& pixels, Posteriors& out) {
  const std::vector<PackedTree>& trees = forest.trees;
  const std::size_t stride = pixels.padded_size();
  std::vector<std::uint32_t> leaves(trees.size() * stride);
  for (std::size_t t = 0; t < trees.size(); ++t) walk_pixels(trees[t], depth, pixels, leaves.data() + t * stride);
  if (forest.has_logits()) {
    read_logits(forest, pixels, leaves, out);
    return;
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::uint16_t* sums = out.at(pixels.column(WalkPixels::kU)[i], pixels.column(WalkPixels::kV)[i]);
    for (std::size_t t = 0; t < trees.size(); ++t) add_leaf(trees[t].leaves[leaves[t * stride + i]], sums);
  }
}

/// The posteriors of a picture for which the forest is not asked about all pixels: first about those of the gate's
/// grid, then about those that the gate leaves open.
class GatedLabels {
 public:
  GatedLabels(const PackedForest& forest, const DepthImage& depth, const PaddedDepth& padded,
              const OffsetScaler& scaler, Posteriors& out)
      : forest_(forest),
        depth_(depth),
        padded_(padded),
        scaler_(scaler),
        out_(out),
        done_(depth.width(), depth.height(), 0) {}

  void run(float gate) {
    parallel_ranges(depth_.height(), kRowGrain, [&](int begin, int end) {
      clear_holes(begin, end);
      ask(begin, end, BackgroundGate::kStep);
    });
    const BackgroundGate closed(depth_, out_, gate);
    out_.settled = Mask(depth_.width(), depth_.height(), 0);
    parallel_ranges(depth_.height(), kRowGrain, [&](int begin, int end) { settle(closed, begin, end); });
    parallel_ranges(depth_.height(), kRowGrain, [&](int begin, int end) { ask(begin, end, 1); });
  }

 private:
  void clear_holes(int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < depth_.width(); ++u) {
        if (depth_(u, v) == 0) std::fill_n(out_.at(u, v), out_.classes, std::uint16_t{0});
      }
    }
  }

  /// Asks the forest about those pixels of the rows that are on a grid and not yet done.
  void ask(int begin, int end, int step) {
    WalkPixels pixels(static_cast<std::size_t>(depth_.width()) * static_cast<std::size_t>(end - begin), scaler_,
                      forest_.convention);
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < depth_.width(); ++u) {
        if (depth_(u, v) == 0 || done_(u, v) != 0 || u % step != 0 || v % step != 0) continue;
        pixels.add(u, v, depth_(u, v));
        std::fill_n(out_.at(u, v), out_.classes, std::uint16_t{0});
        done_(u, v) = 1;
      }
    }
    label_rows(forest_, padded_, pixels, out_);
  }

  void settle(const BackgroundGate& closed, int begin, int end) {
    std::vector<std::uint8_t> shut(static_cast<std::size_t>(depth_.width()));
    for (int v = begin; v < end; ++v) {
      closed.row(v, shut.data());
      for (int u = 0; u < depth_.width(); ++u) {
        if (shut[u] == 0 || depth_(u, v) == 0 || done_(u, v) != 0) continue;
        out_.settled(u, v) = take_from_grid(depth_, BackgroundGate::kStep, u, v, out_) ? 1 : 0;
        done_(u, v) = out_.settled(u, v);
      }
    }
  }

  const PackedForest& forest_;
  const DepthImage& depth_;
  const PaddedDepth& padded_;
  const OffsetScaler& scaler_;
  Posteriors& out_;
  Mask done_;
};

}  // namespace

namespace {

const Forest& checked(const Forest& forest) {
  check(forest);
  return forest;
}

}  // namespace

TrainedLabeller::TrainedLabeller(const Forest& forest)
    : trees_(int(checked(forest).trees.size())), layout_(forest.body, forest.has_background, forest.headings) {}

void check_sides(const DepthImage& depth) {
  if (std::max(depth.width(), depth.height()) > PaddedDepth::kMaxSide) {
    throw Error("depth image of " + std::to_string(depth.width()) + "x" + std::to_string(depth.height()) +
                " pixels, expected at most " + std::to_string(PaddedDepth::kMaxSide) + " a side");
  }
}

void TrainedLabeller::prepare(const DepthImage& depth, Posteriors& out) const {
  check_sides(depth);
  out.resize_like(
      {.width = depth.width(), .height = depth.height(), .classes = layout_.classes(), .whole = whole(), .sums = {}});
  out.headings = layout_.headings;
  out.turns.resize(depth.size() * out.turn_count());
  out.votes = {};
  out.part_votes = {};
}

struct ForestLabeller::Packed : PackedForest {};

ForestLabeller::ForestLabeller(Forest forest) : TrainedLabeller(forest) {
  Packed packed;
  packed.convention = forest.convention;
  packed.logit_unit = forest.logit_unit;
  packed.layout = layout();
  packed.trees.resize(forest.trees.size());
  parallel_for(int(packed.trees.size()), [&](int t) {
    packed.trees[t] = pack(forest.trees[t], forest.convention);
    forest.trees[t] = {};
  });
  packed_ = std::make_unique<const Packed>(std::move(packed));
}

ForestLabeller::~ForestLabeller() = default;

void ForestLabeller::label_into(const Frame& frame, float gate, Posteriors& out) const {
  const DepthImage& depth = frame.depth;
  prepare(depth, out);
  const OffsetScaler scaler(packed_->convention, frame.camera);
  const PaddedDepth padded(depth, packed_->convention);
  if (gate <= 1.F && layout().background) {
    GatedLabels(*packed_, depth, padded, scaler, out).run(gate);
    return;
  }
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    clear_rows(begin, end, out);
    label_rows(*packed_, padded, WalkPixels(depth, begin, end, scaler, packed_->convention), out);
  });
}

ChoiceWeights choice_weights(const LabelOptions& options, int whole) {
  ChoiceWeights weights;
  const auto one = float(weights.part);
  weights.background = std::lround(options.background_weight * one);
  weights.margin = static_cast<std::int64_t>(std::ceil(double(options.unsure_margin) * whole * one));
  return weights;
}

LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options) {
  return Chooser(posteriors, depth, choice, options).run();
}

}  // namespace vesalius

#include "metrics/ablation_variants.h"

#include <fmt/format.h>

#include <functional>
#include <iterator>
#include <utility>

#include "metrics/reduce_forest.h"
#include "vesalius/forest/make_labeller.h"

namespace vesalius {
namespace {

/// Largest depth step between joined neighbours when only colour separates people. It is larger than any within a
/// person's reach.
constexpr float kAnyStep_m = 1.F;
constexpr float kAskEverywhere = 2.F;  ///< a probability that no background reaches

class VariantList {
 public:
  VariantList(const Forest& forest, FrameScorer::Options whole)
      : forest_(forest), labeller_(make_labeller(forest)), whole_(std::move(whole)), options_(whole_.detect) {}

  void add(const std::string& name, const std::function<void(FrameScorer::Options&)>& change) {
    FrameScorer::Options options = whole_;
    change(options);
    variants_.push_back({name, std::make_unique<FrameScorer>(labeller_, options)});
  }

  void add(const std::string& name, Forest forest) { add(name, std::move(forest), options_); }

  void add(const std::string& name, Forest forest, const DetectOptions& detect) {
    FrameScorer::Options options = whole_;
    options.detect = detect;
    variants_.push_back({name, std::make_unique<FrameScorer>(make_labeller(std::move(forest)), std::move(options))});
  }

  void add_options() {
    using Options = FrameScorer::Options;
    add(options_.refine.second_pass ? "no second iteration" : "second iteration",
        [](Options& o) { o.detect.refine.second_pass = !o.detect.refine.second_pass; });
    if (options_.grow.appearance != "none") {
      add("look by depth alone", [](Options& o) { o.detect.grow.appearance = "none"; });
      add("look by colour alone", [](Options& o) { o.detect.grow.radius_m = kAnyStep_m; });
    }
    for (const std::string appearance : {"hue", "texture"}) {
      if (options_.grow.appearance == appearance) continue;
      add("look by depth and " + appearance, [&](Options& o) { o.detect.grow.appearance = appearance; });
    }
    if (options_.smooth.window > 1) add("no smoothing", [](Options& o) { o.detect.smooth.window = 1; });
    if (labeller_->has_distributions() && options_.smooth.window > 1) {
      add(options_.smooth.mode ? "smoothing by mean" : "smoothing by mode",
          [](Options& o) { o.detect.smooth.mode = !o.detect.smooth.mode; });
    }
    add(options_.search.grandparents ? "no links past unseen parts" : "links past unseen parts",
        [](Options& o) { o.detect.search.grandparents = !o.detect.search.grandparents; });
    add(options_.search.any_root ? "roots of the body alone" : "any part as root",
        [](Options& o) { o.detect.search.any_root = !o.detect.search.any_root; });
    if (labeller_->has_background()) {
      add("proposals with the labels' background",
          [](Options& o) { o.detect.label.proposal_weight = o.detect.label.background_weight; });
      const bool gated = options_.label.gate <= 1.F;
      add(gated ? "forest asked everywhere" : "gate",
          [&](Options& o) { o.detect.label.gate = gated ? kAskEverywhere : LabelOptions().gate; });
    }
    if (options_.grid.step != 1) add("every pixel", [](Options& o) { o.detect.grid.step = 1; });
    if (options_.grid.step != 2) add("every second pixel", [](Options& o) { o.detect.grid.step = 2; });
  }

  void add_forests() {
    if (!forest_.context.empty()) {
      Forest alone = forest_;
      alone.context = {};
      add("each pixel by itself", std::move(alone));
    }
    if (forest_.body.roots.size() > 1) {
      DetectOptions options = options_;
      options.search.any_root = false;
      for (const int root : forest_.body.roots) {
        Forest one_root = forest_;
        one_root.body.roots = {root};
        add(fmt::format("root {} alone", forest_.body.parts[root].name), std::move(one_root), options);
      }
    }
    // Votes cannot be smoothed by their mean, so this variant smooths by mode.
    if (labeller_->has_distributions()) add("votes, smoothed by mode", with_hard_votes(forest_));
    for (const int trees : {1, 2, 4}) {
      if (trees >= std::ssize(forest_.trees)) break;
      add(trees == 1 ? "1 tree" : fmt::format("{} trees", trees), with_first_trees(forest_, trees));
    }
  }

  std::vector<Variant> take() { return std::move(variants_); }

 private:
  const Forest& forest_;
  std::shared_ptr<const PixelLabeller> labeller_;
  const FrameScorer::Options whole_;
  const DetectOptions& options_;
  std::vector<Variant> variants_;
};

}  // namespace

std::vector<Variant> ablation_variants(const Forest& forest, const FrameScorer::Options& options) {
  VariantList list(forest, options);
  list.add_options();
  list.add_forests();
  return list.take();
}

}  // namespace vesalius

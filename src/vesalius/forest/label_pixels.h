#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/boosted_trees.h"
#include "vesalius/forest/facing.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

struct SmoothOptions;

struct LabelOptions {
  float background_weight = 0.5F;  ///< multiplies the background's posterior, which corrects its prior
  float proposal_weight = 0.35F;   ///< the factor used instead for part proposals
  float unsure_margin = 0.05F;     ///< difference in probability below which neighbours decide
  /// If the background's probability is at least this at every fourth pixel of every fourth row around a pixel, and
  /// depth is continuous, the forest is not asked about the pixel. Above 1 it is asked about every pixel.
  float gate = 0.7F;
};
void visit_options(const std::string& prefix, LabelOptions& options, OptionVisitor& visitor);

/// Gives every pixel of a depth image its part posteriors. make_labeller (make_labeller.h) returns the shipped ones;
/// tests and experiments provide others (the truth, a network).
///
/// All member functions are called from several threads at once, also for different pictures: a labeller keeps nothing
/// between calls that could change a result. It may run work in parallel itself (base/parallel.h).
class PixelLabeller {
 public:
  virtual ~PixelLabeller() = default;

  /// Writes the posteriors of all pixels to `out` and reuses its memory. If the background has a probability of at
  /// least `gate` all around a pixel, the pixel may get the posteriors of a neighbour of similar depth and be marked as
  /// settled. A labeller that looks at such pixels gives other posteriors there, which are equally valid. With a gate
  /// above 1 every pixel is looked at, and all devices give the same bits for one forest.
  virtual void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const = 0;

  /// Writes the posteriors as label_into does, and to `smooth` what mean_filter (smooth_labels.h) makes of them.
  /// Returns false and does nothing where the labeller has no quicker way than one after the other.
  virtual bool label_and_smooth_into(const DepthImage& /*depth*/, const Camera& /*camera*/, float /*gate*/,
                                     const SmoothOptions& /*options*/, Posteriors& /*out*/,
                                     Posteriors& /*smooth*/) const {
    return false;
  }

  /// Returns the posteriors of all pixels, each looked at.
  Posteriors label(const DepthImage& depth, const Camera& camera) const {
    Posteriors out;
    label_into(depth, camera, 2.F, out);
    return out;
  }

  virtual const BodyModel& body() const = 0;
  /// Returns whether the last class is the background.
  virtual bool has_background() const = 0;
  /// Returns whether posteriors are more than one vote for each tree.
  virtual bool has_distributions() const = 0;
  /// Returns how a person's heading follows from the posteriors' headings, if it has any.
  virtual const FacingModel& facing_model() const {
    static const FacingModel kNone;
    return kNone;
  }
  /// Returns how what is around a pixel tells whether it is a body (body_context.h), if the forest tells.
  virtual const BoostedTrees& context() const {
    static const BoostedTrees kNone;
    return kNone;
  }
  /// Returns which proposals are people, if the forest tells.
  virtual const BoostedTrees& judge() const {
    static const BoostedTrees kNone;
    return kNone;
  }
};

/// What the labellers of a trained forest have in common, on whatever device they walk it.
class TrainedLabeller : public PixelLabeller {
 public:
  const BodyModel& body() const override { return body_; }
  bool has_background() const override { return has_background_; }
  bool has_distributions() const override { return has_distributions_; }
  const FacingModel& facing_model() const override { return facing_; }
  const BoostedTrees& context() const override { return context_; }
  const BoostedTrees& judge() const override { return judge_; }

 protected:
  /// Throws Error for an inconsistent forest (check(Forest)).
  explicit TrainedLabeller(const Forest& forest);

  int tree_count() const { return trees_; }
  /// Returns where leaves have their logits, if they have some.
  const LogitLayout& layout() const { return layout_; }

  /// Throws Error for a picture of more than 16,000 pixels a side.
  static void check_size(const DepthImage& depth);
  /// Does the same, and gives `out` the size of the picture; the numbers are undefined.
  void prepare(const DepthImage& depth, Posteriors& out) const;

 private:
  BodyModel body_;
  bool has_background_, has_distributions_;
  int classes_, trees_;
  LogitLayout layout_;
  FacingModel facing_;
  BoostedTrees context_;
  BoostedTrees judge_;
};

/// Labels on the processor (section 4.3, eq. 2): the posteriors of a pixel are the mean over the trees of the
/// distributions in the leaves that it reaches.
class ForestLabeller : public TrainedLabeller {
 public:
  /// Throws Error for an inconsistent forest (check(Forest)).
  explicit ForestLabeller(Forest forest);
  ~ForestLabeller() override;

  /// Throws Error for a picture of more than 16,000 pixels a side.
  void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const override;

 private:
  struct Packed;
  std::unique_ptr<const Packed> packed_;
};

/// Restrictions on the classes of pixels.
struct LabelChoice {
  int part_count = 0;
  bool has_background = false;
  /// Optional. Pixels outside it are background; inside it the best part is taken whatever the background's posterior
  /// is.
  const Mask* prior = nullptr;
  /// Optional. Pixels outside it are background and take no time.
  const Box* box = nullptr;
};

/// What posteriors weigh when the labels of a picture are chosen, in fixed point, so that every platform makes the same
/// choice.
struct ChoiceWeights {
  std::int64_t part = 1024;  ///< of a part's posterior
  std::int64_t background = 0;
  std::int64_t margin = 0;  ///< weight by which a class must exceed the others to be sure
};
ChoiceWeights choice_weights(const LabelOptions& options, int trees);

/// Returns the most likely class of each pixel, with the background written as kBackground. If the two best classes of
/// a pixel differ by less than `unsure_margin` in probability, it takes that one of the nearly best classes which most
/// of its eight neighbours have (section 4.3). Pixels without a reading are background.
LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options);

}  // namespace vesalius

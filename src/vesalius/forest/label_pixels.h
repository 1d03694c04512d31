#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "vesalius/forest.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/people_options.h"

namespace vesalius {

/// Throws Error for a picture of more than 16,000 pixels a side.
void check_sides(const DepthImage& depth);

/// What the labellers of a trained forest have in common, on whatever device they walk it. They look at depth alone.
/// The posteriors of a forest without a background class have parts only; CutOutLabeller (cut_out_labeller.h) makes a
/// detector's of them.
class TrainedLabeller : public Labeller {
 public:
  /// Returns where leaves have their logits, if they have some.
  const LogitLayout& layout() const { return layout_; }

 protected:
  /// Throws Error for an inconsistent forest (check(Forest)).
  explicit TrainedLabeller(const Forest& forest);

  /// Returns Posteriors::whole.
  int whole() const { return 255 * trees_; }

  /// Does check_sides, and gives `out` the size of the picture; the numbers are undefined.
  void prepare(const DepthImage& depth, Posteriors& out) const;

 private:
  int trees_;
  LogitLayout layout_;
};

/// Labels on the processor (section 4.3, eq. 2): the posteriors of a pixel are the mean over the trees of the
/// distributions in the leaves that it reaches.
class ForestLabeller : public TrainedLabeller {
 public:
  /// Throws Error for an inconsistent forest (check(Forest)).
  explicit ForestLabeller(Forest forest);
  ~ForestLabeller() override;

  /// Throws Error for a picture of more than 16,000 pixels a side.
  void label_into(const Frame& frame, float gate, Posteriors& out) const override;

 private:
  struct Packed;
  std::unique_ptr<const Packed> packed_;
};

/// Restrictions on the classes of pixels.
struct LabelChoice {
  int part_count = 0;
  /// Optional. Pixels outside it are background; inside it the best part is taken whatever the background's posterior
  /// is.
  const Mask* prior = nullptr;
  /// Optional. Pixels outside it are background and take no time.
  const Box* box = nullptr;
};

/// What posteriors weigh when the labels of a picture are chosen, in fixed point, so that every platform makes the same
/// choice.
struct ChoiceWeights {
  std::int64_t part = 1024;  ///< weight of a part's posterior
  std::int64_t background = 0;
  std::int64_t margin = 0;  ///< weight by which a class must exceed the others to be sure
};
ChoiceWeights choice_weights(const LabelOptions& options, int whole);

/// Returns the most likely class of each pixel, with the background written as kBackground. If the two best classes of
/// a pixel differ by less than `unsure_margin` in probability, it takes that one of the nearly best classes which most
/// of its eight neighbours have (section 4.3). Pixels without a reading are background.
LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options);

}  // namespace vesalius

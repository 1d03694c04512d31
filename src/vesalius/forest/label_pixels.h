#pragma once

#include <string>
#include <vector>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/posteriors.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {

struct LabelOptions {
  float background_weight = 0.65F;  ///< multiplies the background's posterior; a run-time correction of its prior
  float proposal_weight = 0.35F;    ///< the same, multiplied instead where part proposals are looked for
  float person_weight = 1.F;        ///< multiplies the parts' posteriors
  float unsure_margin = 0.05F;      ///< difference in probability below which neighbours decide
  /// Probability of the background from which a forest that is sure of it at every fourth pixel of every fourth row is
  /// not asked about those between, where depth goes on; above 1 it is asked about all.
  float gate = 0.9F;
};
void visit_options(const std::string& prefix, LabelOptions& options, OptionVisitor& visitor);

/// Gives every pixel of a depth image its part posteriors. `Forest` is the one shipped; tests and experiments bring
/// their own (the truth, a network).
class PixelLabeller {
 public:
  virtual ~PixelLabeller() = default;
  virtual Posteriors label(const DepthImage& depth, const Camera& camera) const = 0;
  /// The same into `out`, whose memory may be used again. `options.gate` allows it to leave pixels out and to
  /// give them what a neighbour of like depth has.
  virtual void label_into(const DepthImage& depth, const Camera& camera, const LabelOptions& /*options*/,
                          Posteriors& out) const {
    out = label(depth, camera);
  }
  virtual const BodyModel& body() const = 0;
  virtual bool has_background() const = 0;
  /// Whether posteriors carry more than a vote per tree.
  virtual bool has_distributions() const = 0;
};

/// Section 4.3, eq. 2: the mean over trees of the distributions in the leaves that each pixel reaches.
class ForestLabeller : public PixelLabeller {
 public:
  /// Throws Error if the forest is inconsistent (check(Forest)).
  explicit ForestLabeller(Forest forest);
  Posteriors label(const DepthImage& depth, const Camera& camera) const override;
  void label_into(const DepthImage& depth, const Camera& camera, const LabelOptions& options,
                  Posteriors& out) const override;
  const BodyModel& body() const override { return forest_.body; }
  bool has_background() const override { return forest_.has_background; }
  bool has_distributions() const override { return distributions_; }
  const Forest& forest() const { return forest_; }

 private:
  void label_gated(const DepthImage& depth, const OffsetScaler& scaler, float least, Posteriors& out) const;

  Forest forest_;
  std::vector<PackedTree> packed_;
  bool distributions_;
};

/// Which classes a pixel may take.
struct LabelChoice {
  int part_count = 0;
  bool has_background = false;
  /// Optional: outside it pixels are background, inside the best part wins whatever the background says.
  const Mask* prior = nullptr;
  /// Optional: pixels outside it are background and cost nothing.
  const Box* box = nullptr;
};

/// The most likely class of each pixel, background written as kBackground. A pixel whose two best classes lie closer
/// than `unsure_margin` (in probability) takes that one of the near-best which most of its eight neighbours have
/// (section 4.3). Pixels without reading are background.
LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options);

}  // namespace vesalius

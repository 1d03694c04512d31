#pragma once

#include <memory>
#include <string>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

struct LabelOptions {
  float background_weight = 0.65F;  ///< multiplies the background's posterior; a run-time correction of its prior
  float proposal_weight = 0.35F;    ///< the same, multiplied instead where part proposals are looked for
  float unsure_margin = 0.05F;      ///< difference in probability below which neighbours decide
  /// Probability of the background from which a forest that is sure of it at every fourth pixel of every fourth row is
  /// not asked about those between, where depth goes on; above 1 it is asked about all.
  float gate = 0.9F;
};
void visit_options(const std::string& prefix, LabelOptions& options, OptionVisitor& visitor);

/// Gives every pixel of a depth image its part posteriors. make_labeller (make_labeller.h) returns those that are
/// shipped; tests and experiments bring their own (the truth, a network).
///
/// All member functions are called from several threads at once, also for different pictures: a labeller keeps nothing
/// between calls that could change a result. It may run work in parallel itself (base/parallel.h).
class PixelLabeller {
 public:
  virtual ~PixelLabeller() = default;

  /// Writes the posteriors of all pixels to `out`, whose memory is used again, whatever it holds. Where the background
  /// is at least `gate` probable all around, pixels may be given what a neighbour of like depth has and be marked as
  /// settled; a labeller that looks at them all the same gives other posteriors there, which is as right. With a gate
  /// above 1 every pixel is looked at, and all devices give the same bits for one forest.
  virtual void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const = 0;

  /// Returns the posteriors of all pixels, each looked at.
  Posteriors label(const DepthImage& depth, const Camera& camera) const {
    Posteriors out;
    label_into(depth, camera, 2.F, out);
    return out;
  }

  virtual const BodyModel& body() const = 0;
  /// Whether the last class is the background.
  virtual bool has_background() const = 0;
  /// Whether posteriors carry more than a vote per tree.
  virtual bool has_distributions() const = 0;
};

/// Section 4.3, eq. 2, on the processor: the posteriors of a pixel are the mean over the trees of the distributions in
/// the leaves that it reaches.
class ForestLabeller : public PixelLabeller {
 public:
  /// Throws Error for an inconsistent forest (check(Forest)).
  explicit ForestLabeller(Forest forest);
  ~ForestLabeller() override;

  /// Throws Error for a picture of more than 16,000 pixels a side.
  void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const override;
  const BodyModel& body() const override;
  bool has_background() const override;
  bool has_distributions() const override;

 private:
  struct Packed;
  std::unique_ptr<const Packed> packed_;
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

/// Returns the most likely class of each pixel, with the background written as kBackground. A pixel whose two best
/// classes lie closer than `unsure_margin` (in probability) takes that one of the near-best which most of its eight
/// neighbours have (section 4.3). Pixels without a reading are background.
LabelImage choose_labels(const Posteriors& posteriors, const DepthImage& depth, const LabelChoice& choice,
                         const LabelOptions& options);

}  // namespace vesalius

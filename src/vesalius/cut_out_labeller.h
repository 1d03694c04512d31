#pragma once

#include <memory>

#include "vesalius/labeller.h"

namespace vesalius {

/// Makes a labeller with a background class of one without, which knows parts alone, as the paper's released trees do.
/// It takes walls and floor for bodies, so it is shown scenes without their flat surfaces, which are background then,
/// and a person alone.
class CutOutLabeller : public Labeller {
 public:
  /// The posteriors of `of_parts` have no background. With `votes` they are one vote for each tree: what is smoothed
  /// then are the labels, by their mode (section 4.2.1), and smoothed posteriors are certain of them.
  CutOutLabeller(std::shared_ptr<const Labeller> of_parts, bool votes);

  void label_into(const Frame& frame, float gate, Posteriors& out) const override;
  bool label_and_smooth_into(const Frame& frame, float gate, const SmoothOptions& options, Posteriors& out,
                             Posteriors& smooth) const override;
  bool label_person_into(const Frame& frame, const Mask& person, const Box& box, const SmoothOptions& options,
                         Posteriors& out) const override;

 private:
  void smooth(const Posteriors& of_parts, const Frame& shown, const SmoothOptions& options, Posteriors& out) const;

  std::shared_ptr<const Labeller> of_parts_;
  bool votes_;
};

}  // namespace vesalius

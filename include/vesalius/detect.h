#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/frame.h"
#include "vesalius/model.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"
#include "vesalius/prior.h"
#include "vesalius/stage_times.h"

namespace vesalius {

/// The labels of one frame's pixels, in its size.
struct FrameLabels {
  LabelImage labels;  ///< smoothed labels of the first pass: Trace::labels
  LabelImage inside;  ///< labels of a person's pixels by the second pass; empty if no person was given
};

struct Method;
struct Trace;

/// Tells what is known of the people of a frame, when it is asked.
using AskPrior = std::function<Prior(const Frame&)>;

/// The whole method: it finds the people in one frame. Between frames it keeps only memory, which its copies share. It
/// may be called from several threads.
class Detector {
 public:
  /// A model without a labeller (on_device) labels on the processor. `appearance` tells what pixels look like, in place
  /// of the one that the options name. Throws Error for an inconsistent model, and UsageError for an option outside its
  /// range.
  explicit Detector(Model model, DetectOptions options = {}, std::shared_ptr<const Appearance> appearance = nullptr);

  /// Returns the people in the frame, the most certain first (Trace::Candidate::certainty); none if nobody is in view.
  /// `prior` says what earlier frames tell about them. Adds the time of each stage to `times`. Throws Error for a frame
  /// whose images do not fit its camera, or a prior that does not fit the frame.
  std::vector<Person> detect(const Frame& frame, const Prior& prior, Trace* trace = nullptr,
                             StageTimes* times = nullptr) const;
  std::vector<Person> detect(const Frame& frame, Trace* trace = nullptr, StageTimes* times = nullptr) const;

  /// As above, for frames that are worked at two at a time: `prior` is asked only when it is needed, after all of the
  /// frame's pixels are labelled and searched for skeletons, which does not depend on it. It is asked once, in the
  /// caller's thread, and may wait until the people of the frame before are known. What it throws is passed on.
  Detection detect(const Frame& frame, const AskPrior& prior, Trace* trace = nullptr,
                   StageTimes* times = nullptr) const;

  /// As above, and looks for people in `region` alone, widened to the blocks that labellers take, if there is one and
  /// no trace is asked for. Throws Error for one that does not lie within the frame.
  Detection detect(const Frame& frame, const std::optional<PictureRegion>& region, const AskPrior& prior,
                   Trace* trace = nullptr, StageTimes* times = nullptr) const;

  /// Returns the labels of the first pass and runs no other stage. With `person`, also returns the second pass's labels
  /// of the pixels where it is non-zero; those of one person have the same number. Throws Error for a frame whose
  /// images do not fit its camera.
  FrameLabels label(const Frame& frame, const Mask* person = nullptr) const;

  const BodyModel& body() const;
  /// Returns what tells what pixels look like; null if looks do not matter.
  std::shared_ptr<const Appearance> appearance() const;

 private:
  std::shared_ptr<const Method> method_;
};

}  // namespace vesalius

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "train/frame_store.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// One pixel to learn from.
struct TrainingSample {
  std::uint32_t frame = 0;     ///< index in the set's FrameStore
  std::int16_t u = 0, v = 0;   ///< pixel
  std::uint16_t depth_mm = 0;  ///< its reading, never 0
  std::uint8_t label = 0;      ///< class of the forest: body part, or part_count for the background
};

/// Which pixels of a frame are learned from. Holes never are.
struct SampleOptions {
  int pixels_per_frame = 370;
  float background_share = 0.5F;  ///< of a frame's pixels; 0 trains without background class
  float near_share = 0.4F;        ///< of the background pixels: within `near_px` of a person
  int near_px = 40;
  float balanced_share = 0.5F;   ///< of the body pixels: every part in view equally often, the rest by visible area
  int hard_pool = 300;           ///< background pixels a frame offers to the search for hard negatives; empty frames 4x
  float hard_share = 0.5F;       ///< most hard negatives, as a multiple of the ordinary background samples
  float held_out_share = 0.02F;  ///< of the frames: learned from by no tree, to measure accuracy on
};
void visit_options(const std::string& prefix, SampleOptions& options, OptionVisitor& visitor);

/// What a forest learns from: compact depth of many frames and the pixels drawn from them. All trees share the pixels;
/// they differ by the tests their nodes draw.
class TrainingSet {
 public:
  /// Throws UsageError for options out of range, Error for a body without parts or with more than 254.
  TrainingSet(BodyModel body, FeatureConvention convention, const SampleOptions& options, std::uint64_t seed);

  /// Draws this frame's pixels and keeps its depth; the labels are not kept. The pixels depend on the seed, the number
  /// of frames added before and the frame. One thread at a time. Throws Error for a frame whose images differ in size
  /// or whose labels the body lacks.
  void add(const LabelledFrame& labelled);

  /// Turns background pixels of the pool into samples where `forest` gives the parts together more than half: what the
  /// forest would take for a body. At most `hard_share` of the background samples, the worst first, the earlier on a
  /// tie. Returns how many were added. The pool is empty afterwards.
  std::size_t add_hard_negatives(const Forest& forest);

  const BodyModel& body() const { return body_; }
  const FeatureConvention& convention() const { return convention_; }
  bool has_background() const { return options_.background_share > 0.F; }
  int class_count() const { return body_.part_count() + (has_background() ? 1 : 0); }

  const FrameStore& frames() const { return frames_; }
  /// To learn from, ordered by frame.
  std::span<const TrainingSample> samples() const { return samples_; }
  /// To measure accuracy on, ordered by frame; of frames that `samples` has nothing of.
  std::span<const TrainingSample> held_out() const { return held_out_; }

  /// Pixels of each class in all frames learned from; with `samples` it says how sampling changed the shares.
  std::span<const std::uint64_t> class_pixels() const { return class_pixels_; }

  /// Bytes that depth, samples and pool take.
  std::size_t bytes() const;

 private:
  BodyModel body_;
  FeatureConvention convention_;
  SampleOptions options_;
  std::uint64_t seed_;
  FrameStore frames_;
  std::vector<TrainingSample> samples_, pool_, held_out_;
  std::vector<std::uint64_t> class_pixels_;
};

}  // namespace vesalius

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/samples/frame_store.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/body_model.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Options of the pixels from which a forest learns. Only pixels with a reading are used.
struct SampleOptions {
  int pixels_per_frame = 370;
  float background_share = 0.5F;  ///< share of a frame's pixels; 0 trains without background class
  float near_share = 0.4F;        ///< share of the background pixels that are within `near_px` of a person
  int near_px = 40;
  /// Share of the body pixels with equally many of every visible part. The rest is drawn by visible area.
  float balanced_share = 0.5F;
  /// Background pixels of a frame for the search for hard negatives. Empty frames give four times as many.
  int hard_pool = 300;
  float hard_share = 0.5F;       ///< most hard negatives, as a multiple of the ordinary background samples
  float held_out_share = 0.02F;  ///< share of frames that no tree learns from, for measuring accuracy
};
void visit_options(const std::string& prefix, SampleOptions& options, OptionVisitor& visitor);

/// The samples of one frame. `TrainingSample::frame` is not set.
struct DrawnSamples {
  std::vector<TrainingSample> samples;      ///< to learn from
  std::vector<TrainingSample> pool;         ///< background to search for hard negatives
  std::vector<std::uint64_t> class_pixels;  ///< readings of each class, the background last
};

/// Appends evenly spaced pixels of each person of a frame whose heading is known, at most 400 of each, and who they
/// are. People of few pixels are left out. `TrainingSample::frame` is `frame`.
void draw_people(const LabelledFrame& labelled, const BodyModel& body, std::uint32_t frame,
                 std::vector<TrainingSample>& samples, std::vector<PersonSamples>& people);

/// Draws pixels with a reading, with replacement. A frame without people gives only its share of background, a frame
/// without background only its share of body. `where` names the frame in errors. Throws Error if images differ in size
/// or the body lacks a label.
DrawnSamples draw_samples(const LabelledFrame& labelled, const BodyModel& body, const SampleOptions& options,
                          Random& random, const std::string& where);

/// The data from which a forest learns: packed depth of many frames and the pixels drawn from them. All trees share the
/// pixels; they differ by the tests that their nodes draw. If several sets are the shards of one training, each has the
/// frames that follow those of the set before it.
class TrainingSet {
 public:
  /// What a set holds besides the options by which it was drawn.
  struct Contents {
    FrameStore frames;
    std::vector<TrainingSample> samples = {}, pool = {}, held_out = {}, people_samples = {};
    std::vector<PersonSamples> people = {};
    std::vector<std::uint64_t> class_pixels = {};

    /// All but the frames.
    static void visit_fields(auto&& visit, auto&... of) {
      visit("samples", of.samples...)("pool", of.pool...)("held out", of.held_out...)(
          "people samples", of.people_samples...)("people", of.people...)("class pixels", of.class_pixels...);
    }
  };

  /// `first_frame` is the number of frames in the sets before this one. Throws UsageError for options out of range, and
  /// Error for a body without parts or with more than 254.
  TrainingSet(BodyModel body, FeatureConvention convention, const SampleOptions& options, std::uint64_t seed,
              std::size_t first_frame = 0);
  /// A set with what another one held that had the same options. Throws Error for samples that are in no frame, and as
  /// the other constructor.
  TrainingSet(BodyModel body, const SampleOptions& options, std::uint64_t seed, std::size_t first_frame,
              Contents contents);

  /// Draws this frame's pixels and keeps its depth; labels are not kept. The pixels depend on the seed, the number of
  /// frames added before and the frame. It is called from one thread at a time. Throws Error if the frame's images
  /// differ in size or the body lacks a label.
  void add(const LabelledFrame& labelled);

  /// Finds the background pixels of the pool for which `forest` gives the parts together more than half, so that it
  /// would take them for a body. Throws Error for a set without background class.
  HardCounts count_hard_negatives(const Forest& forest);
  /// Makes samples of the pixels that `cut` selects from the last count, and returns their number. The pool is empty
  /// afterwards.
  std::size_t add_hard_negatives(const HardCut& cut);

  /// Returns the samples by class, and the pixels of each class in all frames of learning.
  SampleCounts sample_counts() const;

  const BodyModel& body() const { return body_; }
  const FeatureConvention& convention() const { return contents_.frames.convention(); }
  bool has_background() const { return options_.background_share > 0.F; }
  int class_count() const { return body_.part_count() + (has_background() ? 1 : 0); }
  /// Returns a forest without trees for this set's classes and convention.
  Forest untrained_forest() const;

  const FrameStore& frames() const { return contents_.frames; }
  const Contents& contents() const { return contents_; }
  /// The number of frames in the sets before this one.
  std::size_t first_frame() const { return first_frame_; }
  /// The samples for learning, ordered by frame.
  std::span<const TrainingSample> samples() const { return contents_.samples; }
  /// The samples for measuring accuracy, ordered by frame. `samples` has none of their frames.
  std::span<const TrainingSample> held_out() const { return contents_.held_out; }

  /// The people of held-out frames whose heading is known, and their samples.
  std::span<const PersonSamples> held_out_people() const { return contents_.people; }
  std::span<const TrainingSample> people_samples() const { return contents_.people_samples; }

  /// The pixels of each class in all frames of learning, the background last.
  std::span<const std::uint64_t> class_pixels() const { return contents_.class_pixels; }

  /// Returns the memory of depth, samples and pool in bytes.
  std::size_t bytes() const;

 private:
  void expect_inside(const TrainingSample& sample, bool labelled) const;

  BodyModel body_;
  SampleOptions options_;
  std::uint64_t seed_;
  std::size_t first_frame_;
  Contents contents_;
  std::vector<std::uint32_t> pool_shares_;  ///< shares of the parts, in 1/255 over all trees; 0 up to half
};

}  // namespace vesalius

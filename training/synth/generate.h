#pragma once

#include <cstdint>
#include <memory>

#include "synth/clip/build_clip.h"
#include "synth/recipe.h"
#include "synth/scene/build_scene.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius::synth {

/// Makes labelled frames of people in rooms as a sensor sees them. Frame i depends only on (recipe, assets, seed, i),
/// so any frame can be made again, in any order and on any number of threads. It may be used from several threads.
class Generator {
 public:
  /// Throws UsageError for an invalid recipe, and Error if it requires bodies that the assets lack.
  Generator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed);
  ~Generator();
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;

  /// Returns a frame with its parts, the joints of joint_names(), postures, the upward direction and the
  /// camera's pose in the scene.
  LabelledFrame frame(std::uint64_t index) const;
  /// Returns the scene of that frame.
  BuiltScene scene(std::uint64_t index) const;

  /// Returns body k of the recipe, below its body.count, with its clothes.
  const Poser& body(std::size_t k) const;
  /// Draws a pose as frames do.
  SampledPose draw_pose(Random& random) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Length and rate of clips.
struct ClipTiming {
  float seconds = 10.F;   ///< above 0, at most kMaxClip_s
  double rate_hz = 30.0;  ///< frames a second, above 0, at most kMaxRate_hz

  /// Returns how many frames that is; at least 1.
  int frames() const;
};
inline constexpr float kMaxClip_s = 600.F;
inline constexpr double kMinRate_hz = 0.01, kMaxRate_hz = 240.0;

/// Throws UsageError if a number is out of its range.
void check(const ClipTiming& timing);

/// Makes clips: consecutive labelled frames of people who move in a room, as a sensor sees them. Frame k of clip c
/// depends only on (recipe, assets, seed, c, k) and the clips' length, so any frame can be made again, in any order and
/// on any number of threads. What people do does not depend on the rate. It may be used from several threads.
///
/// Person i of a frame is the same in all frames of a clip; all people of the clip are in every frame's truth, those
/// out of view as well. Times begin at 0. Names are CCCC_FFFFFF, numbers of clip and frame.
class ClipGenerator {
 public:
  /// Throws UsageError for an invalid recipe or timing, and Error if the recipe requires bodies that the assets lack.
  ClipGenerator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed,
                const ClipTiming& timing);
  ~ClipGenerator();
  ClipGenerator(const ClipGenerator&) = delete;
  ClipGenerator& operator=(const ClipGenerator&) = delete;

  int frames_per_clip() const;

  /// Returns frame `k` of a clip; `k` is below frames_per_clip(), `clip` below 2^31.
  LabelledFrame frame(std::uint64_t clip, int k) const;
  /// Returns frame `index` of all clips one after the other.
  LabelledFrame frame(std::uint64_t index) const;

  /// Returns what a clip is made of. The last ones are kept.
  std::shared_ptr<const ClipScene> clip(std::uint64_t clip) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius::synth

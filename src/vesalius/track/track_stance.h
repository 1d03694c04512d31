#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>

#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

// Frames of one second are as much alike as kFramesASecond independent ones; one frame speaks for kMostEvidence_s.
inline constexpr float kFramesASecond = 5.F;
inline constexpr double kMostEvidence_s = 0.2;

/// Follows how one person stands, sits, lies or falls: the likeliest sequence of stances by all frames so far, by
/// Viterbi's algorithm. Each frame tells how probable each stance is (stance_probabilities), and a person changes the
/// stance seldom. A stance is told when it is clearly likelier than any other, and then counts from the frame in which
/// it began. Whoever lies on the floor within 2 seconds of being upright has fallen, unless seen to sit there before,
/// and so has whoever lies there for 10 seconds; who lies as high as on a bed has not. Whoever is up again for a fifth
/// of a second does not lie. Pixels alone tell only of people whose chest, neck or head were seen before. Without
/// evidence for 5 seconds the stance is unknown.
class TrackStance {
 public:
  /// Takes the posture of a frame, if there is one. Returns the new stance and when it began, if it changed.
  std::optional<std::pair<Stance, double>> update(const std::optional<Posture>& posture, double time_s);

  Stance stance() const { return stance_; }

  /// Says that the person, though not found, has not moved: the stance stays known.
  void hold(double time_s);
  /// Returns whether the person was near the floor when last seen: lay, sat on it, or was on the way down.
  bool down() const { return down_; }

 private:
  /// The likeliest sequence of stances that ends in one stance.
  struct Path {
    double log_odds = 0.0;  ///< against the likeliest of all; 0 or below
    double since_s = 0.0;   ///< when its last stance began
    int frames = 0;         ///< frames with evidence since then
    double trunk_m = 0.0;   ///< sum of the trunk's heights over the floor in those in which they are known ...
    int heights = 0;        ///< ... and their number
    bool fell = false;      ///< whether the person had been upright shortly before, and did not sit down first
  };
  static constexpr std::array kStances{Stance::standing, Stance::sitting, Stance::lying};

  void advance(const Posture& posture, double time_s);
  std::optional<Stance> told(const Path& best, double margin, Stance stance, double time_s) const;
  std::optional<std::pair<Stance, double>> change(Stance stance, double since_s);

  std::array<Path, kStances.size()> paths_;
  Stance stance_ = Stance::unknown;
  std::optional<double> upright_s_;  ///< when the person was last seen upright, higher than on the floor
  std::optional<double> rose_s_;     ///< since when the person has been upright
  double near_floor_s_ = 0.0;        ///< seconds in which the person has been seen since
  std::optional<double> seen_s_;     ///< when there was evidence last
  std::optional<double> known_s_;    ///< when a stance was clear last
  bool down_ = false;
};

/// A body that was fitted to a person, with its model.
struct PosedBody {
  const FittedBody& fitted;
  const FleshModel& flesh;
};

/// Returns the posture of a person; if neither chest nor neck nor head are seen, that of the pixels where all of them
/// are near the floor, and else nothing. `up` is the unit vector away from the ground in the optical frame, `height_m`
/// the camera's over the floor, if that is known; without it no heights are. Where hips or knees are not seen, those of
/// the fitted body count if they are rather within 10 cm of the truth than not. What the border of the view cuts off is
/// not known.
std::optional<Posture> posture_of(const Person& person, const Frame& frame, const BodyModel& body,
                                  const Eigen::Vector3f& up, std::optional<float> height_m,
                                  const std::optional<PosedBody>& posed = {});

}  // namespace vesalius

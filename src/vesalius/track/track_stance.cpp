#include "vesalius/track/track_stance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/track/stance_model.h"

namespace vesalius {
namespace {

// Frames of one second are as much alike as kFramesASecond independent ones; one frame speaks for kMostEvidence_s.
constexpr double kFramesASecond = 5.0;
constexpr double kMostEvidence_s = 0.2;
constexpr double kWrong = 0.1;        // share of frames that tell nothing: masks of two people, bodies that do not fit
constexpr double kChangesPerS = 0.1;  // of the stance
constexpr double kClear = 3.0;        // log odds over the next likely stance from which one is told ...
constexpr double kAlarm = 5.0;        // ... and one that alarms
constexpr int kLeastFrames = 3;

constexpr float kOnFloor_m = 0.45F;  // up to which the trunk of somebody on the floor is, its thickness included
constexpr float kUpright_m = 0.6F;   // above which the chest of somebody is who does not sit on the floor
constexpr double kFall_s = 2.0;      // from upright to the floor ...
constexpr double kSinks_s = 0.5;     // ... and of it seen near the floor without lying: who sits there has not fallen
constexpr double kLong_s = 10.0;     // on the floor, without a fall that was seen
constexpr double kForgotten_s = 5.0;

std::optional<float> trunk_height_m(const Posture& posture) {
  if (!posture.chest_m || !posture.hips_m) return posture.chest_m;
  return 0.5F * (*posture.chest_m + *posture.hips_m);
}

}  // namespace

std::optional<std::pair<Stance, double>> TrackStance::change(Stance stance, double since_s) {
  if (stance == stance_) return std::nullopt;
  stance_ = stance;
  return std::make_pair(stance, since_s);
}

void TrackStance::advance(const Posture& posture, double time_s) {
  const StanceProbabilities of = stance_probabilities(builtin_stances(), posture);
  const std::array probabilities{of.standing, of.sitting, of.lying};
  const double passed_s = std::max(seen_s_ ? time_s - *seen_s_ : kMostEvidence_s, 0.0);
  const double evidence = kFramesASecond * std::min(passed_s, kMostEvidence_s);
  const double to_others = 1.0 - std::exp(-kChangesPerS * passed_s);
  const double stays = std::log(1.0 - to_others), changes = std::log(to_others / (kStances.size() - 1) + 1e-12);
  const bool begins = !seen_s_;
  const bool falls = upright_s_ && time_s - *upright_s_ <= kFall_s && near_floor_s_ <= kSinks_s;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    Path& path = paths_[i];
    path.log_odds += stays;
    // The likeliest of all has the log odds 0 before.
    if (begins || changes > path.log_odds) {
      path = {begins ? 0.0 : changes, time_s, 0, 0.0, 0, falls};
    }
    const double probable = (1.0 - kWrong) * double(probabilities[i]) + kWrong / kStances.size();
    path.log_odds += evidence * std::log(probable);
    ++path.frames;
    if (const std::optional<float> height_m = trunk_height_m(posture)) {
      path.trunk_m += double(*height_m);
      ++path.heights;
    }
  }
  const double most = std::ranges::max_element(paths_, {}, &Path::log_odds)->log_odds;
  for (Path& path : paths_) path.log_odds -= most;
  if (posture.chest_m) down_ = *posture.chest_m <= kUpright_m;
  near_floor_s_ += std::min(passed_s, kMostEvidence_s);
  if (of.lying < 0.5F && posture.chest_m && !down_) {
    upright_s_ = time_s;
    near_floor_s_ = 0.0;
  }
  seen_s_ = time_s;
}

/// Returns what is to be told of the likeliest path, if it is clear enough.
std::optional<Stance> TrackStance::told(const Path& best, double margin, Stance stance, double time_s) const {
  if (margin < kClear || best.frames < kLeastFrames) return std::nullopt;
  if (stance != Stance::lying || best.heights == 0) return stance;
  if (best.trunk_m / best.heights > double(kOnFloor_m)) return stance;
  if (!best.fell && time_s - best.since_s < kLong_s && stance_ != Stance::fallen) return stance;
  if (margin < kAlarm) return std::nullopt;
  return Stance::fallen;
}

void TrackStance::hold(double time_s) {
  if (known_s_) known_s_ = time_s;
}

std::optional<std::pair<Stance, double>> TrackStance::update(const std::optional<Posture>& posture, double time_s) {
  if (posture) {
    advance(*posture, time_s);
    const auto best = std::ranges::max_element(paths_, {}, &Path::log_odds);
    double next = -std::numeric_limits<double>::max();
    for (auto path = paths_.begin(); path != paths_.end(); ++path) {
      if (path != best) next = std::max(next, path->log_odds);
    }
    const Stance likeliest = kStances[static_cast<std::size_t>(best - paths_.begin())];
    if (const std::optional<Stance> stance = told(*best, best->log_odds - next, likeliest, time_s)) {
      known_s_ = time_s;
      return change(*stance, best->since_s);
    }
  }
  if (!known_s_ || time_s - *known_s_ < kForgotten_s) return std::nullopt;
  const double since_s = *known_s_;
  paths_ = {};
  upright_s_.reset();
  seen_s_.reset();
  known_s_.reset();
  return change(Stance::unknown, since_s);
}

}  // namespace vesalius

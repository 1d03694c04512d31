#include "vesalius/track/track_stance.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <vector>

#include "vesalius/track/stance_model.h"
#include "vesalius/track/track_place.h"

namespace vesalius {
namespace {

constexpr double kUntoldShare = 0.1;  // share of frames that tell nothing: masks of two people, bodies that do not fit
constexpr double kChangesPerS = 0.1;  // of the stance
constexpr double kClear = 3.0;        // log odds over the next likely stance from which one is told ...
constexpr double kAlarm = 5.0;        // ... and one that alarms
constexpr int kLeastFrames = 3;

constexpr float kOnFloor_m = 0.45F;  // up to which the trunk of somebody on the floor is, its thickness included
constexpr float kUpright_m = 0.6F;   // above which the chest of somebody is who does not sit on the floor
constexpr double kFall_s = 2.0;      // from upright to the floor ...
constexpr double kSinks_s = 0.5;     // ... and of it seen near the floor without lying: who sits there has not fallen
constexpr double kUp_s = 0.2;        // upright for so long, nobody lies any more
constexpr double kLong_s = 10.0;     // on the floor, without a fall that was seen
constexpr double kStanceForgotten_s = 5.0;

/// Returns the trunk's height over the floor by chest and hips. Where neither is seen, that of the highest pixels, if
/// the trunk of somebody on the floor may be so high.
std::optional<float> trunk_height_m(const Posture& posture) {
  if (posture.chest_m && posture.hips_m) return 0.5F * (*posture.chest_m + *posture.hips_m);
  if (posture.chest_m) return posture.chest_m;
  if (posture.hips_m) return posture.hips_m;
  if (posture.top_m && *posture.top_m <= kOnFloor_m) return posture.top_m;
  return std::nullopt;
}

using Eigen::Vector3f;

constexpr float kTrusted = 0.5F;       // probability from which places of the fitted body count
constexpr float kLeastAxis_m = 0.05F;  // shorter axes are seen along the body
constexpr std::size_t kLeastTrunkPixels = 40;

/// The mean of places that have one meaning.
struct Place {
  Vector3f sum = Vector3f::Zero();
  int count = 0;

  void add(const Vector3f& point) {
    if (!point.allFinite()) return;
    sum += point;
    ++count;
  }
  std::optional<Vector3f> mean() const {
    if (count == 0) return std::nullopt;
    return sum / float(count);
  }
};

/// Returns the middle of the seen parts whose names end so, such as l_chest and r_chest.
std::optional<Vector3f> seen_part(const Skeleton& skeleton, const BodyModel& body, std::string_view ending) {
  Place place;
  for (std::size_t p = 0; p < std::min(body.parts.size(), skeleton.parts.size()); ++p) {
    const SkeletonPart& part = skeleton.parts[p];
    if (part.state == State::observed && body.parts[p].name.ends_with(ending)) place.add(part.centre);
  }
  return place.mean();
}

/// Returns the middle of the lower or outer ends of those bones, of those that are trusted.
std::optional<Vector3f> fitted_end(const std::optional<PosedBody>& posed,
                                   std::initializer_list<std::string_view> bones) {
  if (!posed) return std::nullopt;
  Place place;
  for (const std::string_view name : bones) {
    const int index = posed->flesh.find_bone(name);
    if (index < 0) continue;
    const FittedBone& bone = posed->fitted.bones[static_cast<std::size_t>(index)];
    if (bone.state != State::none && bone.tail_confidence >= kTrusted) place.add(bone.tail);
  }
  return place.mean();
}

std::optional<float> slope(const std::optional<Vector3f>& from, const std::optional<Vector3f>& to, const Vector3f& up) {
  if (!from || !to) return std::nullopt;
  const Vector3f axis = *to - *from;
  if (axis.norm() < kLeastAxis_m) return std::nullopt;
  return axis.normalized().dot(up);
}

/// Which ends of a person the border of the view may cut off.
struct Cut {
  bool above = false;
  bool below = false;
};

Cut cut_by_border(const Box& box, int width, int height, const Vector3f& up) {
  const int margin = view_margin(width);
  const bool left = box.u <= margin, right = box.u + box.width >= width - margin;
  const bool top = box.v <= margin, bottom = box.v + box.height >= height - margin;
  if (std::abs(up.y()) >= std::abs(up.x())) return up.y() < 0.F ? Cut{top, bottom} : Cut{bottom, top};
  return up.x() < 0.F ? Cut{left, right} : Cut{right, left};
}

float quantile(std::vector<float>& values, double share) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

void measure_pixels(const Person& person, const Frame& frame, const Vector3f& up, std::optional<float> height_m,
                    Posture& posture) {
  if (!person.mask.same_size(frame.depth)) return;
  std::vector<float> heights_m;
  const Box& box = person.box;
  for (int v = box.v; v < box.v + box.height; ++v) {
    for (int u = box.u; u < box.u + box.width; ++u) {
      if (person.mask(u, v) == 0 || frame.depth(u, v) == 0) continue;
      heights_m.push_back(up.dot(point_at(frame.camera, frame.depth, u, v)));
    }
  }
  if (heights_m.size() < kLeastTrunkPixels) return;
  const Cut cut = cut_by_border(box, frame.depth.width(), frame.depth.height(), up);
  if (cut.above) return;
  if (height_m) posture.top_m = *height_m + quantile(heights_m, 0.98);
  if (!cut.below) posture.vertical_m = quantile(heights_m, 0.9) - quantile(heights_m, 0.1);
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
  const double evidence = double(kFramesASecond) * std::min(passed_s, kMostEvidence_s);
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
    const double probable = (1.0 - kUntoldShare) * double(probabilities[i]) + kUntoldShare / kStances.size();
    path.log_odds += evidence * std::log(probable);
    ++path.frames;
    if (const std::optional<float> height_m = trunk_height_m(posture)) {
      path.trunk_m += double(*height_m);
      ++path.heights;
    }
  }
  if (const auto height_m = posture.chest_m ? posture.chest_m : posture.top_m) down_ = *height_m <= kUpright_m;
  near_floor_s_ += std::min(passed_s, kMostEvidence_s);
  if (of.lying < 0.5F && posture.chest_m && !down_) {
    if (!rose_s_) rose_s_ = time_s;
    upright_s_ = time_s;
    near_floor_s_ = 0.0;
  } else {
    rose_s_.reset();
  }
  auto& [standing, sitting, lying] = paths_;
  // However long somebody lay: who is up does not lie.
  if (rose_s_ && time_s - *rose_s_ >= kUp_s) {
    lying.log_odds = std::min(lying.log_odds, std::max(standing.log_odds, sitting.log_odds) - kClear);
  }
  const double most = std::ranges::max_element(paths_, {}, &Path::log_odds)->log_odds;
  for (Path& path : paths_) path.log_odds -= most;
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
  const bool by_pixels_alone = posture && posture->top_m && !posture->chest_m;
  if (posture && (seen_s_ || !by_pixels_alone)) {
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
  if (!known_s_ || time_s - *known_s_ < kStanceForgotten_s) return std::nullopt;
  const double since_s = *known_s_;
  paths_ = {};
  upright_s_.reset();
  seen_s_.reset();
  known_s_.reset();
  return change(Stance::unknown, since_s);
}

std::optional<Posture> posture_of(const Person& person, const Frame& frame, const BodyModel& body, const Vector3f& up,
                                  std::optional<float> height_m, const std::optional<PosedBody>& posed) {
  const auto seen = [&](std::string_view ending) { return seen_part(person.skeleton, body, ending); };
  const std::optional<Vector3f> neck = seen("neck");
  std::optional<Vector3f> chest = seen("chest"), hips = seen("hips"), knees = seen("knee"), head = seen("face_top");
  if (!head) head = seen("face_bottom");
  const std::optional<Vector3f> top = head ? head : neck;
  Posture posture;
  if (posed && posed->fitted.stature_m > 0.F) posture.stature_m = posed->fitted.stature_m;
  Place above;
  for (const auto& part : {chest, neck, head}) {
    if (part) above.add(*part);
  }
  // The centres of the parts called hips lie 5 to 10 cm above the joints of the legs, where this bone ends.
  if (!hips) hips = fitted_end(posed, {"pelvis"});
  if (!knees) knees = fitted_end(posed, {"l_thigh", "r_thigh"});
  posture.trunk_up = slope(hips, above.mean(), up);
  posture.thighs_up = slope(knees, hips, up);
  if (chest && top) posture.pitch_m = up.dot(*top - *chest);
  if (height_m) {
    if (const std::optional<Vector3f> trunk = chest ? chest : top) posture.chest_m = *height_m + up.dot(*trunk);
    if (hips) posture.hips_m = *height_m + up.dot(*hips);
  }
  measure_pixels(person, frame, up, height_m, posture);
  // Pixels higher up without an upper body may be a piece of somebody who stands.
  if (!chest && !top && (!posture.top_m || *posture.top_m > kUpright_m)) return std::nullopt;
  return posture;
}

}  // namespace vesalius

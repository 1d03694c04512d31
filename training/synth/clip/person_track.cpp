#include "synth/clip/person_track.h"

#include <algorithm>
#include <cmath>

#include "synth/scene/person_mesh.h"

namespace vesalius::synth {

TrackState PersonTrack::at(float time_s) const {
  const float place = std::clamp(time_s * kTrackRate_hz, 0.F, float(states.size() - 1));
  const auto first = static_cast<std::size_t>(place);
  const float share = place - float(first);
  const TrackState& a = states[first];
  if (share == 0.F) return a;
  const TrackState& b = states[first + 1];
  return {interpolated(a.pose, b.pose, share), a.at + share * (b.at - a.at),
          a.heading_rad + share * (b.heading_rad - a.heading_rad), a.seated + share * (b.seated - a.seated)};
}

int track_length(float seconds) { return int(std::ceil(seconds * kTrackRate_hz)) + 1; }

PosedBody body_at(const Poser& poser, const PersonTrack& track, float time_s) {
  const TrackState state = track.at(time_s);
  PosedBody body = poser.pose(state.pose);
  const float lift = track.pelvis_m ? state.seated * (*track.pelvis_m - body.joints[index(Bone::pelvis)].y()) : 0.F;
  const Eigen::Isometry3f world_from_body(Eigen::Translation3f(state.at.x(), lift, state.at.y()) *
                                          Eigen::AngleAxisf(state.heading_rad, Eigen::Vector3f::UnitY()));
  return moved(std::move(body), world_from_body);
}

Eigen::Vector2f front_of(float heading_rad) { return {std::sin(heading_rad), std::cos(heading_rad)}; }
Eigen::Vector2f left_of(float heading_rad) { return {std::cos(heading_rad), -std::sin(heading_rad)}; }

}  // namespace vesalius::synth

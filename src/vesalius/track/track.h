#pragma once

#include <optional>

#include "vesalius/fit/body_history.h"
#include "vesalius/person.h"
#include "vesalius/track/track_look.h"
#include "vesalius/track/track_motion.h"
#include "vesalius/track/track_place.h"
#include "vesalius/track/track_stance.h"

namespace vesalius {

/// Somebody found in a frame, with all by which people are matched.
struct Sighting {
  Person person;
  TrunkPlace trunk;
  AppearanceHistogram look;
  std::optional<float> scale;  ///< body_scale
  TrackPlace place;            ///< empty if the mask has another size than the frame
};

/// Somebody who is followed.
struct Track {
  int id = 0;
  TrackState state = TrackState::fresh;
  TrackMotion motion;
  TrackLook look;
  TrackSize size;
  TrackPlace place;                ///< place in the frame in which the person was found last
  Eigen::Vector3f place_position;  ///< place of the trunk in that frame, filtered
  Person person;                   ///< the person as found last, without mask, labels and points
  std::optional<FittedBody> body;
  BodyHistory history;   ///< what is learned of the person's body
  Mask expected;         ///< pixels at which the person is expected in the next frame; empty if that is unknown
  float log_odds = 0.F;  ///< log odds of being a person, by all frames so far
  int found = 0;         ///< frames in which the person was found
  float evidence = 0.F;  ///< sum of what their scores tell, as long as the track is fresh
  TrackStance stance;
  bool rests = false;  ///< not found, but most pixels are as they were when the person was
  JointSmoother smoother;
  double smoothed_s = 0.0;  ///< time of the joints that were smoothed last
  double since_s = 0.0;     ///< time of the first one
  double seen_s = 0.0;      ///< time of the last one

  Track(int number, const Sighting& sighting, double time_s);

  /// Forgets what speaks for somebody fresh.
  void doubt() {
    found = 0;
    evidence = 0.F;
  }
  /// Takes the person found at a time.
  void take_sighting(const Sighting& sighting, double time_s);
};

}  // namespace vesalius

#include "synth/clip/clip_options.h"

namespace vesalius::synth {

void visit_options(const std::string& prefix, ClipOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "walking-share", o.walking_share, {"", 0, 1, "Share of people in clips who walk about."});
  visitor.option(prefix + "pause-share", o.pause_share, {"", 0, 1, "Share of their ways that end with a stay."});
  visitor.option(prefix + "leaving-share", o.leaving_share,
                 {"", 0, 1, "Share of their ways that lead out of the picture."});
  visitor.option(prefix + "crossing-share", o.crossing_share,
                 {"", 0, 1, "Share of clips of several people in which those who walk pass before or behind others."});
  visitor.option(prefix + "falling-share", o.falling_share, {"", 0, 1, "Share of people who fall and remain lying."});
  visitor.option(prefix + "rising-share", o.rising_share,
                 {"", 0, 1, "Share of those who fall or lie down who get up again."});
  visitor.option(prefix + "seating-share", o.seating_share,
                 {"", 0, 1, "Share of people on seats who sit down or get up meanwhile."});
  visitor.option(prefix + "moving-share", o.moving_share, {"", 0, 1, "Share of clips whose camera moves."});
  visitor.option(prefix + "speed-max", o.speed_max_m_s, {"m/s", 0, 2, "Greatest speed of such a camera."});
  visitor.option(prefix + "turn-max", o.turn_max_deg_s, {"deg/s", 0, 90, "Greatest turn of such a camera."});
  visitor.option(prefix + "cameras", o.cameras,
                 {"", 1, kMostClipCameras, "Cameras about the same people. Several of them stand."});
  visitor.option(prefix + "seen-from", o.seen_from,
                 {"", 0, kMostClipCameras - 1, "Number of the camera whose pictures are made, from 0."});
  visitor.option(prefix + "apart", o.apart_deg,
                 {"deg", -180, 180, "Angle about the middle of the scene from each camera to the next."});
}

}  // namespace vesalius::synth

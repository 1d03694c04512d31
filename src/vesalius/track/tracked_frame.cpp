#include "vesalius/track/tracked_frame.h"

namespace vesalius {

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::fresh:
      return "new";
    case TrackState::tracked:
      return "tracked";
    case TrackState::hidden:
      return "hidden";
    default:
      return "lost";
  }
}

const char* to_string(Stance stance) {
  switch (stance) {
    case Stance::standing:
      return "standing";
    case Stance::sitting:
      return "sitting";
    case Stance::lying:
      return "lying";
    case Stance::fallen:
      return "fallen";
    default:
      return "unknown";
  }
}

}  // namespace vesalius

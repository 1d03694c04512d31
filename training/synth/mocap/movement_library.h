#pragma once

#include <span>
#include <string>
#include <vector>

#include "synth/mocap/motion_list.h"
#include "synth/pose/gait.h"
#include "synth/pose/movement.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// What people do in clips, taken from recorded motions at about 30 frames a second. Recordings without any of it, such
/// as jumps, and those with a marker's error are in none of the lists.
struct MovementLibrary {
  std::vector<Gait> gaits;           ///< walks
  std::vector<Movement> stays;       ///< what somebody does standing at one place
  std::vector<Movement> lie_downs;   ///< from standing to lying on the floor
  std::vector<std::string> skipped;  ///< one line for each file that could not be used, with the reason

  bool empty() const { return gaits.empty() && stays.empty() && lie_downs.empty(); }
};

/// Loads a library of movements. A file that cannot be used is skipped and named in `skipped`.
MovementLibrary load_movements(std::span<const MotionFile> files, const ReadText& read);

/// Puts a movement into the list to which it belongs, if there is one.
void sort_in(Movement movement, MovementLibrary& library);

}  // namespace vesalius::synth

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/track_people.h"
#include "view/happenings.h"
#include "view/player.h"
#include "view/source_choice.h"

namespace vesalius {

/// A recording that was completed.
struct SavedRecording {
  std::string path;  ///< absolute
  int frames = 0;
  std::uintmax_t bytes = 0;
};

/// How things stand, besides the player.
struct ViewerState {
  double frames_per_s = 0.0;        ///< frames a second of the detector, over the last second
  int frames = 0;                   ///< that were detected
  int dropped = 0;                  ///< that were not, since newer ones had come or the camera was not asked in time
  std::optional<double> result_ms;  ///< from a frame's arrival to its people, median of the last ones
  std::optional<double> page_ms;    ///< to a page having shown it
  int clients = 0;
  std::string recording;                ///< path of the file that is being recorded; empty = none
  int recorded = 0;                     ///< frames in it
  std::optional<SavedRecording> saved;  ///< the one before it
};

/// What changes with the source alone, or never, while a viewer runs.
struct ViewerFacts {
  std::string source, model, folder;
  bool track = true;        ///< whether people are followed over frames
  std::string choice = {};  ///< folder below which the page may open other sources; empty where it may not
  int after = 0;            ///< number of the last frame of the source before this one
};

// Messages to a page, as JSON texts with a "type" (docs/formats.md).
std::string hello_message(const ViewerFacts& facts, const BodyModel& body);
std::string state_message(const ViewerState& state, const PlayerState& player);
/// `first` are the options with which the viewer began, to which a page can go back. Those of tracking are left out
/// where people are not followed.
std::string options_message(const PeopleOptions& options, const PeopleOptions& first, bool track);
std::string happenings_message(const Happenings& happenings);
std::string notice_message(const std::string& text);
/// Tells what may be opened in a folder, and for the choice's own which cameras are plugged in.
std::string sources_message(const ChoiceList& list, const std::vector<SensorInfo>& cameras);
/// Tells why a folder cannot be listed.
std::string no_sources_message(const std::string& folder, const std::string& why);

/// Sets the option `name` to a value given as JSON. Throws Error for one that does not exist or a value that does not
/// fit.
void set_option(PeopleOptions& options, const std::string& name, const std::string& value_json);

}  // namespace vesalius

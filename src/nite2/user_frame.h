#pragma once

#include <NiteCAPI.h>

#include <vector>

#include "nite2/openni_library.h"

namespace vesalius::nite2 {

/// What was found in a picture, as programs read it.
class UserFrame {
 public:
  /// `map` has the size of the picture.
  UserFrame(OniFrameReference depth, std::vector<NiteUserData> users, std::vector<NiteUserId> map);

  /// Where the program finds it.
  NiteUserTrackerFrame* address() { return &frame_; }
  const std::vector<NiteUserData>& users() const { return users_; }
  void set_floor(const NitePlane& floor);

 private:
  OniFrameReference depth_;
  std::vector<NiteUserData> users_;
  std::vector<NiteUserId> map_;
  NiteUserTrackerFrame frame_{};
};

}  // namespace vesalius::nite2

#pragma once

#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// What a camera saw in the last frame that was looked at as a whole, by which one knows whether it sees the same
/// still.
class TrackView {
 public:
  /// Takes that frame, at a time, its planes, and a box around all people in it.
  void take_frame(const Frame& frame, double time_s, std::vector<Plane> planes, const Box& people);

  double time_s() const { return time_s_; }
  const std::vector<Plane>& planes() const { return planes_; }

  /// Returns whether a frame of the same size shows the same depth outside of `people` and of where they were: whether
  /// the camera is where it was, and nobody has come.
  bool unchanged(const Frame& frame, const Box& people) const;

 private:
  int width_ = 0, height_ = 0;  ///< of the frame
  DepthImage depth_;            ///< some of its pixels; empty where nothing is known
  Box people_;
  std::vector<Plane> planes_;
  double time_s_ = 0.0;
};

}  // namespace vesalius

#pragma once

#include <limits>
#include <string>

#include "io/recordings/frame_recorder.h"
#include "vesalius/body_model.h"
#include "view/frame_message.h"

namespace vesalius {

/// A recording of what a viewer shows. All throws Error naming the path if it cannot be written.
class Recording {
 public:
  /// Creates a new file in `folder`. Frames without times get those of `rate` frames a second.
  Recording(const std::string& folder, double rate);

  /// Adds a frame with its people unless its time is there already: a recording shows a source once, however it was
  /// moved in.
  void add_frame(const ViewedFrame& viewed, const BodyModel& body);
  /// Completes the file.
  void close() { file_.close(); }

  const std::string& path() const { return path_; }
  int frames() const { return frames_; }

 private:
  std::string path_;
  FrameRecorder file_;
  double rate_;
  int frames_ = 0;
  double up_to_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace vesalius

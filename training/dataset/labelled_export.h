#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dataset/clip_layout.h"
#include "io/sources/write_frames.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Writes labelled frames as plain files that any program can read: depth/, rgb/ and meta.json in the layout of
/// `open_source`, labels/NAME.png and person/NAME.png (8-bit, 255 = background), truth/NAME.json (part centres and
/// joints in metres, postures, the upward direction; optical frame; the frame's time, the camera's height and pose),
/// and body.toml, which names the labels. Of clips also clips.json: `frames_per_clip` and `rate_hz`.
class LabelledExporter {
 public:
  /// Creates `folder`. Throws Error if it cannot be created or already has files in it. `joints` names the joints of
  /// the frames. Of clips whole ones are written, one after the other, under names in that order.
  LabelledExporter(const std::string& folder, const BodyModel& body, std::vector<std::string> joints = {},
                   const ClipLayout& clips = {});

  /// Writes one frame. Throws Error as FrameWriter::write does, and if the truth does not fit the frame, the body or
  /// the joints.
  void write(const LabelledFrame& labelled);

 private:
  std::string folder_;
  const BodyModel& body_;
  std::vector<std::string> joints_;
  std::unique_ptr<FrameWriter> frames_;
};

}  // namespace vesalius

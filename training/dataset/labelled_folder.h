#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dataset/labelled_dataset.h"
#include "io/sources/list_source.h"
#include "io/sources/write_frames.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Reads a folder that LabelledExporter wrote, its frames in any order. It may be used from several threads.
class LabelledFolder {
 public:
  /// Throws Error if the folder has no frames, no camera (meta.json) or no body (body.toml), or clips.json cannot
  /// be used.
  explicit LabelledFolder(const std::string& folder);

  std::uint64_t size() const { return frames_.size(); }
  const BodyModel& body() const { return body_; }
  /// Returns how frames form clips (clips.json).
  const ClipLayout& clips() const { return clips_; }
  /// Returns the names of the people's joints, as the first frame that has any gives them.
  const std::vector<std::string>& joint_names() const { return joint_names_; }

  /// Returns frame `index` in the order of the frames' names; `index` must be below size(). Parts and joints are given
  /// to a tenth of a millimetre, and joints have the order of the file. Throws Error naming the file that cannot be
  /// used.
  LabelledFrame read(std::uint64_t index, bool with_colour = true) const;

  /// Returns an XXH64 over everything that `read` reads for all frames, except colour; it is equal for equal frames.
  /// Reads all files once.
  std::uint64_t content_hash() const;

 private:
  std::string file(const char* kind, std::uint64_t index, const char* extension) const;

  std::string folder_;
  BodyModel body_;
  ClipLayout clips_;
  FrameListReader frames_;
  std::vector<std::string> joint_names_;
};

/// Returns whether `path` is a folder of labelled frames, which has body.toml, depth/, labels/, person/ and truth/.
bool is_labelled_folder(const std::string& path);

/// Writes labelled frames as plain files that any program can read: depth/, rgb/ and meta.json in the layout of
/// `open_source`, labels/NAME.png and person/NAME.png (8-bit, 255 = background), truth/NAME.json (part centres and
/// joints in metres, postures, the upward direction; optical frame; the frame's time, the camera's height and pose),
/// and body.toml, which names the labels. Of clips also clips.json: `frames_per_clip` and `rate_hz`, and imu.csv.
class LabelledExporter {
 public:
  /// Creates `folder`. Throws Error if it cannot be created or already has files in it. `joints` names the joints of
  /// the frames. Of clips whole ones are written, one after the other, under names in that order.
  LabelledExporter(const std::string& folder, const BodyModel& body, std::vector<std::string> joints = {},
                   const ClipLayout& clips = {});

  /// Writes one frame. Throws Error as FrameWriter::write does, and if the truth does not fit the frame, the body or
  /// the joints.
  void write(const LabelledFrame& labelled);
  /// Writes what lists all frames, as FrameWriter::close does.
  void close();

 private:
  std::string folder_;
  const BodyModel& body_;
  std::vector<std::string> joints_;
  std::unique_ptr<FrameWriter> frames_;
};

}  // namespace vesalius

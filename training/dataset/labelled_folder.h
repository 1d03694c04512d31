#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dataset/clip_layout.h"
#include "io/sources/list_source.h"
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

}  // namespace vesalius

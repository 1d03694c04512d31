#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/sources/pcd_header.h"
#include "vesalius/base/frame.h"

namespace vesalius {

/// Layouts of frames on disk that `open_source` reads back.
enum class FrameFormat {
  folder,  ///< depth/NAME.png (16-bit, millimetres), rgb/NAME.png, meta.json
  tum,     ///< depth.txt, rgb.txt, depth/TIME.png, rgb/TIME.png, and meta.json for the camera; frames go by their times
  pcd      ///< NAME.pcd, organised, and meta.json
};

/// "folder", "tum" or "pcd"; throws UsageError for another word.
FrameFormat parse_frame_format(std::string_view word);

struct WriteOptions {
  PcdEncoding pcd_encoding = PcdEncoding::binary_compressed;
  float tum_units_per_m = 5000.F;   ///< 16 bits of the usual 5000 end at 13.1 m
  std::optional<float> frame_rate;  ///< frames per second, for the times of frames that have none in `tum`
};

/// Writes frames into a folder, losslessly. Frames of one folder share one camera.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;
  /// Throws Error naming the frame or file: for a name that is no file name or was written before, another camera
  /// than the first frame's, depth that does not fit the format, a time that the format needs and nobody knows, or a
  /// file that cannot be written.
  virtual void write(const Frame& frame) = 0;
  /// Writes what lists all frames; a folder is complete only after it.
  virtual void close() = 0;
};

/// Makes `folder`; throws Error when it cannot or when it has files in it already.
std::unique_ptr<FrameWriter> make_frame_writer(FrameFormat format, const std::string& folder,
                                               const WriteOptions& options = {});

}  // namespace vesalius

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "vesalius/frame.h"

namespace vesalius {

/// Layouts of frames on disk, which `open_source` reads.
enum class FrameFormat {
  folder,  ///< depth/NAME.png (16-bit, millimetres), rgb/NAME.png, meta.json
  tum      ///< depth.txt, rgb.txt, depth/TIME.png, rgb/TIME.png, and meta.json for the camera; TIME names a frame
};

/// Returns the format that "folder" or "tum" names. Throws UsageError for any other word.
FrameFormat parse_frame_format(std::string_view word);

struct WriteOptions {
  float tum_units_per_m = 5000.F;  ///< at the benchmark's 5000, 16 bits reach 13.1 m
  /// Frames per second; gives times to frames without, which `tum` needs. `folder` has it in meta.json.
  std::optional<float> frame_rate;
};

/// Writes frames into a folder without loss; where up is in frames with times goes into imu.csv. All frames of one
/// folder share one camera.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;
  /// Writes one frame. Throws Error naming the frame or file if its name is not a valid file name or was used before,
  /// its camera differs from the first frame's, its depth does not fit the format, the format needs a time and the
  /// frame has none, or a file cannot be written.
  virtual void write(const Frame& frame) = 0;
  /// Writes the files that list all frames. The folder is complete only after this call.
  virtual void close() = 0;
};

/// Creates `folder` and returns a writer for it. Throws Error if the folder cannot be created or already has files in
/// it.
std::unique_ptr<FrameWriter> make_frame_writer(FrameFormat format, const std::string& folder,
                                               const WriteOptions& options = {});

}  // namespace vesalius

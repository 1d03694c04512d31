#pragma once

#include <memory>
#include <string>

#include "vesalius/base/image.h"

namespace vesalius {

/// Writes pictures of one size as a Motion JPEG .avi, which needs no codec library. The file appears under its name
/// at `close`; a writer destroyed before leaves nothing.
class VideoWriter {
 public:
  /// `frame_rate` in frames per second. Throws UsageError for another extension than .avi or a rate out of (0, 1000],
  /// Error naming the path where no file can be made.
  VideoWriter(const std::string& path, double frame_rate);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Throws Error naming the path for a picture of another size than the first, an empty one, a file that cannot be
  /// made or grows over 2 GB, where the format ends.
  void write(const ColourImage& picture);
  /// Throws Error naming the path when nothing was written or the disk did not take all.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius

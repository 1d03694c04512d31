#pragma once

#include <memory>
#include <string>

#include "vesalius/image.h"

namespace vesalius {

/// Writes pictures of one size as a Motion JPEG .avi file, which needs no codec library. The file appears under its
/// name when `close` is called; a writer that is destroyed earlier leaves no file.
class VideoWriter {
 public:
  /// `frame_rate` is in frames per second. Throws UsageError for an extension other than .avi or a rate outside (0,
  /// 1000], and Error naming the path if the file cannot be created.
  VideoWriter(const std::string& path, double frame_rate);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Appends a picture. Throws Error naming the path for an empty picture, for one of another size than the first, and
  /// if the file cannot be written or grows over 2 GB, the limit of the format.
  void write(const ColourImage& picture);
  /// Completes the file. Throws Error naming the path if no picture was written or the disk did not take all data.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius

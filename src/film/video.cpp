#include "film/video.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <system_error>

#include "io/files/atomic_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

/// Keeps OpenCV from printing while an object of this class lives; errors are reported as Error instead.
class Silence {
 public:
  Silence() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~Silence() { cv::utils::logging::setLogLevel(level_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

/// Returns whether a closed file is complete. OpenCV does not report failed writes, but it writes the RIFF length at
/// the front last: in a file that lost bytes it is wrong.
bool is_whole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[8] = {};
  file.read(reinterpret_cast<char*>(head), sizeof head);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (!file || error || std::string(head, head + 4) != "RIFF") return false;
  const std::uint32_t length = std::uint32_t{head[4]} | std::uint32_t{head[5]} << 8U | std::uint32_t{head[6]} << 16U |
                               std::uint32_t{head[7]} << 24U;
  return std::uintmax_t{length} + 8 == size;
}

}  // namespace

struct VideoWriter::State {
  TemporaryFile file;
  double frame_rate;
  cv::VideoWriter writer;
  int width = 0;
  int height = 0;

  State(const std::string& path, double rate) : file(path, ".avi"), frame_rate(rate) {}

  void open(const ColourImage& first) {
    width = first.width();
    height = first.height();
    if (first.empty()) throw Error(file.final_path() + ": empty picture, expected one pixel at least");
    const Silence silence;
    bool opened = false;
    try {
      opened = writer.open(file.path(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), frame_rate,
                           cv::Size(width, height));
    } catch (const cv::Exception&) {
      opened = false;
    }
    if (!opened) throw Error(fmt::format("{}: video of {}x{} cannot be made", file.final_path(), width, height));
  }
};

VideoWriter::VideoWriter(const std::string& path, double frame_rate) {
  if (fs::path(path).extension() != ".avi") throw UsageError(path + ": expected a file name ending in .avi");
  if (!(frame_rate > 0.0 && frame_rate <= 1000.0)) {
    throw UsageError(fmt::format("{}: {} frames per second, expected more than 0 to 1000", path, frame_rate));
  }
  state_ = std::make_unique<State>(path, frame_rate);
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::write(const ColourImage& picture) {
  State& state = *state_;
  const std::string& path = state.file.final_path();
  if (!state.writer.isOpened()) state.open(picture);
  if (picture.width() != state.width || picture.height() != state.height) {
    throw Error(fmt::format("{}: picture of {}x{}, expected {}x{} as the first", path, picture.width(),
                            picture.height(), state.width, state.height));
  }
  cv::Mat mat(picture.height(), picture.width(), CV_8UC3);
  for (int v = 0; v < picture.height(); ++v) {
    for (int u = 0; u < picture.width(); ++u) {
      const Rgb& pixel = picture(u, v);
      mat.at<cv::Vec3b>(v, u) = {pixel.b, pixel.g, pixel.r};
    }
  }
  const Silence silence;
  try {
    state.writer.write(mat);
  } catch (const cv::Exception& e) {
    throw Error(path + ": video cannot be written: " + e.err);
  }
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(state.file.path(), ignored);
  if (!ignored && size > std::numeric_limits<std::int32_t>::max()) throw Error(path + ": video over 2 GB");
}

void VideoWriter::close() {
  State& state = *state_;
  const std::string& path = state.file.final_path();
  if (!state.writer.isOpened()) throw Error(path + ": no pictures for the video");
  state.writer.release();
  if (!is_whole(state.file.path())) throw Error(path + ": cannot be written: not all of the video reached the disk");
  state.file.commit();
}

}  // namespace vesalius

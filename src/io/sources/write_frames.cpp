#include "io/sources/write_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <vector>

#include "io/files/atomic_file.h"
#include "io/files/plain_text.h"
#include "io/recordings/imu_messages.h"
#include "io/sources/acceleration_file.h"
#include "io/sources/camera_file.h"
#include "io/sources/fact_tree.h"
#include "io/sources/picture_files.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": folder cannot be made: " + error.message());
}

void make_empty_folder(const fs::path& folder) {
  make_folder(folder);
  std::error_code error;
  const bool empty = fs::is_empty(folder, error);
  if (error) throw Error(folder.string() + ": folder cannot be read: " + error.message());
  if (!empty) throw Error(folder.string() + ": folder has files in it, expected a new or empty one");
}

/// The part that all formats share: it checks names and writes the camera's file with the first frame.
class FolderWriter : public FrameWriter {
 public:
  FolderWriter(fs::path root, float units_per_m, std::optional<float> rate_hz = {})
      : root_(std::move(root)), units_per_m_(units_per_m), rate_hz_(rate_hz) {
    make_empty_folder(root_);
  }

  void write(const Frame& frame) final {
    check(frame);
    std::string name = file_name(frame);
    const bool plain =
        !name.empty() && name.front() != '.' && name.find('/') == name.npos && name.find('\0') == name.npos;
    if (!plain) throw Error(fmt::format("{}: frame named \"{}\", expected a file name", root_.string(), name));
    name = one_of_its_own(name);
    if (!camera_) {
      camera_ = frame.camera;
      write_file_atomically((root_ / "meta.json").string(), serialise_meta(*camera_, units_per_m_, rate_hz_));
    }
    if (frame.camera != *camera_) {
      throw Error(fmt::format("{}: frame {} has another camera than the first", root_.string(), name));
    }
    write_pictures(frame, name);
    const auto time_s = time_when_read(frame, name);
    if (frame.up && time_s) accelerations_.push_back({*time_s, kGravity_m_s2 * frame.up->cast<double>()});
  }

  void close() override {
    if (accelerations_.empty()) return;
    write_file_atomically((root_ / kAccelerationFile).string(), serialise_accelerations(accelerations_));
  }

 protected:
  virtual std::string file_name(const Frame& frame) { return frame.name; }
  virtual void write_pictures(const Frame& frame, const std::string& name) = 0;
  /// Returns the time that a reader of the folder gives a frame, seconds.
  virtual std::optional<double> time_when_read(const Frame& frame, const std::string& name) = 0;

  void write_pngs(const Image<std::uint16_t>& depth, const ColourImage& colour, const std::string& name) const {
    make_folder(root_ / "depth");
    write_png(depth, (root_ / "depth" / (name + ".png")).string());
    if (colour.empty()) return;
    make_folder(root_ / "rgb");
    write_png(colour, (root_ / "rgb" / (name + ".png")).string());
  }

  const fs::path& root() const { return root_; }
  std::optional<float> rate_hz() const { return rate_hz_; }

 private:
  /// Frames of one time, as of a clock that stood or was set back, have one name: the second gets "_2".
  std::string one_of_its_own(const std::string& name) {
    int& count = names_[name];
    std::string own = ++count == 1 ? name : fmt::format("{}_{}", name, count);
    while (own != name && !names_.try_emplace(own, 1).second) own = fmt::format("{}_{}", name, ++count);
    return own;
  }

  fs::path root_;
  float units_per_m_;
  std::optional<float> rate_hz_;
  std::optional<Camera> camera_;
  std::map<std::string, int> names_;  ///< how many frames were named so
  std::vector<TimedAcceleration> accelerations_;
};

class PngWriter final : public FolderWriter {
 public:
  PngWriter(const fs::path& root, std::optional<float> rate_hz) : FolderWriter(root, 1000.F, rate_hz) {}

 private:
  // Of several clips in a folder each begins at 0, and names or places count on.
  std::optional<double> time_when_read(const Frame& frame, const std::string& name) override {
    const int place = count_++;
    if (!rate_hz()) return frame.time_s;
    return (std::ranges::all_of(name, is_digit) ? number_of(std::string_view(name)) : std::nullopt).value_or(place) /
           *rate_hz();
  }

  void write_pictures(const Frame& frame, const std::string& name) override {
    write_pngs(frame.depth, frame.colour, name);
  }

  int count_ = 0;
};

class TumWriter final : public FolderWriter {
 public:
  TumWriter(const fs::path& root, const WriteOptions& options)
      : FolderWriter(root, options.tum_units_per_m), options_(options) {}

  void close() override {
    FolderWriter::close();
    write_file_atomically((root() / "depth.txt").string(), "# depth maps\n# timestamp filename\n" + depth_list_);
    if (!colour_list_.empty()) {
      write_file_atomically((root() / "rgb.txt").string(), "# color images\n# timestamp filename\n" + colour_list_);
    }
  }

 private:
  std::string file_name(const Frame& frame) override {
    const int index = count_++;
    if (frame.time_s) return fmt::format("{:.6f}", *frame.time_s);
    if (options_.frame_rate) return fmt::format("{:.6f}", index / double{*options_.frame_rate});
    throw Error(fmt::format(
        "frame {} has no time, which this layout needs: expected a source with times or a frame rate (--rate)",
        frame.name));
  }

  void write_pictures(const Frame& frame, const std::string& name) override {
    write_pngs(stored(frame), frame.colour, name);
    const std::string_view time = std::string_view(name).substr(0, name.find('_'));
    depth_list_ += fmt::format("{} depth/{}.png\n", time, name);
    if (!frame.colour.empty()) colour_list_ += fmt::format("{} rgb/{}.png\n", time, name);
  }

  std::optional<double> time_when_read(const Frame& /*frame*/, const std::string& name) override {
    return number_of(std::string_view(name).substr(0, name.find('_')));
  }

  Image<std::uint16_t> stored(const Frame& frame) const {
    const double units_per_mm = options_.tum_units_per_m / 1000.0;
    Image<std::uint16_t> image(frame.depth.width(), frame.depth.height());
    std::transform(frame.depth.begin(), frame.depth.end(), image.begin(), [&](std::uint16_t depth_mm) {
      const double units = std::round(depth_mm * units_per_mm);
      if (units > 65535.0) {
        throw Error(fmt::format("{}: frame {}: depth of {} mm, expected at most {} at {} units per metre",
                                root().string(), frame.name, depth_mm, std::floor(65535.0 / units_per_mm),
                                options_.tum_units_per_m));
      }
      return static_cast<std::uint16_t>(units);
    });
    return image;
  }

  WriteOptions options_;
  int count_ = 0;
  std::string depth_list_;
  std::string colour_list_;
};

}  // namespace

FrameFormat parse_frame_format(std::string_view word) {
  if (word == "folder") return FrameFormat::folder;
  if (word == "tum") return FrameFormat::tum;
  throw UsageError(fmt::format("format \"{}\", expected folder or tum", word));
}

std::unique_ptr<FrameWriter> make_frame_writer(FrameFormat format, const std::string& folder,
                                               const WriteOptions& options) {
  if (!(options.tum_units_per_m >= 1000.F && options.tum_units_per_m <= 65535.F)) {
    throw UsageError("TUM scale: expected 1000 to 65535 units per metre: fewer would lose millimetres");
  }
  const float rate = options.frame_rate.value_or(1.F);
  if (!(rate > 0.F && rate <= 1000.F)) {
    throw UsageError("frame rate: expected more than 0 to 1000 frames per second");
  }
  if (format == FrameFormat::tum) return std::make_unique<TumWriter>(folder, options);
  return std::make_unique<PngWriter>(folder, options.frame_rate);
}

}  // namespace vesalius

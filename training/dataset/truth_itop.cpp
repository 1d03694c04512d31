#include "dataset/truth_itop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dataset/hdf5_array.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kDepthSuffix = "_depth_map.h5";
constexpr std::string_view kLabelsSuffix = "_labels.h5";
constexpr std::size_t kWidth = 320;
constexpr std::size_t kHeight = 240;
constexpr std::size_t kMaxRows = 10'000'000;
constexpr float kFarthest_m = 100.F;
/// The data set converts pixels to metres by x = (u - 160) z 0.0035, y = (120 - v) z 0.0035, with y up.
constexpr float kMetresPerPixel = 0.0035F;

constexpr std::array<const char*, 15> kJoints{"head",    "neck",   "r_shoulder", "l_shoulder", "r_elbow",
                                              "l_elbow", "r_hand", "l_hand",     "torso",      "r_hip",
                                              "l_hip",   "r_knee", "l_knee",     "r_foot",     "l_foot"};

std::string labels_path(const std::string& depth_path) {
  return depth_path.substr(0, depth_path.size() - kDepthSuffix.size()) + std::string(kLabelsSuffix);
}

DepthImage to_depth(const std::vector<float>& metres) {
  DepthImage depth(kWidth, kHeight);
  std::ranges::transform(metres, depth.begin(), [](float m) -> std::uint16_t {
    const float mm = std::round(m * 1000.F);
    const bool held = mm >= 1.F && mm <= static_cast<float>(std::numeric_limits<std::uint16_t>::max());
    return held ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};  // NaN gives 0 too
  });
  return depth;
}

class ItopTruth final : public TruthSource {
 public:
  ItopTruth(const std::string& depth_path, int step)
      : path_(labels_path(depth_path)),
        depth_(depth_path, "data", {kHeight, kWidth}),
        joints_(path_, "real_world_coordinates", {kJoints.size(), 3}),
        segmentation_(path_, "segmentation", {kHeight, kWidth}) {
    const Hdf5Array valid(path_, "is_valid", {});
    rows_ = depth_.rows();
    for (const std::size_t rows : {valid.rows(), joints_.rows(), segmentation_.rows()}) {
      if (rows == rows_ && rows <= kMaxRows) continue;
      throw Error(fmt::format("{}: {} rows, expected {} as in the depth maps", path_, rows, rows_));
    }
    std::size_t kept = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      if (valid.read(row).front() == 0.F) continue;
      if (kept++ % step == 0) wanted_.push_back(row);
    }
    left_out_ = rows_ - kept;
  }

  std::optional<TrueFrame> next() override {
    if (next_ == wanted_.size()) return std::nullopt;
    const std::size_t row = wanted_[next_++];
    TrueFrame result;
    result.frame.name = fmt::format("{:06}", row);
    result.frame.camera = {kWidth, kHeight, 1.F / kMetresPerPixel, 1.F / kMetresPerPixel, kWidth / 2.F, kHeight / 2.F};
    result.frame.depth = to_depth(depth_.read(row));
    result.truth.people = 1;
    result.truth.joint_set = "itop15";
    result.truth.joint_names.assign(kJoints.begin(), kJoints.end());
    result.truth.joints.push_back(read_joints(row));
    result.truth.mask = read_mask(row);
    return result;
  }
  int size() const override { return static_cast<int>(wanted_.size()); }
  std::vector<std::string> notes() const override {
    if (left_out_ == 0) return {};
    return {fmt::format("{}: {} of {} frames have no valid labels and are left out", path_, left_out_, rows_)};
  }

 private:
  std::vector<Eigen::Vector3f> read_joints(std::size_t row) const {
    const std::vector<float> xyz = joints_.read(row);
    std::vector<Eigen::Vector3f> joints;
    for (std::size_t i = 0; i < xyz.size(); i += 3) {
      Eigen::Vector3f joint(xyz[i], -xyz[i + 1], xyz[i + 2]);
      if (!joint.allFinite()) joint.setConstant(std::numeric_limits<float>::quiet_NaN());
      if (joint.cwiseAbs().maxCoeff() > kFarthest_m) {
        throw Error(fmt::format("{}: real_world_coordinates: row {}: a joint at {} m, expected metres", path_, row,
                                joint.cwiseAbs().maxCoeff()));
      }
      joints.push_back(joint);
    }
    return joints;
  }

  /// Reads the mask of a row. Parts are numbered from 0 and the background is -1; if no pixel has a part, there is no
  /// mask.
  Mask read_mask(std::size_t row) const {
    const std::vector<float> parts = segmentation_.read(row);
    Mask mask(kWidth, kHeight);
    std::ranges::transform(parts, mask.begin(), [](float part) -> std::uint8_t { return part >= 0.F ? 1 : 0; });
    return std::ranges::find(mask, std::uint8_t{1}) == mask.end() ? Mask{} : mask;
  }

  std::string path_;  ///< path of the labels' file
  Hdf5Array depth_;
  Hdf5Array joints_;
  Hdf5Array segmentation_;
  std::size_t rows_ = 0;
  std::size_t left_out_ = 0;
  std::vector<std::size_t> wanted_;
  std::size_t next_ = 0;
};

}  // namespace

bool is_itop(const std::string& path) { return path.ends_with(kDepthSuffix); }

std::unique_ptr<TruthSource> open_itop(const std::string& depth_path, int step) {
  return std::make_unique<ItopTruth>(depth_path, step);
}

}  // namespace vesalius

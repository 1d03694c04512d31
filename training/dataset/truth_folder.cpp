#include "dataset/truth_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <system_error>

#include "dataset/truth_csv.h"
#include "io/files/data_file.h"
#include "io/files/plain_text.h"
#include "io/sources/folder_source.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr int kMostPeople = 1000;
constexpr std::size_t kMostJoints = 1000;
constexpr double kFarthest_m = 1000.0;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

/// Removes a trailing slash, which would hide the folder's name.
fs::path plain(const std::string& folder) {
  std::error_code ignored;
  fs::path path = fs::absolute(folder, ignored).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// Returns the name of a frame; tables may give it with or without the extension of a picture.
std::string frame_name(const std::string& text) {
  return text.ends_with(".png") ? text.substr(0, text.size() - 4) : text;
}

std::optional<double> number_in(const std::string& name) {
  double number = 0.0;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, number);
  return error == std::errc() && stop == end && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

Mask read_mask(const std::string& path, const Frame& frame) {
  const ColourImage picture = read_colour(path);
  if (!picture.same_size(frame.depth)) {
    throw Error(fmt::format("{}: {}x{} pixels, expected those of the frame, {}x{}", path, picture.width(),
                            picture.height(), frame.depth.width(), frame.depth.height()));
  }
  Mask mask(picture.width(), picture.height(), 0);
  std::ranges::transform(picture, mask.begin(), [](Rgb pixel) -> std::uint8_t { return pixel == Rgb{} ? 0 : 1; });
  return mask;
}

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
constexpr double kLongestGap_s = 0.15;  // the benchmark's motion capture gives 100 poses a second

/// Returns the eight numbers of a line, or nothing if the line has any other form.
std::optional<std::array<double, 8>> numbers(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::array<double, 8> values{};
  for (double& value : values) {
    line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
    const char* end = line.data() + line.size();
    const auto [stop, error] = std::from_chars(line.data(), end, value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    if (stop != end && kSpace.find(*stop) == kSpace.npos) return std::nullopt;
    line.remove_prefix(stop - line.data());
  }
  if (line.find_first_not_of(kSpace) != line.npos) return std::nullopt;
  return values;
}

}  // namespace

TruthFolder::TruthFolder(const std::string& folder) : folder_(folder) {
  const fs::path path = plain(folder);
  has_masks_ = is_folder(path / "mask");
  if (is_file(path / "frames.csv")) {
    read_people((path / "frames.csv").string(), "");
  } else if (is_file(path.parent_path() / "frames.csv")) {
    read_people((path.parent_path() / "frames.csv").string(), path.filename().string());
  }
  if (is_file(path / "joints.csv")) read_joints((path / "joints.csv").string());
  if (is_file(path / "groundtruth.txt")) camera_ = Trajectory::read((path / "groundtruth.txt").string());
  if (facts_.empty() && joints_.empty() && !has_masks_) {
    throw Error(
        fmt::format("{}: no truth, expected frames.csv (in it, or beside it naming it), joints.csv or mask/", folder));
  }
  const auto any = [&](auto&& is) {
    return std::ranges::any_of(facts_, is, [](const auto& f) { return f.second.people; });
  };
  const bool somebody = !joints_.empty() || any([](int people) { return people == 1; });
  one_person_ = somebody && !any([](int people) { return people > 1; });
}

std::optional<double> TruthFolder::time_of(const Frame& frame) const {
  return frame.time_s || !camera_ ? frame.time_s : number_in(frame.name);
}

/// Reads the rows of `set`; if it is empty, the table has one set only.
void TruthFolder::read_people(const std::string& path, const std::string& set) {
  const CsvTable table = CsvTable::read(path);
  const std::size_t frame = table.column("frame");
  const std::size_t people = table.column("people");
  const bool has_posture = table.has("posture");
  const std::size_t posture = has_posture ? table.column("posture") : 0;
  const bool has_heading = table.has("heading");
  const std::size_t heading = has_heading ? table.column("heading") : 0;
  const std::size_t set_column = set.empty() ? 0 : table.column("set");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!set.empty() && table.cell(row, set_column) != set) continue;
    Facts facts{table.integer(row, people, -1, kMostPeople), has_posture ? table.cell(row, posture) : "",
                has_heading ? heading_in(table, row, heading) : std::nullopt};
    const std::string name = frame_name(table.cell(row, frame));
    if (!facts_.emplace(name, std::move(facts)).second) {
      throw Error(fmt::format("{}: frame {} comes twice", table.place(row), name));
    }
  }
}

void TruthFolder::read_joints(const std::string& path) {
  const CsvTable table = CsvTable::read(path);
  const std::size_t frame = table.column("frame");
  const std::size_t joint = table.column("joint");
  const std::size_t x = table.column("x_m"), y = table.column("y_m"), z = table.column("z_m");
  std::map<std::string, std::size_t> index;
  std::set<std::pair<std::string, std::size_t>> known;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto [found, is_new] = index.try_emplace(table.cell(row, joint), joint_names_.size());
    if (is_new) joint_names_.push_back(found->first);
    if (joint_names_.size() > kMostJoints) {
      throw Error(fmt::format("{}: expected at most {} joints", table.place(row), kMostJoints));
    }
    const std::string name = frame_name(table.cell(row, frame));
    if (!known.emplace(name, found->second).second) {
      throw Error(fmt::format("{}: joint {} of frame {} comes twice", table.place(row), found->first, name));
    }
    const Eigen::Vector3d point(table.number(row, x), table.number(row, y), table.number(row, z));
    if (point.cwiseAbs().maxCoeff() > kFarthest_m) {
      throw Error(fmt::format("{}: a joint at {} m, expected metres", table.place(row), point.cwiseAbs().maxCoeff()));
    }
    auto& joints = joints_[name];
    joints.resize(joint_names_.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    joints[found->second] = point.cast<float>();
  }
  for (auto& [name, joints] : joints_) {
    joints.resize(joint_names_.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  }
}

FrameTruth TruthFolder::truth_of(const Frame& frame) const {
  FrameTruth truth;
  const auto facts = facts_.find(frame.name);
  if (facts != facts_.end()) {
    truth.people = facts->second.people;
    truth.posture = facts->second.posture;
    truth.heading = facts->second.heading;
  }
  if (const auto time_s = time_of(frame); camera_ && time_s) {
    if (const auto turn = camera_->world_from_camera(*time_s)) {
      truth.up = (turn->toRotationMatrix().transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
    }
  }
  const auto joints = joints_.find(frame.name);
  if (joints != joints_.end()) {
    if (facts == facts_.end()) truth.people = 1;
    truth.joint_names = joint_names_;
    truth.joints.push_back(joints->second);
  }
  const fs::path mask = fs::path(folder_) / "mask" / (frame.name + ".png");
  if (has_masks_ && is_file(mask)) truth.mask = read_mask(mask.string(), frame);
  if (facts == facts_.end() && joints == joints_.end() && truth.mask.empty()) {
    throw Error(fmt::format("{}: nothing is known of frame {}, expected it in frames.csv or joints.csv, or its mask",
                            folder_, frame.name));
  }
  // If there are people but the mask has no pixel of them, it was not made for this frame.
  const bool blank = std::ranges::all_of(truth.mask, [](std::uint8_t pixel) { return pixel == 0; });
  if (blank && truth.people != 0) truth.mask = {};
  truth.sequence = 0;
  if (one_person_ && truth.people != 0) truth.ids = {0};
  return truth;
}

std::vector<std::string> sets_in(const std::string& folder) {
  const fs::path path(folder);
  if (!is_folder(path) || !is_file(path / "frames.csv") || is_folder(path / "depth")) return {folder};
  const CsvTable table = CsvTable::read((path / "frames.csv").string());
  if (!table.has("set")) return {folder};
  const std::size_t column = table.column("set");
  std::set<std::string> named;
  for (std::size_t row = 0; row < table.rows(); ++row) named.insert(table.cell(row, column));
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    if (is_folder(entry.path()) && (named.contains(name) || is_file(entry.path() / "joints.csv"))) {
      names.push_back(name);
    }
  }
  if (names.empty()) throw Error(fmt::format("{}: none of the sets that its frames.csv names is there", folder));
  std::ranges::sort(names, natural_less);
  for (std::string& name : names) name = (path / name).string();
  return names;
}

Trajectory Trajectory::parse(std::string_view text, const std::string& name) {
  Trajectory trajectory;
  each_line(text, " \t\r", [&](std::string_view line, int number) {
    const auto v = numbers(line);
    if (!v) throw Error(fmt::format("{}:{}: expected \"timestamp tx ty tz qx qy qz qw\"", name, number));
    const double time_s = (*v)[0];
    const Eigen::Quaterniond rotation((*v)[7], (*v)[4], (*v)[5], (*v)[6]);
    if (std::abs(rotation.norm() - 1.0) > 0.01) {
      throw Error(fmt::format("{}:{}: a quaternion of length {}, expected 1", name, number, rotation.norm()));
    }
    if (!trajectory.poses_.empty() && time_s <= trajectory.poses_.back().time_s) {
      throw Error(fmt::format("{}:{}: a time that does not come after the one before", name, number));
    }
    trajectory.poses_.push_back({time_s, rotation.normalized()});
  });
  if (trajectory.poses_.empty()) throw Error(name + ": no pose, expected \"timestamp tx ty tz qx qy qz qw\"");
  return trajectory;
}

Trajectory Trajectory::read(const std::string& path) { return parse(read_file(path, kMaxBytes), path); }

std::optional<Eigen::Quaterniond> Trajectory::world_from_camera(double time_s) const {
  const auto after = std::ranges::lower_bound(poses_, time_s, {}, &Pose::time_s);
  if (after == poses_.end()) return std::nullopt;
  if (after->time_s == time_s) return after->rotation;
  if (after == poses_.begin()) return std::nullopt;
  const Pose& before = *(after - 1);
  const double gap_s = after->time_s - before.time_s;
  if (gap_s > kLongestGap_s) return std::nullopt;
  return before.rotation.slerp((time_s - before.time_s) / gap_s, after->rotation);
}

}  // namespace vesalius

#include "commands/evaluate/truth_bvh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

#include "dataset/open_truth.h"
#include "dataset/stepped_source.h"
#include "dataset/tum_trajectory.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "synth/mocap/motion.h"
#include "synth/text/text_scanner.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "truth_bvh.toml";
constexpr std::size_t kMaxMotionBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxTableBytes = std::size_t{64} << 20;

BvhTruthOptions read_bvh_options(const std::string& path) {
  BvhTruthOptions options;
  read_options(path, [&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  RangeCheck check;
  visit_options("", options, check);
  const auto need = [&](bool there, const char* what) {
    if (!there) throw Error(fmt::format("{}: expected {}", path, what));
  };
  need(!options.motion.empty(), "motion = \"FILE.bvh\"");
  need(!options.joints.empty(), "joints = \"OURS=THEIRS ...\"");
  need(options.camera_from_world.empty() != options.camera_trajectory.empty(),
       "either camera-from-world or camera-trajectory");
  return options;
}

Eigen::Isometry3d parse_transform(const std::string& text, const std::string& name) {
  synth::TextScanner scan(text, name);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      transform.matrix()(row, column) = scan.number("twelve numbers, the rows of [R | t]");
    }
  }
  if (!scan.at_end()) throw Error(name + ": expected twelve numbers, the rows of [R | t], found more");
  const Eigen::Matrix3d rotation = transform.linear();
  if (!(rotation * rotation.transpose()).isIdentity(1e-3) || rotation.determinant() < 0.0) {
    throw Error(name + ": expected a rotation in the first three columns");
  }
  return transform;
}

/// Returns for each picture its frame of the motion, from one column of a table.
std::vector<int> parse_frame_table(const std::string& text, const std::string& name, int column, int frame_count) {
  std::vector<int> frames;
  synth::TextScanner scan(text, name);
  while (!scan.at_end()) {
    for (int c = 1; c < column; ++c) {
      scan.word("a column more");
      if (scan.at_line_end()) scan.fail(fmt::format("expected {} columns, found {}", column, c));
    }
    frames.push_back(scan.whole("a frame of the motion, from 0", 0, frame_count - 1));
    scan.skip_line();
  }
  return frames;
}

double parse_seconds(const std::string& text, const std::string& name) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) throw Error(name + ": expected seconds");
  return value;
}

struct NamedJoint {
  std::string name;
  int joint = -1;
};

std::vector<NamedJoint> parse_joints(const std::string& text, const std::string& name, const synth::Motion& motion) {
  std::vector<NamedJoint> joints;
  synth::TextScanner scan(text, name);
  while (!scan.at_end()) {
    const std::string_view word = scan.word("OURS=THEIRS");
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == word.npos) scan.fail("expected OURS=THEIRS, found " + synth::in_quotes(word));
    const std::string_view theirs = word.substr(equals + 1);
    joints.push_back({std::string(word.substr(0, equals)), motion.find_joint(theirs)});
    if (joints.back().joint < 0) scan.fail("the motion has no joint " + synth::in_quotes(theirs));
  }
  return joints;
}

/// Returns all joints of a frame in world coordinates and the file's unit of length.
std::vector<Eigen::Vector3d> joint_positions(const synth::Motion& motion, int frame) {
  std::vector<Eigen::Vector3d> positions;
  for (const synth::MotionJoint& joint : motion.joints) {
    if (joint.parent < 0) {
      positions.push_back(motion.root[frame].cast<double>());
    } else {
      const Eigen::Quaterniond turn = motion.rotation(frame, joint.parent).cast<double>();
      positions.push_back(positions[joint.parent] + turn * joint.offset.cast<double>());
    }
  }
  return positions;
}

class BvhTruth final : public TruthSource {
 public:
  BvhTruth(const std::string& folder, int step)
      : path_((fs::path(folder) / kFile).string()),
        options_(read_bvh_options(path_)),
        source_(open_source(folder), step) {
    const auto file = [&](const std::string& name) { return (fs::path(folder) / name).string(); };
    motion_ = synth::parse_bvh(read_file(file(options_.motion), kMaxMotionBytes), file(options_.motion));
    start_s_ = parse_seconds(options_.start_s, path_ + ": start");
    joints_ = parse_joints(options_.joints, path_ + ": joints", motion_);
    if (!options_.camera_trajectory.empty()) {
      trajectory_ = Trajectory::read(file(options_.camera_trajectory));
    } else {
      camera_from_world_ = parse_transform(options_.camera_from_world, path_ + ": camera-from-world");
    }
    if (!options_.frames.empty()) {
      const std::string table = file(options_.frames);
      frames_ =
          parse_frame_table(read_file(table, kMaxTableBytes), table, options_.frames_column, motion_.frame_count());
    }
  }

  std::optional<TrueFrame> next() override {
    if (left_) return std::nullopt;
    auto step = source_.next();
    if (!step) return std::nullopt;
    FrameTruth truth = truth_of(step->frame, step->index);
    return TrueFrame{std::move(step->frame), std::move(truth)};
  }
  void leave_sequence() override { left_ = true; }
  int size() const override { return source_.size(); }
  std::vector<std::string> notes() const override { return source_.notes(); }

 private:
  /// Returns the motion's frame for a picture, or -1 if the motion has none.
  int motion_frame(const Frame& frame, int index) const {
    if (!frames_.empty()) {
      return static_cast<std::size_t>(index) < frames_.size() ? frames_[index] : -1;
    }
    if (!frame.time_s) {
      throw Error(fmt::format("{}: frame {} has no time, expected a table as frames", path_, frame.name));
    }
    const double at = std::round((*frame.time_s - start_s_) * double(motion_.fps));
    return at >= 0.0 && at < motion_.frame_count() ? int(at) : -1;
  }

  FrameTruth truth_of(const Frame& frame, int index) const {
    FrameTruth truth;
    truth.people = 1;
    truth.sequence = 0;
    truth.ids = {0};
    truth.joint_set = options_.joint_set;
    for (const NamedJoint& joint : joints_) truth.joint_names.push_back(joint.name);
    std::optional<Eigen::Isometry3d> camera_from_world = camera_from_world_;
    if (trajectory_ && frame.time_s) {
      truth.camera_motion = trajectory_->motion(*frame.time_s);
      if (const auto pose = trajectory_->world_from_camera(*frame.time_s)) camera_from_world = pose->inverse();
    }
    const int at = motion_frame(frame, index);
    if (at < 0 || !camera_from_world) return truth;  // there is a person whose joints are unknown
    const std::vector<Eigen::Vector3d> world = joint_positions(motion_, at);
    const auto unit_m = double(options_.unit_m);
    std::vector<Eigen::Vector3f>& joints = truth.joints.emplace_back();
    for (const NamedJoint& joint : joints_) {
      const Eigen::Vector3d metres = unit_m * world[joint.joint];
      joints.emplace_back((*camera_from_world * metres).cast<float>());
    }
    return truth;
  }

  bool left_ = false;
  std::string path_;
  BvhTruthOptions options_;
  SteppedSource source_;
  double start_s_ = 0.0;
  synth::Motion motion_;
  std::vector<NamedJoint> joints_;
  std::vector<int> frames_;  ///< frame of the motion for each picture; empty means that times decide
  std::optional<Eigen::Isometry3d> camera_from_world_;
  std::optional<Trajectory> trajectory_;
};

}  // namespace

void visit_options(const std::string& prefix, BvhTruthOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "motion", o.motion, {"", 0, 0, "BVH file."});
  visitor.option(prefix + "unit", o.unit_m, {"m", 1e-4, 10.0, "The BVH file's unit of length."});
  visitor.option(prefix + "camera-from-world", o.camera_from_world, {"", 0, 0, "Rows of [R | t], t in metres."});
  visitor.option(prefix + "camera-trajectory", o.camera_trajectory, {"", 0, 0, "World from camera, TUM's form."});
  visitor.option(prefix + "frames", o.frames, {"", 0, 0, "Table with a line for each picture."});
  visitor.option(prefix + "frames-column", o.frames_column, {"", 1, 100, "Column of the motion's frame, from 1."});
  visitor.option(prefix + "start", o.start_s, {"s", 0, 0, "Time of the motion's first frame."});
  visitor.option(prefix + "joints", o.joints, {"", 0, 0, "Pairs OURS=THEIRS of joints."});
  visitor.option(prefix + "joint-set", o.joint_set, {"", 0, 0, "Joint set of the body to compare with."});
}

std::unique_ptr<TruthSource> open_evaluation_truth(const std::string& uri, int step) {
  std::error_code ignored;
  if (fs::is_regular_file(fs::path(uri) / kFile, ignored)) {
    if (step < 1) throw UsageError("every 0th frame, expected a step of at least 1");
    return std::make_unique<BvhTruth>(uri, step);
  }
  return open_truth(uri, step);
}

}  // namespace vesalius::cli

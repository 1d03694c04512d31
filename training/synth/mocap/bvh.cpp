#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "synth/mocap/motion.h"
#include "synth/text/text_scanner.h"

namespace vesalius::synth {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::array<std::string_view, 6> kChannelNames = {"Xposition", "Yposition", "Zposition",
                                                           "Xrotation", "Yrotation", "Zrotation"};
constexpr int kFirstRotation = 3;
/// Joints that are nearer to each other than this share of the longest offset coincide, so their offset gives no
/// direction.
constexpr float kApart = 1e-4F;

class BvhParser {
 public:
  BvhParser(std::string_view text, const std::string& name) : scan_(text, name) { motion_.name = name; }

  Motion parse() {
    hierarchy();
    find_directions();
    frames();
    return std::move(motion_);
  }

 private:
  void hierarchy();
  void joint(int parent);
  void end_site(int parent);
  void channels();
  Eigen::Vector3f offset();
  void find_directions();
  void frames();
  void frame(std::size_t first);

  TextScanner scan_;
  Motion motion_;
  std::vector<std::vector<int>> channels_;             ///< for each joint, indices of kChannelNames
  std::vector<std::pair<int, Eigen::Vector3f>> ends_;  ///< end sites with their parent and offset
  int channel_count_ = 0;
};

/// Reads the nested blocks of the joints. A list of open blocks replaces recursion, which a hostile file could make too
/// deep.
void BvhParser::hierarchy() {
  scan_.expect("HIERARCHY");
  scan_.expect("ROOT");
  joint(-1);
  std::vector<int> open = {0};
  while (!open.empty()) {
    const std::string_view word = scan_.word("JOINT, End or }");
    if (word == "JOINT") {
      joint(open.back());
      open.push_back(motion_.joint_count() - 1);
    } else if (word == "End") {
      end_site(open.back());
    } else if (word == "}") {
      open.pop_back();
    } else {
      scan_.fail(fmt::format("expected JOINT, End or }}, found {}", in_quotes(word)));
    }
  }
}

void BvhParser::joint(int parent) {
  if (motion_.joint_count() == kMaxMotionJoints) {
    scan_.fail(fmt::format("more than {} joints", kMaxMotionJoints));
  }
  MotionJoint read;
  read.name = scan_.word("the name of a joint");
  if (motion_.find_joint(read.name) >= 0) scan_.fail(fmt::format("a second joint called {}", in_quotes(read.name)));
  read.parent = parent;
  scan_.expect("{");
  read.offset = offset();
  motion_.joints.push_back(std::move(read));
  channels();
}

void BvhParser::end_site(int parent) {
  scan_.expect("Site");
  scan_.expect("{");
  ends_.emplace_back(parent, offset());
  scan_.expect("}");
}

Eigen::Vector3f BvhParser::offset() {
  scan_.expect("OFFSET");
  Eigen::Vector3f read;
  for (float& value : read) value = float(scan_.number("an offset"));
  return read;
}

void BvhParser::channels() {
  scan_.expect("CHANNELS");
  const int count = scan_.whole("the number of channels", 0, 6);
  std::vector<int> read;
  for (int i = 0; i < count; ++i) {
    const std::string_view word = scan_.word("the name of a channel");
    const auto* found = std::ranges::find_if(kChannelNames, [&](auto known) { return same_word(word, known); });
    if (found == kChannelNames.end()) {
      scan_.fail(
          fmt::format("channel {} of {}: expected Xposition ... Zrotation, found {}", i + 1, count, in_quotes(word)));
    }
    const int channel = int(found - kChannelNames.begin());
    if (std::ranges::find(read, channel) != read.end()) scan_.fail(fmt::format("channel {} stands twice", word));
    read.push_back(channel);
  }
  if (!scan_.at_line_end()) scan_.fail(fmt::format("expected {} names of channels, found more", count));
  channel_count_ += count;
  channels_.push_back(std::move(read));
}

void BvhParser::find_directions() {
  float longest = 0.F;
  for (const MotionJoint& joint : motion_.joints) longest = std::max(longest, joint.offset.norm());
  const auto point = [&](int parent, const Eigen::Vector3f& offset) {
    if (parent < 0 || offset.norm() <= kApart * longest) return;
    Eigen::Vector3f& along = motion_.joints[parent].along;
    if (along.isZero()) along = offset.normalized();
  };
  for (const MotionJoint& joint : motion_.joints) point(joint.parent, joint.offset);
  for (const auto& [parent, offset] : ends_) point(parent, offset);
}

void BvhParser::frames() {
  scan_.expect("MOTION");
  scan_.expect("Frames:");
  const int count = scan_.whole("the number of frames", 1, 100'000'000);
  const auto total = static_cast<std::size_t>(count);
  if (channel_count_ == 0) scan_.fail("no joint has a channel");
  // Every number takes at least a digit and a space, so there cannot be more frames than that.
  if (total > scan_.bytes_left() / (2 * static_cast<std::size_t>(channel_count_)) + 1) {
    scan_.fail(fmt::format("{} frames of {} numbers: the file is too short for them", count, channel_count_));
  }
  if (total * motion_.joints.size() > kMaxMotionRotations) scan_.fail(fmt::format("{} frames are too many", count));
  scan_.expect("Frame");
  scan_.expect("Time:");
  const double seconds = scan_.number("the time of a frame");
  if (!(seconds > 1e-5)) scan_.fail("the time of a frame: expected more than 0 seconds");
  motion_.fps = float(1.0 / seconds);
  motion_.world.resize(total * motion_.joints.size());
  motion_.root.resize(total);
  for (std::size_t f = 0; f < total; ++f) frame(f);
  if (!scan_.at_end()) {
    scan_.word("the end");
    scan_.fail(fmt::format("expected the end after {} frames", count));
  }
}

void BvhParser::frame(std::size_t f) {
  motion_.root[f] = motion_.joints[0].offset;
  for (std::size_t j = 0, read = 0; j < motion_.joints.size(); ++j) {
    Eigen::Quaterniond local = Eigen::Quaterniond::Identity();
    for (const int channel : channels_[j]) {
      if (read++ > 0 && scan_.at_line_end()) {
        scan_.fail(fmt::format("frame {}: expected {} numbers, found {}", f + 1, channel_count_, read - 1));
      }
      const double value = scan_.number("a number of the motion");
      if (channel >= kFirstRotation) {
        local = local * axis_rotation(channel - kFirstRotation, value * kDegree);
      } else if (j == 0) {
        motion_.root[f][channel] = float(value);
      }
    }
    const int parent = motion_.joints[j].parent;
    Eigen::Quaternionf& world = motion_.world[f * motion_.joints.size() + j];
    world = local.cast<float>();
    if (parent >= 0) world = (motion_.rotation(int(f), parent) * world).normalized();
  }
  if (!scan_.at_line_end()) scan_.fail(fmt::format("frame {}: expected {} numbers, found more", f + 1, channel_count_));
}

}  // namespace

Motion parse_bvh(std::string_view text, const std::string& name) { return BvhParser(text, name).parse(); }

}  // namespace vesalius::synth

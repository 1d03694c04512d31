#include "dataset/labelled_truth.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace vesalius {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// A joint of other trackers, as the middle between two joints of the skeleton.
struct Named {
  const char* name;
  const char* first;
  const char* second;
};
constexpr std::array kNamed{Named{"head", "head", "head_end"},
                            Named{"neck", "neck", "neck"},
                            Named{"shoulder_center", "l_upper_arm", "r_upper_arm"},
                            Named{"torso", "neck", "pelvis"},
                            Named{"spine", "spine", "spine"},
                            Named{"hip_center", "l_thigh", "r_thigh"},
                            Named{"l_shoulder", "l_upper_arm", "l_upper_arm"},
                            Named{"l_elbow", "l_forearm", "l_forearm"},
                            Named{"l_wrist", "l_hand", "l_hand"},
                            Named{"l_hand", "l_hand", "l_hand_end"},
                            Named{"r_shoulder", "r_upper_arm", "r_upper_arm"},
                            Named{"r_elbow", "r_forearm", "r_forearm"},
                            Named{"r_wrist", "r_hand", "r_hand"},
                            Named{"r_hand", "r_hand", "r_hand_end"},
                            Named{"l_hip", "l_thigh", "l_thigh"},
                            Named{"l_knee", "l_shin", "l_shin"},
                            Named{"l_ankle", "l_foot", "l_foot"},
                            Named{"l_foot", "l_foot", "l_foot_end"},
                            Named{"r_hip", "r_thigh", "r_thigh"},
                            Named{"r_knee", "r_shin", "r_shin"},
                            Named{"r_ankle", "r_foot", "r_foot"},
                            Named{"r_foot", "r_foot", "r_foot_end"}};

/// The joints from an ankle to the top of the head. Their distances do not depend on the pose.
constexpr std::array kUpwards{"foot", "shin", "thigh"};
constexpr std::array kTrunk{"pelvis", "spine", "chest", "neck", "head", "head_end"};
/// A stature as a multiple of those distances together, since some of it lies below the ankle: between the 1.037 of
/// MakeHuman bodies and the 1.053 of built-in ones, whose statures it gives to 2 cm.
constexpr float kStaturePerLength = 1.043F;

class Skeleton {
 public:
  Skeleton(const std::vector<std::string>& names, const Points& points) : names_(names), points_(points) {}

  const Eigen::Vector3f& at(const std::string& name) const {
    return points_[std::ranges::find(names_, name) - names_.begin()];
  }
  float distance(const std::string& a, const std::string& b) const { return (at(a) - at(b)).norm(); }

  float stature_m() const {
    float length_m = 0.F;
    for (const char* side : {"l_", "r_"}) {
      for (std::size_t i = 1; i < kUpwards.size(); ++i) {
        length_m += 0.5F * distance(std::string(side) + kUpwards[i - 1], std::string(side) + kUpwards[i]);
      }
    }
    for (std::size_t i = 1; i < kTrunk.size(); ++i) length_m += distance(kTrunk[i - 1], kTrunk[i]);
    return kStaturePerLength * length_m;
  }

 private:
  const std::vector<std::string>& names_;
  const Points& points_;
};

bool has_all(const std::vector<std::string>& names) {
  const auto has = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  const auto has_leg = [&](const char* bone) { return has(std::string("l_") + bone) && has(std::string("r_") + bone); };
  return std::ranges::all_of(kNamed, [&](const Named& n) { return has(n.first) && has(n.second); }) &&
         std::ranges::all_of(kUpwards, has_leg) && std::ranges::all_of(kTrunk, has);
}

/// Adds what follows from the joints of the people's skeletons, [person][joint]: the joints of other trackers under
/// their names, each a joint of the skeleton or the middle between two, and the people's statures. Adds nothing if the
/// names are those of another skeleton or there is none.
void add_skeleton_truth(const std::vector<std::string>& names, const std::vector<Points>& skeletons,
                        FrameTruth& truth) {
  if (skeletons.empty() || !has_all(names)) return;
  for (const Named& named : kNamed) truth.joint_names.emplace_back(named.name);
  for (const Points& points : skeletons) {
    const Skeleton skeleton(names, points);
    Points& joints = truth.joints.emplace_back();
    for (const Named& named : kNamed)
      joints.emplace_back(0.5F * (skeleton.at(named.first) + skeleton.at(named.second)));
    truth.statures_m.push_back(skeleton.stature_m());
  }
  truth.joint_set = "nite15";
}

/// Returns how many of the people are in the picture.
int people_seen(const Image<std::uint8_t>& person, std::size_t people) {
  std::vector<bool> seen(kBackground + 1, false);
  for (const std::uint8_t who : person) seen[who] = true;
  return int(std::count(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(people), true));
}

}  // namespace

TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& joint_names, int clip) {
  TrueFrame result;
  FrameTruth& truth = result.truth;
  truth.people = int(labelled.parts.size());
  truth.sequence = clip;
  if (clip >= 0) {
    truth.ids.resize(labelled.parts.size());
    std::iota(truth.ids.begin(), truth.ids.end(), 0);
    truth.people = people_seen(labelled.person, labelled.parts.size());
  }
  truth.mask = Mask(labelled.person.width(), labelled.person.height(), 0);
  for (std::size_t i = 0; i < truth.mask.size(); ++i) truth.mask[i] = labelled.person[i] == kBackground ? 0 : 1;
  add_skeleton_truth(joint_names, labelled.joints, truth);
  truth.parts = std::move(labelled.parts);
  truth.postures = std::move(labelled.postures);
  truth.up = labelled.up;
  truth.camera_height_m = labelled.camera_height_m;
  truth.person = std::move(labelled.person);
  truth.labels = std::move(labelled.labels);
  result.frame = std::move(labelled.frame);
  return result;
}

std::vector<std::string> part_names_of(const BodyModel& body) {
  std::vector<std::string> names;
  for (const BodyPart& part : body.parts) names.push_back(part.name);
  return names;
}

}  // namespace vesalius

#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/derive_joints.h"

namespace vesalius {

/// Distance below which a joint counts as right, metres. The tables of ITOP call the share of right joints mAP.
inline constexpr double kJointTolerance_m = 0.1;
/// A joint that lies farther from the truth was mistaken for something else and tells nothing about its place.
inline constexpr double kPlacedJoint_m = 0.25;

/// The joints of one true person under the names of its data set, and where they were found. NaN means not known or not
/// found.
struct JointPair {
  std::vector<Eigen::Vector3f> truth;
  std::vector<Eigen::Vector3f> found;  ///< found positions, of the same length
};

/// Returns the positions of `joints`, which are in the order of `set`, in the order of `names`. Joints that were not
/// found are NaN; if the person was not found (`joints` is empty), all are. Throws Error for a name that the set lacks.
std::vector<Eigen::Vector3f> joints_by_name(const std::vector<std::string>& names, const JointSet& set,
                                            const std::vector<Joint>& joints);

/// Returns the confidences of the same joints; 0 of those that were not found.
std::vector<float> confidences_by_name(const std::vector<std::string>& names, const JointSet& set,
                                       const std::vector<Joint>& joints);

/// Returns the joint set called `wanted` if the body has it and it has any of these joints, otherwise the first one
/// that has all of them, or null.
const JointSet* joint_set_with_names(const BodyModel& body, const std::vector<std::string>& names,
                                     std::string_view wanted = "");

/// Points of the true people that a joint set of the body predicts.
struct KnownPoints {
  const JointSet* set = nullptr;
  std::vector<std::string> names;  ///< those that the set has
  std::vector<std::vector<Eigen::Vector3f>> of_person;
};
/// Returns the true joints in a set of the body: the one called `joint_set`, or where that is empty the truth's own
/// choice. Returns nothing if no joints are known or no set has them. The result is valid while `body` is.
std::optional<KnownPoints> known_joints(const FrameTruth& truth, const BodyModel& body, const std::string& joint_set);

/// Returns the distance of each joint in metres: NaN if the truth is not known, infinity if the joint was not found.
std::vector<double> joint_errors(const JointPair& pair);

/// Returns the joint metrics of one person. Joints that were not found count as wrong in the shares of right joints,
/// and are left out of the mean errors.
MetricTerms joint_terms(const JointPair& pair, const std::vector<std::string>& names);
/// Returns the shares of the centres of one person's parts, in the same way.
MetricTerms centre_terms(const JointPair& pair, const std::vector<std::string>& names);

/// Returns how many of a person's parts that were not observed have a predicted place within kJointTolerance_m.
/// `centres` are those of the parts' volumes, true and found.
MetricTerms predicted_part_terms(const Skeleton& skeleton, const JointPair& centres);

/// Returns how far the joints that both have lie from the truth along the true body's axis from the middle of the hips
/// to the neck, in millimetres with a sign; once more for the joints within kPlacedJoint_m alone. There are no terms
/// unless the truth has hips and neck or shoulders, and none of joints nearer to their partner's truth than to their
/// own: one swapped arm would outweigh many biases.
MetricTerms joint_bias_terms(const JointPair& pair, const std::vector<std::string>& names);

/// The proposed joints of a person in a frame, under the names of the truth; NaN = not proposed.
struct JointProposals {
  float score = 0.F;  ///< score of the person
  std::vector<Eigen::Vector3f> joints;
};

/// The average precision of each joint over all proposals of a set of frames, whatever their score (Shotton et al.
/// 2011): the area under precision against recall as the minimum score falls. A proposal is right if it lies within
/// kJointTolerance_m of a true joint of its name that no proposal with a higher score took.
class JointPrecision {
 public:
  /// Adds a frame. `truth` is [person][joint] in the order of `names`; NaN leaves a joint out in this frame. People
  /// with an index of `counted` or more count neither as missed nor, if they are proposed, as wrong.
  void add(const std::vector<std::string>& names, std::vector<JointProposals> proposals,
           const std::vector<std::vector<Eigen::Vector3f>>& truth, std::size_t counted);
  void add(const JointPrecision& frames);

  /// Returns name and average precision (0-1) of the joints that occur in the truth, in the order of their first
  /// occurrence.
  std::vector<std::pair<std::string, double>> averages() const;

 private:
  struct Judged {
    float score = 0.F;
    bool right = false;
  };
  struct Of {
    std::string name;
    long known = 0;
    std::vector<Judged> proposals;
  };

  Of& of(const std::string& name);

  std::vector<Of> joints_;
};

/// Whether the camera sees the body about a true joint.
enum class Sight {
  unknown,  ///< the person's pixels, or the joint, are not known
  seen,     ///< at least 10 cm^2 of the person's surface lie within 0.15 m of it and are seen
  hidden,   ///< less does
};

/// Returns this of joints of a true person, metres, optical frame.
std::vector<Sight> joint_sight(const TrueFrame& frame, std::size_t person, const std::vector<Eigen::Vector3f>& joints);

/// Returns how many of the seen and of the hidden joints of a person lie within kJointTolerance_m, their mean errors,
/// and of the joints given out with a confidence from each tenth how many lie so, of all, of the seen and of the
/// hidden. As in joint_terms, joints that were not found count as wrong in the shares and are left out of the errors.
/// `confidences` and `sight` have the order of the pair.
MetricTerms sight_terms(const JointPair& pair, const std::vector<float>& confidences, const std::vector<Sight>& sight);

}  // namespace vesalius

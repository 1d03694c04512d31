#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace vesalius {

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
  bool empty() const { return joints_.empty(); }

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

}  // namespace vesalius

#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// The side that a person turns to the camera: front within 60 degrees, back beyond 120.
enum class Heading { front, side, back };
const char* to_string(Heading heading);

/// The known facts about a frame. Unknown ones are empty. Lists of people have one order, that of `person`.
struct FrameTruth {
  int people = -1;                                  ///< exact number in view, or -1 for at least one
  std::string posture;                              ///< one word for the posture of all
  std::optional<Heading> heading;                   ///< heading of all people
  Mask mask;                                        ///< non-zero on the pixels of all people
  Image<std::uint8_t> person;                       ///< index of each pixel's person, kBackground elsewhere
  LabelImage labels;                                ///< part of each pixel, kBackground elsewhere
  std::vector<std::vector<Eigen::Vector3f>> parts;  ///< [person][part]: centre of the part's volume, metres; or NaN
  std::string joint_set;  ///< joint set of the body to compare with; if empty, the first that has all joints
  std::vector<std::string> joint_names;
  std::vector<std::vector<Eigen::Vector3f>> joints;  ///< [person][joint]: metres, optical frame; NaN = not known
  std::vector<std::string> postures;                 ///< [person]: one word
  std::vector<float> statures_m;                     ///< [person]: height of the body standing upright; NaN = not known
  std::optional<Eigen::Vector3f> up;                 ///< unit vector away from the ground, optical frame
  std::optional<float> camera_height_m;              ///< height above the ground on which people stand
  /// Number of the recording in its set that the frame belongs to; frames of one recording come after each other in
  /// time. -1: the frame stands alone.
  int sequence = -1;
  std::vector<int> ids;  ///< [person]: one number for one person over a recording; empty = not known
};

/// A frame with its truth.
struct TrueFrame {
  Frame frame;
  FrameTruth truth;
};

/// Returns a number of its own for each person where the true label is a part, 1 where people are not known apart;
/// empty where no labels are known.
Mask labelled_people(const FrameTruth& truth);

/// Returns the mean of the points that are known (not NaN), or zero.
Eigen::Vector3f mean_known(const std::vector<Eigen::Vector3f>& points);

/// Points of a body of which some have a partner on the other side.
struct SidedNames {
  std::vector<std::string> names;
  std::vector<int> partner;  ///< index of the point on the other side; -1 on the middle line

  bool is_left(std::size_t point) const { return names[point].starts_with("l_"); }
};

/// Returns the body's parts with their mirror partners.
SidedNames sided(const BodyModel& body);
/// Returns joints of these names; l_... and r_... are partners.
SidedNames sided(const std::vector<std::string>& names);

/// Returns the side that a person turns to the camera, from the points called l_... and their partners (metres, optical
/// frame; NaN = not known), as seen from above. Returns nothing for somebody whose left and right lie above each other,
/// as when lying on a side, or if no pair is known.
std::optional<Heading> heading_of(const SidedNames& names, const std::vector<Eigen::Vector3f>& points);

/// Returns the heading of a true person: from the centres of the parts by body_yaw, from the truth of the whole frame,
/// or from the joints, whichever is known first.
std::optional<Heading> heading_of(const FrameTruth& truth, std::size_t person, const BodyModel& body);

}  // namespace vesalius

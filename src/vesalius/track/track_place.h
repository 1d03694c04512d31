#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns how near to the border of a picture of that width depth may end: that of structured light ends before it.
inline int view_margin(int width) { return std::max(1, width / 64); }

/// The pixels of somebody in one frame with their depth, from which follows where the person is to be expected in
/// another.
class TrackPlace {
 public:
  TrackPlace() = default;
  /// `mask` has the frame's size, and `box` is the smallest box around it.
  TrackPlace(const Frame& frame, const Mask& mask, const Box& box);

  bool empty() const { return mask_.empty(); }
  /// Returns the smallest box around the person, empty if the place is.
  const Box& box() const { return box_; }
  /// Returns the number of the person's pixels.
  long pixels() const { return pixels_; }
  /// Returns whether the person reached to the border of the view, where people leave it.
  bool at_border() const { return at_border_; }

  /// Returns the share of the pixels, 0-1, at which the frame has the same depth: whether the person, or somebody else,
  /// is still there. 0 if the frame has another size.
  float unchanged(const Frame& frame) const;

  /// Returns the pixels, moved as somebody who goes from `from` to `to` (metres, optical frame) moves in the picture,
  /// that are where the moved person would be: not those where something nearer hides them, nor those through which
  /// one sees what is behind. Empty if the frame has another size, too few pixels are left, or `to` is behind the
  /// camera.
  Mask expected(const Frame& frame, const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

 private:
  int width_ = 0, height_ = 0;  ///< size of the whole picture
  Box box_;
  Mask mask_;         ///< the box's part of the mask
  DepthImage depth_;  ///< the box's part of the picture
  long pixels_ = 0;
  bool at_border_ = false;
};

/// Returns by how many columns and rows a point that goes from `from` to `to` (metres, optical frame) moves in the
/// picture; nothing if either is not before the camera, or it moves by more than the picture.
std::optional<Eigen::Vector2i> moved_pixels(const Camera& camera, const Eigen::Vector3f& from,
                                            const Eigen::Vector3f& to);

/// Where the trunk of a person was measured.
struct TrunkPlace {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, optical frame
  float sigma_m = 0.F;                                 ///< standard deviation along each axis
};

/// Returns the middle of the trunk: the mean of the chest's and the hips' parts where the body names them so and both
/// are known, the less certain the more of them are predicted; otherwise the mean of the seen parts, or without any
/// that of the mask's points. Nothing if the frame has no reading on the mask either.
std::optional<TrunkPlace> trunk_place(const Person& person, const Frame& frame, const BodyModel& body);

}  // namespace vesalius

#include "dataset/turned_truth.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dataset/mapped_truth.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

/// Maps pixels between a picture and the turned one.
class Turn {
 public:
  Turn(const Camera& from, double degrees) : from_(from) {
    const double angle = degrees * std::numbers::pi / 180.0;
    cos_ = std::cos(angle);
    sin_ = std::sin(angle);
    // The corners, seen from the principal point, bound the new picture.
    double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
    for (const double u : {0.0, from.width - 1.0}) {
      for (const double v : {0.0, from.height - 1.0}) {
        const double du = u - static_cast<double>(from.cx), dv = v - static_cast<double>(from.cy);
        left = std::min(left, cos_ * du - sin_ * dv);
        right = std::max(right, cos_ * du - sin_ * dv);
        top = std::min(top, sin_ * du + cos_ * dv);
        bottom = std::max(bottom, sin_ * du + cos_ * dv);
      }
    }
    const auto whole = [](double pixels) { return std::ceil(pixels - 1e-6); };  // a quarter is not quite a quarter
    to_ = from;
    to_.cx = static_cast<float>(whole(-left));
    to_.cy = static_cast<float>(whole(-top));
    to_.width = static_cast<int>(whole(-left) + whole(right)) + 1;
    to_.height = static_cast<int>(whole(-top) + whole(bottom)) + 1;
  }

  const Camera& camera() const { return to_; }

  template <class T>
  Image<T> picture(const Image<T>& image, T empty) const {
    if (image.empty()) return {};
    Image<T> out(to_.width, to_.height, empty);
    for (int v = 0; v < to_.height; ++v) {
      for (int u = 0; u < to_.width; ++u) {
        const double du = u - static_cast<double>(to_.cx), dv = v - static_cast<double>(to_.cy);
        const auto old_u = std::lround(static_cast<double>(from_.cx) + cos_ * du + sin_ * dv);
        const auto old_v = std::lround(static_cast<double>(from_.cy) - sin_ * du + cos_ * dv);
        if (old_u < 0 || old_v < 0 || old_u >= image.width() || old_v >= image.height()) continue;
        out(u, v) = image(static_cast<int>(old_u), static_cast<int>(old_v));
      }
    }
    return out;
  }

  void points(std::vector<std::vector<Eigen::Vector3f>>& of_people) const {
    for (auto& of_person : of_people) {
      for (Eigen::Vector3f& p : of_person) p = point(p);
    }
  }
  Eigen::Vector3f point(const Eigen::Vector3f& p) const {
    const auto c = static_cast<float>(cos_), s = static_cast<float>(sin_);
    return {c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()};
  }

 private:
  Camera from_, to_;
  double cos_ = 1.0, sin_ = 0.0;
};

}  // namespace

TrueFrame turned(const TrueFrame& frame, double degrees) {
  constexpr float kMostUneven = 0.05F;
  const Camera& camera = frame.frame.camera;
  if (std::abs(camera.fx - camera.fy) > kMostUneven * camera.fx) {
    throw Error(fmt::format("frame {}: fx {} and fy {}, expected square pixels to turn it", frame.frame.name, camera.fx,
                            camera.fy));
  }
  const Turn turn(camera, degrees);
  TrueFrame out = frame;
  out.frame.camera = turn.camera();
  out.frame.depth = turn.picture(frame.frame.depth, std::uint16_t{0});
  out.frame.colour = turn.picture(frame.frame.colour, Rgb{});
  out.truth.mask = turn.picture(frame.truth.mask, std::uint8_t{0});
  out.truth.person = turn.picture(frame.truth.person, kBackground);
  out.truth.labels = turn.picture(frame.truth.labels, kBackground);
  turn.points(out.truth.parts);
  turn.points(out.truth.joints);
  if (out.truth.up) out.truth.up = turn.point(*out.truth.up);
  return out;
}

std::unique_ptr<TruthSource> with_turn(std::unique_ptr<TruthSource> frames, double degrees) {
  return mapped(std::move(frames), [degrees](const TrueFrame& frame) { return turned(frame, degrees); });
}

}  // namespace vesalius

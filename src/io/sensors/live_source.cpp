#include "io/sensors/live_source.h"

#include <fmt/format.h>

#include <cmath>

#include "io/sensors/sensor.h"
#include "vesalius/error.h"

namespace vesalius {

std::optional<Eigen::Vector3f> up_of(const Eigen::Vector3f& acceleration_mps2) {
  constexpr float kGravity = 9.81F, kMostOff = 0.1F;
  const float magnitude = acceleration_mps2.norm();
  // Written so that not-a-number is refused too.
  if (!(std::abs(magnitude - kGravity) <= kMostOff * kGravity)) return std::nullopt;
  return acceleration_mps2 / magnitude;
}

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

void set_time(Frame& frame, double time_s) {
  frame.time_s = time_s;
  frame.name = fmt::format("{:.6f}", time_s);
}

LiveSource::LiveSource(std::string_view scheme, const std::string& id) : place_(source_of(scheme, id)) {}

void LiveSource::fail_without_frame() const {
  throw Error(fmt::format("{}: no frame for {} s; unplugged, or used by another program", place_,
                          kSensorPatience.count() / 1000));
}

LensCamera LiveSource::with_lens(const Camera& camera, std::string_view model,
                                 const std::vector<double>& coefficients) {
  check(camera);
  const std::optional<Lens> lens = make_lens(model, coefficients);
  if (!lens) notes_.push_back(fmt::format("{}: a lens distorts by the model {}, which is not undone", place_, model));
  return {camera, lens.value_or(Lens{})};
}

Frame LiveSource::arrived(double time_s) {
  Frame frame;
  set_time(frame, time_s);
  frame.arrived_s = now_s();
  return frame;
}

}  // namespace vesalius

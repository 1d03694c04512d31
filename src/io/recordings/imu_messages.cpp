#include "io/recordings/imu_messages.h"

#include "io/recordings/camera_topics.h"
#include "io/recordings/message_fields.h"

namespace vesalius {
namespace {

constexpr std::size_t kCovariance = 9;
/// The first number of a covariance whose quantity is not known.
constexpr double kNotKnown = -1.0;

void write_covariance(CdrWriter& out, double first) {
  for (std::size_t i = 0; i < kCovariance; ++i) out.real64(i == 0 ? first : 0.0);
}

constexpr double kWindow_ns = 5e8;
/// Frames ask that much later than measurements come, since they wait for their colour.
constexpr double kKept_ns = 4 * kWindow_ns;
constexpr std::size_t kMostSamples = 10'000;
constexpr double kLeast_m_s2 = 9.3, kMost_m_s2 = 10.3;

/// Times of damaged files may be any number.
double difference_ns(std::int64_t a, std::int64_t b) { return double(a) - double(b); }

}  // namespace

bool is_acceleration(const RecordedTopic& topic) {
  if (topic.type != "sensor_msgs/Imu") return false;
  if (topic.layout != MessageLayout::ros1 && topic.layout != MessageLayout::cdr) return false;
  const std::string stream = realsense_stream(topic.name);
  return stream.empty() || stream.find("/Accel_") != stream.npos;
}

Acceleration parse_acceleration(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  Acceleration acceleration;
  MessageFields fields(message, topic.layout, name);
  acceleration.time_ns = fields.header(acceleration.frame);
  if (std::string stream = realsense_stream(topic.name); !stream.empty()) acceleration.frame = std::move(stream);
  fields.reals64(4 + kCovariance, "the orientation");
  fields.reals64(3 + kCovariance, "the angular velocity");
  for (double& axis : acceleration.m_s2) axis = fields.real64("the acceleration");
  if (fields.real64("the acceleration's covariance") == kNotKnown) acceleration.m_s2.setZero();
  return acceleration;
}

std::string acceleration_message(const Acceleration& acceleration) {
  CdrWriter out;
  out.header(acceleration.time_ns, acceleration.frame);
  for (const double q : {0.0, 0.0, 0.0, 1.0}) out.real64(q);
  write_covariance(out, kNotKnown);
  for (int axis = 0; axis < 3; ++axis) out.real64(0.0);
  write_covariance(out, kNotKnown);
  for (const double axis : acceleration.m_s2) out.real64(axis);
  write_covariance(out, acceleration.m_s2.isZero(0.0) ? kNotKnown : 0.0);
  return out.message();
}

std::string imu_message(const std::optional<Eigen::Vector3f>& up, std::int64_t time_ns, std::string_view frame) {
  const Eigen::Vector3d direction = up.value_or(Eigen::Vector3f::Zero()).cast<double>();
  return acceleration_message({time_ns, std::string(frame), kGravity_m_s2 * direction});
}

void UpHistory::add(std::int64_t time_ns, const Eigen::Vector3d& acceleration_m_s2) {
  if (!acceleration_m_s2.allFinite()) return;
  samples_.push_back({time_ns, acceleration_m_s2});
  while (difference_ns(time_ns, samples_.front().time_ns) > kKept_ns || samples_.size() > kMostSamples)
    samples_.pop_front();
}

std::optional<Eigen::Vector3f> UpHistory::up_at(std::int64_t time_ns) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Sample& sample : samples_) {
    if (sample.time_ns == time_ns) {
      sum = sample.acceleration_m_s2;
      count = 1;
      break;
    }
    const double age_ns = difference_ns(time_ns, sample.time_ns);
    if (age_ns < 0.0 || age_ns >= kWindow_ns) continue;
    sum += sample.acceleration_m_s2;
    ++count;
  }
  if (count == 0) return std::nullopt;
  const Eigen::Vector3d mean = sum / count;
  if (mean.norm() < kLeast_m_s2 || mean.norm() > kMost_m_s2) return std::nullopt;
  return mean.normalized().cast<float>();
}

}  // namespace vesalius

#include "io/recordings/up_history.h"

namespace vesalius {
namespace {

constexpr double kWindow_ns = 5e8;
/// Frames ask that much later than measurements come, since they wait for their colour.
constexpr double kKept_ns = 4 * kWindow_ns;
constexpr std::size_t kMostSamples = 10'000;
constexpr double kLeast_m_s2 = 9.3, kMost_m_s2 = 10.3;

/// Times of damaged files may be any number.
double difference_ns(std::int64_t a, std::int64_t b) { return double(a) - double(b); }

}  // namespace

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

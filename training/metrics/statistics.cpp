#include "metrics/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kZ = 1.959963984540054;  // for 95 %
constexpr std::uint64_t kBootstrapStream = 0xb007;

/// Draws by inversion: adds the probabilities of 0, 1, 2, ... until `uniform` is exceeded.
std::uint8_t poisson_of_mean_1(double uniform) {
  double probability = std::exp(-1.0);
  double sum = probability;
  std::uint8_t count = 0;
  while (uniform >= sum && count < 20) {  // more than 20 has a probability below 1e-20
    ++count;
    probability /= count;
    sum += probability;
  }
  return count;
}

double at_share(const std::vector<double>& sorted, double share) {
  const double place = share * double(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - double(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

Interval wilson(double successes, double trials) {
  if (!(successes >= 0.0 && successes <= trials && std::isfinite(trials))) {
    throw Error(fmt::format("interval of a share: {} of {}, expected at most all", successes, trials));
  }
  if (trials == 0.0) return {};
  const double share = successes / trials;
  const double z2 = kZ * kZ / trials;
  const double middle = (share + z2 / 2.0) / (1.0 + z2);
  const double half = kZ / (1.0 + z2) * std::sqrt(share * (1.0 - share) / trials + z2 / (4.0 * trials));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

Weights bootstrap_weights(std::uint64_t frame_key) {
  Random random(frame_key, kBootstrapStream);
  Weights weights{};
  for (std::uint8_t& weight : weights) weight = poisson_of_mean_1(random.uniform());
  return weights;
}

std::uint64_t frame_key(const char* set, const char* frame) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto mix = [&hash](unsigned char byte) { hash = (hash ^ byte) * 0x100000001b3ULL; };
  for (const char c : std::string_view(set)) mix(static_cast<unsigned char>(c));
  mix(0);
  for (const char c : std::string_view(frame)) mix(static_cast<unsigned char>(c));
  return hash;
}

Interval percentile_interval(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    return {kNaN, kNaN};
  }
  std::ranges::sort(values);
  return {at_share(values, 0.025), at_share(values, 0.975)};
}

}  // namespace vesalius

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <numeric>

namespace vesalius {

/// What a Detector does, in this order.
enum class Stage { planes, label, smooth, choose, cluster, search, grow, second_pass, people };
inline constexpr std::array kStageNames = {"planes", "label", "smooth",      "choose", "cluster",
                                           "search", "grow",  "second pass", "people"};

/// Milliseconds that each stage of one detection took, by the clock on the wall.
struct StageTimes {
  std::array<double, kStageNames.size()> ms{};

  double& operator[](Stage stage) { return ms[static_cast<std::size_t>(stage)]; }
  double total() const { return std::accumulate(ms.begin(), ms.end(), 0.0); }
};

/// Adds what has passed since the last `lap`, or since it was made, to a stage; does nothing for null.
class StageClock {
 public:
  explicit StageClock(StageTimes* times) : times_(times) {}

  void lap(Stage stage) {
    if (times_ == nullptr) return;
    const Clock::time_point now = Clock::now();
    (*times_)[stage] += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;

  StageTimes* times_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace vesalius

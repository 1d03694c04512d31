#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <numeric>

namespace vesalius {

/// The stages of a Detector in their order. `grid` is the removal of blended readings and the selection of the grid's
/// pixels before all others, and the enlarging after them.
enum class Stage { planes, label, smooth, context, choose, cluster, search, grow, second_pass, people, grid };
inline constexpr std::array kStageNames = {"planes", "label", "smooth",      "context", "choose", "cluster",
                                           "search", "grow",  "second pass", "people",  "grid"};

/// The wall-clock time of each stage of one detection in milliseconds.
struct StageTimes {
  std::array<double, kStageNames.size()> ms{};

  double& operator[](Stage stage) { return ms[static_cast<std::size_t>(stage)]; }
  double total() const { return std::accumulate(ms.begin(), ms.end(), 0.0); }
};

/// Returns the wall-clock time of `work` in milliseconds.
template <class Work>
double elapsed_ms(Work&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// Adds the time since its last `lap`, or since its construction, to a stage. Does nothing for null.
class StageClock {
 public:
  explicit StageClock(StageTimes* times) : times_(times) {}

  void lap(Stage stage) { add_to(stage, since_last()); }

  /// Forgets the time since the last `lap`: it belongs to no stage.
  void skip() { since_last(); }

  /// Adds the time to two stages that ran in parallel, in proportion to the time that each took.
  void lap(const std::array<Stage, 2>& stages, const std::array<double, 2>& took_ms) {
    const double passed = since_last();
    const double sum = took_ms[0] + took_ms[1];
    for (std::size_t i = 0; i < 2; ++i) add_to(stages[i], sum > 0.0 ? passed * took_ms[i] / sum : passed / 2.0);
  }

 private:
  using Clock = std::chrono::steady_clock;

  double since_last() {
    const Clock::time_point now = Clock::now();
    const double passed = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return passed;
  }

  void add_to(Stage stage, double ms) {
    if (times_ != nullptr) (*times_)[stage] += ms;
  }

  StageTimes* times_;
  Clock::time_point last_ = Clock::now();
};

}  // namespace vesalius

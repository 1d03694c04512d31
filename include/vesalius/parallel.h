#pragma once

#include <functional>
#include <memory>

namespace vesalius {

/// Runs `work(i)` for i in [0, count), in any order, on all allowed threads. Results must not depend on the order. The
/// first exception of any call is rethrown.
void parallel_for(int count, const std::function<void(int)>& work);

/// Splits [0, count) into ranges of about `grain` and runs `work(begin, end)` on each.
void parallel_ranges(int count, int grain, const std::function<void(int, int)>& work);

/// Limits the parallel work of this process to `threads` threads while an object of this class lives (1 = only the
/// caller; 0 = as many as the machine has). If several limits live at once, the smallest one applies.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns how many threads parallel work may use now.
int thread_count();

}  // namespace vesalius

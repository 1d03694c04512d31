#include "vesalius/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace vesalius {

void parallel_for(int count, const std::function<void(int)>& work) {
  tbb::parallel_for(0, count, [&](int i) { work(i); });
}

void parallel_ranges(int count, int grain, const std::function<void(int, int)>& work) {
  tbb::parallel_for(
      tbb::blocked_range<int>(0, count, static_cast<std::size_t>(std::max(1, grain))),
      [&](const tbb::blocked_range<int>& range) { work(range.begin(), range.end()); }, tbb::simple_partitioner{});
}

struct ThreadLimit::State {
  // The control is made in place, because oneTBB knows it by its address and a copy would end the limit together with
  // the original.
  explicit State(int threads)
      : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : state_(std::make_unique<State>(threads > 0 ? threads : tbb::info::default_concurrency())) {}

ThreadLimit::~ThreadLimit() = default;

int thread_count() { return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

}  // namespace vesalius

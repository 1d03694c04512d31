// This implements the same functions with std::thread, only for the thread sanitizer. That cannot see how oneTBB, which
// is not built with it, passes work between threads, and would report every such transfer as a race.

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kNoLimit = std::numeric_limits<int>::max();
std::atomic<int> thread_limit{kNoLimit};

/// Each thread takes the next index until none is left.
void run(int count, const std::function<void(int)>& work) {
  std::atomic<int> next{0};
  std::exception_ptr first;
  std::mutex first_mutex;
  const auto take = [&] {
    for (int i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::scoped_lock lock(first_mutex);
        if (!first) first = std::current_exception();
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < std::min(count, thread_count()); ++i) helpers.emplace_back(take);
  take();
  helpers.clear();  // joins the threads
  if (first) std::rethrow_exception(first);
}

}  // namespace

void parallel_for(int count, const std::function<void(int)>& work) { run(count, work); }

void parallel_ranges(int count, int grain, const std::function<void(int, int)>& work) {
  const int step = std::max(1, grain);
  run((count + step - 1) / step, [&](int i) { work(i * step, std::min(count, (i + 1) * step)); });
}

struct ThreadLimit::State {
  int before;
};

ThreadLimit::ThreadLimit(int threads) : state_(std::make_unique<State>(State{thread_limit})) {
  if (threads > 0) thread_limit = std::min(state_->before, threads);
}

ThreadLimit::~ThreadLimit() { thread_limit = state_->before; }

int thread_count() {
  const int limit = thread_limit;
  return limit != kNoLimit ? limit : int(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace vesalius

#pragma once

#include <algorithm>
#include <future>
#include <vector>

#include "vesalius/parallel.h"

namespace vesalius {

/// Makes items 0 .. count-1 on all allowed threads and passes them on in order. `make(i)` returns an item. `take(i,
/// item)` gets it in the calling thread, while later ones are being made, and returns whether to continue. At most two
/// batches of 8 items per thread are held. The first exception of either function is rethrown.
template <class Make, class Take>
void parallel_in_order(int count, const Make& make, const Take& take) {
  constexpr int kItemsPerThread = 8;
  const int threads = thread_count();
  const int batch = std::max(1, threads * kItemsPerThread);
  using Item = decltype(make(0));
  const auto make_batch = [&](int begin) {
    std::vector<Item> items(static_cast<std::size_t>(std::min(batch, count - begin)));
    parallel_for(int(items.size()), [&](int i) { items[i] = make(begin + i); });
    return items;
  };
  // If only one thread is allowed, the next batch waits for the caller.
  const auto policy = threads > 1 ? std::launch::async : std::launch::deferred;
  std::future<std::vector<Item>> next = std::async(policy, make_batch, 0);
  for (int begin = 0; begin < count; begin += batch) {
    std::vector<Item> items = next.get();
    if (begin + batch < count) next = std::async(policy, make_batch, begin + batch);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (!take(begin + int(i), std::move(items[i]))) return;
    }
  }
}

}  // namespace vesalius

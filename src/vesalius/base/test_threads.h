#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "vesalius/parallel.h"

namespace vesalius {

/// Calls `work()` once for each number in `counts`, one call after the other, while parallel work uses exactly that
/// many threads. Fails the test where another limit holds: limits nest and the smallest one wins, so `work` would run
/// on fewer threads than it was meant to and the test would compare a thread count with itself.
template <class Work>
void for_threads(std::initializer_list<int> counts, const Work& work) {
  for (const int threads : counts) {
    const ThreadLimit limit(threads);
    ASSERT_EQ(thread_count(), threads) << "another limit holds";
    SCOPED_TRACE(std::to_string(threads) + " threads");
    work();
  }
}

}  // namespace vesalius

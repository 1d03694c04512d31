#include "vesalius/parallel.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

// Labels: threads
TEST(ParallelThreads, VisitEveryIndexOnce) {
  for_threads({1, 2, 8}, [] {
    std::vector<std::atomic<int>> visits(1000);
    parallel_for(1000, [&](int i) { ++visits[i]; });
    for (const auto& v : visits) ASSERT_EQ(v, 1);
  });
}

// Labels: threads
TEST(ParallelThreads, CoverEverythingOnceWithRangesOfAnyGrain) {
  for (const int count : {0, 1, 7, 100}) {
    for (const int grain : {0, 1, 3, 1000}) {
      std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
      parallel_ranges(count, grain, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& v : visits) ASSERT_EQ(v, 1) << count << ' ' << grain;
    }
  }
}

// Labels: threads
TEST(ParallelThreads, PassAnExceptionToTheCaller) {
  EXPECT_THROW(parallel_for(100,
                            [](int i) {
                              if (i == 50) throw std::runtime_error("fifty");
                            }),
               std::runtime_error);
}

// Labels: threads
TEST(ParallelThreads, FollowNestedLimits) {
  const int before = thread_count();
  {
    const ThreadLimit outer(2);
    EXPECT_EQ(thread_count(), 2);
    {
      const ThreadLimit inner(1);
      EXPECT_EQ(thread_count(), 1);
    }
    const ThreadLimit larger(8);
    EXPECT_EQ(thread_count(), 2) << "the smallest limit holds";
  }
  EXPECT_EQ(thread_count(), before);
}

}  // namespace
}  // namespace vesalius

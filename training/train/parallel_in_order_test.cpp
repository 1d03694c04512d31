#include "train/parallel_in_order.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

namespace vesalius {
namespace {

// Labels: threads
TEST(ParallelInOrderThreads, PassesItemsInOrderInTheCallersThread) {
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const auto caller = std::this_thread::get_id();
    std::vector<std::string> taken;
    parallel_in_order(
        100, [](int i) { return std::to_string(i); },
        [&](int i, std::string item) {
          EXPECT_TRUE(std::this_thread::get_id() == caller);
          EXPECT_EQ(item, std::to_string(i));
          taken.push_back(std::move(item));
          return true;
        });
    EXPECT_EQ(taken.size(), 100U);
  }
}

TEST(ParallelInOrder, ReturnsAtOnceWithoutItems) {
  parallel_in_order(
      0, [](int i) { return i; }, [](int, int) { return ADD_FAILURE(), true; });
}

TEST(ParallelInOrder, StopsWhenToldAndMakesFewItemsBeyond) {
  const ThreadLimit limit(2);
  std::atomic<int> made = 0;
  parallel_in_order(
      100000, [&](int i) { return ++made, i; }, [](int i, int) { return i < 4; });
  EXPECT_LE(made, 3 * 16);
}

TEST(ParallelInOrder, RethrowsExceptions) {
  const auto run = [](int made, int taken) {
    parallel_in_order(
        50, [=](int i) { return i == made ? throw std::runtime_error("made") : i; },
        [=](int i, int) { return i == taken ? throw std::runtime_error("taken") : true; });
  };
  EXPECT_THROW(run(33, -1), std::runtime_error);
  EXPECT_THROW(run(-1, 3), std::runtime_error);
}

}  // namespace
}  // namespace vesalius

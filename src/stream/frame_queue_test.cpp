#include "stream/frame_queue.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace vesalius {
namespace {

using std::chrono::milliseconds;

// Labels: threads
TEST(FrameQueueThreads, KeepsOrderAndCapacity) {
  FrameQueue<int> queue(2);
  std::jthread writer([&] {
    for (int i = 0; i < 100; ++i) queue.push(i);
    queue.close();
  });
  std::vector<int> got;
  while (!queue.finished()) {
    if (const auto item = queue.pop(milliseconds(1000))) got.push_back(*item);
  }
  ASSERT_EQ(got.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(got[i], i);
}

TEST(FrameQueue, DropsTheOldestItem) {
  FrameQueue<int> queue(2);
  EXPECT_EQ(queue.push_newest(1), 0);
  EXPECT_EQ(queue.push_newest(2), 0);
  EXPECT_EQ(queue.push_newest(3), 1);
  EXPECT_EQ(queue.pop(milliseconds(0)), 2);
  EXPECT_EQ(queue.pop(milliseconds(0)), 3);
  EXPECT_EQ(queue.pop(milliseconds(0)), std::nullopt);
}

// Labels: threads
TEST(FrameQueueThreads, WakesAWaitingWriterWhenClosed) {
  FrameQueue<int> queue(1);
  EXPECT_TRUE(queue.push(1));
  bool pushed = true;
  {
    std::jthread writer([&] { pushed = queue.push(2); });
    queue.close();
  }
  EXPECT_FALSE(pushed);
  EXPECT_FALSE(queue.finished());
  EXPECT_EQ(queue.pop(milliseconds(0)), 1);
  EXPECT_TRUE(queue.finished());
}

}  // namespace
}  // namespace vesalius

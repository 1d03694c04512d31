#include "io/recordings/up_history.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::int64_t kMs = 1'000'000;

TEST(UpHistory, IsTheDirectionOfTheMeanOfHalfASecond) {
  UpHistory history;
  EXPECT_FALSE(history.up_at(0));
  history.add(0, {9.8, 0, 0});  // too old for the frame at 600 ms
  for (int i = 0; i < 50; ++i) history.add((200 + 5 * i) * kMs, {0.0, -9.8, i % 2 == 0 ? 1.0 : -1.0});
  history.add(700 * kMs, {9.8, 0, 0});  // later than the frame
  EXPECT_LT((history.up_at(600 * kMs).value() - Vector3f(0, -1, 0)).norm(), 1e-6F);
  EXPECT_FALSE(history.up_at(1300 * kMs)) << "the last measurement is older";
}

TEST(UpHistory, KnowsNothingOfACameraThatMoves) {
  for (const double length : {0.0, 9.2, 9.4, 10.2, 10.4}) {
    UpHistory history;
    history.add(0, {0, -length, 0});
    EXPECT_EQ(history.up_at(kMs).has_value(), length > 9.3 && length < 10.3) << length;
  }
}

TEST(UpHistory, TakesWhatWasMeasuredForTheFrameAlone) {
  UpHistory history;
  history.add(990 * kMs, {9.8, 0, 0});
  history.add(1000 * kMs, {0, 0, 9.8});
  EXPECT_EQ(history.up_at(1000 * kMs), Vector3f(0, 0, 1));
  history.clear();
  EXPECT_FALSE(history.up_at(1000 * kMs));
}

}  // namespace
}  // namespace vesalius

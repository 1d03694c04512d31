#include "io/sensors/reconnecting_source.h"

#include <gmock/gmock.h>

#include <deque>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "io/sensors/live_source.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

/// What one opening of the camera gives: frames at these times of its clock, which arrive so much later.
struct Session {
  std::vector<double> times_s;
  double arrived_after_s = 0.0;
  int missed = 0;
  double apart_s = 0.0;  ///< by which each frame arrives later, whatever its time
};

/// A camera that gives its frames and is then unplugged.
class Unplugged final : public LiveSource {
 public:
  explicit Unplugged(Session session) : LiveSource("fake", ""), session_(std::move(session)) {
    notes_.emplace_back("a note");
  }
  std::optional<Frame> next() override {
    if (given_ == session_.times_s.size()) fail_without_frame();
    missed_ = session_.missed;
    const double time_s = session_.times_s[given_++];
    Frame frame = arrived(time_s);
    frame.arrived_s = time_s + session_.arrived_after_s + session_.apart_s * double(given_);
    return frame;
  }

 private:
  Session session_;
  std::size_t given_ = 0;
};

/// A place where cameras are plugged in and out: an empty entry is an attempt to open that fails.
struct Socket {
  std::deque<std::optional<Session>> sessions;
  std::vector<std::string> said;
  int attempts = 0;

  std::unique_ptr<FrameSource> open() {
    ++attempts;
    std::optional<Session> session;
    if (!sessions.empty()) {
      session = sessions.front();
      sessions.pop_front();
    }
    if (!session) throw Error("fake: no camera is plugged in");
    return std::make_unique<Unplugged>(*session);
  }
  std::unique_ptr<FrameSource> source(milliseconds retry = milliseconds(1)) {
    return keep_open([this] { return open(); },
                     {"fake", [this](const std::string& line) { said.push_back(line); }, retry});
  }
};

TEST(ReconnectingSource, GoesOnWhenTheCameraIsBack) {
  Socket socket{{Session{{1.0, 1.1}, 1000.0, 2}, {}, {}, Session{{1.2}, 1000.0, 3}}, {}, 0};
  const auto source = socket.source();
  EXPECT_TRUE(source->is_live());
  EXPECT_THAT(source->notes(), ElementsAre("a note"));
  std::vector<double> times_s;
  for (int i = 0; i < 3; ++i) times_s.push_back(*source->next()->time_s);
  EXPECT_THAT(times_s, ElementsAre(1.0, 1.1, testing::DoubleNear(1.2, 1e-6)));
  EXPECT_EQ(socket.attempts, 4);
  EXPECT_EQ(source->missed(), 5);
  ASSERT_EQ(socket.said.size(), 2U) << "one line for the loss, however often it is tried, and one for the return";
  EXPECT_EQ(socket.said[0], "fake: no frame for 3 s; unplugged, or used by another program; waiting until it is back");
  EXPECT_THAT(socket.said[1], HasSubstr("fake: back after "));
}

TEST(ReconnectingSource, ClocksThatBeginAnewGoOnFromWhereTheyWere) {
  // The camera's clock begins at 0 again; it comes back 10 s later by this machine's clock.
  Socket socket{{Session{{50.0, 51.0}, 1000.0}, Session{{0.5, 0.6}, 1060.5}}, {}, 0};
  const auto source = socket.source();
  std::vector<double> times_s;
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const Frame frame = *source->next();
    times_s.push_back(*frame.time_s);
    name = frame.name;
  }
  EXPECT_THAT(times_s, ElementsAre(50.0, 51.0, testing::DoubleNear(61.0, 1e-6), testing::DoubleNear(61.1, 1e-6)));
  EXPECT_EQ(name, "61.100000");
}

TEST(ReconnectingSource, AClockThatStandsIsReplacedByThisMachines) {
  // The camera's clock stands at 7 once it is back, 2 s later; frames come each 0.1 s.
  Session back{{7.0, 7.0, 7.0}, 995.0};
  back.apart_s = 0.1;
  Socket socket{{Session{{50.0, 50.1}, 950.0 - 0.1}, back}, {}, 0};
  const auto source = socket.source();
  std::vector<double> times_s;
  for (int i = 0; i < 5; ++i) times_s.push_back(*source->next()->time_s);
  for (std::size_t i = 3; i < 5; ++i) EXPECT_NEAR(times_s[i] - times_s[i - 1], 0.1, 1e-6) << i;
}

TEST(ReconnectingSource, TimesIncreaseThoughThisMachinesClockIsSetBack) {
  Socket socket{{Session{{50.0}, 1000.0}, Session{{0.5}, 100.0}}, {}, 0};
  const auto source = socket.source();
  source->next();
  EXPECT_GT(*source->next()->time_s, 50.0);
}

TEST(ReconnectingSource, ACameraThatStallsAgainAtOnceIsNotSaidTwice) {
  Socket socket{{Session{{1.0}}, Session{}, Session{}, Session{{1.0}}}, {}, 0};
  const auto source = socket.source();
  source->next();
  EXPECT_TRUE(source->next());
  EXPECT_EQ(socket.said.size(), 2U);
}

TEST(ReconnectingSource, FailsWhereTheCameraWasNeverThere) {
  Socket socket;
  EXPECT_THROW(socket.source(), Error);
}

// Labels: threads
TEST(ReconnectingSourceThreads, StopEndsTheWaiting) {
  Socket socket{{Session{{1.0}}}, {}, 0};
  const auto source = socket.source(milliseconds(60'000));
  source->next();
  const auto start = std::chrono::steady_clock::now();
  std::jthread stopper([&] {
    std::this_thread::sleep_for(milliseconds(50));
    source->stop();
  });
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->next());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

TEST(ReconnectingSource, IsForCamerasAlone) {
  SourceOptions options;
  options.reconnect = true;
  EXPECT_THROW(open_source("frames/", options), UsageError);
}

}  // namespace
}  // namespace vesalius

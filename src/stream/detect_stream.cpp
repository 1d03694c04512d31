#include "vesalius/detect_stream.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <future>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "stream/frame_queue.h"
#include "vesalius/base/quiet_thread.h"
#include "vesalius/parallel.h"
#include "vesalius/prior.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFramesAhead = 4;  // frames that are read, processed or waiting to be written
constexpr int kDetectors = 2;  // while one frame is in a single-threaded stage, the next uses the other thread
constexpr std::chrono::milliseconds kPatience(50);  // time between questions whether to stop

/// Returns false at the end of the source.
bool read_next(FrameSource& source, FoundFrame& to) {
  const auto start = Clock::now();
  try {
    to.frame = source.next();
  } catch (...) {
    to.error = std::current_exception();
  }
  to.read_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return to.frame || to.error;
}

/// Lets frames that are worked at together use the tracker one after the other, in their order.
class Turns {
 public:
  /// Waits until all frames before this one have ended their turn.
  void wait(long number) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return next_ == number; });
  }
  /// Ends the turn of a frame, whether it has begun or not. Every frame must end its own.
  void end(long number) {
    wait(number);
    const std::scoped_lock lock(mutex_);
    ++next_;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  long next_ = 0;
};

/// Finds people, and follows them if there is a tracker.
class Finder {
 public:
  Finder(const Detector& detector, PeopleTracker* tracker) : detector_(detector), tracker_(tracker) {}

  /// `number` counts the frames that are passed to this function, from 0, in the source's order.
  void find(FoundFrame& in, long number) {
    if (in.frame && !in.error) {
      try {
        tracker_ != nullptr ? follow(in, number) : detect(in);
      } catch (...) {
        in.error = std::current_exception();
      }
    }
    if (tracker_ != nullptr) turns_.end(number);
  }

 private:
  void detect(FoundFrame& in) { in.people = seen_people(detector_.detect(*in.frame, nullptr, &in.times)); }

  void follow(FoundFrame& in, long number) {
    FollowReport report;
    report.wait = [&] { turns_.wait(number); };
    in.people = vesalius::follow(detector_, *tracker_, *in.frame, report);
    in.times = report.times;
    in.track_ms = report.track_ms;
  }

  const Detector& detector_;
  PeopleTracker* tracker_;  ///< null: people are not followed
  Turns turns_;
};

void find_people(Finder& finder, FoundFrame& in, long number) {
  finder.find(in, number);
  if (in.frame && !in.error && in.frame->arrived_s) {
    const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
    in.latency_ms = 1e3 * (now.count() - *in.frame->arrived_s);
  }
}

/// Tells when a camera would have the next frame ready.
class Pace {
 public:
  explicit Pace(double rate) : period_s_(1.0 / rate) {}

  Clock::time_point due(const Frame& frame) {
    const double time_s = frame.time_s.value_or(kNoTime);
    const double step_s = time_s - latest_s_;
    if (begun_) due_s_ += std::isfinite(step_s) ? wait(step_s) : period_s_;
    begun_ = true;
    // After a frame that comes late the next one is as far from the latest as before.
    if (std::isfinite(time_s) && !is_late(step_s)) latest_s_ = time_s;
    return start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(due_s_));
  }

 private:
  static bool is_late(double step_s) { return step_s < 0.0 && step_s > -kLate_s; }
  /// Where the clock was set, or nothing was taken, nobody waits for long.
  double wait(double step_s) const {
    if (step_s <= -kLate_s) return period_s_;
    return std::clamp(step_s, 0.0, kLongestGap_s);
  }

  static constexpr double kLongestGap_s = 2.0, kLate_s = 1.0;
  static constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
  double period_s_;
  Clock::time_point start_ = Clock::now();
  bool begun_ = false;
  double due_s_ = 0.0;  ///< after the start
  double latest_s_ = kNoTime;
};

/// A frame in the queues. Whoever takes it out of the writing queue waits until it is processed.
struct Job {
  FoundFrame found;
  long number = 0;  ///< among the frames that are worked at
  std::promise<void> done;
};
using JobPointer = std::shared_ptr<Job>;

bool stopped(const StreamOptions& options) { return options.stop && options.stop(); }

class Stream {
 public:
  Stream(FrameSource& source, const Detector& detector, PeopleTracker* tracker, const StreamOptions& options)
      : source_(source),
        finder_(detector, tracker),
        options_(options),
        realtime_(options.realtime || source.is_live()),
        work_(realtime_ ? 1 : kFramesAhead),
        written_(kFramesAhead) {
    helpers_.push_back(quiet_thread([this] { realtime_ ? read_in_real_time() : read_ahead(); }));
    const int detectors = realtime_ ? 1 : kDetectors;
    working_ = detectors;
    for (int i = 0; i < detectors; ++i) helpers_.push_back(quiet_thread([this] { work(); }));
  }
  ~Stream() { stop(); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void run(const std::function<bool(FoundFrame)>& take) {
    while (!stopped(options_) && !written_.finished()) {
      const std::optional<JobPointer> job = written_.pop(kPatience);
      if (!job) continue;
      (*job)->done.get_future().wait();
      if (!take(std::move((*job)->found))) return;
    }
  }
  int dropped() const { return dropped_; }

 private:
  void stop() {
    stopping_ = true;
    source_.stop();
    work_.close();
    written_.close();
    helpers_.clear();  // joins the threads
  }

  void read_ahead() {
    long number = 0;
    for (auto job = std::make_shared<Job>(); read_next(source_, job->found); job = std::make_shared<Job>()) {
      job->number = number++;
      // The job enters the writing queue first: that one keeps the order of reading and bounds both queues.
      if (!written_.push(job) || !work_.push(job)) break;
    }
    work_.close();
    written_.close();
  }

  void read_in_real_time() {
    Pace pace(options_.rate);
    bool after_error = false;
    for (auto job = std::make_shared<Job>(); read_next(source_, job->found); job = std::make_shared<Job>()) {
      // A camera keeps its own pace, by a clock that may run a little faster or slower than ours.
      const bool waits = job->found.frame && !source_.is_live();
      if (waits && work_.closed_by(pace.due(*job->found.frame))) break;
      if (stopping_) break;
      const bool is_error = bool(job->found.error);
      if (!is_error && !after_error) {
        dropped_ += work_.push_newest(std::move(job));
      } else if (!work_.push(std::move(job))) {  // no newer frame may take the place of an error
        break;
      }
      if (is_error && source_.is_live()) break;  // a camera has ended
      after_error = is_error;
    }
    work_.close();
  }

  // Jobs are taken in the order of their numbers and each ends its turn, so that whoever waits for one gets it.
  void work() {
    long worked = 0;
    while (!stopping_ && !work_.finished()) {
      const std::optional<JobPointer> job = work_.pop(kPatience);
      if (!job) continue;
      if (realtime_) (*job)->number = worked++;  // some were dropped; there is one thread here
      find_people(finder_, (*job)->found, (*job)->number);
      (*job)->done.set_value();
      if (realtime_ && !written_.push(*job)) break;
    }
    if (--working_ == 0) written_.close();
  }

  FrameSource& source_;
  Finder finder_;
  const StreamOptions& options_;
  const bool realtime_;
  FrameQueue<JobPointer> work_;     ///< frames to be processed
  FrameQueue<JobPointer> written_;  ///< the same frames in the order of writing
  std::atomic<int> dropped_ = 0;
  std::atomic<int> working_ = 0;
  std::atomic<bool> stopping_ = false;
  std::vector<std::jthread> helpers_;
};

/// Reads frames while those before are taken.
class Passing {
 public:
  Passing(FrameSource& source, std::size_t ahead)
      : source_(source), ahead_(ahead), reader_(quiet_thread([this] { read(); })) {}
  ~Passing() {
    stopping_ = true;
    source_.stop();
    ahead_.close();
  }
  Passing(const Passing&) = delete;
  Passing& operator=(const Passing&) = delete;

  void run(const StreamOptions& options, const std::function<bool(FoundFrame)>& take) {
    while (!stopped(options) && !ahead_.finished()) {
      std::optional<FoundFrame> found = ahead_.pop(kPatience);
      if (found && !take(std::move(*found))) return;
    }
  }
  int dropped() const { return dropped_; }

 private:
  void read() {
    for (FoundFrame found; !stopping_ && read_next(source_, found); found = {}) {
      // Errors wait for their turn: they are no frames that may be missed.
      if (source_.is_live() && !found.error) {
        if (!ahead_.try_push(std::move(found))) ++dropped_;
      } else if (!ahead_.push(std::move(found))) {
        break;
      }
    }
    ahead_.close();
  }

  FrameSource& source_;
  FrameQueue<FoundFrame> ahead_;
  std::atomic<int> dropped_ = 0;
  std::atomic<bool> stopping_ = false;
  std::jthread reader_;
};

int stream_people(FrameSource& source, const Detector& detector, PeopleTracker* tracker, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take) {
  if (options.realtime || source.is_live() || thread_count() > 1) {
    Stream stream(source, detector, tracker, options);
    stream.run(take);
    return stream.dropped();
  }
  Finder finder(detector, tracker);
  for (long number = 0; !stopped(options); ++number) {
    FoundFrame found;
    if (!read_next(source, found)) break;
    find_people(finder, found, number);
    if (!take(std::move(found))) break;
  }
  return 0;
}

}  // namespace

int stream_frames(FrameSource& source, const StreamOptions& options, std::size_t ahead,
                  const std::function<bool(FoundFrame)>& take) {
  Passing passing(source, ahead);
  passing.run(options, take);
  return passing.dropped();
}

int stream_frames(FrameSource& source, const Detector& detector, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take) {
  return stream_people(source, detector, nullptr, options, take);
}

int stream_frames(FrameSource& source, const Detector& detector, PeopleTracker& tracker, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take) {
  return stream_people(source, detector, &tracker, options, take);
}

}  // namespace vesalius

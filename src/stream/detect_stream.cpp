#include "stream/detect_stream.h"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include "stream/frame_queue.h"
#include "vesalius/base/parallel.h"
#include "vesalius/base/quiet_thread.h"

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

void detect(const Detector& detector, FoundFrame& in) {
  if (!in.frame || in.error) return;
  try {
    in.people = detector.detect(*in.frame, nullptr, &in.times);
    if (in.frame->arrived_s) {
      const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
      in.latency_ms = 1e3 * (now.count() - *in.frame->arrived_s);
    }
  } catch (...) {
    in.error = std::current_exception();
  }
}

/// Tells when a camera would have the next frame ready.
class Pace {
 public:
  explicit Pace(double rate) : period_s_(1.0 / rate) {}

  Clock::time_point due(const Frame& frame) {
    if (frames_ == 0) first_s_ = frame.time_s;
    const double by_rate = period_s_ * frames_++;
    const double wait_s = frame.time_s && first_s_ ? *frame.time_s - *first_s_ : by_rate;
    return start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait_s));
  }

 private:
  double period_s_;
  Clock::time_point start_ = Clock::now();
  std::optional<double> first_s_;  ///< none if frames have no times
  int frames_ = 0;
};

/// A frame in the queues. Whoever takes it out of the writing queue waits until it is processed.
struct Job {
  FoundFrame found;
  std::promise<void> done;
};
using JobPointer = std::shared_ptr<Job>;

bool stopped(const StreamOptions& options) { return options.stop && options.stop(); }

class Stream {
 public:
  Stream(FrameSource& source, const Detector& detector, const StreamOptions& options)
      : source_(source),
        detector_(detector),
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
    for (auto job = std::make_shared<Job>(); read_next(source_, job->found); job = std::make_shared<Job>()) {
      // The job enters the writing queue first: that one keeps the order of reading and bounds both queues.
      if (!written_.push(job) || !work_.push(job)) break;
    }
    work_.close();
    written_.close();
  }

  void read_in_real_time() {
    Pace pace(options_.rate);
    for (auto job = std::make_shared<Job>(); read_next(source_, job->found); job = std::make_shared<Job>()) {
      // A camera keeps its own pace, by a clock that may run a little faster or slower than ours.
      const bool waits = job->found.frame && !source_.is_live();
      if (waits && work_.closed_by(pace.due(*job->found.frame))) break;
      if (stopping_) break;
      const bool lost = source_.is_live() && job->found.error;
      dropped_ += work_.push_newest(std::move(job));
      if (lost) break;  // a camera has ended: no newer frame may take the place of its error
    }
    work_.close();
  }

  void work() {
    while (!stopping_ && !work_.finished()) {
      const std::optional<JobPointer> job = work_.pop(kPatience);
      if (!job) continue;
      detect(detector_, (*job)->found);
      (*job)->done.set_value();
      if (realtime_ && !written_.push(*job)) break;
    }
    if (--working_ == 0) written_.close();
  }

  FrameSource& source_;
  const Detector& detector_;
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

}  // namespace

int stream_frames(FrameSource& source, const StreamOptions& options, std::size_t ahead,
                  const std::function<bool(FoundFrame)>& take) {
  Passing passing(source, ahead);
  passing.run(options, take);
  return passing.dropped();
}

int stream_frames(FrameSource& source, const Detector& detector, const StreamOptions& options,
                  const std::function<bool(FoundFrame)>& take) {
  if (options.realtime || source.is_live() || thread_count() > 1) {
    Stream stream(source, detector, options);
    stream.run(take);
    return stream.dropped();
  }
  while (!stopped(options)) {
    FoundFrame found;
    if (!read_next(source, found)) break;
    detect(detector, found);
    if (!take(std::move(found))) break;
  }
  return 0;
}

}  // namespace vesalius

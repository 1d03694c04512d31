#include "io/sensors/reconnecting_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "io/sensors/live_source.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;

class ReconnectingSource final : public FrameSource {
 public:
  ReconnectingSource(std::function<std::unique_ptr<FrameSource>()> open, ReconnectOptions options)
      : open_(std::move(open)), options_(std::move(options)), source_(open_()), notes_(source_->notes()) {}

  std::optional<Frame> next() override {
    while (!stopped()) {
      try {
        if (!source_) take(open_());
        std::optional<Frame> frame = source_->next();
        if (!frame) return frame;  // it was told to stop
        if (lost_since_) say_back();
        keep_time(*frame);
        return frame;
      } catch (const Error& e) {
        if (!lost_since_) say_lost(e);
        close();
        wait();
      }
    }
    return std::nullopt;
  }

  int size() const override { return -1; }
  bool is_live() const override { return true; }
  std::vector<std::string> notes() const override { return notes_; }
  int missed() const override {
    const std::scoped_lock lock(mutex_);
    return missed_before_ + (source_ ? source_->missed() : 0);
  }
  void stop() override {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    if (source_) source_->stop();
    changed_.notify_all();
  }

 private:
  bool stopped() const {
    const std::scoped_lock lock(mutex_);
    return stopped_;
  }

  void take(std::unique_ptr<FrameSource> source) {
    const std::scoped_lock lock(mutex_);
    source_ = std::move(source);
    if (stopped_) source_->stop();
  }

  void close() {
    std::unique_ptr<FrameSource> old;
    {
      const std::scoped_lock lock(mutex_);
      if (source_) missed_before_ += source_->missed();
      old.swap(source_);
    }
  }  // closing may take a while, so it is done without the lock

  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, options_.retry, [&] { return stopped_; });
  }

  void say_lost(const Error& why) {
    lost_since_ = Clock::now();
    shift_is_old_ = true;
    if (options_.say) options_.say(fmt::format("{}; waiting until it is back", why.what()));
  }

  void say_back() {
    const std::chrono::duration<double> away = Clock::now() - *lost_since_;
    lost_since_.reset();
    if (options_.say) options_.say(fmt::format("{}: back after {:.1f} s", options_.place, away.count()));
  }

  void keep_time(Frame& frame) {
    if (!frame.time_s || !frame.arrived_s) return;
    // A clock that stands, as some do after a cable was pulled, is as good as one that begins anew.
    const bool stands = last_time_s_ && *frame.time_s + shift_s_ <= *last_time_s_;
    if ((shift_is_old_ || stands) && last_time_s_) {
      constexpr double kLeast_s = 1e-3;  // this machine's clock may have been set back
      const double later_s = std::max(kLeast_s, *frame.arrived_s - last_arrived_s_);
      shift_s_ = *last_time_s_ + later_s - *frame.time_s;
    }
    shift_is_old_ = false;
    if (shift_s_ != 0.0) set_time(frame, *frame.time_s + shift_s_);
    last_time_s_ = frame.time_s;
    last_arrived_s_ = *frame.arrived_s;
  }

  std::function<std::unique_ptr<FrameSource>()> open_;
  ReconnectOptions options_;
  mutable std::mutex mutex_;  ///< guards what `stop` and `missed` use: changes of source_, and what follows
  std::condition_variable changed_;
  std::unique_ptr<FrameSource> source_;
  bool stopped_ = false;
  int missed_before_ = 0;  ///< frames missed by the sources that were lost
  std::vector<std::string> notes_;
  std::optional<Clock::time_point> lost_since_;
  bool shift_is_old_ = false;
  double shift_s_ = 0.0;  ///< from the camera's clock to ours
  std::optional<double> last_time_s_;
  double last_arrived_s_ = 0.0;
};

}  // namespace

std::unique_ptr<FrameSource> keep_open(std::function<std::unique_ptr<FrameSource>()> open, ReconnectOptions options) {
  return std::make_unique<ReconnectingSource>(std::move(open), std::move(options));
}

}  // namespace vesalius

#include "view/player.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <utility>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

/// How far back the frame before this one is looked for, in seconds, at first and when it was not there.
constexpr std::array kBack_s = {0.2, 2.0, 60.0};
constexpr int kMostFailures = 100;               // one after the other; then nothing is left to be hoped for
constexpr std::chrono::seconds kLongestWait(2);  // for a frame that was taken long after the last
/// Later than that by the clock, the pace starts anew: the machine slept, or the disk did.
constexpr std::chrono::milliseconds kMostBehind(500);

}  // namespace

int frame_number(double time_s) { return static_cast<int>(std::ceil(time_s * kUsualRate - 1e-6)); }

Player::Player(FrameSource& source, double rate, bool playing, Outputs outputs, int index)
    : source_(source), rate_(rate), outputs_(std::move(outputs)), index_(index) {
  state_.live = source.is_live();
  state_.span = source.span();
  state_.playing = playing || state_.live;
  state_.repeat = state_.span.has_value();
  if (state_.span) state_.at_s = state_.span->first_s;
  if (!state_.playing) commands_.emplace_back([this] { play_one(); });  // something to look at
}

void Player::start() {
  thread_ = std::jthread([this] {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    run();
  });
}

Player::~Player() { stop(); }

void Player::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (state().live) source_.stop();  // it may be waiting for a camera
  if (thread_.joinable()) thread_.join();
}

PlayerState Player::state() const {
  const std::scoped_lock lock(mutex_);
  return state_;
}

template <class Change>
void Player::change(Change change) {
  {
    const std::scoped_lock lock(mutex_);
    change(state_);
  }
  outputs_.changed();
}

void Player::post(Command command) {
  {
    const std::scoped_lock lock(mutex_);
    commands_.push_back(std::move(command));
  }
  changed_.notify_all();
}

void Player::play() {
  post([this] {
    if (state().at_end && state().span) move_to(state().span->first_s);
    restart_pace();
    change([](PlayerState& s) { s.playing = true; });
  });
}

void Player::pause() {
  post([this] { change([](PlayerState& s) { s.playing = false; }); });
}

void Player::step(int by) {
  post([this, by] {
    change([](PlayerState& s) { s.playing = false; });
    if (by > 0) play_one();
    if (by < 0 && state().span) step_back();
  });
}

void Player::seek(double time_s) {
  post([this, time_s] {
    const PlayerState now = state();
    if (!now.span) return;
    move_to(std::clamp(time_s, now.span->first_s, now.span->last_s));
    if (std::optional<TimedFrame> next = read()) show(std::move(*next));
  });
}

void Player::set_speed(double times) {
  post([this, times] {
    restart_pace();
    change([&](PlayerState& s) { s.speed = std::clamp(times, 0.1, 10.0); });
  });
}

void Player::set_repeat(bool repeat) {
  post([this, repeat] { change([&](PlayerState& s) { s.repeat = repeat && s.span; }); });
}

std::optional<Player::Command> Player::next_command(std::optional<Clock::time_point> until) {
  std::unique_lock lock(mutex_);
  const auto ready = [&] { return stopping_ || !commands_.empty(); };
  if (until) {
    changed_.wait_until(lock, *until, ready);
  } else {
    changed_.wait(lock, ready);
  }
  if (stopping_ || commands_.empty()) return std::nullopt;
  Command command = std::move(commands_.front());
  commands_.pop_front();
  return command;
}

bool Player::stopping() const {
  const std::scoped_lock lock(mutex_);
  return stopping_;
}

/// Returns when a frame is to be shown at the source's pace, which must have begun.
Player::Clock::time_point Player::planned(const TimedFrame& next, const PlayerState& now) const {
  const double rate = next.frame.time_s ? 1.0 : rate_ / kUsualRate;
  const std::chrono::duration<double> after((next.at_s - pace_from_s_) / (now.speed * rate));
  return *pace_start_ + std::chrono::duration_cast<Clock::duration>(after);
}

/// Returns until when there is nothing to do but to obey; nothing if that is for ever.
std::optional<Player::Clock::time_point> Player::due(const PlayerState& now) const {
  // A camera is read while nobody looks, or its frames would wait and be old.
  if (!now.playing && !now.live) return std::nullopt;
  if (!waiting_ || !pace_start_ || now.live) return Clock::now();
  return std::min(planned(*waiting_, now), last_shown_ + kLongestWait);
}

void Player::run() {
  while (!stopping()) {
    const PlayerState now = state();
    const std::optional<Command> command = next_command(due(now));
    if (stopping()) return;
    if (command) {
      (*command)();
    } else if (!waiting_) {
      waiting_ = read();
      if (!waiting_) end_of_source();
    } else if (now.playing) {
      show(*std::exchange(waiting_, std::nullopt));
    } else {
      waiting_.reset();
    }
  }
}

/// Returns the next frame that can be read, nothing at the end.
std::optional<Player::TimedFrame> Player::read() {
  if (waiting_) return std::exchange(waiting_, std::nullopt);
  for (int failures = 0; failures < kMostFailures && !stopping(); ++failures) {
    const int index = index_++;
    try {
      std::optional<Frame> frame = source_.next();
      if (!frame) return std::nullopt;
      const double at_s = frame->time_s.value_or(index / kUsualRate);
      return TimedFrame{std::move(*frame), at_s};
    } catch (const Error& e) {
      outputs_.failed(e.what());
    }
  }
  return std::nullopt;
}

void Player::play_one() {
  if (std::optional<TimedFrame> next = read()) {
    show(std::move(*next));
  } else {
    end_of_source();
  }
}

void Player::end_of_source() {
  const PlayerState now = state();
  // Where nothing was shown since the beginning, nothing will be.
  const bool again = now.playing && now.repeat && now.span && shown_since_start_;
  if (again) {
    move_to(now.span->first_s);
    shown_since_start_ = false;
    return;
  }
  change([](PlayerState& s) {
    s.playing = false;
    s.live = false;
    s.at_end = true;
  });
}

void Player::move_to(double time_s) {
  waiting_.reset();
  source_.seek(time_s);
  index_ = frame_number(time_s);
  restart_pace();
}

void Player::step_back() {
  const PlayerState now = state();
  for (const double back_s : kBack_s) {
    const double from_s = std::max(now.span->first_s, now.at_s - back_s);
    move_to(from_s);
    std::optional<TimedFrame> before;
    std::optional<TimedFrame> next = read();
    while (next && next->at_s < now.at_s) {
      before = std::move(next);
      next = read();
    }
    waiting_ = std::move(next);  // the frame that is shown now: it comes after the one before it
    if (before) return show(std::move(*before));
    if (from_s == now.span->first_s) break;
  }
  waiting_.reset();  // there is none before: the next one is still that after the one that is shown
}

void Player::show(TimedFrame next) {
  const Clock::time_point now = Clock::now();
  if (!pace_start_ || now > planned(next, state()) + kMostBehind) {
    pace_start_ = now;
    pace_from_s_ = next.at_s;
  }
  last_shown_ = now;
  shown_since_start_ = true;
  {
    const std::scoped_lock lock(mutex_);
    state_.at_s = next.at_s;
    state_.at_end = false;
  }
  Clock::time_point arrived = now;
  if (next.frame.arrived_s) {
    const std::chrono::duration<double> since = std::chrono::system_clock::now().time_since_epoch();
    const std::chrono::duration<double> ago(std::clamp(since.count() - *next.frame.arrived_s, 0.0, 60.0));
    arrived -= std::chrono::duration_cast<Clock::duration>(ago);
  }
  outputs_.show({std::move(next.frame), next.at_s, arrived});
}

}  // namespace vesalius

#include "view/player.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "vesalius/base/quiet_thread.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// How far back the frame before this one is looked for, in seconds, at first and when it was not there.
constexpr std::array kBack_s = {0.2, 2.0, 60.0, std::numeric_limits<double>::infinity()};
constexpr int kMostFailures = 100;     // frames one after the other that cannot be read; then nothing more is hoped for
constexpr int kMostMoves = 4;          // that wait: a held key sends more than are done
constexpr double kLongestGap_s = 2.0;  // between two frames; where nothing was taken for longer, nobody waits that long
/// Later than that by the clock, the pace starts anew: the machine slept, or the disk did.
constexpr std::chrono::milliseconds kMostBehind(500);

/// Returns the number of the first frame not before a time, in a source whose frames have none.
std::int64_t frame_number(double time_s) {
  constexpr double kMost = 1e15;
  return static_cast<std::int64_t>(std::clamp(std::ceil(time_s * kUsualRate - 1e-6), -kMost, kMost));
}

}  // namespace

Player::Player(FrameSource& source, const PlayerOptions& options, Outputs outputs)
    : source_(source), rate_(options.rate), outputs_(std::move(outputs)), index_(frame_number(options.start_s)) {
  state_.live = source.is_live();
  state_.span = source.span();
  state_.playing = options.playing || state_.live;
  state_.repeat = options.repeat && state_.span;
  if (state_.span) state_.at_s = state_.span->first_s;
  if (!state_.playing) commands_.push_back({false, [this] { play_one(); }});  // something to look at
}

void Player::start() {
  thread_ = quiet_thread([this] { run(); });
}

Player::~Player() { stop(); }

void Player::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  source_.stop();  // it may be waiting for a camera
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

void Player::forget_moves() {
  const std::scoped_lock lock(mutex_);
  std::erase_if(commands_, [](const Command& command) { return command.moves; });
}

void Player::play() {
  post({false, [this] {
          const PlayerState now = state();
          if (now.at_end && now.span) move_to(now.span->first_s);
          planned_.reset();
          change([](PlayerState& s) { s.playing = true; });
        }});
}

void Player::pause() {
  forget_moves();
  post({false, [this] { change([](PlayerState& s) { s.playing = false; }); }});
}

void Player::step(int by) {
  {
    const std::scoped_lock lock(mutex_);
    if (std::ranges::count(commands_, true, &Command::moves) >= kMostMoves) return;
  }
  post({true, [this, by] {
          change([](PlayerState& s) { s.playing = false; });
          if (by > 0) play_one();
          if (by < 0 && state().span) step_back();
        }});
}

void Player::seek(double time_s) {
  forget_moves();
  post({true, [this, time_s] {
          const PlayerState now = state();
          if (!now.span) return;
          move_to(std::clamp(time_s, now.span->first_s, now.span->last_s));
          if (std::optional<TimedFrame> next = read()) show(std::move(*next));
        }});
}

void Player::set_speed(double times) {
  post({false, [this, times] { change([&](PlayerState& s) { s.speed = std::clamp(times, 0.1, 10.0); }); }});
}

void Player::set_repeat(bool repeat) {
  post({false, [this, repeat] { change([&](PlayerState& s) { s.repeat = repeat && s.span; }); }});
}

void Player::set_loop(std::optional<TimeSpan> loop) {
  post({false, [this, loop] {
          change([&](PlayerState& s) {
            s.loop.reset();
            if (!loop || !s.span) return;
            const auto inside = [&](double time_s) { return std::clamp(time_s, s.span->first_s, s.span->last_s); };
            const auto [first_s, last_s] = std::minmax(loop->first_s, loop->last_s);
            s.loop = TimeSpan{inside(first_s), inside(last_s)};
          });
        }});
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

/// Returns how long after the frame that is shown another is due.
Player::Clock::duration Player::period(const TimedFrame& next, const PlayerState& now) const {
  const double rate = next.frame.time_s ? 1.0 : rate_ / kUsualRate;
  double gap_s = next.at_s - now.at_s;
  // Back to the beginning, or times that fall: a frame is shown as long as usual.
  if (!(gap_s > 0.0)) gap_s = 1.0 / kUsualRate;
  return std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(std::min(std::min(gap_s, kLongestGap_s) / (now.speed * rate), kLongestGap_s)));
}

/// Returns until when there is nothing to do but to obey; nothing if that is for ever.
std::optional<Player::Clock::time_point> Player::due(const PlayerState& now) const {
  // A camera is read while nobody looks, or its frames would wait and be old.
  if (!now.playing && !now.live) return std::nullopt;
  if (!waiting_ || !planned_ || now.live) return Clock::now();
  return *planned_ + period(*waiting_, now);
}

void Player::run() {
  while (!stopping()) {
    const PlayerState now = state();
    const std::optional<Command> command = next_command(due(now));
    if (stopping()) return;
    guarded([&] {
      if (command) {
        command->act();
      } else if (!waiting_) {
        waiting_ = read();
        if (!waiting_) end_of_source();
      } else if (now.playing && ends_loop(now)) {
        play_again(now.loop->first_s);
        began_loop_ = true;
      } else if (now.playing) {
        began_loop_ = false;
        show(*std::exchange(waiting_, std::nullopt));
      } else {
        waiting_.reset();
      }
    });
  }
}

/// A source that cannot be moved in, or memory that is short, ends the playing and not the program.
void Player::guarded(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::exception& e) {
    outputs_.failed(e.what());
    change([](PlayerState& s) { s.playing = false; });
  }
}

/// Returns the next frame that can be read, nothing at the end.
std::optional<Player::TimedFrame> Player::read() {
  if (waiting_) return std::exchange(waiting_, std::nullopt);
  for (int failures = 0; failures < kMostFailures && !stopping(); ++failures) {
    const std::int64_t index = index_++;
    try {
      std::optional<Frame> frame = source_.next();
      if (!frame) return std::nullopt;
      const double at_s = frame->time_s.value_or(double(index) / kUsualRate);
      return TimedFrame{std::move(*frame), at_s};
    } catch (const Error& e) {
      if (state().live) {
        outputs_.lost(std::current_exception());
        return std::nullopt;
      }
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

/// Returns whether the frame that waits is the first beyond the loop. Where a loop has no frame, the one after it is
/// shown.
bool Player::ends_loop(const PlayerState& now) const {
  return now.loop && !began_loop_ && now.at_s <= now.loop->last_s && waiting_->at_s > now.loop->last_s;
}

/// Moves so that the frame that is shown is shown as long as the others.
void Player::play_again(double from_s) {
  const std::optional<Clock::time_point> planned = planned_;
  move_to(from_s);
  planned_ = planned;
}

void Player::end_of_source() {
  const PlayerState now = state();
  // A single frame has been shown; where nothing was shown since the beginning, nothing will be.
  const bool has_more = now.span && now.span->last_s > now.span->first_s && shown_since_start_;
  if (now.playing && (now.repeat || now.loop) && has_more) {
    play_again(now.loop ? now.loop->first_s : now.span->first_s);
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
  planned_.reset();
  began_loop_ = false;
  source_.seek(time_s);
  index_ = frame_number(time_s);
}

void Player::step_back() {
  const PlayerState now = state();
  for (const double back_s : kBack_s) {
    const double from_s = std::max(now.span->first_s, now.at_s - back_s);
    move_to(from_s);
    std::optional<TimedFrame> before;
    std::optional<TimedFrame> next = read();
    while (next && next->at_s <= now.at_s && next->frame.name != shown_) {
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
  const Clock::time_point planned = planned_ ? *planned_ + period(next, state()) : now;
  planned_ = now > planned + kMostBehind || now < planned ? now : planned;
  shown_since_start_ = true;
  shown_ = next.frame.name;
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

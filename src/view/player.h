#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "vesalius/base/frame_source.h"

namespace vesalius {

/// A frame that is to be shown now.
struct PlayedFrame {
  Frame frame;
  double at_s = 0.0;                              ///< its place in the source, as TimeSpan counts
  std::chrono::steady_clock::time_point arrived;  ///< when it was due, or when it was there if that was later
};

/// How a source is being played.
struct PlayerState {
  bool live = false;
  bool playing = true;
  bool at_end = false;  ///< whether the source ended and nobody has moved since
  bool repeat = true;   ///< whether the source starts again when it ends
  double speed = 1.0;
  double at_s = 0.0;             ///< of the frame that was shown last
  std::optional<TimeSpan> span;  ///< none where one cannot move
};

/// Returns the number of the first frame not before a time, in a source whose frames have none.
int frame_number(double time_s);

/// Plays a source on a thread of its own: at the pace at which the frames were taken, or at that of a camera.
class Player {
 public:
  struct Outputs {
    std::function<void(PlayedFrame)> show;               ///< receives each frame when it is due; must not take long
    std::function<void(const std::string& why)> failed;  ///< a frame could not be read; playing goes on
    std::function<void()> changed;                       ///< the state has changed otherwise than by a frame
  };

  /// `rate` is the frames a second of a source without times, and `index` the number of the frame that it gives next.
  /// The source must outlive the player.
  Player(FrameSource& source, double rate, bool playing, Outputs outputs, int index = 0);

  void start();
  /// Ends the thread. `outputs` are not called from then on.
  void stop();

  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  // What follows returns at once and is done in its order. What a source cannot do is left out.
  void play();  ///< from the beginning, if the source has ended
  void pause();
  void step(int by);             ///< 1 shows the next frame, -1 the one before; both pause
  void seek(double time_s);      ///< shows the first frame not before this time, and goes on as before
  void set_speed(double times);  ///< 0.1 to 10
  void set_repeat(bool repeat);

  PlayerState state() const;

 private:
  using Clock = std::chrono::steady_clock;
  using Command = std::function<void()>;
  struct TimedFrame {
    Frame frame;
    double at_s;
  };

  void post(Command command);
  void run();
  bool stopping() const;
  Clock::time_point planned(const TimedFrame& next, const PlayerState& now) const;
  std::optional<Clock::time_point> due(const PlayerState& now) const;
  std::optional<Command> next_command(std::optional<Clock::time_point> until);
  std::optional<TimedFrame> read();
  void play_one();
  void end_of_source();
  void move_to(double time_s);
  void step_back();
  void show(TimedFrame next);
  void restart_pace() { pace_start_.reset(); }
  template <class Change>
  void change(Change change);

  FrameSource& source_;
  const double rate_;
  const Outputs outputs_;
  // Of the player's thread alone:
  int index_;                                    ///< of the next frame that is read, where frames have no times
  std::optional<TimedFrame> waiting_;            ///< read, not due yet
  std::optional<Clock::time_point> pace_start_;  ///< when the frame at pace_from_s_ was shown
  double pace_from_s_ = 0.0;
  Clock::time_point last_shown_;
  bool shown_since_start_ = false;  ///< whether the source has given a frame since it began

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Command> commands_;
  PlayerState state_;
  bool stopping_ = false;
  std::jthread thread_;
};

}  // namespace vesalius

#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "vesalius/frame_source.h"

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
  double at_s = 0.0;             ///< place of the frame that was shown last
  std::optional<TimeSpan> span;  ///< none where one cannot move
  std::optional<TimeSpan> loop;  ///< the stretch that is played again and again
};

struct PlayerOptions {
  double rate = kUsualRate;  ///< frames a second of a source without times
  bool playing = true;       ///< otherwise it shows the first frame and waits
  bool repeat = true;        ///< whether a source in which one can move starts again
  double start_s = 0.0;      ///< where the source stands, in seconds from its first frame
};

/// Plays a source on a thread of its own: at the pace at which the frames were taken, or at that of a camera.
class Player {
 public:
  struct Outputs {
    std::function<void(PlayedFrame)> show;               ///< receives each frame when it is due; must not take long
    std::function<void(const std::string& why)> failed;  ///< a frame could not be read; playing goes on
    std::function<void(std::exception_ptr why)> lost;    ///< a camera gives nothing more: it has ended
    std::function<void()> changed;                       ///< the state has changed otherwise than by a frame
  };

  /// The source must outlive the player.
  Player(FrameSource& source, const PlayerOptions& options, Outputs outputs);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  void start();
  /// Ends the thread. `outputs` are not called from then on.
  void stop();

  // What follows returns at once and is done in its order. What a source cannot do is left out. Nobody waits for moves
  // that are outdated: a seek replaces those before it that are not done yet, a pause too, and only so many steps wait.
  void play();  ///< plays on, or from the beginning if the source has ended
  void pause();
  void step(int by);             ///< shows the next frame (above 0) or the one before (below 0), and pauses
  void seek(double time_s);      ///< shows the first frame not before this time, and goes on as before
  void set_speed(double times);  ///< 0.1 to 10
  void set_repeat(bool repeat);
  /// Playing goes back to the stretch's first frame after its last, and at the end of the source, until there is no
  /// stretch. Whoever seeks beyond it sees what is there. Its ends may come in either order.
  void set_loop(std::optional<TimeSpan> loop);

  PlayerState state() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Command {
    bool moves = false;  ///< whether it only goes to another frame
    std::function<void()> act;
  };
  struct TimedFrame {
    Frame frame;
    double at_s;
  };

  void post(Command command);
  void forget_moves();
  void run();
  void guarded(const std::function<void()>& act);
  bool stopping() const;
  Clock::duration period(const TimedFrame& next, const PlayerState& now) const;
  std::optional<Clock::time_point> due(const PlayerState& now) const;
  std::optional<Command> next_command(std::optional<Clock::time_point> until);
  std::optional<TimedFrame> read();
  void play_one();
  bool ends_loop(const PlayerState& now) const;
  void play_again(double from_s);
  void end_of_source();
  void move_to(double time_s);
  void step_back();
  void show(TimedFrame next);
  template <class Change>
  void change(Change change);

  FrameSource& source_;
  const double rate_;
  const Outputs outputs_;
  // Of the player's thread alone:
  std::int64_t index_;                        ///< number of the next frame that is read, where frames have no times
  std::optional<TimedFrame> waiting_;         ///< read, not due yet
  std::optional<Clock::time_point> planned_;  ///< when the frame that is shown was due; none after a move
  std::string shown_;                         ///< its name
  bool began_loop_ = false;                   ///< whether the next frame that plays is the first of the loop
  bool shown_since_start_ = false;            ///< whether the source has given a frame since it began

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Command> commands_;
  PlayerState state_;
  bool stopping_ = false;
  std::jthread thread_;
};

}  // namespace vesalius

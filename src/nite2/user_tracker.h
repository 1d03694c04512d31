#pragma once

#include <NiteCAPI.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "nite2/depth_stream.h"
#include "nite2/user_frame.h"
#include "nite2/users.h"
#include "standin/body_smoother.h"
#include "vesalius/detect_stream.h"

namespace vesalius::nite2 {

/// Finds the users of a stream of depth, picture after picture, in a thread of its own. Of a camera only what was found
/// in the newest picture waits to be read; recordings wait for whoever reads.
class UserTracker : public std::enable_shared_from_this<UserTracker> {
 public:
  /// Throws Error as DepthStream, and for a model without the joints.
  UserTracker(std::shared_ptr<const Detector> detector, OniDeviceHandle device);
  UserTracker(const UserTracker&) = delete;
  UserTracker& operator=(const UserTracker&) = delete;

  /// Begins.
  void start();
  /// Ends, and returns when nobody looks at pictures any more; at once in a callback.
  void end();

  /// Returns the next frame. Throws Error if none comes.
  std::shared_ptr<UserFrame> read();

  /// Changes what is wanted of a user of the last frame that was read. Returns whether there is one.
  bool change(NiteUserId user, const std::function<void(Wish&)>& change);
  /// Returns whether that is somebody's skeleton.
  bool wants_skeleton(NiteUserId user) const;

  float smoothing() const { return smoothing_; }
  /// From 0 to 1.
  void set_smoothing(float factor) { smoothing_ = factor; }

  void add_callbacks(NiteUserTrackerCallbacks* callbacks, void* cookie);
  void remove_callbacks(NiteUserTrackerCallbacks* callbacks);

  DepthView view() const { return stream_.view(); }

 private:
  /// A picture that is looked at.
  struct Seen {
    OniFrameReference picture;
    DepthView view;
  };
  /// What was found in it. Users are told of when it is read, so that whoever asks for a skeleton has it in the next
  /// frame, and hears of everybody who is new although frames are left out.
  struct Found {
    FoundFrame people;
    Seen seen;
  };
  struct Listener {
    NiteUserTrackerCallbacks* callbacks;
    void* cookie;
  };
  void run();
  std::optional<Seen> next_picture();
  std::optional<Frame> next_frame();
  bool take(FoundFrame people);
  std::shared_ptr<UserFrame> frame_of(Found found);
  NiteUserData user_of(const TrackedPerson& person, const Found& found);
  void tell_listeners();

  const std::shared_ptr<const Detector> detector_;
  const NiteJoints joints_;
  DepthStream stream_;
  std::atomic<float> smoothing_ = 0.F;
  mutable std::mutex telling_;  ///< of what follows, while a frame is told of
  standin::BodySmoother smoother_;
  std::map<NiteUserId, Wish> wishes_;  ///< of the users of the last frame that was read
  mutable std::mutex mutex_;           ///< of what follows
  std::condition_variable changed_;
  std::deque<Seen> working_;
  std::optional<Found> found_;  ///< that nobody has read
  bool newcomers_ = false;      ///< listeners came after the last frame
  bool ended_ = false;
  std::recursive_mutex calling_;     ///< while listeners are told
  std::vector<Listener> listeners_;  ///< guarded by that
  std::thread thread_;
};

}  // namespace vesalius::nite2

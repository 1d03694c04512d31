#include "nite2/user_tracker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "nite2/guard.h"
#include "standin/pulled_frames.h"
#include "vesalius/error.h"
#include "vesalius/track_people.h"

namespace vesalius::nite2 {
namespace {

/// How long a program waits for a frame, and how soon a tracker notices its end.
constexpr std::chrono::seconds kPatience(10);
constexpr std::chrono::milliseconds kTick(50);
constexpr double kMicroseconds = 1e6;  ///< of a second

/// Returns somebody of whom only the id is known.
NiteUserData lost_user(NiteUserId id) {
  NiteUserData user{};
  user.id = id;
  user.state = NITE_USER_STATE_LOST;
  for (int j = 0; j < NITE_JOINT_COUNT; ++j) user.skeleton.joints[j].jointType = static_cast<NiteJointType>(j);
  for (int p = 0; p < NITE_POSE_COUNT; ++p) user.poses[p].type = static_cast<NitePoseType>(p);
  return user;
}

}  // namespace

UserTracker::UserTracker(std::shared_ptr<const Detector> detector, OniDeviceHandle device)
    : detector_(std::move(detector)), joints_(detector_->body()), stream_(device) {
  (void)stream_.view();
}

void UserTracker::start() {
  thread_ = std::thread([self = shared_from_this()] { self->run(); });
}

void UserTracker::end() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  if (std::this_thread::get_id() == thread_.get_id()) {
    thread_.detach();  // it holds this object until it has ended
  } else {
    thread_.join();
  }
}

std::shared_ptr<UserFrame> UserTracker::read() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [&] { return found_ || ended_; });
  if (!found_) throw Error(ended_ ? "the tracker has ended" : "no depth came for ten seconds");
  Found found = std::move(*found_);
  found_.reset();
  changed_.notify_all();
  lock.unlock();
  const std::scoped_lock telling(telling_);
  return frame_of(std::move(found));
}

bool UserTracker::change(NiteUserId user, const std::function<void(Wish&)>& change) {
  const std::scoped_lock lock(telling_);
  const auto known = wishes_.find(user);
  if (known == wishes_.end()) return false;
  change(known->second);
  return true;
}

bool UserTracker::wants_skeleton(NiteUserId user) const {
  const std::scoped_lock lock(telling_);
  const auto known = wishes_.find(user);
  return known != wishes_.end() && known->second.skeleton;
}

void UserTracker::add_callbacks(NiteUserTrackerCallbacks* callbacks, void* cookie) {
  {
    const std::scoped_lock lock(calling_);
    listeners_.push_back({callbacks, cookie});
  }
  const std::scoped_lock lock(mutex_);
  newcomers_ = true;
  changed_.notify_all();
}

void UserTracker::remove_callbacks(NiteUserTrackerCallbacks* callbacks) {
  const std::scoped_lock lock(calling_);
  std::erase_if(listeners_, [&](const Listener& one) { return one.callbacks == callbacks; });
}

void UserTracker::tell_listeners() {
  const std::scoped_lock lock(calling_);
  const std::vector<Listener> all = listeners_;
  for (const Listener& one : all) {
    // One may have removed another.
    const bool is_there = std::ranges::any_of(
        listeners_, [&](const Listener& l) { return l.callbacks == one.callbacks && l.cookie == one.cookie; });
    if (is_there && one.callbacks->readyForNextFrame != nullptr) one.callbacks->readyForNextFrame(one.cookie);
  }
}

void UserTracker::run() {
  try {
    PulledFrames pictures([this] { return next_frame(); });
    PeopleTracker tracker = make_tracker(*detector_, {});
    stream_frames(pictures, *detector_, tracker, {}, [&](FoundFrame found) { return take(std::move(found)); });
  } catch (...) {
    kGuard.say_exception("a tracker ends");
  }
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

std::optional<UserTracker::Seen> UserTracker::next_picture() {
  try {
    Seen seen;
    while (!seen.picture) {
      {
        const std::scoped_lock lock(mutex_);
        if (ended_) return std::nullopt;
      }
      seen.picture = stream_.read(kTick);
    }
    seen.view = stream_.view();
    return seen;
  } catch (...) {
    kGuard.say_exception("a tracker ends");
    return std::nullopt;
  }
}

std::optional<Frame> UserTracker::next_frame() {
  std::optional<Seen> seen = next_picture();
  if (!seen) return std::nullopt;
  const OniFrame& picture = *seen->picture;
  const DepthView view = seen->view;
  {
    const std::scoped_lock lock(mutex_);
    working_.push_back(std::move(*seen));
  }
  // What cannot be read is told with the frame's people, of which there are none. The picture stays until then.
  Frame frame;
  frame.time_s = double(picture.timestamp) / kMicroseconds;
  frame.camera = view.camera_of(picture);
  frame.depth = view.depth_of(picture);
  return frame;
}

NiteUserData UserTracker::user_of(const TrackedPerson& person, const Found& found) {
  const DepthView& view = found.seen.view;
  const TrackedFrame& people = found.people.people;
  NiteUserData user = lost_user(user_id(person.id));
  user.centerOfMass = view.millimetres(person.position);
  place_user(person.person, *found.people.frame, view, user);
  const auto [wish, is_new] = wishes_.try_emplace(user.id);
  if (person.state != TrackState::lost) {
    user.state = (is_found(person) ? NITE_USER_STATE_VISIBLE : 0) | (is_new ? NITE_USER_STATE_NEW : 0);
  }
  const Joints joints = joints_.ordered(smoother_.smooth(person, joints_.set(), people.time_s, smoothing_));
  if (wish->second.skeleton) user.skeleton = skeleton_of(person, joints, joints_, view);
  const Eigen::Vector3f up = people.floor ? people.floor->up : FloorView{}.up;
  for (int p = 0; p < NITE_POSE_COUNT; ++p) {
    const auto type = static_cast<NitePoseType>(p);
    user.poses[p] =
        pose_of(type, wish->second.detects[p], is_found(person) && holds_pose(joints, type, up), wish->second.held[p]);
  }
  if (person.state == TrackState::lost) wishes_.erase(wish);
  return user;
}

std::shared_ptr<UserFrame> UserTracker::frame_of(Found found) {
  const TrackedFrame& people = found.people.people;
  std::vector<NiteUserData> users;
  std::vector<NiteUserId> ids;
  std::vector<NiteUserId> map;
  if (found.people.frame) {
    for (const TrackedPerson& person : people.people) {
      ids.push_back(user_id(person.id));
      users.push_back(user_of(person, found));
    }
    smoother_.keep(people);
    // Of whom the tracker gave up while nobody read, and of whom it was never sure, it says nothing more.
    for (const auto& [id, wish] : wishes_) {
      if (std::ranges::find(ids, id) == ids.end()) users.push_back(lost_user(id));
    }
    std::erase_if(wishes_, [&](const auto& one) { return std::ranges::find(ids, one.first) == ids.end(); });
    map = user_map(people_of(people), ids, *found.people.frame, found.seen.view);
  } else {
    const OniFrame& picture = *found.seen.picture;
    map.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  }
  auto frame = std::make_shared<UserFrame>(std::move(found.seen.picture), std::move(users), std::move(map));
  if (people.floor) frame->set_floor(floor_of(*people.floor, found.seen.view));
  return frame;
}

bool UserTracker::take(FoundFrame people) {
  if (people.error) {
    try {
      std::rethrow_exception(people.error);
    } catch (...) {
      kGuard.say_exception("nobody is looked for in a picture");
    }
  }
  std::unique_lock lock(mutex_);
  // A recording waits to be read. Whoever listens from now on must hear of what waits, too.
  while (stream_.is_recording() && found_ && !ended_) {
    changed_.wait(lock, [&] { return ended_ || !found_ || newcomers_; });
    if (!std::exchange(newcomers_, false)) continue;
    lock.unlock();
    tell_listeners();
    lock.lock();
  }
  if (ended_) return false;
  found_ = Found{std::move(people), std::move(working_.front())};
  working_.pop_front();
  newcomers_ = false;
  changed_.notify_all();
  lock.unlock();
  tell_listeners();
  return true;
}

}  // namespace vesalius::nite2

#include "k4abt/body_tracker.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "k4abt/guard.h"
#include "standin/pulled_frames.h"
#include "vesalius/base/quiet_thread.h"
#include "vesalius/error.h"
#include "vesalius/track_people.h"

namespace vesalius::k4abt {
namespace {

constexpr std::size_t kMostWorking = 2;  ///< captures that are looked at together, as by stream_frames
/// Indices of bodies are bytes, of which one is the background's.
constexpr std::size_t kMostBodies = K4ABT_BODY_INDEX_MAP_BACKGROUND;

}  // namespace

BodyTracker::BodyTracker(std::shared_ptr<const Detector> detector, CaptureReader reader)
    : detector_(std::move(detector)), reader_(std::move(reader)), set_(find_joint_set(detector_->body(), "k4abt32")) {
  if (detector_->body().joint_sets[set_].joints.size() != K4ABT_JOINT_COUNT) {
    throw Error("the model's joint set k4abt32 has another number of joints than " + std::to_string(K4ABT_JOINT_COUNT));
  }
  thread_ = std::thread([this] { run(); });
}

/// Returns whether it is ready, after at most this time.
template <class Ready>
bool BodyTracker::wait(std::unique_lock<std::mutex>& lock, std::int32_t timeout_ms, const Ready& ready) {
  if (timeout_ms >= 0) return changed_.wait_for(lock, std::chrono::milliseconds(timeout_ms), ready);
  changed_.wait(lock, ready);
  return true;
}

k4a_wait_result_t BodyTracker::enqueue(k4a_capture_t capture, std::int32_t timeout_ms) {
  (void)reader_.depth_of(capture);
  std::unique_lock lock(mutex_);
  if (!wait(lock, timeout_ms, [&] { return closed_ || waiting_.size() < kMostWaiting; })) {
    return K4A_WAIT_RESULT_TIMEOUT;
  }
  if (closed_) return K4A_WAIT_RESULT_FAILED;
  k4a().capture_reference(capture);
  waiting_.emplace_back(capture);
  changed_.notify_all();
  return K4A_WAIT_RESULT_SUCCEEDED;
}

k4a_wait_result_t BodyTracker::pop(std::shared_ptr<const BodyFrame>& to, std::int32_t timeout_ms) {
  std::unique_lock lock(mutex_);
  const auto nothing_comes = [&] { return ended_ || (closed_ && waiting_.empty() && working_.empty()); };
  if (!wait(lock, timeout_ms, [&] { return !found_.empty() || nothing_comes(); })) return K4A_WAIT_RESULT_TIMEOUT;
  if (found_.empty()) return K4A_WAIT_RESULT_FAILED;
  to = std::move(found_.front());
  found_.pop_front();
  changed_.notify_all();
  return K4A_WAIT_RESULT_SUCCEEDED;
}

void BodyTracker::shut_down() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void BodyTracker::end() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = ended_ = true;
    waiting_.clear();
    found_.clear();
    changed_.notify_all();
  }
  std::call_once(joined_, [&] { thread_.join(); });
}

void BodyTracker::run() {
  try {
    PulledFrames captures([this] { return next_frame(); });
    PeopleTracker tracker = make_tracker(*detector_, {});
    stream_frames(captures, *detector_, tracker, {}, [&](const FoundFrame& found) { return take(found); });
  } catch (...) {
    kGuard.say_exception("a tracker ends");
  }
  const std::scoped_lock lock(mutex_);
  closed_ = ended_ = true;
  changed_.notify_all();
}

std::optional<Frame> BodyTracker::next_frame() {
  k4a_capture_t capture = nullptr;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || (waiting_.empty() ? closed_ : working_.size() < kMostWorking); });
    if (ended_ || waiting_.empty()) return std::nullopt;
    capture = waiting_.front().get();
    working_.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
    changed_.notify_all();
  }
  return reader_.read(capture);
}

std::shared_ptr<const BodyFrame> BodyTracker::frame_of(const FoundFrame& found, CaptureReference capture) {
  const JointSet& set = detector_->body().joint_sets[set_];
  const float factor = smoothing_;
  std::vector<k4abt_body_t> bodies;
  std::vector<Person> people;
  for (const TrackedPerson& person : found.people.people) {
    if (!is_found(person) || bodies.size() == kMostBodies) continue;
    bodies.push_back(to_body(person, smoother_.smooth(person, set_, found.people.time_s, factor), set));
    people.push_back(person.person);
  }
  smoother_.keep(found.people);
  ImageReference depth = reader_.depth_of(capture.get());
  const Camera& camera = reader_.camera();
  Image<std::uint8_t> map =
      reader_.to_camera(body_index_map(people, camera.width, camera.height), K4ABT_BODY_INDEX_MAP_BACKGROUND);
  return std::make_shared<const BodyFrame>(std::move(capture), std::move(depth), std::move(bodies), std::move(map));
}

bool BodyTracker::take(const FoundFrame& found) {
  if (found.error) {
    try {
      std::rethrow_exception(found.error);
    } catch (...) {
      kGuard.say_exception("nobody is looked for in a capture");
    }
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return ended_ || found_.size() < kMostFound; });
  if (ended_) return false;
  CaptureReference capture = std::move(working_.front());
  lock.unlock();
  std::shared_ptr<const BodyFrame> frame = frame_of(found, std::move(capture));
  lock.lock();
  working_.pop_front();
  found_.push_back(std::move(frame));
  changed_.notify_all();
  return true;
}

}  // namespace vesalius::k4abt

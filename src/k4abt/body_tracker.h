#pragma once

#include <k4abttypes.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "k4abt/bodies.h"
#include "k4abt/body_frame.h"
#include "k4abt/read_capture.h"
#include "standin/body_smoother.h"
#include "vesalius/detect_stream.h"

namespace vesalius::k4abt {

/// Captures that wait to be looked at, and what was found in those before. A thread of its own looks at them, two at a
/// time where there are several processors; each gives one frame of bodies, in their order.
class BodyTracker {
 public:
  static constexpr std::size_t kMostWaiting = 3;  ///< captures that nobody has begun to look at
  static constexpr std::size_t kMostFound = 3;    ///< frames that nobody has fetched

  BodyTracker(std::shared_ptr<const Detector> detector, CaptureReader reader);
  ~BodyTracker() { end(); }
  BodyTracker(const BodyTracker&) = delete;
  BodyTracker& operator=(const BodyTracker&) = delete;

  /// Takes a reference to the capture. Throws UsageError for one that cannot be looked at.
  k4a_wait_result_t enqueue(k4a_capture_t capture, std::int32_t timeout_ms);
  /// Moves the next frame to `to`.
  k4a_wait_result_t pop(std::shared_ptr<const BodyFrame>& to, std::int32_t timeout_ms);
  /// From 0 to 1.
  void set_smoothing(float factor) { smoothing_ = factor; }
  /// Takes no more captures.
  void shut_down();
  /// The same, forgets those that wait, and returns when nobody looks at any.
  void end();

 private:
  void run();
  std::optional<Frame> next_frame();
  bool take(const FoundFrame& found);
  std::shared_ptr<const BodyFrame> frame_of(const FoundFrame& found, CaptureReference capture);
  template <class Ready>
  bool wait(std::unique_lock<std::mutex>& lock, std::int32_t timeout_ms, const Ready& ready);

  const std::shared_ptr<const Detector> detector_;
  const CaptureReader reader_;
  const std::size_t set_;  ///< index of the joint set
  std::atomic<float> smoothing_ = K4ABT_DEFAULT_TRACKER_SMOOTHING_FACTOR;
  standin::BodySmoother smoother_;  ///< of the thread
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<CaptureReference> waiting_, working_;
  std::deque<std::shared_ptr<const BodyFrame>> found_;
  bool closed_ = false;  ///< no more captures come
  bool ended_ = false;   ///< nobody wants more frames
  std::once_flag joined_;
  std::thread thread_;
};

}  // namespace vesalius::k4abt

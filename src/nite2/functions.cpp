#include <NiteCAPI.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "nite2/guard.h"
#include "nite2/openni_library.h"
#include "nite2/user_frame.h"
#include "nite2/user_tracker.h"
#include "standin/handle_registry.h"
#include "standin/shared_detector.h"
#include "vesalius/error.h"

namespace vesalius::nite2 {
namespace {

std::atomic<bool> initialized = false;

/// The registries are never destroyed: programs may release what they have at their very end.
auto& trackers() {
  static auto& registry = *new standin::HandleRegistry<NiteUserTrackerHandle, UserTracker>("user tracker");
  return registry;
}
auto& frames() {
  static auto& registry = *new standin::HandleRegistry<NiteUserTrackerFrame*, UserFrame>("frame");
  return registry;
}

void end_all() {
  for (const auto& tracker : trackers().clear()) tracker->end();
}

/// No thread may run on while the libraries that it uses are taken down.
void end_at_exit() {
  static const bool registered = std::atexit(&end_all) == 0;
  (void)registered;
}

template <class T>
T& need(T* pointer, const char* name) {
  if (pointer == nullptr) throw UsageError(std::string(name) + " is NULL");
  return *pointer;
}

/// What NiTE.h reads where it fails: it looks at a frame whatever the status is.
template <class Frame>
Frame* empty_frame() {
  static Frame frame{};
  return &frame;
}

/// The second of the pointers that an openni::Device begins with.
OniDeviceHandle handle_of(void* device) {
  std::array<OniDeviceHandle, 2> pointers{};
  std::memcpy(pointers.data(), &need(static_cast<char*>(device), "the device"), sizeof pointers);
  return &need(pointers[1], "the device's handle");
}

/// `device` is null for the first there is.
NiteStatus initialize_tracker(OniDeviceHandle device, NiteUserTrackerHandle* to) {
  const std::string model =
      standin::usual_model(reinterpret_cast<const void*>(&niteInitialize), VESALIUS_MODELS_FROM_NITE2);
  const auto tracker = std::make_shared<UserTracker>(standin::shared_detector(model), device);
  end_at_exit();
  tracker->start();
  *to = trackers().add(tracker);
  return NITE_STATUS_OK;
}

/// Returns the pose's number, which need not be one of the enumeration's.
std::size_t pose_index(const NitePoseType& type) {
  int value = 0;
  std::memcpy(&value, &type, sizeof value);
  if (value >= 0 && value < NITE_POSE_COUNT) return static_cast<std::size_t>(value);
  throw UsageError("the pose is " + std::to_string(value) + ", expected 0 or 1");
}

/// Returns the status of the function, which asks for a user.
template <class Change>
NiteStatus change_user(const char* function, NiteUserTrackerHandle tracker, NiteUserId user, const Change& change) {
  return kGuard.run(function, NITE_STATUS_ERROR, [&] {
    return trackers().get(tracker)->change(user, change) ? NITE_STATUS_OK : NITE_STATUS_BAD_USER_ID;
  });
}

NiteStatus no_hands() {
  kGuard.say_once("hands by themselves and gestures are not followed; functions of hand trackers fail");
  return NITE_STATUS_ERROR;
}

}  // namespace
}  // namespace vesalius::nite2

using namespace vesalius;
using namespace vesalius::nite2;

NiteStatus niteInitialize() {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    expect(openni2().Initialize(ONI_API_VERSION), "OpenNI does not start");
    initialized = true;
    return NITE_STATUS_OK;
  });
}

void niteShutdown() {
  kGuard.run(__func__, [&] {
    initialized = false;
    end_all();
  });
}

NiteVersion niteGetVersion() { return {2, 2, 0, 0}; }

NiteStatus niteInitializeUserTracker(NiteUserTrackerHandle* tracker) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(tracker, "the user tracker") = nullptr;
    return initialized ? initialize_tracker(nullptr, tracker) : NITE_STATUS_OUT_OF_FLOW;
  });
}

NiteStatus niteInitializeUserTrackerByDevice(void* device, NiteUserTrackerHandle* tracker) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(tracker, "the user tracker") = nullptr;
    const OniDeviceHandle handle = handle_of(device);
    return initialized ? initialize_tracker(handle, tracker) : NITE_STATUS_OUT_OF_FLOW;
  });
}

NiteStatus niteShutdownUserTracker(NiteUserTrackerHandle tracker) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    trackers().release(tracker)->end();
    return NITE_STATUS_OK;
  });
}

NiteStatus niteStartSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user) {
  return change_user(__func__, tracker, user, [](Wish& wish) { wish.skeleton = true; });
}

void niteStopSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user) {
  change_user(__func__, tracker, user, [](Wish& wish) { wish.skeleton = false; });
}

bool niteIsSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user) {
  return kGuard.run(__func__, false, [&] { return trackers().get(tracker)->wants_skeleton(user); });
}

NiteStatus niteSetSkeletonSmoothing(NiteUserTrackerHandle tracker, float factor) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    const auto of = trackers().get(tracker);
    if (!(factor >= 0.F && factor <= 1.F)) {
      throw UsageError("the factor is " + std::to_string(factor) + ", expected 0 to 1");
    }
    of->set_smoothing(factor);
    return NITE_STATUS_OK;
  });
}

NiteStatus niteGetSkeletonSmoothing(NiteUserTrackerHandle tracker, float* factor) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(factor, "the factor") = trackers().get(tracker)->smoothing();
    return NITE_STATUS_OK;
  });
}

NiteStatus niteStartPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user, NitePoseType type) {
  return change_user(__func__, tracker, user, [&](Wish& wish) { wish.detects[pose_index(type)] = true; });
}

void niteStopPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user, NitePoseType type) {
  change_user(__func__, tracker, user, [&](Wish& wish) { wish.detects[pose_index(type)] = false; });
}

void niteStopAllPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user) {
  change_user(__func__, tracker, user, [](Wish& wish) { wish.detects = {}; });
}

NiteStatus niteRegisterUserTrackerCallbacks(NiteUserTrackerHandle tracker, NiteUserTrackerCallbacks* callbacks,
                                            void* cookie) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    trackers().get(tracker)->add_callbacks(&need(callbacks, "the callbacks"), cookie);
    return NITE_STATUS_OK;
  });
}

void niteUnregisterUserTrackerCallbacks(NiteUserTrackerHandle tracker, NiteUserTrackerCallbacks* callbacks) {
  kGuard.run(__func__, [&] { trackers().get(tracker)->remove_callbacks(callbacks); });
}

NiteStatus niteReadUserTrackerFrame(NiteUserTrackerHandle tracker, NiteUserTrackerFrame** frame) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(frame, "the frame") = empty_frame<NiteUserTrackerFrame>();
    std::shared_ptr<UserFrame> read = trackers().get(tracker)->read();
    NiteUserTrackerFrame* address = read->address();
    frames().add(address, std::move(read));
    *frame = address;
    return NITE_STATUS_OK;
  });
}

NiteStatus niteUserTrackerFrameAddRef(NiteUserTrackerHandle /*tracker*/, NiteUserTrackerFrame* frame) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    if (frame != empty_frame<NiteUserTrackerFrame>()) frames().reference(frame);
    return NITE_STATUS_OK;
  });
}

NiteStatus niteUserTrackerFrameRelease(NiteUserTrackerHandle /*tracker*/, NiteUserTrackerFrame* frame) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    if (frame != empty_frame<NiteUserTrackerFrame>()) frames().release(frame);
    return NITE_STATUS_OK;
  });
}

NiteStatus niteConvertJointCoordinatesToDepth(NiteUserTrackerHandle tracker, float x, float y, float z, float* out_x,
                                              float* out_y) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(out_x, "x of the pixel") = need(out_y, "y of the pixel") = 0.F;
    const DepthView view = trackers().get(tracker)->view();
    if (!(z > 0.F)) return NITE_STATUS_ERROR;  // as of joints that nobody asked for, which programs draw all the same
    const Eigen::Vector2f pixel = view.pixel_of({x, y, z});
    *out_x = pixel.x();
    *out_y = pixel.y();
    return NITE_STATUS_OK;
  });
}

NiteStatus niteConvertDepthCoordinatesToJoint(NiteUserTrackerHandle tracker, int x, int y, int z, float* out_x,
                                              float* out_y) {
  return kGuard.run(__func__, NITE_STATUS_ERROR, [&] {
    need(out_x, "x of the point") = need(out_y, "y of the point") = 0.F;
    const NitePoint3f point = trackers().get(tracker)->view().point_of(float(x), float(y), float(z));
    *out_x = point.x;
    *out_y = point.y;
    return NITE_STATUS_OK;
  });
}

NiteStatus niteInitializeHandTracker(NiteHandTrackerHandle* tracker) {
  if (tracker != nullptr) *tracker = nullptr;
  return no_hands();
}
NiteStatus niteInitializeHandTrackerByDevice(void* /*device*/, NiteHandTrackerHandle* tracker) {
  return niteInitializeHandTracker(tracker);
}
NiteStatus niteShutdownHandTracker(NiteHandTrackerHandle /*tracker*/) { return no_hands(); }
NiteStatus niteStartHandTracking(NiteHandTrackerHandle /*tracker*/, const NitePoint3f* /*position*/, NiteHandId* hand) {
  if (hand != nullptr) *hand = 0;
  return no_hands();
}
void niteStopHandTracking(NiteHandTrackerHandle /*tracker*/, NiteHandId /*hand*/) { no_hands(); }
void niteStopAllHandTracking(NiteHandTrackerHandle /*tracker*/) { no_hands(); }
NiteStatus niteSetHandSmoothingFactor(NiteHandTrackerHandle /*tracker*/, float /*factor*/) { return no_hands(); }
NiteStatus niteGetHandSmoothingFactor(NiteHandTrackerHandle /*tracker*/, float* factor) {
  if (factor != nullptr) *factor = 0.F;
  return no_hands();
}
NiteStatus niteRegisterHandTrackerCallbacks(NiteHandTrackerHandle /*tracker*/, NiteHandTrackerCallbacks* /*callbacks*/,
                                            void* /*cookie*/) {
  return no_hands();
}
void niteUnregisterHandTrackerCallbacks(NiteHandTrackerHandle /*tracker*/, NiteHandTrackerCallbacks* /*callbacks*/) {
  no_hands();
}
NiteStatus niteReadHandTrackerFrame(NiteHandTrackerHandle /*tracker*/, NiteHandTrackerFrame** frame) {
  if (frame != nullptr) *frame = empty_frame<NiteHandTrackerFrame>();
  return no_hands();
}
NiteStatus niteHandTrackerFrameAddRef(NiteHandTrackerHandle /*tracker*/, NiteHandTrackerFrame* /*frame*/) {
  return no_hands();
}
NiteStatus niteHandTrackerFrameRelease(NiteHandTrackerHandle /*tracker*/, NiteHandTrackerFrame* /*frame*/) {
  return no_hands();
}
NiteStatus niteStartGestureDetection(NiteHandTrackerHandle /*tracker*/, NiteGestureType /*type*/) { return no_hands(); }
void niteStopGestureDetection(NiteHandTrackerHandle /*tracker*/, NiteGestureType /*type*/) { no_hands(); }
void niteStopAllGestureDetection(NiteHandTrackerHandle /*tracker*/) { no_hands(); }
NiteStatus niteConvertHandCoordinatesToDepth(NiteHandTrackerHandle /*tracker*/, float /*x*/, float /*y*/, float /*z*/,
                                             float* out_x, float* out_y) {
  if (out_x != nullptr) *out_x = 0.F;
  if (out_y != nullptr) *out_y = 0.F;
  return no_hands();
}
NiteStatus niteConvertDepthCoordinatesToHand(NiteHandTrackerHandle tracker, int /*x*/, int /*y*/, int /*z*/,
                                             float* out_x, float* out_y) {
  return niteConvertHandCoordinatesToDepth(tracker, 0.F, 0.F, 0.F, out_x, out_y);
}

// As programs in C++ do by NiTE.h: a device of their own, and frames that are read in a callback. Prints what
// user_loop.c prints.

#include <NiteCAPI.h>
#include <fake_openni2.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace {

// How an openni::Device begins.
struct Device {
  void* playback = nullptr;
  OniDeviceHandle handle = nullptr;
};

struct Listener {
  NiteUserTrackerCallbacks callbacks;
  NiteUserTrackerHandle tracker;
  int left;
  std::mutex mutex;
  std::condition_variable done;
};

long pixels_of(const NiteUserMap& map, NiteUserId id) {
  long count = 0;
  for (int i = 0; i < map.width * map.height; ++i) count += map.pixels[i] == id ? 1 : 0;
  return count;
}

void read_frame(void* cookie) {
  Listener& self = *static_cast<Listener*>(cookie);
  const std::lock_guard<std::mutex> lock(self.mutex);
  NiteUserTrackerFrame* frame = nullptr;
  if (self.left == 0) return;
  if (niteReadUserTrackerFrame(self.tracker, &frame) != NITE_STATUS_OK) std::exit(1);
  std::printf("frame %llu\n", frame->timestamp);
  for (int u = 0; u < frame->userCount; ++u) {
    const NiteUserData& user = frame->pUser[u];
    if ((user.state & NITE_USER_STATE_NEW) != 0) niteStartSkeletonTracking(self.tracker, user.id);
    const NiteSkeletonJoint& head = user.skeleton.joints[NITE_JOINT_HEAD];
    std::printf("%d %d: %d %.3f %.3f %.3f %.3f, %ld\n", user.id, user.state, static_cast<int>(user.skeleton.state),
                double(head.position.x), double(head.position.y), double(head.position.z),
                double(head.positionConfidence), pixels_of(frame->userMap, user.id));
  }
  niteUserTrackerFrameRelease(self.tracker, frame);
  if (--self.left == 0) self.done.notify_all();
}

}  // namespace

int main(int argc, char** argv) {
  Device device;
  Listener listener;
  listener.callbacks.readyForNextFrame = &read_frame;
  listener.left = argc > 1 ? std::atoi(argv[1]) : 0;
  if (niteInitialize() != NITE_STATUS_OK || oniDeviceOpen(nullptr, &device.handle) != ONI_STATUS_OK ||
      niteInitializeUserTrackerByDevice(&device, &listener.tracker) != NITE_STATUS_OK ||
      niteRegisterUserTrackerCallbacks(listener.tracker, &listener.callbacks, &listener) != NITE_STATUS_OK) {
    return 1;
  }
  {
    std::unique_lock<std::mutex> lock(listener.mutex);
    listener.done.wait(lock, [&] { return listener.left == 0; });
  }
  niteUnregisterUserTrackerCallbacks(listener.tracker, &listener.callbacks);
  niteShutdownUserTracker(listener.tracker);
  oniDeviceClose(device.handle);
  niteShutdown();
  return 0;
}

// A program with OpenNI's own classes, as those that NiTE.h hands on, for other_side.py. Reads three frames and prints
// time, users and the first user's pixels of each. Ends without shutting anything down if there is an argument.

#include <NiteCAPI.h>
#include <OpenNI.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** /*argv*/) {
  openni::Device device;
  NiteUserTrackerHandle tracker = nullptr;
  if (niteInitialize() != NITE_STATUS_OK || openni::OpenNI::initialize() != openni::STATUS_OK ||
      device.open(openni::ANY_DEVICE) != openni::STATUS_OK ||
      niteInitializeUserTrackerByDevice(&device, &tracker) != NITE_STATUS_OK) {
    return 1;
  }
  openni::VideoFrameRef depth;
  for (int i = 0; i < 3; ++i) {
    NiteUserTrackerFrame* frame = nullptr;
    if (niteReadUserTrackerFrame(tracker, &frame) != NITE_STATUS_OK) return 1;
    depth._setFrame(frame->pDepthFrame);
    int visible = 0;
    for (int u = 0; u < frame->userCount; ++u)
      visible += (frame->pUser[u].state & NITE_USER_STATE_VISIBLE) != 0 ? 1 : 0;
    long pixels = 0;
    for (int p = 0; p < frame->userMap.width * frame->userMap.height; ++p) {
      pixels += frame->userCount > 0 && frame->userMap.pixels[p] == frame->pUser[0].id ? 1 : 0;
    }
    std::printf("%llu %d %ld\n", frame->timestamp, visible, pixels);
    niteUserTrackerFrameRelease(tracker, frame);
    if (depth.getWidth() <= 0 || !depth.isValid()) return 1;
  }
  if (argc > 1) std::exit(0);
  niteShutdownUserTracker(tracker);
  depth.release();
  device.close();
  niteShutdown();
  openni::OpenNI::shutdown();
  return 0;
}

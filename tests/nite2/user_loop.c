/* What programs of the interface do: frames read one after the other, a skeleton for everybody. Reads as many frames as
   the argument says from the first device there is. Prints a line for each user: id, state, head in millimetres and its
   confidence, pixels. */

#include <NiteCAPI.h>
#include <stdio.h>
#include <stdlib.h>

#define VERIFY(call)                        \
  if ((call) != NITE_STATUS_OK) {           \
    fprintf(stderr, "failed: %s\n", #call); \
    exit(1);                                \
  }

static long pixels_of(const NiteUserMap* map, NiteUserId id) {
  long count = 0;
  for (int v = 0; v < map->height; ++v) {
    const NiteUserId* row = map->pixels + v * (map->stride / (int)sizeof(NiteUserId));
    for (int u = 0; u < map->width; ++u) count += row[u] == id;
  }
  return count;
}

int main(int argc, char** argv) {
  const int frames = argc > 1 ? atoi(argv[1]) : 0;
  NiteUserTrackerHandle tracker = NULL;
  VERIFY(niteInitialize());
  VERIFY(niteInitializeUserTracker(&tracker));
  for (int i = 0; i < frames; ++i) {
    NiteUserTrackerFrame* frame = NULL;
    VERIFY(niteReadUserTrackerFrame(tracker, &frame));
    printf("frame %llu\n", frame->timestamp);
    for (int u = 0; u < frame->userCount; ++u) {
      const NiteUserData* user = &frame->pUser[u];
      if (user->state & NITE_USER_STATE_NEW) VERIFY(niteStartSkeletonTracking(tracker, user->id));
      const NiteSkeletonJoint* head = &user->skeleton.joints[NITE_JOINT_HEAD];
      printf("%d %d: %d %.3f %.3f %.3f %.3f, %ld\n", user->id, user->state, (int)user->skeleton.state, head->position.x,
             head->position.y, head->position.z, head->positionConfidence, pixels_of(&frame->userMap, user->id));
    }
    VERIFY(niteUserTrackerFrameRelease(tracker, frame));
  }
  VERIFY(niteShutdownUserTracker(tracker));
  niteShutdown();
  return 0;
}

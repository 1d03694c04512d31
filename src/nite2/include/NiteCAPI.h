/* The C interface of NiTE 2.2, as vesalius's libNiTE2.so answers it (docs/nite2.md): the names, numbers and layouts
   that its programs were written for, described anew. Functions may be called from any thread. What was shut down or
   released, NULL and what is no handle are told: functions fail with NITE_STATUS_ERROR and one line on the error
   output. Without niteInitialize they fail with NITE_STATUS_OUT_OF_FLOW. */
#ifndef NITE_C_API_H
#define NITE_C_API_H

/* NOLINTBEGIN(modernize-*,bugprone-reserved-identifier): what is C is no old C++, and the names are theirs. */
#ifdef __cplusplus
#include <OniCTypes.h> /* of the program's OpenNI2 */
#else
#include <stdbool.h>
typedef struct OniFrame OniFrame; /* OpenNI2's own headers are C++ alone */
#endif

#ifndef NITE_API
#define NITE_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define NITE_JOINT_COUNT 15
#define NITE_POSE_COUNT 2

typedef enum {
  NITE_STATUS_OK,
  NITE_STATUS_ERROR,
  NITE_STATUS_BAD_USER_ID, /* nobody in the last frame that was read has this id */
  NITE_STATUS_OUT_OF_FLOW
} NiteStatus;

/* Left and right are the person's own, whether pictures are mirrored or not. */
typedef enum {
  NITE_JOINT_HEAD,
  NITE_JOINT_NECK,
  NITE_JOINT_LEFT_SHOULDER,
  NITE_JOINT_RIGHT_SHOULDER,
  NITE_JOINT_LEFT_ELBOW,
  NITE_JOINT_RIGHT_ELBOW,
  NITE_JOINT_LEFT_HAND,
  NITE_JOINT_RIGHT_HAND,
  NITE_JOINT_TORSO,
  NITE_JOINT_LEFT_HIP,
  NITE_JOINT_RIGHT_HIP,
  NITE_JOINT_LEFT_KNEE,
  NITE_JOINT_RIGHT_KNEE,
  NITE_JOINT_LEFT_FOOT,
  NITE_JOINT_RIGHT_FOOT
} NiteJointType;

/* Of these only the first and the third are given: nobody has to be calibrated. */
typedef enum {
  NITE_SKELETON_NONE, /* nobody asked for it */
  NITE_SKELETON_CALIBRATING,
  NITE_SKELETON_TRACKED,
  NITE_SKELETON_CALIBRATION_ERROR_NOT_IN_POSE,
  NITE_SKELETON_CALIBRATION_ERROR_HANDS,
  NITE_SKELETON_CALIBRATION_ERROR_HEAD,
  NITE_SKELETON_CALIBRATION_ERROR_LEGS,
  NITE_SKELETON_CALIBRATION_ERROR_TORSO
} NiteSkeletonState;

/* Bits of NiteUserData::state. Somebody who is not visible is expected to come back. */
typedef enum {
  NITE_USER_STATE_VISIBLE = 1,
  NITE_USER_STATE_NEW = 2, /* the first frame that has the user */
  NITE_USER_STATE_LOST = 4 /* the last one */
} NiteUserState;

typedef enum {
  NITE_POSE_PSI,          /* upper arms to the sides, forearms up */
  NITE_POSE_CROSSED_HANDS /* hands before the chest, each on the other's side */
} NitePoseType;

/* Bits of NitePoseData::state. */
typedef enum {
  NITE_POSE_STATE_DETECTING = 1,
  NITE_POSE_STATE_IN_POSE = 2,
  NITE_POSE_STATE_ENTER = 4,
  NITE_POSE_STATE_EXIT = 8
} NitePoseState;

typedef enum { NITE_GESTURE_WAVE, NITE_GESTURE_CLICK, NITE_GESTURE_HAND_RAISE } NiteGestureType;

typedef enum {
  NITE_GESTURE_STATE_NEW = 1,
  NITE_GESTURE_STATE_IN_PROGRESS = 2,
  NITE_GESTURE_STATE_COMPLETED = 4
} NiteGestureState;

typedef enum {
  NITE_HAND_STATE_LOST = 0,
  NITE_HAND_STATE_NEW = 1,
  NITE_HAND_STATE_TRACKED = 2,
  NITE_HAND_STATE_TOUCHING_FOV = 4
} NiteHandState;

typedef short NiteUserId; /* from 1 */
typedef short NiteHandId;

typedef struct NiteUserTracker* NiteUserTrackerHandle;
typedef struct NiteHandTracker* NiteHandTrackerHandle;

typedef struct {
  int major, minor, maintenance, build;
} NiteVersion;

/* Millimetres: x right in the picture, y up, z away from the camera. */
typedef struct {
  float x, y, z;
} NitePoint3f;

/* The turn from a T before the camera (arms to the sides, face to the camera), in the axes of NitePoint3f. */
typedef struct {
  float x, y, z, w;
} NiteQuaternion;

typedef struct {
  NiteJointType jointType;
  NitePoint3f position;
  float positionConfidence; /* the probability that it lies within 10 cm; 0: nobody knows, the next joint's is given */
  NiteQuaternion orientation;
  float orientationConfidence; /* the same, 0 where nobody knows the turn */
} NiteSkeletonJoint;

typedef struct {
  NiteSkeletonJoint joints[NITE_JOINT_COUNT];
  NiteSkeletonState state;
} NiteSkeleton;

typedef struct {
  NitePoint3f min, max;
} NiteBoundingBox;

typedef struct {
  NitePoseType type;
  int state;
} NitePoseData;

typedef struct {
  NiteUserId id;
  NiteBoundingBox boundingBox; /* of the user's pixels in the picture of depth; z in millimetres */
  NitePoint3f centerOfMass;    /* of what the camera sees */
  int state;
  NiteSkeleton skeleton;
  NitePoseData poses[NITE_POSE_COUNT];
} NiteUserData;

typedef struct {
  NiteUserId* pixels; /* 0 is nobody */
  int width, height;
  int stride; /* bytes of a row */
} NiteUserMap;

typedef struct {
  NitePoint3f point, normal;
} NitePlane;

typedef struct {
  int userCount;
  NiteUserData* pUser;
  NiteUserMap userMap;
  OniFrame* pDepthFrame;        /* in which they were found; it stays as long as this */
  unsigned long long timestamp; /* of that, as its index */
  int frameIndex;
  float floorConfidence; /* 1 or 0 */
  NitePlane floor;
} NiteUserTrackerFrame;

typedef struct {
  void (*readyForNextFrame)(void* cookie);
} NiteUserTrackerCallbacks;

typedef struct {
  NiteHandId id;
  NitePoint3f position;
  int state;
} NiteHandData;

typedef struct {
  NiteGestureType type;
  NitePoint3f currentPosition;
  int state;
} NiteGestureData;

typedef struct {
  int handCount;
  NiteHandData* pHands;
  int gestureCount;
  NiteGestureData* pGestures;
  OniFrame* pDepthFrame;
  unsigned long long timestamp;
  int frameIndex;
} NiteHandTrackerFrame;

typedef struct {
  void (*readyForNextFrame)(void* cookie);
} NiteHandTrackerCallbacks;

/* Begins, with the libOpenNI2 that the program has loaded or else that of the system; $VESALIUS_OPENNI2 names another.
   OpenNI is initialized too, and stays so. */
NITE_API NiteStatus niteInitialize(void);
/* Ends all trackers. Frames that were read stay. */
NITE_API void niteShutdown(void);
NITE_API NiteVersion niteGetVersion(void);

/* Makes a tracker on the depth of the first device there is. */
NITE_API NiteStatus niteInitializeUserTracker(NiteUserTrackerHandle* tracker);
/* The same on a device: the openni::Device of a program in C++, whose second pointer is the OniDeviceHandle. The mode
   and the mirroring of its depth stay as they are. */
NITE_API NiteStatus niteInitializeUserTrackerByDevice(void* device, NiteUserTrackerHandle* tracker);
NITE_API NiteStatus niteShutdownUserTracker(NiteUserTrackerHandle tracker);

/* Asks for somebody's skeleton, from the next frame on. */
NITE_API NiteStatus niteStartSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user);
NITE_API void niteStopSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user);
NITE_API bool niteIsSkeletonTracking(NiteUserTrackerHandle tracker, NiteUserId user);

/* How much joints are smoothed over time: 0 (as at first) not at all, 1 most. */
NITE_API NiteStatus niteSetSkeletonSmoothing(NiteUserTrackerHandle tracker, float factor);
NITE_API NiteStatus niteGetSkeletonSmoothing(NiteUserTrackerHandle tracker, float* factor);

NITE_API NiteStatus niteStartPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user, NitePoseType type);
NITE_API void niteStopPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user, NitePoseType type);
NITE_API void niteStopAllPoseDetection(NiteUserTrackerHandle tracker, NiteUserId user);

/* Has a function called in the tracker's thread when a frame can be read. Callbacks are known by their address. When
   the second function returns, theirs is not called any more. */
NITE_API NiteStatus niteRegisterUserTrackerCallbacks(NiteUserTrackerHandle tracker, NiteUserTrackerCallbacks* callbacks,
                                                     void* cookie);
NITE_API void niteUnregisterUserTrackerCallbacks(NiteUserTrackerHandle tracker, NiteUserTrackerCallbacks* callbacks);

/* Returns the newest frame that was not read, and waits for it for at most ten seconds. It has one reference, and is
   gone with the last. If it fails, the frame is an empty one without depth, which NiTE.h reads in any case. */
NITE_API NiteStatus niteReadUserTrackerFrame(NiteUserTrackerHandle tracker, NiteUserTrackerFrame** frame);
NITE_API NiteStatus niteUserTrackerFrameAddRef(NiteUserTrackerHandle tracker, NiteUserTrackerFrame* frame);
NITE_API NiteStatus niteUserTrackerFrameRelease(NiteUserTrackerHandle tracker, NiteUserTrackerFrame* frame);

/* Between millimetres and pixels of the picture of depth, as OpenNI's CoordinateConverter does. */
NITE_API NiteStatus niteConvertJointCoordinatesToDepth(NiteUserTrackerHandle tracker, float x, float y, float z,
                                                       float* out_x, float* out_y);
NITE_API NiteStatus niteConvertDepthCoordinatesToJoint(NiteUserTrackerHandle tracker, int x, int y, int z, float* out_x,
                                                       float* out_y);

/* Hands by themselves and gestures are not followed: all of these fail with NITE_STATUS_ERROR. */
NITE_API NiteStatus niteInitializeHandTracker(NiteHandTrackerHandle* tracker);
NITE_API NiteStatus niteInitializeHandTrackerByDevice(void* device, NiteHandTrackerHandle* tracker);
NITE_API NiteStatus niteShutdownHandTracker(NiteHandTrackerHandle tracker);
NITE_API NiteStatus niteStartHandTracking(NiteHandTrackerHandle tracker, const NitePoint3f* position, NiteHandId* hand);
NITE_API void niteStopHandTracking(NiteHandTrackerHandle tracker, NiteHandId hand);
NITE_API void niteStopAllHandTracking(NiteHandTrackerHandle tracker);
NITE_API NiteStatus niteSetHandSmoothingFactor(NiteHandTrackerHandle tracker, float factor);
NITE_API NiteStatus niteGetHandSmoothingFactor(NiteHandTrackerHandle tracker, float* factor);
NITE_API NiteStatus niteRegisterHandTrackerCallbacks(NiteHandTrackerHandle tracker, NiteHandTrackerCallbacks* callbacks,
                                                     void* cookie);
NITE_API void niteUnregisterHandTrackerCallbacks(NiteHandTrackerHandle tracker, NiteHandTrackerCallbacks* callbacks);
NITE_API NiteStatus niteReadHandTrackerFrame(NiteHandTrackerHandle tracker, NiteHandTrackerFrame** frame);
NITE_API NiteStatus niteHandTrackerFrameAddRef(NiteHandTrackerHandle tracker, NiteHandTrackerFrame* frame);
NITE_API NiteStatus niteHandTrackerFrameRelease(NiteHandTrackerHandle tracker, NiteHandTrackerFrame* frame);
NITE_API NiteStatus niteStartGestureDetection(NiteHandTrackerHandle tracker, NiteGestureType type);
NITE_API void niteStopGestureDetection(NiteHandTrackerHandle tracker, NiteGestureType type);
NITE_API void niteStopAllGestureDetection(NiteHandTrackerHandle tracker);
NITE_API NiteStatus niteConvertHandCoordinatesToDepth(NiteHandTrackerHandle tracker, float x, float y, float z,
                                                      float* out_x, float* out_y);
NITE_API NiteStatus niteConvertDepthCoordinatesToHand(NiteHandTrackerHandle tracker, int x, int y, int z, float* out_x,
                                                      float* out_y);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(modernize-*,bugprone-reserved-identifier) */

#endif

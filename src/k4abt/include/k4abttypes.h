/* Types of the interface of Azure Kinect Body Tracking: the names, numbers and layouts that its programs were written
   for, described anew. vesalius's libk4abt.so answers them (docs/k4abt.md). */
#ifndef K4ABTTYPES_H
#define K4ABTTYPES_H

/* NOLINTBEGIN(modernize-*,bugprone-reserved-identifier): what is C is no old C++, and the names are theirs. */
#include <k4a/k4atypes.h> /* of the program's libk4a */
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Finds the people of captures, one after the other; k4abt_tracker_create. */
K4A_DECLARE_HANDLE(k4abt_tracker_t);
/* The bodies of one capture, counted by references; k4abt_tracker_pop_result. */
K4A_DECLARE_HANDLE(k4abt_frame_t);

/* Left and right are the person's own. */
typedef enum {
  K4ABT_JOINT_PELVIS = 0,
  K4ABT_JOINT_SPINE_NAVEL,
  K4ABT_JOINT_SPINE_CHEST,
  K4ABT_JOINT_NECK,
  K4ABT_JOINT_CLAVICLE_LEFT,
  K4ABT_JOINT_SHOULDER_LEFT,
  K4ABT_JOINT_ELBOW_LEFT,
  K4ABT_JOINT_WRIST_LEFT,
  K4ABT_JOINT_HAND_LEFT,
  K4ABT_JOINT_HANDTIP_LEFT,
  K4ABT_JOINT_THUMB_LEFT,
  K4ABT_JOINT_CLAVICLE_RIGHT,
  K4ABT_JOINT_SHOULDER_RIGHT,
  K4ABT_JOINT_ELBOW_RIGHT,
  K4ABT_JOINT_WRIST_RIGHT,
  K4ABT_JOINT_HAND_RIGHT,
  K4ABT_JOINT_HANDTIP_RIGHT,
  K4ABT_JOINT_THUMB_RIGHT,
  K4ABT_JOINT_HIP_LEFT,
  K4ABT_JOINT_KNEE_LEFT,
  K4ABT_JOINT_ANKLE_LEFT,
  K4ABT_JOINT_FOOT_LEFT,
  K4ABT_JOINT_HIP_RIGHT,
  K4ABT_JOINT_KNEE_RIGHT,
  K4ABT_JOINT_ANKLE_RIGHT,
  K4ABT_JOINT_FOOT_RIGHT,
  K4ABT_JOINT_HEAD,
  K4ABT_JOINT_NOSE,
  K4ABT_JOINT_EYE_LEFT,
  K4ABT_JOINT_EAR_LEFT,
  K4ABT_JOINT_EYE_RIGHT,
  K4ABT_JOINT_EAR_RIGHT,
  K4ABT_JOINT_COUNT
} k4abt_joint_id_t;

/* How the camera is mounted, as seen by somebody who looks at its front. Results stay in the camera's own frame. */
typedef enum {
  K4ABT_SENSOR_ORIENTATION_DEFAULT = 0,
  K4ABT_SENSOR_ORIENTATION_CLOCKWISE90,
  K4ABT_SENSOR_ORIENTATION_COUNTERCLOCKWISE90,
  K4ABT_SENSOR_ORIENTATION_FLIP180
} k4abt_sensor_orientation_t;

/* Taken and ignored: people are found on the processor. */
typedef enum {
  K4ABT_TRACKER_PROCESSING_MODE_GPU = 0,
  K4ABT_TRACKER_PROCESSING_MODE_CPU,
  K4ABT_TRACKER_PROCESSING_MODE_GPU_CUDA,
  K4ABT_TRACKER_PROCESSING_MODE_GPU_TENSORRT,
  K4ABT_TRACKER_PROCESSING_MODE_GPU_DIRECTML
} k4abt_tracker_processing_mode_t;

typedef struct _k4abt_tracker_configuration_t {
  k4abt_sensor_orientation_t sensor_orientation;
  k4abt_tracker_processing_mode_t processing_mode;
  int32_t gpu_device_id;  /* ignored */
  const char* model_path; /* a model of vesalius; NULL or an .onnx file: the usual one */
} k4abt_tracker_configuration_t;

typedef union {
  struct _wxyz {
    float w, x, y, z;
  } wxyz;
  float v[4];
} k4a_quaternion_t;

/* By the probability that the joint lies within 10 cm of its place: LOW below 0.5, MEDIUM from there on. NONE: nobody
   knows, and the joint has its parent's place. HIGH is never given. */
typedef enum {
  K4ABT_JOINT_CONFIDENCE_NONE = 0,
  K4ABT_JOINT_CONFIDENCE_LOW,
  K4ABT_JOINT_CONFIDENCE_MEDIUM,
  K4ABT_JOINT_CONFIDENCE_HIGH,
  K4ABT_JOINT_CONFIDENCE_LEVELS_COUNT
} k4abt_joint_confidence_level_t;

typedef struct _k4abt_joint_t {
  k4a_float3_t position;        /* millimetres in the depth camera's frame: x right, y down, z forward */
  k4a_quaternion_t orientation; /* depth camera's frame from the joint's axes (docs/tracking.md) */
  k4abt_joint_confidence_level_t confidence_level;
} k4abt_joint_t;

typedef struct {
  k4abt_joint_t joints[K4ABT_JOINT_COUNT];
} k4abt_skeleton_t;

typedef struct _k4abt_body_t {
  uint32_t id; /* from 1; the same for one person, never of two */
  k4abt_skeleton_t skeleton;
} k4abt_body_t;

#define K4ABT_BODY_INDEX_MAP_BACKGROUND 255
#define K4ABT_INVALID_BODY_ID 0xFFFFFFFF
#define K4ABT_DEFAULT_TRACKER_SMOOTHING_FACTOR 0.0f

/* Where it is not used, compilers should not mind. */
#if defined(__GNUC__)
__attribute__((unused))
#endif
static const k4abt_tracker_configuration_t K4ABT_TRACKER_CONFIG_DEFAULT = {
    K4ABT_SENSOR_ORIENTATION_DEFAULT, K4ABT_TRACKER_PROCESSING_MODE_GPU_CUDA, 0, NULL};

#ifdef __cplusplus
}
#endif

/* NOLINTEND(modernize-*,bugprone-reserved-identifier) */

#endif

/* What libk4abt takes of the interface of libk4a, the library of Azure Kinect cameras: names, numbers and layouts, no
   text. It stands in for <k4a/k4atypes.h> where this project is built and is not installed: programs have that of their
   libk4a. */
#ifndef K4ATYPES_H
#define K4ATYPES_H

/* NOLINTBEGIN(modernize-*,bugprone-reserved-identifier): what is C is no old C++, and the names are theirs. */
#include <stddef.h>
#include <stdint.h>

/* A handle is a pointer to something of the library's own. */
#define K4A_DECLARE_HANDLE(name)        \
  typedef struct _handle_##name {       \
    size_t _rsvd; /* nobody reads it */ \
  } * name

K4A_DECLARE_HANDLE(k4a_capture_t);
K4A_DECLARE_HANDLE(k4a_image_t);

typedef enum { K4A_RESULT_SUCCEEDED = 0, K4A_RESULT_FAILED } k4a_result_t;
typedef enum { K4A_WAIT_RESULT_SUCCEEDED = 0, K4A_WAIT_RESULT_FAILED, K4A_WAIT_RESULT_TIMEOUT } k4a_wait_result_t;
#define K4A_WAIT_INFINITE (-1)

typedef enum {
  K4A_DEPTH_MODE_OFF = 0,
  K4A_DEPTH_MODE_NFOV_2X2BINNED,
  K4A_DEPTH_MODE_NFOV_UNBINNED,
  K4A_DEPTH_MODE_WFOV_2X2BINNED,
  K4A_DEPTH_MODE_WFOV_UNBINNED,
  K4A_DEPTH_MODE_PASSIVE_IR
} k4a_depth_mode_t;

typedef enum {
  K4A_COLOR_RESOLUTION_OFF = 0,
  K4A_COLOR_RESOLUTION_720P,
  K4A_COLOR_RESOLUTION_1080P,
  K4A_COLOR_RESOLUTION_1440P,
  K4A_COLOR_RESOLUTION_1536P,
  K4A_COLOR_RESOLUTION_2160P,
  K4A_COLOR_RESOLUTION_3072P
} k4a_color_resolution_t;

typedef enum {
  K4A_IMAGE_FORMAT_COLOR_MJPG = 0,
  K4A_IMAGE_FORMAT_COLOR_NV12,
  K4A_IMAGE_FORMAT_COLOR_YUY2,
  K4A_IMAGE_FORMAT_COLOR_BGRA32,
  K4A_IMAGE_FORMAT_DEPTH16,
  K4A_IMAGE_FORMAT_IR16,
  K4A_IMAGE_FORMAT_CUSTOM8,
  K4A_IMAGE_FORMAT_CUSTOM16,
  K4A_IMAGE_FORMAT_CUSTOM
} k4a_image_format_t;

typedef enum {
  K4A_CALIBRATION_TYPE_UNKNOWN = -1,
  K4A_CALIBRATION_TYPE_DEPTH,
  K4A_CALIBRATION_TYPE_COLOR,
  K4A_CALIBRATION_TYPE_GYRO,
  K4A_CALIBRATION_TYPE_ACCEL,
  K4A_CALIBRATION_TYPE_NUM
} k4a_calibration_type_t;

typedef enum {
  K4A_CALIBRATION_LENS_DISTORTION_MODEL_UNKNOWN = 0,
  K4A_CALIBRATION_LENS_DISTORTION_MODEL_THETA,
  K4A_CALIBRATION_LENS_DISTORTION_MODEL_POLYNOMIAL_3K,
  K4A_CALIBRATION_LENS_DISTORTION_MODEL_RATIONAL_6KT,
  K4A_CALIBRATION_LENS_DISTORTION_MODEL_BROWN_CONRADY
} k4a_calibration_model_type_t;

typedef union {
  struct _xyz {
    float x, y, z;
  } xyz;
  float v[3];
} k4a_float3_t;

/* Row by row; millimetres. */
typedef struct _k4a_calibration_extrinsics_t {
  float rotation[9];
  float translation[3];
} k4a_calibration_extrinsics_t;

/* Of pictures of the mode in pixels, whose centres are whole numbers. */
typedef union {
  struct _param {
    float cx, cy, fx, fy, k1, k2, k3, k4, k5, k6, codx, cody, p2, p1, metric_radius;
  } param;
  float v[15];
} k4a_calibration_intrinsic_parameters_t;

typedef struct _k4a_calibration_intrinsics_t {
  k4a_calibration_model_type_t type;
  unsigned int parameter_count;
  k4a_calibration_intrinsic_parameters_t parameters;
} k4a_calibration_intrinsics_t;

typedef struct _k4a_calibration_camera_t {
  k4a_calibration_extrinsics_t extrinsics;
  k4a_calibration_intrinsics_t intrinsics;
  int resolution_width, resolution_height;
  float metric_radius;
} k4a_calibration_camera_t;

/* extrinsics[a][b] takes points from a to b. */
typedef struct _k4a_calibration_t {
  k4a_calibration_camera_t depth_camera_calibration;
  k4a_calibration_camera_t color_camera_calibration;
  k4a_calibration_extrinsics_t extrinsics[K4A_CALIBRATION_TYPE_NUM][K4A_CALIBRATION_TYPE_NUM];
  k4a_depth_mode_t depth_mode;
  k4a_color_resolution_t color_resolution;
} k4a_calibration_t;

/* NOLINTEND(modernize-*,bugprone-reserved-identifier) */

#endif

/* What of OpenNI2's types and numbers is needed here, in place of the program's header: names, numbers and layouts are
   theirs. Not installed. */
#ifndef ONI_C_TYPES_STAND_IN_H
#define ONI_C_TYPES_STAND_IN_H

/* NOLINTBEGIN(modernize-*,bugprone-reserved-identifier): what is C is no old C++, and the names are theirs. */
#include <stdint.h>

typedef int OniBool;

/* 2.2 */
#define ONI_API_VERSION 2002

typedef enum {
  ONI_STATUS_OK = 0,
  ONI_STATUS_ERROR = 1,
  ONI_STATUS_NOT_SUPPORTED = 3,
  ONI_STATUS_NO_DEVICE = 6,
  ONI_STATUS_TIME_OUT = 102
} OniStatus;

typedef enum { ONI_SENSOR_DEPTH = 3 } OniSensorType;

typedef enum { ONI_PIXEL_FORMAT_DEPTH_1_MM = 100, ONI_PIXEL_FORMAT_DEPTH_100_UM = 101 } OniPixelFormat;

enum { ONI_DEVICE_PROPERTY_PLAYBACK_SPEED = 100 };

enum {
  ONI_STREAM_PROPERTY_HORIZONTAL_FOV = 1, /* float, radians */
  ONI_STREAM_PROPERTY_VERTICAL_FOV = 2,
  ONI_STREAM_PROPERTY_VIDEO_MODE = 3,
  ONI_STREAM_PROPERTY_MIRRORING = 7 /* OniBool */
};

typedef struct {
  OniPixelFormat pixelFormat;
  int resolutionX, resolutionY;
  int fps;
} OniVideoMode;

typedef struct _OniDevice* OniDeviceHandle;
typedef struct _OniStream* OniStreamHandle;

typedef struct {
  int dataSize;
  void* data;
  OniSensorType sensorType;
  uint64_t timestamp; /* microseconds */
  int frameIndex;
  int width, height;
  OniVideoMode videoMode; /* of the whole picture, of which a cropped one is a part */
  OniBool croppingEnabled;
  int cropOriginX, cropOriginY;
  int stride; /* bytes of a row */
} OniFrame;

/* NOLINTEND(modernize-*,bugprone-reserved-identifier) */

#endif

/* See the header. A device that is opened plays the file that FAKE_OPENNI2 names, if it names one: a FakeView, then for
   each picture its time (uint64, microseconds) and its depth. */

#include "fake_openni2.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct Counted {
  OniFrame frame; /* first, so that both have one address */
  atomic_int references;
  struct Counted* next;
} Counted;

struct _OniStream {
  struct _OniDevice* device;
};

struct _OniDevice {
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  FakeView view;
  Counted *first, *last; /* pictures that nobody has read */
  int fails;
};

static atomic_int held;

int fake_held(void) { return held; }

OniStatus oniInitialize(int version) { return version == ONI_API_VERSION ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED; }
void oniShutdown(void) {}
const char* oniGetExtendedError(void) { return "\tthe fake\n\tfails\n"; }

void oniFrameAddRef(OniFrame* frame) { ++((Counted*)frame)->references; }

void oniFrameRelease(OniFrame* frame) {
  Counted* of = (Counted*)frame;
  if (--of->references > 0) return;
  free(of->frame.data);
  free(of);
  --held;
}

static void push(OniDeviceHandle device, const OniFrame* like, const void* data) {
  Counted* made = calloc(1, sizeof *made);
  made->references = 1;
  made->frame = *like;
  made->frame.data = malloc((size_t)like->dataSize);
  memcpy(made->frame.data, data, (size_t)like->dataSize);
  ++held;
  pthread_mutex_lock(&device->mutex);
  while (!device->view.is_recording && device->first) {
    Counted* old = device->first;
    device->first = old->next;
    oniFrameRelease(&old->frame);
  }
  if (device->first) {
    device->last->next = made;
  } else {
    device->first = made;
  }
  device->last = made;
  pthread_cond_broadcast(&device->changed);
  pthread_mutex_unlock(&device->mutex);
}

void fake_push(OniDeviceHandle device, const OniFrame* frame, const void* data) { push(device, frame, data); }

void fake_set_view(OniDeviceHandle device, const FakeView* view) {
  pthread_mutex_lock(&device->mutex);
  device->view = *view;
  pthread_mutex_unlock(&device->mutex);
}

void fake_fail(OniDeviceHandle device) {
  pthread_mutex_lock(&device->mutex);
  device->fails = 1;
  pthread_cond_broadcast(&device->changed);
  pthread_mutex_unlock(&device->mutex);
}

static void play(OniDeviceHandle device, const char* path) {
  FILE* file = fopen(path, "rb");
  if (!file || fread(&device->view, sizeof device->view, 1, file) != 1) abort();
  const FakeView* view = &device->view;
  OniFrame frame;
  memset(&frame, 0, sizeof frame);
  frame.dataSize = view->width * view->height * 2;
  frame.width = view->width;
  frame.height = view->height;
  frame.stride = view->width * 2;
  frame.sensorType = ONI_SENSOR_DEPTH;
  frame.videoMode.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM;
  frame.videoMode.resolutionX = view->width;
  frame.videoMode.resolutionY = view->height;
  frame.videoMode.fps = 30;
  void* depth = malloc((size_t)frame.dataSize);
  while (fread(&frame.timestamp, sizeof frame.timestamp, 1, file) == 1 &&
         fread(depth, (size_t)frame.dataSize, 1, file) == 1) {
    ++frame.frameIndex;
    push(device, &frame, depth);
  }
  free(depth);
  fclose(file);
}

OniStatus oniDeviceOpen(const char* uri, OniDeviceHandle* device) {
  if (uri && !strcmp(uri, "none")) return ONI_STATUS_NO_DEVICE;
  OniDeviceHandle made = calloc(1, sizeof *made);
  pthread_mutex_init(&made->mutex, NULL);
  pthread_condattr_t clock;
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&made->changed, &clock);
  ++held;
  if (getenv("FAKE_OPENNI2")) play(made, getenv("FAKE_OPENNI2"));
  *device = made;
  return ONI_STATUS_OK;
}

OniStatus oniDeviceClose(OniDeviceHandle device) {
  while (device->first) {
    Counted* old = device->first;
    device->first = old->next;
    oniFrameRelease(&old->frame);
  }
  free(device);
  --held;
  return ONI_STATUS_OK;
}

OniStatus oniDeviceGetProperty(OniDeviceHandle device, int id, void* data, int* size) {
  if (id != ONI_DEVICE_PROPERTY_PLAYBACK_SPEED || !device->view.is_recording) return ONI_STATUS_NOT_SUPPORTED;
  *(float*)data = -1.F;
  *size = sizeof(float);
  return ONI_STATUS_OK;
}

OniStatus oniDeviceCreateStream(OniDeviceHandle device, OniSensorType sensor, OniStreamHandle* stream) {
  if (sensor != ONI_SENSOR_DEPTH || device->fails) return ONI_STATUS_ERROR;
  *stream = malloc(sizeof **stream);
  (*stream)->device = device;
  ++held;
  return ONI_STATUS_OK;
}

OniStatus oniStreamGetProperty(OniStreamHandle stream, int id, void* data, int* size) {
  OniDeviceHandle device = stream->device;
  pthread_mutex_lock(&device->mutex);
  const FakeView view = device->view;
  pthread_mutex_unlock(&device->mutex);
  const OniVideoMode mode = {ONI_PIXEL_FORMAT_DEPTH_1_MM, view.width, view.height, 30};
  const void* from = NULL;
  switch (id) {
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      from = &view.across_rad, *size = sizeof(float);
      break;
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      from = &view.down_rad, *size = sizeof(float);
      break;
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      from = &mode, *size = sizeof mode;
      break;
    case ONI_STREAM_PROPERTY_MIRRORING:
      from = &view.mirrored, *size = sizeof(int);
      break;
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
  memcpy(data, from, (size_t)*size);
  return ONI_STATUS_OK;
}

OniStatus oniStreamStart(OniStreamHandle stream) {
  (void)stream;
  return ONI_STATUS_OK;
}
void oniStreamStop(OniStreamHandle stream) { (void)stream; }
void oniStreamDestroy(OniStreamHandle stream) {
  free(stream);
  --held;
}

OniStatus oniWaitForAnyStream(OniStreamHandle* streams, int count, int* index, int timeout_ms) {
  if (count != 1) return ONI_STATUS_ERROR;
  OniDeviceHandle device = streams[0]->device;
  struct timespec until;
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += timeout_ms * 1000000L;
  until.tv_sec += until.tv_nsec / 1000000000L;
  until.tv_nsec %= 1000000000L;
  int late = 0;
  pthread_mutex_lock(&device->mutex);
  while (!device->first && !device->fails && !late) {
    late = pthread_cond_timedwait(&device->changed, &device->mutex, &until) != 0;
  }
  const OniStatus status = device->fails ? ONI_STATUS_ERROR : device->first ? ONI_STATUS_OK : ONI_STATUS_TIME_OUT;
  pthread_mutex_unlock(&device->mutex);
  *index = 0;
  return status;
}

OniStatus oniStreamReadFrame(OniStreamHandle stream, OniFrame** frame) {
  OniDeviceHandle device = stream->device;
  pthread_mutex_lock(&device->mutex);
  Counted* read = device->first;
  if (read) device->first = read->next;
  pthread_mutex_unlock(&device->mutex);
  if (!read) return ONI_STATUS_ERROR;
  *frame = &read->frame;
  return ONI_STATUS_OK;
}

/* An OpenNI2 without a camera: devices whose pictures a test gives them. */
#ifndef FAKE_OPENNI2_H
#define FAKE_OPENNI2_H

#include <OniCTypes.h>

#ifdef __cplusplus
extern "C" {
#endif

OniStatus oniInitialize(int version);
void oniShutdown(void);
const char* oniGetExtendedError(void);
OniStatus oniDeviceOpen(const char* uri, OniDeviceHandle* device);
OniStatus oniDeviceClose(OniDeviceHandle device);
OniStatus oniDeviceGetProperty(OniDeviceHandle device, int id, void* data, int* size);
OniStatus oniDeviceCreateStream(OniDeviceHandle device, OniSensorType sensor, OniStreamHandle* stream);
OniStatus oniStreamGetProperty(OniStreamHandle stream, int id, void* data, int* size);
OniStatus oniStreamStart(OniStreamHandle stream);
void oniStreamStop(OniStreamHandle stream);
void oniStreamDestroy(OniStreamHandle stream);
OniStatus oniWaitForAnyStream(OniStreamHandle* streams, int count, int* index, int timeout_ms);
OniStatus oniStreamReadFrame(OniStreamHandle stream, OniFrame** frame);
void oniFrameAddRef(OniFrame* frame);
void oniFrameRelease(OniFrame* frame);

/* How a device sees. A recording keeps all pictures until they are read, a camera the newest. */
typedef struct {
  int width, height;
  float across_rad, down_rad;
  int mirrored;
  int is_recording;
} FakeView;

void fake_set_view(OniDeviceHandle device, const FakeView* view);
/* Gives a picture: `frame` without its data, which is copied. */
void fake_push(OniDeviceHandle device, const OniFrame* frame, const void* data);
/* From now on the device fails. */
void fake_fail(OniDeviceHandle device);
/* Devices, streams and frames that somebody still has. */
int fake_held(void);

#ifdef __cplusplus
}
#endif

#endif

// Records the camera of openni_driver.cpp with OpenNI2's recorder, for other_side.py.
// usage: openni_record PICTURES FILE.oni SECONDS LOSSY
#include <OpenNI.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

int main(int count, char** words) {
  if (count != 5) return 2;
  const bool is_lossy = std::atoi(words[4]) != 0;
  openni::Device camera;
  openni::VideoStream depth, colour;
  openni::Recorder recorder;
  if (openni::OpenNI::initialize() != openni::STATUS_OK || camera.open(words[1]) != openni::STATUS_OK ||
      depth.create(camera, openni::SENSOR_DEPTH) != openni::STATUS_OK ||
      colour.create(camera, openni::SENSOR_COLOR) != openni::STATUS_OK ||
      recorder.create(words[2]) != openni::STATUS_OK || recorder.attach(depth) != openni::STATUS_OK ||
      recorder.attach(colour, is_lossy) != openni::STATUS_OK || recorder.start() != openni::STATUS_OK) {
    std::fprintf(stderr, "OpenNI2: %s\n", openni::OpenNI::getExtendedError());
    return 1;
  }
  usleep(200000);  // the recorder starts in a thread of its own
  depth.start();
  colour.start();
  usleep(static_cast<useconds_t>(1e6 * std::atof(words[3])));
  depth.stop();
  colour.stop();
  recorder.stop();
  recorder.destroy();
  std::fflush(nullptr);
  _exit(0);  // some drivers do not stand a shutdown
}

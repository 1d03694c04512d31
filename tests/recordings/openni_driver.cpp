// A driver of OpenNI2 whose camera plays pictures out of a file, for other_side.py: OpenNI2's own recorder then writes
// them. The camera's address is the file: width, height, number of pictures (int32), focal lengths fx, fy (float32),
// then for each picture its depth (uint16, millimetres) and its colour (RGB).
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete pointer
#include <Driver/OniDriverAPI.h>

namespace {

constexpr int kFrame_us = 33333;
constexpr std::chrono::milliseconds kPace(15);

struct Pictures {
  std::int32_t width = 0, height = 0, count = 0;
  float fx = 0.F, fy = 0.F;
  std::string bytes;

  bool read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(&width), sizeof(width));
    file.read(reinterpret_cast<char*>(&height), sizeof(height));
    file.read(reinterpret_cast<char*>(&count), sizeof(count));
    file.read(reinterpret_cast<char*>(&fx), sizeof(fx));
    file.read(reinterpret_cast<char*>(&fy), sizeof(fy));
    if (!file) return false;
    bytes.assign(std::istreambuf_iterator<char>(file), {});
    return bytes.size() == static_cast<std::size_t>(count) * width * height * 5;
  }
};

class Stream final : public oni::driver::StreamBase {
 public:
  Stream(const Pictures& pictures, bool is_depth) : pictures_(pictures), is_depth_(is_depth) {}
  ~Stream() override { stop(); }

  OniStatus start() override {
    running_ = true;
    thread_ = std::thread([this] { play(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(mode(), data, size);
    if (id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV)
      return give(2.F * std::atan(0.5F * pictures_.width / pictures_.fx), data, size);
    if (id == ONI_STREAM_PROPERTY_VERTICAL_FOV)
      return give(2.F * std::atan(0.5F * pictures_.height / pictures_.fy), data, size);
    if (id == ONI_STREAM_PROPERTY_MAX_VALUE && is_depth_) return give(65535, data, size);
    if (id == ONI_STREAM_PROPERTY_MIRRORING) return give(OniBool{FALSE}, data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
           id == ONI_STREAM_PROPERTY_VERTICAL_FOV || id == ONI_STREAM_PROPERTY_MIRRORING;
  }

 private:
  template <class T>
  static OniStatus give(T value, void* data, int* size) {
    if (*size != static_cast<int>(sizeof(value))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(value));
    return ONI_STATUS_OK;
  }
  OniVideoMode mode() const {
    return {is_depth_ ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888, pictures_.width, pictures_.height, 30};
  }

  void play() {
    const int pixels = pictures_.width * pictures_.height;
    const int size = pixels * (is_depth_ ? 2 : 3);
    for (int i = 0; i < pictures_.count && running_; ++i) {
      OniFrame* frame = getServices().acquireFrame();
      if (frame == nullptr) return;
      std::memcpy(frame->data, pictures_.bytes.data() + std::size_t(i) * pixels * 5 + (is_depth_ ? 0 : pixels * 2),
                  size);
      frame->dataSize = size;
      frame->frameIndex = i + 1;
      frame->timestamp = 1000 + std::uint64_t(i) * kFrame_us;
      frame->videoMode = mode();
      frame->width = pictures_.width;
      frame->height = pictures_.height;
      frame->stride = size / pictures_.height;
      frame->cropOriginX = frame->cropOriginY = 0;
      frame->croppingEnabled = FALSE;
      frame->sensorType = is_depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
      raiseNewFrame(frame);
      getServices().releaseFrame(frame);
      std::this_thread::sleep_for(kPace);
    }
  }

  const Pictures& pictures_;
  bool is_depth_;
  std::atomic<bool> running_{false};
  std::thread thread_;
};

class Camera final : public oni::driver::DeviceBase {
 public:
  bool open(const std::string& path) {
    if (!pictures_.read(path)) return false;
    for (int s = 0; s < 2; ++s) {
      modes_[s] = {s == 0 ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888, pictures_.width, pictures_.height,
                   30};
      sensors_[s] = {s == 0 ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR, 1, &modes_[s]};
    }
    return true;
  }
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return new Stream(pictures_, type == ONI_SENSOR_DEPTH);
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

 private:
  Pictures pictures_;
  OniVideoMode modes_[2] = {};
  OniSensorInfo sensors_[2] = {};
};

class Driver final : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}
  OniStatus tryDevice(const char* uri) override {
    if (!Pictures().read(uri)) return ONI_STATUS_ERROR;
    std::strncpy(info_.uri, uri, sizeof(info_.uri) - 1);
    std::strncpy(info_.name, "of a file", sizeof(info_.name) - 1);
    deviceConnected(&info_);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    auto* camera = new Camera;
    if (camera->open(uri)) return camera;
    delete camera;
    return nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* camera) override { delete camera; }
  void shutdown() override {}

 private:
  OniDeviceInfo info_ = {};
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)

// A driver of OpenNI2 for other_side.py, which compiles it: its one device plays the pictures of a file over and over,
// each when somebody waits for it. The file, which VESALIUS_PICTURES names: width and height (int32), fields of view
// across and down (float), whether it is mirrored (int32), microseconds from picture to picture (int32), then depth.

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(object) delete object
#include <Driver/OniDriverAPI.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <vector>

namespace {

const char* const kUri = "vesalius-pictures";

struct Pictures {
  std::int32_t width = 0, height = 0;
  float across_rad = 0.F, down_rad = 0.F;
  std::int32_t mirrored = 0, step_usec = 0;
};

template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size < int(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  *size = sizeof value;
  return ONI_STATUS_OK;
}

class DepthStream final : public oni::driver::StreamBase {
 public:
  explicit DepthStream(const char* path) : file_(path, std::ios::binary) {
    file_.read(reinterpret_cast<char*>(&pictures_), sizeof pictures_);
    depth_.resize(std::size_t(pictures_.width) * std::size_t(pictures_.height));
  }

  OniVideoMode mode() const { return {ONI_PIXEL_FORMAT_DEPTH_1_MM, pictures_.width, pictures_.height, 30}; }

  OniStatus start() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_running_ = true;
    return ONI_STATUS_OK;
  }
  void stop() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_running_ = false;
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV || id == ONI_STREAM_PROPERTY_VERTICAL_FOV ||
           id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_MIRRORING;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV) return give(pictures_.across_rad, data, size);
    if (id == ONI_STREAM_PROPERTY_VERTICAL_FOV) return give(pictures_.down_rad, data, size);
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(mode(), data, size);
    if (id == ONI_STREAM_PROPERTY_MIRRORING) return give(OniBool(pictures_.mirrored), data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }

  void raise_next() {
    OniFrame* frame = nullptr;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!is_running_ || (frame = getServices().acquireFrame()) == nullptr) return;
      const auto bytes = std::streamsize(depth_.size() * sizeof depth_[0]);
      if (!file_.read(reinterpret_cast<char*>(depth_.data()), bytes)) {
        file_.clear();
        file_.seekg(sizeof pictures_);
        file_.read(reinterpret_cast<char*>(depth_.data()), bytes);
      }
      std::memcpy(frame->data, depth_.data(), std::size_t(bytes));
      frame->dataSize = int(bytes);
      frame->sensorType = ONI_SENSOR_DEPTH;
      frame->timestamp = std::uint64_t(count_) * std::uint64_t(pictures_.step_usec);
      frame->frameIndex = ++count_;
      frame->width = pictures_.width;
      frame->height = pictures_.height;
      frame->videoMode = mode();
      frame->croppingEnabled = FALSE;
      frame->cropOriginX = frame->cropOriginY = 0;
      frame->stride = pictures_.width * 2;
    }
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  std::ifstream file_;
  Pictures pictures_;
  std::mutex mutex_;
  std::vector<std::uint16_t> depth_;
  bool is_running_ = false;
  int count_ = 0;
};

class PlayingDevice final : public oni::driver::DeviceBase {
 public:
  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
    static OniVideoMode mode = DepthStream(std::getenv("VESALIUS_PICTURES")).mode();
    static OniSensorInfo depth{ONI_SENSOR_DEPTH, 1, &mode};
    *infos = &depth;
    *count = 1;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    if (sensor != ONI_SENSOR_DEPTH) return nullptr;
    return stream_ = new DepthStream(std::getenv("VESALIUS_PICTURES"));
  }
  void destroyStream(oni::driver::StreamBase* stream) override {
    stream_ = nullptr;
    delete stream;
  }
  OniBool isPropertySupported(int id) override { return id == ONI_DEVICE_PROPERTY_PLAYBACK_SPEED; }
  OniStatus getProperty(int id, void* data, int* size) override {
    return id == ONI_DEVICE_PROPERTY_PLAYBACK_SPEED ? give(-1.F, data, size) : ONI_STATUS_NOT_SUPPORTED;
  }
  OniStatus tryManualTrigger() override {
    if (stream_ != nullptr) stream_->raise_next();
    return ONI_STATUS_OK;
  }

 private:
  DepthStream* stream_ = nullptr;
};

class Driver final : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    OniDeviceInfo info{};
    std::strcpy(info.uri, kUri);
    std::strcpy(info.vendor, "vesalius");
    std::strcpy(info.name, "pictures");
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    return std::strcmp(uri, kUri) == 0 ? new PlayingDevice : nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)

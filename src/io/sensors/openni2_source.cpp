#include <OpenNI.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "io/files/image_bytes.h"
#include "io/sensors/live_source.h"
#include "io/sensors/sensor_drivers.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// How far a colour picture's time may lie from depth's: half the time between two frames.
constexpr std::int64_t kMostApart_us = 17'000;
constexpr int kColourPatience_ms = 20;
/// How long a stopped stream is kept. Some drivers (OpenNI2's own Dummy) do not wait in `stop` for the thread that
/// makes their frames; it goes on with the stream until the next one, 33 ms away.
constexpr std::chrono::milliseconds kUntilThreadsEnd(200);

std::string reason() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& c : text) c = c == '\n' || c == '\t' ? ' ' : c;
  while (!text.empty() && text.back() == ' ') text.pop_back();
  text.erase(0, text.find_first_not_of(' '));
  return text.empty() ? "no reason given" : text;
}

void expect(openni::Status status, const std::string& what) {
  if (status != openni::STATUS_OK) throw Error(fmt::format("{}: {}", what, reason()));
}

/// Starts the library once. It is never shut down: some of its drivers crash then, and the process ends anyway.
void start_library() {
  static const openni::Status status = openni::OpenNI::initialize();
  expect(status, "openni2: the library does not start");
}

std::string serial_of(const openni::Device& device) {
  std::array<char, 256> text{};
  int size = int(text.size() - 1);
  if (device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, text.data(), &size) != openni::STATUS_OK) return "";
  return text.data();
}

/// A camera and where it is plugged in.
struct Found {
  SensorInfo info;
  std::string address;
};

std::vector<Found> all_plugged_in() {
  start_library();
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  std::vector<Found> found;
  for (int i = 0; i < devices.getSize(); ++i) {
    const std::string address = devices[i].getUri();
    openni::Device device;
    // One that another program uses cannot be asked for its number.
    const std::string serial = device.open(address.c_str()) == openni::STATUS_OK ? serial_of(device) : "";
    found.push_back(
        {{serial.empty() ? address : serial, fmt::format("{} {}", devices[i].getVendor(), devices[i].getName())},
         address});
  }
  return found;
}

std::vector<SensorInfo> infos_of(const std::vector<Found>& found) {
  std::vector<SensorInfo> infos;
  for (const Found& one : found) infos.push_back(one.info);
  return infos;
}

/// Opens the camera with this id. An id that is none of those plugged in may be an address that is not listed.
void open_device(openni::Device& device, const std::string& id, const std::string& place) {
  const std::vector<Found> found = all_plugged_in();
  const auto known = std::ranges::find(found, id, [](const Found& f) { return f.info.id; });
  if (known == found.end() && !id.empty() && device.open(id.c_str()) == openni::STATUS_OK) return;
  expect_plugged_in("openni2", infos_of(found), id);
  const std::string& address = id.empty() ? found.front().address : known->address;
  if (device.open(address.c_str()) != openni::STATUS_OK) fail_to_open(place, reason());
}

/// Sets the mode that is wanted where the camera has it.
void choose_mode(openni::VideoStream& stream, openni::PixelFormat format, int width, int height) {
  const auto& modes = stream.getSensorInfo().getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    const openni::VideoMode& mode = modes[i];
    if (mode.getPixelFormat() == format && mode.getResolutionX() == width && mode.getResolutionY() == height &&
        mode.getFps() == kCameraRate) {
      stream.setVideoMode(mode);
      return;
    }
  }
}

class Openni2Source final : public LiveSource {
 public:
  explicit Openni2Source(const std::string& id) : LiveSource("openni2", id) {
    open_device(device_, id, place_);
    expect(depth_.create(device_, openni::SENSOR_DEPTH), place_ + " has no depth");
    choose_mode(depth_, openni::PIXEL_FORMAT_DEPTH_1_MM, kCameraWidth, kCameraHeight);
    const openni::VideoMode mode = depth_.getVideoMode();
    if (mode.getPixelFormat() != openni::PIXEL_FORMAT_DEPTH_1_MM &&
        mode.getPixelFormat() != openni::PIXEL_FORMAT_DEPTH_100_UM) {
      throw Error(fmt::format("{}: depth of format {}, expected millimetres", place_, int(mode.getPixelFormat())));
    }
    per_mm_ = mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM ? 10 : 1;
    depth_.setMirroringEnabled(false);
    start_colour(mode.getResolutionX(), mode.getResolutionY());
    set_camera(mode.getResolutionX(), mode.getResolutionY());
    expect(depth_.start(), place_ + ": depth does not start");
  }

  ~Openni2Source() override {
    depth_.stop();
    colour_.stop();
    std::this_thread::sleep_for(kUntilThreadsEnd);
    depth_.destroy();
    colour_.destroy();
    device_.close();
  }

  std::optional<Frame> next() override {
    openni::VideoFrameRef read;
    const auto has_frame = [&](std::chrono::milliseconds patience) {
      read = wait_for(depth_, int(patience.count()));
      return read.isValid();
    };
    if (!wait_for_frame(has_frame)) return std::nullopt;
    if (last_index_ > 0 && read.getFrameIndex() > last_index_ + 1) missed_ += read.getFrameIndex() - last_index_ - 1;
    last_index_ = read.getFrameIndex();
    Frame frame = arrived(double(read.getTimestamp()) / kMicroseconds);
    frame.camera = camera_;
    frame.depth = copy_depth(read);
    if (colour_.isValid()) frame.colour = colour_near(static_cast<std::int64_t>(read.getTimestamp()));
    return frame;
  }

 private:
  static openni::VideoFrameRef wait_for(openni::VideoStream& stream, int patience_ms) {
    openni::VideoStream* of = &stream;
    int ready = -1;
    openni::VideoFrameRef frame;
    if (openni::OpenNI::waitForAnyStream(&of, 1, &ready, patience_ms) == openni::STATUS_OK) stream.readFrame(&frame);
    return frame;
  }

  /// Colour is of use only where the camera puts depth onto its grid.
  void start_colour(int width, int height) {
    if (!device_.hasSensor(openni::SENSOR_COLOR)) return;
    if (!device_.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR)) {
      notes_.push_back(place_ + ": no colour, since the camera does not register depth to it");
      return;
    }
    if (colour_.create(device_, openni::SENSOR_COLOR) != openni::STATUS_OK) {
      notes_.push_back(fmt::format("{}: no colour: {}", place_, reason()));
      return;
    }
    choose_mode(colour_, openni::PIXEL_FORMAT_RGB888, width, height);
    const openni::VideoMode mode = colour_.getVideoMode();
    const bool fits = mode.getPixelFormat() == openni::PIXEL_FORMAT_RGB888 && mode.getResolutionX() == width &&
                      mode.getResolutionY() == height;
    colour_.setMirroringEnabled(false);
    if (!fits || device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR) != openni::STATUS_OK ||
        colour_.start() != openni::STATUS_OK) {
      notes_.push_back(place_ + ": no colour, since it does not come in the size of depth");
      colour_.destroy();
      return;
    }
    device_.setDepthColorSyncEnabled(true);
  }

  /// The driver knows the lens by its field of view. Registered depth lies on the grid of colour.
  void set_camera(int width, int height) {
    const openni::VideoStream& of = colour_.isValid() ? colour_ : depth_;
    const double across = of.getHorizontalFieldOfView(), down = of.getVerticalFieldOfView();
    camera_.width = width;
    camera_.height = height;
    if (across > 0.0 && down > 0.0) {
      camera_.fx = float(width / (2.0 * std::tan(across / 2.0)));
      camera_.fy = float(height / (2.0 * std::tan(down / 2.0)));
    } else {
      constexpr float kUsual = 525.F / kCameraWidth;  // of PrimeSense cameras
      camera_.fx = camera_.fy = kUsual * float(width);
      notes_.push_back(
          fmt::format("{}: no field of view given; a focal length of {:.4g} pixels assumed", place_, camera_.fx));
    }
    camera_.cx = float(width - 1) / 2.F;
    camera_.cy = float(height - 1) / 2.F;
  }

  DepthImage copy_depth(const openni::VideoFrameRef& read) const {
    if (read.getWidth() != camera_.width || read.getHeight() != camera_.height) {
      throw Error(fmt::format("{}: a frame of {}x{}, expected {}x{}", place_, read.getWidth(), read.getHeight(),
                              camera_.width, camera_.height));
    }
    DepthImage depth(camera_.width, camera_.height);
    copy_rows(read.getData(), read.getStrideInBytes(), depth);
    if (per_mm_ > 1) {
      for (std::uint16_t& z : depth) z = static_cast<std::uint16_t>((z + per_mm_ / 2) / per_mm_);
    }
    return depth;
  }

  /// Returns the colour of the same moment; empty if it does not come.
  ColourImage colour_near(std::int64_t time_us) {
    while (!last_colour_.isValid() ||
           static_cast<std::int64_t>(last_colour_.getTimestamp()) < time_us - kMostApart_us) {
      const openni::VideoFrameRef read = wait_for(colour_, kColourPatience_ms);
      if (!read.isValid()) return {};
      last_colour_ = read;
    }
    if (static_cast<std::int64_t>(last_colour_.getTimestamp()) > time_us + kMostApart_us) return {};
    ColourImage colour(camera_.width, camera_.height);
    if (last_colour_.getWidth() != camera_.width || last_colour_.getHeight() != camera_.height) return {};
    copy_rows(last_colour_.getData(), last_colour_.getStrideInBytes(), colour);
    return colour;
  }

  openni::Device device_;
  openni::VideoStream depth_, colour_;
  openni::VideoFrameRef last_colour_;
  Camera camera_;
  int per_mm_ = 1;
  int last_index_ = 0;
};

}  // namespace

std::vector<SensorInfo> list_openni2() { return infos_of(all_plugged_in()); }

std::unique_ptr<FrameSource> open_openni2(const std::string& id) { return std::make_unique<Openni2Source>(id); }

}  // namespace vesalius

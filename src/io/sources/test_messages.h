#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/message_fields.h"
#include "vesalius/base/frame.h"

namespace vesalius::test {

/// Writes single messages of a camera.
class Messages {
 public:
  explicit Messages(const std::string& path) : out_(path) {}
  void put(const std::string& topic, const std::string& type, std::int64_t time_ns, const std::string& message) {
    const auto [found, is_new] = topics_.try_emplace(topic, std::uint16_t{0});
    if (is_new) found->second = out_.add_topic(topic, type, "as in common_interfaces\n");
    out_.write(found->second, time_ns, message);
  }
  void depth(const std::string& topic, std::int64_t time_ns, const Frame& frame,
             const std::string& place = "depth_frame") {
    put(topic, "sensor_msgs/msg/Image", time_ns, depth_message(frame.depth, time_ns, place));
  }
  void colour(const std::string& topic, std::int64_t time_ns, const Frame& frame,
              const std::string& place = "depth_frame") {
    put(topic, "sensor_msgs/msg/Image", time_ns, colour_message(frame.colour, time_ns, place));
  }
  void lens(const std::string& topic, const LensCamera& camera, const std::string& model, const std::vector<double>& d,
            const std::string& place) {
    CdrWriter out;
    out.header(0, place);
    out.u32(static_cast<std::uint32_t>(camera.camera.height));
    out.u32(static_cast<std::uint32_t>(camera.camera.width));
    out.text(model);
    out.u32(static_cast<std::uint32_t>(d.size()));
    for (const double k : d) out.real64(k);
    const double fx = camera.camera.fx, fy = camera.camera.fy, cx = camera.camera.cx, cy = camera.camera.cy;
    for (const double k : {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}) out.real64(k);
    for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) out.real64(r);
    for (const double p : {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) out.real64(p);
    for (int i = 0; i < 6; ++i) out.u32(0);
    out.u8(0);
    put(topic, "sensor_msgs/msg/CameraInfo", 0, out.message());
  }
  void transform(const std::string& parent, const std::string& child, const Eigen::Isometry3d& parent_from_child) {
    CdrWriter out;
    out.u32(1);
    out.header(0, parent);
    out.text(child);
    for (const double t : parent_from_child.translation()) out.real64(t);
    const Eigen::Quaterniond q(parent_from_child.linear());
    for (const double k : {q.x(), q.y(), q.z(), q.w()}) out.real64(k);
    put("/tf_static", "tf2_msgs/msg/TFMessage", 0, out.message());
  }
  /// An accelerometer's, of any length.
  void acceleration(const std::string& topic, std::int64_t time_ns, const Eigen::Vector3d& m_s2,
                    const std::string& place) {
    constexpr double kGravity = 9.80665;
    put(topic, "sensor_msgs/msg/Imu", time_ns, imu_message((m_s2 / kGravity).cast<float>(), time_ns, place));
  }
  void camera(const std::string& topic, const Camera& camera, const std::string& place = "depth_frame") {
    put(topic, "sensor_msgs/msg/CameraInfo", 0, calibration_message(camera, 0, place));
  }
  void close() { out_.close(); }

 private:
  McapWriter out_;
  std::map<std::string, std::uint16_t> topics_;
};

}  // namespace vesalius::test

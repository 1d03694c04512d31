#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/transform_messages.h"
#include "vesalius/frame.h"

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
    const double fx = camera.camera.fx, fy = camera.camera.fy, cx = camera.camera.cx, cy = camera.camera.cy;
    Calibration c;
    c.frame = place;
    c.width = camera.camera.width;
    c.height = camera.camera.height;
    c.model = model;
    c.distortion = d;
    c.matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
    c.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    c.projection = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
    put(topic, "sensor_msgs/msg/CameraInfo", 0, calibration_message(c, 0));
  }
  void transform(const std::string& parent, const std::string& child, const Eigen::Isometry3d& parent_from_child) {
    put("/tf_static", "tf2_msgs/msg/TFMessage", 0, transforms_message({{parent, child, parent_from_child}}, 0));
  }
  void acceleration(const std::string& topic, std::int64_t time_ns, const Eigen::Vector3d& m_s2,
                    const std::string& place) {
    put(topic, "sensor_msgs/msg/Imu", time_ns, acceleration_message({time_ns, place, m_s2}));
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

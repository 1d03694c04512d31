#include "io/recordings/frame_recorder.h"

#include <cmath>

#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/people_messages.h"

namespace vesalius {
namespace {

constexpr const char* kFrame = "camera_optical_frame";

}  // namespace

FrameRecorder::FrameRecorder(const std::string& path, double rate) : out_(path), rate_(rate) {}

std::uint16_t FrameRecorder::topic(std::optional<std::uint16_t>& known, const char* name, const char* type) {
  if (!known) {
    const std::string folder = std::string(type).substr(0, std::string(type).find('/'));
    const std::string ros2 = folder + "/msg/" + std::string(type).substr(folder.size() + 1);
    known = out_.add_topic(name, ros2, message_definition(type));
  }
  return *known;
}

void FrameRecorder::write(const Frame& frame) {
  check(frame);
  time_ns_ = std::llround(double(kNanoseconds) * frame.time_s.value_or(double(frames_) / rate_));
  log_ns_ = frame.arrived_s ? std::llround(double(kNanoseconds) * *frame.arrived_s) : time_ns_;
  ++frames_;
  out_.write(topic(camera_, "/camera/depth/camera_info", "sensor_msgs/CameraInfo"), log_ns_,
             calibration_message(frame.camera, time_ns_, kFrame));
  // Once one frame knew up, readers must be told of those that do not.
  if (frame.up || imu_) {
    out_.write(topic(imu_, "/camera/imu", "sensor_msgs/Imu"), log_ns_, imu_message(frame.up, time_ns_, kFrame));
  }
  if (!frame.colour.empty()) {
    out_.write(topic(colour_, "/camera/color/image", "sensor_msgs/Image"), log_ns_,
               colour_message(frame.colour, time_ns_, kFrame));
  }
  out_.write(topic(depth_, "/camera/depth/image", "sensor_msgs/Image"), log_ns_,
             depth_message(frame.depth, time_ns_, kFrame));
}

void FrameRecorder::write_people(const Frame& frame, const TrackedFrame& people, const BodyModel& body,
                                 const std::string& json) {
  const std::vector<Person> found = people_of(people);
  const int width = frame.depth.width(), height = frame.depth.height();
  out_.write(topic(index_, "/people/body_index", "sensor_msgs/Image"), log_ns_,
             grey_message(body_index_map(found, width, height), time_ns_, kFrame));
  out_.write(topic(parts_, "/people/parts", "sensor_msgs/Image"), log_ns_,
             grey_message(part_label_map(found, width, height), time_ns_, kFrame));
  out_.write(topic(markers_, "/people/markers", "visualization_msgs/MarkerArray"), log_ns_,
             markers_message(people, body, time_ns_, kFrame));
  CdrWriter text;
  text.text(json);
  out_.write(topic(json_, "/people/json", "std_msgs/String"), log_ns_, text.message());
}

}  // namespace vesalius

#pragma once

// Recorded people of whom everything is known.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <string>

#include "export/people_record.h"

namespace vesalius::test {

inline constexpr std::size_t kFrames = 6;

inline std::string quaternion_json(const Eigen::Quaterniond& q) {
  return fmt::format("[{},{},{},{}]", q.x(), q.y(), q.z(), q.w());
}
inline std::string vector_json(const Eigen::Vector3d& v) { return fmt::format("[{},{},{}]", v.x(), v.y(), v.z()); }

/// Returns the body of a person whose hips are at `root_m`: it turns and swings a leg from frame to frame.
inline std::string body_json(const Eigen::Vector3d& root_m, std::size_t frame) {
  const auto turn = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  const double t = static_cast<double>(frame);
  const Eigen::Quaterniond facing(0.0, 1.0, 0.0, 0.0);  // the rest pose before the camera
  const Eigen::Quaterniond pelvis = facing * turn(0.7 * t, Eigen::Vector3d::UnitY());
  const Eigen::Quaterniond spine = pelvis * turn(0.1 * t, Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond thigh = pelvis * turn(-0.4 * t, Eigen::Vector3d(1.0, 0.3, 0.0).normalized());
  const auto bone = [](const char* name, const Eigen::Vector3d& head, const Eigen::Vector3d& tail,
                       const Eigen::Quaterniond& global) {
    return fmt::format(R"("{}":{{"head_m":{},"tail_m":{},"global_xyzw":{}}})", name, vector_json(head),
                       vector_json(tail), quaternion_json(global));
  };
  const Eigen::Vector3d spine_at = root_m + pelvis * Eigen::Vector3d(0.0, 0.1, 0.0);
  const Eigen::Vector3d thigh_at = root_m + pelvis * Eigen::Vector3d(0.09, -0.05, 0.01);
  return fmt::format(
      R"("body":{{"bones":{{{},{},{}}},"joint_rotations_xyzw":{{"k4abt32":{{"l_wrist":[-0.5,0.5,-0.5,0.5]}}}}}})",
      bone("pelvis", root_m, spine_at, pelvis),
      bone("spine", spine_at, spine_at + spine * Eigen::Vector3d(0.0, 0.13, 0.0), spine),
      bone("l_thigh", thigh_at, thigh_at + thigh * Eigen::Vector3d(0.0, -0.42, 0.0), thigh));
}

/// Returns lines of two people, 1 and 7, of whom the second comes in frame 1 and is away in frame 2.
inline std::string lines(bool bodies = true) {
  std::string all;
  for (std::size_t f = 0; f < kFrames; ++f) {
    std::string people;
    for (const int id : {1, 7}) {
      if (id == 7 && (f == 0 || f == 2)) continue;
      const double x = id == 1 ? 0.1 : 1.1;
      const auto joint = [&](double y) {
        return fmt::format(R"({{"xyz_m":[{},{},2.0],"px":[345.0,109.5],"confidence":0.8,"state":"observed"}})", x, y);
      };
      const char* none = R"({"xyz_m":null,"px":null,"confidence":0.0,"state":"none"})";
      people += fmt::format(
          R"({}{{"id":{},"index":{},"score":0.9,"box_px":[10,20,30,40],"joints":{{"k4abt32":{{"pelvis":{},"l_wrist":{}}},"coco17":{{"nose":{},"l_wrist":{}}}}}{}{}}})",
          people.empty() ? "" : ",", id, id == 1 ? 0 : 1, joint(0.2), none, joint(-0.5), none, bodies ? "," : "",
          bodies ? body_json({x, 0.2 + 0.01 * static_cast<double>(f), 2.0}, f) : "");
    }
    all += fmt::format(
        R"({{"frame":"a,{}","time_s":null,"track_time_s":{},"camera":{{"width":640,"height":480,"fx":525.0,"fy":525.0,"cx":319.5,"cy":239.5}},"people":[{}]}})"
        "\n",
        f, 0.04 * static_cast<double>(f), people);
  }
  return all + R"({"complete":true,"frames":6})" + "\n";
}

inline PeopleRecord people() { return parse_people(lines(), "people.jsonl", {}); }

}  // namespace vesalius::test

// What examples/detect_people.c should say, by the C++ detector: c_reference FOLDER OUT
//
// Writes the depth of each frame of FOLDER to OUT/NAME.depth as the examples read it, and prints a line with the file
// and the camera as they take them, then what they should print.

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

namespace {

long millimetres(float metres) { return std::lround(static_cast<double>(metres) * 1000.0); }

void print(const vesalius::Person& person, std::size_t index, const vesalius::BodyModel& body) {
  std::printf("person %zu: score %ld/1000, box %d %d %d %d\n", index, millimetres(person.score), person.box.u,
              person.box.v, person.box.width, person.box.height);
  const std::size_t set = vesalius::find_joint_set(body, "k4abt32");
  for (std::size_t j = 0; j < person.joints[set].size(); ++j) {
    const vesalius::Joint& joint = person.joints[set][j];
    if (joint.state == vesalius::State::none) continue;
    std::printf("  %s: %ld %ld %ld mm\n", body.joint_sets[set].joints[j].name.c_str(), millimetres(joint.position.x()),
                millimetres(joint.position.y()), millimetres(joint.position.z()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const vesalius::Detector detector(
      vesalius::load_model(std::string(VESALIUS_SOURCE_DIR) + "/data/models/default.model"));
  const auto source = vesalius::open_source(argv[1]);
  while (auto frame = source->next()) {
    const std::string path = std::string(argv[2]) + "/" + frame->name + ".depth";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(frame->depth.data()),
               static_cast<std::streamsize>(frame->depth.size() * 2));
    const vesalius::Camera& camera = frame->camera;
    std::printf("frame %s %d %d %.9g %.9g %.9g %.9g\n", path.c_str(), camera.width, camera.height,
                static_cast<double>(camera.fx), static_cast<double>(camera.fy), static_cast<double>(camera.cx),
                static_cast<double>(camera.cy));
    frame->colour = {};
    std::size_t index = 0;
    for (const vesalius::Person& person : detector.detect(*frame)) print(person, index++, detector.body());
  }
}

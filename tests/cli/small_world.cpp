#include "small_world.h"

#include <unistd.h>

#include <fstream>

#include "capsule/capsule_person.h"
#include "io/sources/write_frames.h"
#include "train/grow_forest.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

constexpr Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

LabelledFrame person_with(float raised_arm) {
  CapsuleScene scene;
  CapsulePerson person;
  person.pose.l_arm.raise = raised_arm;
  person.pose.r_arm.raise = 0.5F;
  scene.people = {person};
  return render(scene, kCamera, paper_body());
}

}  // namespace

std::filesystem::path SmallWorld::folder() {
  return std::filesystem::path(testing::TempDir()) / ("vesalius_small_world_" + std::to_string(::getpid()));
}

void SmallWorld::SetUpTestSuite() {
  std::filesystem::create_directories(folder());
  std::vector<LabelledFrame> frames = {person_with(0.5F), person_with(1.2F), render({}, kCamera, paper_body())};
  const auto writer = make_frame_writer(FrameFormat::folder, path("frames"));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].frame.name = std::string(1, static_cast<char>('a' + i));
    writer->write(frames[i].frame);
  }
  writer->close();
  TrainOptions options;
  options.trees = 2;
  options.grow.leaf.max_depth = 10;
  options.sample.pixels_per_frame = 3000;
  save_model(grow_forest(frames, paper_body(), options), model());
}

void SmallWorld::TearDownTestSuite() { std::filesystem::remove_all(folder()); }

void SmallWorld::write(const std::string& name, const std::string& bytes) {
  std::ofstream(path(name), std::ios::binary) << bytes;
}

}  // namespace vesalius

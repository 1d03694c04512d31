#include "bench/bench_scenes.h"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <utility>

#include "capsule/capsule_person.h"
#include "io/model/text_trees.h"
#include "vesalius/error.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/trace.h"

namespace vesalius {
namespace {

Frame capsule_frame() {
  CapsuleScene scene;
  CapsulePerson left, right;
  left.feet = {-0.6F, 1.F, 2.5F};
  left.pose.l_arm.raise = 1.2F;
  right.feet = {0.7F, 1.F, 3.F};
  right.pose.yaw = 0.5F;
  scene.people = {left, right};
  Frame frame = render(scene, {640, 480, 575.F, 575.F, 319.5F, 239.5F}, paper_body()).frame;
  add_sensor_noise(frame, 1);
  return frame;
}

BenchScene run_stages(std::string name, Frame frame, Forest forest) {
  BenchScene scene;
  scene.name = std::move(name);
  scene.frame = std::move(frame);
  scene.forest = std::move(forest);
  scene.posteriors = ForestLabeller(scene.forest).label(scene.frame);
  Trace trace;
  DetectOptions options;
  options.grid.step = 1;
  Detector(scene.forest, options).detect(scene.frame, &trace);
  scene.labels = std::move(trace.labels);
  scene.clusters = std::move(trace.clusters);
  scene.rough = std::move(trace.rough);
  return scene;
}

std::filesystem::path shared_folder() {
  const char* given = std::getenv("VESALIUS_SHARED");
  return given != nullptr ? given : VESALIUS_SOURCE_DIR "/../shared";
}

/// Returns a frame of one whole person who stands in a living room.
Frame alina_frame(const std::filesystem::path& depth_file) {
  auto frame = open_source(depth_file.string())->next();
  if (!frame) throw Error(depth_file.string() + ": expected a frame");
  return *std::move(frame);
}

}  // namespace

std::vector<BenchScene> bench_scenes() {
  std::vector<BenchScene> scenes;
  scenes.push_back(
      run_stages("capsule", capsule_frame(), load_model(VESALIUS_SOURCE_DIR "/data/models/capsule.forest").forest));
  const std::filesystem::path shared = shared_folder();
  const std::filesystem::path depth_file = shared / "real/alina_wave/depth/0255.png";
  if (!std::filesystem::exists(depth_file)) {
    std::cerr << "no real frame: " << depth_file.string() << " is missing\n";
    return scenes;
  }
  std::vector<std::string> trees;
  for (const char* number : {"1", "2", "3"})
    trees.push_back((shared / "reference/pcl_tree_").string() + number + ".txt.bz2");
  scenes.push_back(run_stages("alina_wave", alina_frame(depth_file), import_text_trees(trees)));
  if (const char* model = std::getenv("VESALIUS_BENCH_MODEL")) {
    scenes.push_back(run_stages("model", alina_frame(depth_file), load_model(model).forest));
  }
  return scenes;
}

}  // namespace vesalius

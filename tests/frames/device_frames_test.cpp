#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cuda/cuda_device.h"
#include "cuda/cuda_labeller.h"
#include "cuda/test_forests.h"
#include "shared_frames.h"
#include "simulator/simulated_device.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

Model shipped(const std::string& name) { return load_model(VESALIUS_SOURCE_DIR "/data/models/" + name); }

/// Returns a model whose labeller is on a device.
Model placed(const Model& model, const std::shared_ptr<gpu::Device>& device) {
  return on_device(model, "this",
                   {{{"this", [&](const Model& of, int) { return gpu::make_device_labeller(of, device); }}}});
}

/// Returns the processor's labeller, which is shown whole frames.
std::shared_ptr<const Labeller> labeller_of(const Model& model) {
  if (model.network != nullptr) return on_device(model).labeller;
  return std::make_shared<ForestLabeller>(model.forest);
}

/// Expects a device's posteriors, smoothed ones and people to be the processor's in every `step`-th frame of all real
/// sets, which are looked at on the grid that the detector takes.
void expect_same_on_real_frames(const std::filesystem::path& shared, const Model& model,
                                const std::shared_ptr<gpu::Device>& device, std::size_t step) {
  const std::shared_ptr<const Labeller> processor = labeller_of(model);
  const std::shared_ptr<const Labeller> labeller = gpu::make_device_labeller(model, device);
  const Detector detector(model);
  const Detector device_detector(placed(model, device));
  int frames = 0, people = 0;
  for (const std::string set :
       {"alina_wave", "fallseq", "jointvosf", "neg_7scenes_kitchen", "neg_aims", "neg_leezl_tabletop", "neg_pcl", "pcl",
        "tue_people", "uc3m", "utd_joints", "uva_person"}) {
    const std::vector<RealFrame> all = load_real_set(shared, set);
    for (std::size_t i = 0; i < all.size(); i += step, ++frames) {
      SCOPED_TRACE(set + ", frame " + std::to_string(i));
      const Frame& frame = all[i].frame;
      const Frame grid = every_nth(frame, grid_step(frame.camera, {}));
      for (const float gate : {LabelOptions{}.gate, 2.F}) {
        Posteriors expected, found, mean;
        processor->label_into(grid, gate, expected);
        const bool smooths = labeller->label_and_smooth_into(grid, gate, {}, found, mean);
        ASSERT_EQ(smooths, model.network == nullptr);
        if (!smooths) labeller->label_into(grid, gate, found);
        ASSERT_NO_FATAL_FAILURE(test::expect_same(found, expected, grid.depth));
        if (smooths) {
          ASSERT_EQ(mean.sums, mean_filter(expected, grid.depth, grid.camera, {}).sums);
        }
      }
      const std::vector<Person> one = detector.detect(frame), other = device_detector.detect(frame);
      ASSERT_EQ(one.size(), other.size());
      for (std::size_t p = 0; p < one.size(); ++p, ++people) {
        ASSERT_EQ(one[p].score, other[p].score);
        ASSERT_EQ(one[p].mask, other[p].mask);
        ASSERT_EQ(one[p].labels, other[p].labels);
      }
    }
  }
  EXPECT_GT(frames, 10);
  EXPECT_GT(people, 0);
}

/// The simulator takes every so many-th frame: VESALIUS_FRAME_STEP, 1 in .ci/nightly.
std::size_t frame_step() {
  const char* given = std::getenv("VESALIUS_FRAME_STEP");
  return given != nullptr ? std::stoul(given) : 17;
}

/// Returns the part of a frame's grid that begins at (`left`, `top`).
Frame part_of(const Frame& frame, int left, int top, int width, int height) {
  DepthImage depth(width, height, 0);
  for (int v = 0; v < height; ++v) std::copy_n(frame.depth.row(top + v) + left, width, depth.row(v));
  Camera camera = frame.camera;
  camera.width = width;
  camera.height = height;
  camera.cx -= float(left);
  camera.cy -= float(top);
  return depth_frame(depth, camera);
}

TEST(DemoOnADevice, IsTheSameByTheDefaultNetworkInTheSimulator) {
  const Frame frame = *open_source(VESALIUS_SOURCE_DIR "/data/rooms")->next();
  const Frame part = part_of(every_nth(frame, grid_step(frame.camera, {})), 80, 40, 150, 120);
  const Model model = shipped("default.model");
  const Posteriors expected = on_device(model).labeller->label(part);
  test::expect_same(placed(model, std::make_shared<gpu::SimulatedDevice>()).labeller->label(part), expected,
                    part.depth);
  int body = 0;
  for (int v = 0; v < expected.height; ++v) {
    for (int u = 0; u < expected.width; ++u) body += body_share(expected, u, v, expected.classes - 1) > 0.5 ? 1 : 0;
  }
  EXPECT_GT(body, 500) << "somebody is in view";
}

// Labels: real slow
TEST(RealFramesOnADevice, GiveTheSameInTheSimulator) {
  VESALIUS_NEEDS_SHARED();
  expect_same_on_real_frames(shared, shipped("default.forest"), std::make_shared<gpu::SimulatedDevice>(), frame_step());
}

// Labels: real slow
TEST(RealFramesOnADevice, GiveTheSameInTheSimulatorByTheDefaultNetwork) {
  VESALIUS_NEEDS_SHARED();
  constexpr std::size_t kSlower = 20;
  expect_same_on_real_frames(shared, shipped("default.model"), std::make_shared<gpu::SimulatedDevice>(),
                             kSlower * frame_step());
}

// Labels: real slow
TEST(RealFramesOnADevice, GiveTheSameInTheSimulatorWithTheReleasedTrees) {
  VESALIUS_NEEDS_SHARED();
  expect_same_on_real_frames(shared, load_released_trees(shared), std::make_shared<gpu::SimulatedDevice>(),
                             frame_step());
}

// Labels: real gpu
TEST(RealFramesOnADevice, GiveTheSameOnACard) {
  VESALIUS_NEEDS_SHARED();
  std::shared_ptr<gpu::Device> card;
  try {
    card = gpu::open_cuda_device(0);
  } catch (const DeviceError& e) {
    GTEST_SKIP() << e.what();
  }
  expect_same_on_real_frames(shared, shipped("default.forest"), card, 1);
  expect_same_on_real_frames(shared, shipped("default.model"), card, 1);
  expect_same_on_real_frames(shared, load_released_trees(shared), card, 1);
}

}  // namespace
}  // namespace vesalius

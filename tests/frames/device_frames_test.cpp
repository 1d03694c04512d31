#include <gmock/gmock.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cuda/cuda_device.h"
#include "cuda/device_labeller.h"
#include "cuda/test_forests.h"
#include "shared_frames.h"
#include "simulator/simulated_device.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

Model default_model() { return load_model(VESALIUS_SOURCE_DIR "/data/models/default.forest"); }

/// Expects a device's posteriors, smoothed ones and people to be the processor's in every `step`-th frame of all real
/// sets, which are looked at on the grid that the detector takes.
void expect_same_on_real_frames(const std::filesystem::path& shared, const Model& model,
                                const std::shared_ptr<gpu::Device>& device, std::size_t step) {
  const ForestLabeller processor(model.forest);
  const auto labeller = std::make_shared<gpu::DeviceLabeller>(model.forest, device);
  const Detector detector(model);
  const Detector device_detector(on_device(model, "this", {{{"this", [&](const Forest&, int) { return labeller; }}}}));
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
        processor.label_into(grid, gate, expected);
        ASSERT_TRUE(labeller->label_and_smooth_into(grid, gate, {}, found, mean));
        ASSERT_NO_FATAL_FAILURE(test::expect_same(found, expected, grid.depth));
        ASSERT_EQ(mean.sums, mean_filter(expected, grid.depth, grid.camera, {}).sums);
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

// Labels: real slow
TEST(RealFramesOnADevice, GiveTheSameInTheSimulator) {
  VESALIUS_NEEDS_SHARED();
  expect_same_on_real_frames(shared, default_model(), std::make_shared<gpu::SimulatedDevice>(), frame_step());
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
  expect_same_on_real_frames(shared, default_model(), card, 1);
  expect_same_on_real_frames(shared, load_released_trees(shared), card, 1);
}

}  // namespace
}  // namespace vesalius

#include "cuda/device_labeller.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "cuda/kernels.h"
#include "cuda/test_forests.h"
#include "simulator/simulated_device.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"

namespace vesalius::gpu {
namespace {

using test::expect_same;
using test::ForestKind;
using test::LeafKind;
using test::random_forest;
using test::random_scene;

constexpr float kNoGate = 2.F;
constexpr float kGate = 0.5F;

std::shared_ptr<SimulatedDevice> simulated(SimulatedDeviceOptions options = {}) {
  return std::make_shared<SimulatedDevice>(options);
}

Camera camera_of(const DepthImage& depth) {
  return {depth.width(), depth.height(), 61.F, 59.F, 0.5F * static_cast<float>(depth.width()), 20.F};
}

/// Labels on a device and on the processor, smoothed and not, and expects the same bits. Returns settled pixels.
long expect_same_labels(const Forest& forest, const DeviceLabeller& device, const DepthImage& depth, float gate) {
  const ForestLabeller processor(forest);
  const Camera camera = camera_of(depth);
  Posteriors expected, found, mean;
  processor.label_into(depth_frame(depth, camera), gate, expected);
  device.label_into(depth_frame(depth, camera), gate, found);
  expect_same(found, expected, depth);
  EXPECT_TRUE(device.label_and_smooth_into(depth_frame(depth, camera), gate, {}, found, mean));
  expect_same(found, expected, depth);
  const Posteriors smooth = mean_filter(expected, depth, camera, {});
  EXPECT_EQ(mean.sums, smooth.sums);
  EXPECT_EQ(mean.settled, smooth.settled);
  return std::ranges::count(expected.settled, 1);
}

std::vector<ForestKind> all_kinds() {
  std::vector<ForestKind> kinds;
  for (const LeafKind leaves : {LeafKind::votes, LeafKind::distributions, LeafKind::logits, LeafKind::headings}) {
    for (const bool background : {true, false}) {
      for (const int max_offset : {127, kMaxOffset}) kinds.push_back({leaves, background, 3, max_offset, 800});
    }
  }
  kinds.push_back({LeafKind::distributions, true, 12, 127, 0});  // sums over windows exceed 16 bits
  return kinds;
}

TEST(DeviceLabeller, GivesTheProcessorsBitsForEveryKindOfForest) {
  long settled = 0;
  for (const ForestKind& kind : all_kinds()) {
    SCOPED_TRACE("leaves " + std::to_string(static_cast<int>(kind.leaves)) + ", background " +
                 std::to_string(kind.background) + ", offsets to " + std::to_string(kind.max_offset));
    Random random(5);
    const Forest forest = random_forest(random, kind);
    const DeviceLabeller device(forest, simulated());
    const DepthImage depth = random_scene(random, 67, 45);
    for (const float gate : {kNoGate, kGate}) settled += expect_same_labels(forest, device, depth, gate);
  }
  EXPECT_GT(settled, 1000) << "the gate had nothing to do";
}

TEST(DeviceLabeller, GivesTheProcessorsBitsForBodiesOfManyParts) {
  // More logits than a pixel's lanes take at a time, an odd and an even number of classes.
  for (const int more_parts : {40, 95, 170}) {
    for (const LeafKind leaves : {LeafKind::distributions, LeafKind::headings}) {
      Random random(16);
      const Forest forest = random_forest(random, {.leaves = leaves, .more_parts = more_parts});
      const DeviceLabeller device(forest, simulated());
      const DepthImage depth = random_scene(random, 41, 33);
      for (const float gate : {kNoGate, kGate}) expect_same_labels(forest, device, depth, gate);
    }
  }
}

TEST(DeviceLabeller, GivesTheSameBitsForPicturesOfEverySize) {
  Random random(6);
  const Forest forest = random_forest(random, {});
  const DeviceLabeller device(forest, simulated());
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{
           {1, 1}, {1, 37}, {53, 1}, {4, 4}, {5, 4}, {31, 33}, {128, 3}, {97, 61}, {2, 2}, {0, 0}, {3, 0}}) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    for (const float gate : {kNoGate, kGate}) {
      expect_same_labels(forest, device, random_scene(random, width, height), gate);
      expect_same_labels(forest, device, test::random_depth(random, width, height), gate);
    }
  }
  expect_same_labels(forest, device, DepthImage(20, 20, 0), kGate);
  EXPECT_THROW(device.label(depth_frame(DepthImage(16001, 1, 1000), camera_of(DepthImage(16001, 1)))), Error);
}

TEST(DeviceLabeller, GivesTheSameBitsForBlocksOfEveryShapeAndOrder) {
  Random random(7);
  for (const LeafKind leaves : {LeafKind::distributions, LeafKind::headings}) {
    const Forest forest = random_forest(random, {.leaves = leaves});
    const DepthImage depth = random_scene(random, 50, 30);
    for (const unsigned threads : {32U, 48U, 64U, 100U, 256U, 1024U}) {
      for (const bool backwards : {false, true}) {
        SCOPED_TRACE(std::to_string(threads) + (backwards ? " threads, the last first" : " threads"));
        const DeviceLabeller device(forest, simulated({.simulator = {.backwards = backwards}}), {threads});
        expect_same_labels(forest, device, depth, kGate);
      }
    }
  }
  for (const unsigned threads : {0U, 31U, 1025U}) {
    EXPECT_THROW(DeviceLabeller(random_forest(random, {}), simulated(), {threads}), Error);
  }
}

TEST(DeviceLabeller, SmoothsWithEveryWindow) {
  Random random(8);
  const Forest forest = random_forest(random, {.leaves = LeafKind::distributions});
  const DeviceLabeller device(forest, simulated());
  const DepthImage depth = random_scene(random, 40, 30);
  const Camera camera = camera_of(depth);
  for (const SmoothOptions& options :
       {SmoothOptions{.window = 1}, SmoothOptions{.window = 4}, SmoothOptions{.window = 31, .spacing = 2},
        SmoothOptions{.window = 7, .spacing = 3, .depth_gate_mm = 0},
        SmoothOptions{.window = 3, .depth_gate_mm = 10000}}) {
    Posteriors found, mean;
    device.label_and_smooth_into(depth_frame(depth, camera), kGate, options, found, mean);
    EXPECT_EQ(mean.sums, mean_filter(found, depth, camera, options).sums) << "window " << options.window;
  }
}

// Labels: threads
TEST(DeviceLabeller, GivesTheSameBitsFromSeveralThreads) {
  Random random(9);
  const Forest forest = random_forest(random, {});
  const DeviceLabeller device(forest, simulated());
  const ForestLabeller processor(forest);
  std::vector<DepthImage> pictures;
  for (int i = 0; i < 6; ++i) pictures.push_back(random_scene(random, 30 + 7 * i, 40));
  std::vector<Posteriors> found(pictures.size());
  for_threads({1, 2, 4}, [&] {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      threads.emplace_back(
          [&, i] { device.label_into(depth_frame(pictures[i], camera_of(pictures[i])), kGate, found[i]); });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      Posteriors expected;
      processor.label_into(depth_frame(pictures[i], camera_of(pictures[i])), kGate, expected);
      expect_same(found[i], expected, pictures[i]);
    }
  });
}

/// Returns what the processor chooses.
LabelImage chosen(const ForestLabeller& processor, const DepthImage& depth, const Camera& camera,
                  const LabelOptions& label) {
  Posteriors posteriors;
  processor.label_into(depth_frame(depth, camera), label.gate, posteriors);
  return choose_labels(mean_filter(posteriors, depth, camera, {}), depth, {processor.layout().parts}, label);
}

TEST(LabelPictures, ChoosesTheProcessorsLabelsForAnyBatches) {
  Random random(10);
  for (const bool background : {true, false}) {
    const Forest forest = random_forest(random, {.background = background});
    const ForestLabeller processor(forest);
    std::vector<DepthImage> pictures;
    std::vector<Camera> cameras;
    for (int i = 0; i < 9; ++i) {
      pictures.push_back(random_scene(random, i == 4 ? 31 : 40, i == 8 ? 0 : 24));
      cameras.push_back(camera_of(pictures.back()));
      cameras.back().fx = i < 3 ? 60.F : 280.F + static_cast<float>(i);  // another spacing, another scale
    }
    for (const LabelOptions& label :
         {LabelOptions{}, LabelOptions{.background_weight = 0.1F, .unsure_margin = 0.3F, .gate = kGate}}) {
      for (const std::uint32_t batch_pixels : {1U, 2000U, 1U << 20U}) {
        const DeviceLabeller device(forest, simulated(), {.batch_pixels = batch_pixels});
        const std::vector<LabelImage> labels = device.label_pictures(pictures, cameras, label, {});
        ASSERT_EQ(labels.size(), pictures.size());
        for (std::size_t i = 0; i < pictures.size(); ++i) {
          EXPECT_EQ(labels[i], chosen(processor, pictures[i], cameras[i], label)) << "picture " << i;
        }
      }
    }
  }
}

TEST(LabelPictures, MovesDepthUpAndLabelsDown) {
  Random random(11);
  const Forest forest = random_forest(random, {});
  const auto device = simulated();
  const DeviceLabeller labeller(forest, device);
  const std::size_t of_forest = device->copied_to_device();
  const std::vector<DepthImage> pictures(4, random_scene(random, 64, 48));
  labeller.label_pictures(pictures, std::vector<Camera>(4, camera_of(pictures[0])), {}, {});
  const std::size_t pixels = 4 * pictures[0].size();
  EXPECT_EQ(device->copied_to_device() - of_forest, pixels * 2 + 4 * sizeof(OffsetUnits));
  EXPECT_EQ(device->copied_to_host(), pixels);
}

TEST(LabelPictures, RefusesWhatItCannotLabel) {
  Random random(12);
  const DepthImage depth(8, 8, 1000);
  const DeviceLabeller device(random_forest(random, {}), simulated());
  EXPECT_THROW(device.label_pictures({depth}, {}, {}, {}), Error);
  EXPECT_THAT(device.label_pictures({}, {}, {}, {}), testing::IsEmpty());
}

TEST(DeviceLabeller, KeepsItsMemoryForTheNextPicture) {
  Random random(13);
  const auto device = simulated();
  const DeviceLabeller labeller(random_forest(random, {}), device);
  const DepthImage depth = random_scene(random, 40, 40);
  labeller.label(depth_frame(depth, camera_of(depth)));
  const std::size_t used = device->allocated_bytes();
  for (int i = 0; i < 3; ++i) labeller.label(depth_frame(random_scene(random, 40, 39), camera_of(depth)));
  EXPECT_EQ(device->allocated_bytes(), used);
}

TEST(DeviceLabeller, CopiesNothingBackThatNobodyWrote) {
  Random random(7);
  const Forest forest = random_forest(random, {LeafKind::headings, true, 3, 127, 800});
  const DeviceLabeller device(forest, simulated());
  DepthImage depth = random_scene(random, 40, 30);
  for (int v = 10; v < 20; ++v) std::fill_n(depth.row(v), depth.width(), std::uint16_t{0});
  Posteriors found;
  for (int again = 0; again < 2; ++again) {
    device.label_into(depth_frame(depth, camera_of(depth)), kNoGate, found);
    ASSERT_GT(found.turn_count(), 0U);
    for (int v = 10; v < 20; ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        ASSERT_EQ(std::count(found.turns_at(u, v), found.turns_at(u, v) + found.turn_count(), 0), found.turn_count());
        ASSERT_EQ(std::count(found.at(u, v), found.at(u, v) + found.classes, 0), found.classes);
      }
    }
  }
}

TEST(DeviceLabeller, SaysWhenADeviceIsTooSmallOrLost) {
  Random random(14);
  const Forest forest = random_forest(random, {});
  const DepthImage depth = random_scene(random, 60, 40);
  EXPECT_THAT([&] { DeviceLabeller(forest, simulated({.memory_bytes = 1000})); },
              testing::ThrowsMessage<DeviceError>(testing::HasSubstr("simulated card: no room for")));
  const auto small = simulated({.memory_bytes = 200'000});
  const DeviceLabeller crowded(forest, small);
  EXPECT_THROW(crowded.label(depth_frame(depth, camera_of(depth))), DeviceError);
  const DepthImage part = random_scene(random, 12, 12);
  expect_same_labels(forest, crowded, part, kGate);  // a smaller picture still fits

  int lost = 0;
  for (int after = 5; after < 60; after += 3) {
    try {
      const DeviceLabeller labeller(forest, simulated({.lost_after = after}));
      Posteriors out;
      labeller.label_into(depth_frame(depth, camera_of(depth)), kGate, out);
      Posteriors expected;
      ForestLabeller(forest).label_into(depth_frame(depth, camera_of(depth)), kGate, expected);
      expect_same(out, expected, depth);
    } catch (const DeviceError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("the device was lost"));
      ++lost;
    }
  }
  EXPECT_GT(lost, 5);
  EXPECT_LT(lost, 18);
}

/// Returns whether labels of a device with a planted fault differ from the processor's in any order of threads, or the
/// simulator notices the fault.
bool is_found(const Forest& forest, const DepthImage& depth, SimulatedDeviceOptions options) {
  for (const bool backwards : {false, true}) {
    options.simulator.backwards = backwards;
    const Camera camera = camera_of(depth);
    Posteriors expected, found, mean;
    ForestLabeller(forest).label_into(depth_frame(depth, camera), kGate, expected);
    try {
      const DeviceLabeller device(forest, simulated(options));
      device.label_and_smooth_into(depth_frame(depth, camera), kGate, {}, found, mean);
    } catch (const std::logic_error&) {
      return true;
    }
    const Posteriors smooth = mean_filter(expected, depth, camera, {});
    if (found.sums != expected.sums || found.settled != expected.settled || mean.sums != smooth.sums) return true;
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0 || expected.settled(u, v) != 0) continue;
        if (!std::equal(expected.turns_at(u, v), expected.turns_at(u, v) + expected.turn_count(),
                        found.turns_at(u, v))) {
          return true;
        }
      }
    }
  }
  return false;
}

class PlantedFaults : public testing::Test {
 protected:
  Random random_{15};
  Forest forest_ = random_forest(random_, {});
  DepthImage depth_ = random_scene(random_, 67, 45);
};

TEST_F(PlantedFaults, NothingIsFoundWithoutOne) { EXPECT_FALSE(is_found(forest_, depth_, {})); }

TEST_F(PlantedFaults, EveryBarrierThatIsLeftOutIsFound) {
  const std::vector<std::pair<std::string, int>> barriers{
      {SelectArguments::kName, 3}, {LogitArguments::kName, 6}, {SettleArguments::kName, 1}, {MeanArguments::kName, 1}};
  for (const auto& [kernel, count] : barriers) {
    for (int barrier = 0; barrier < count; ++barrier) {
      const SimulatorOptions simulator{.zeroed = true, .faults = {.left_out_barrier = barrier}};
      EXPECT_TRUE(is_found(forest_, depth_, {.simulator = simulator, .faulty_kernel = kernel}))
          << kernel << ", barrier " << barrier;
    }
  }
}

TEST_F(PlantedFaults, AProbeOneColumnBeyondTheBorderIsFound) {
  for (const int columns : {-1, 1}) {
    EXPECT_TRUE(is_found(forest_, depth_, {.columns_too_many = columns})) << columns;
  }
}

TEST_F(PlantedFaults, SharedMemoryThatIsTooSmallIsFound) {
  // One element less goes unnoticed unless blocks use all that they have, as those of 1024 threads do.
  const DeviceLabeller device(forest_, simulated({.simulator = {.faults = {.missing_shared = 1}}}), {kMostThreads});
  EXPECT_THROW(device.label(depth_frame(depth_, camera_of(depth_))), std::logic_error);
}

}  // namespace
}  // namespace vesalius::gpu

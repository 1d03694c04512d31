#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cuda/cuda_device.h"
#include "cuda/device_labeller.h"
#include "cuda/device_network.h"
#include "cuda/test_forests.h"
#include "simulator/simulated_device.h"
#include "vesalius/error.h"
#include "vesalius/network/test_networks.h"

namespace vesalius::gpu {
namespace {

using test::expect_same;
using test::LeafKind;
using test::random_forest;
using test::random_scene;

/// Returns why no card can be used; empty if one can.
std::string no_card() {
  try {
    open_cuda_device(0);
    return {};
  } catch (const DeviceError& e) {
    return e.what();
  }
}

#define VESALIUS_NEEDS_CARD() \
  if (const std::string reason = no_card(); !reason.empty()) GTEST_SKIP() << reason

// Labels: gpu
TEST(Card, GivesTheProcessorsBitsForEveryKindOfForest) {
  VESALIUS_NEEDS_CARD();
  for (const LeafKind leaves : {LeafKind::votes, LeafKind::distributions, LeafKind::logits, LeafKind::headings}) {
    for (const int max_offset : {127, kMaxOffset}) {
      for (const unsigned threads : {32U, 96U, 256U, 1024U}) {
        Random random(5);
        const Forest forest = random_forest(random, {.leaves = leaves, .trees = 5, .max_offset = max_offset});
        const DeviceLabeller card(forest, open_cuda_device(0), {threads});
        const ForestLabeller processor(forest);
        const DepthImage depth = random_scene(random, 331, 243);
        const Camera camera{331, 243, 300.F, 301.F, 160.F, 120.F};
        for (const float gate : {0.5F, 2.F}) {
          Posteriors expected, found, mean;
          processor.label_into(depth_frame(depth, camera), gate, expected);
          ASSERT_TRUE(card.label_and_smooth_into(depth_frame(depth, camera), gate, {}, found, mean));
          expect_same(found, expected, depth);
          EXPECT_EQ(mean.sums, mean_filter(expected, depth, camera, {}).sums);
        }
      }
    }
  }
}

// Labels: gpu
TEST(Card, GivesTheProcessorsBitsForNetworks) {
  VESALIUS_NEEDS_CARD();
  constexpr int kParts = 25;
  Random random(7);
  std::vector<Network> networks = {test::random_network(random, test::kLargeShape, kParts)};
  for (int n = 0; n < 20; ++n) networks.push_back(test::random_tangle(random, kParts, 40));
  for (const Network& network : networks) {
    const DeviceNetwork card(network, kParts, open_cuda_device(0));
    const NetworkRunner processor(network, kParts);
    for (const auto& [width, height] : {std::pair{320, 256}, {32, 64}}) {
      const NetworkInput input = test::random_input(random, width, height);
      NetworkResult found, expected;
      card.run(input, found);
      processor.run(input, expected);
      EXPECT_TRUE(found.classes.values == expected.classes.values);
      EXPECT_TRUE(found.person.values == expected.person.values);
      EXPECT_TRUE(found.centres.values == expected.centres.values);
    }
  }
}

// Labels: gpu
TEST(Card, GivesTheSameBitsInBatchesAndFromSeveralThreads) {
  VESALIUS_NEEDS_CARD();
  Random random(6);
  const Forest forest = random_forest(random, {.trees = 8});
  const DeviceLabeller card(forest, open_cuda_device(0));
  const DeviceLabeller simulated(forest, std::make_shared<SimulatedDevice>());
  std::vector<DepthImage> pictures;
  for (int i = 0; i < 24; ++i) pictures.push_back(random_scene(random, i < 12 ? 320 : 512, i < 12 ? 240 : 424));
  std::vector<Camera> cameras;
  for (const DepthImage& p : pictures) cameras.push_back({p.width(), p.height(), 280.F, 281.F, 160.F, 120.F});
  const std::vector<LabelImage> expected = simulated.label_pictures(pictures, cameras, {}, {});
  std::vector<std::vector<LabelImage>> found(4);
  std::vector<std::thread> threads;
  for (std::vector<LabelImage>& labels : found) {
    threads.emplace_back([&] { labels = card.label_pictures(pictures, cameras, {}, {}); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<LabelImage>& labels : found) EXPECT_EQ(labels, expected);
}

// Labels: gpu
TEST(Card, FillsItsMultiprocessors) {
  VESALIUS_NEEDS_CARD();
  for (const KernelFacts& kernel : kernel_facts(0)) {
    EXPECT_EQ(kernel.local_bytes, 0U) << kernel.name << " spills registers";
    EXPECT_GE(kernel.occupancy, 0.5F) << kernel.name;
  }
}

TEST(Card, SaysWhatIsMissing) {
  const std::string reason = no_card();
  if (reason.empty()) {
    EXPECT_FALSE(cuda_devices().empty());
    EXPECT_THAT([] { open_cuda_device(1000); }, testing::ThrowsMessage<DeviceError>(testing::HasSubstr("cuda:1000")));
    return;
  }
  EXPECT_THAT(reason, testing::StartsWith("cuda: "));
  EXPECT_THAT(reason, testing::HasSubstr(has_cuda() ? "no card" : "no kernels"));
  EXPECT_THROW(cuda_devices(), DeviceError);
  EXPECT_THROW(kernel_facts(0), DeviceError);
}

}  // namespace
}  // namespace vesalius::gpu

// Labels: threads
#include "vesalius/network/network_labeller.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"
#include "vesalius/error.h"
#include "vesalius/model.h"
#include "vesalius/network/network_input.h"
#include "vesalius/network/test_networks.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kParts = 3;

Frame frame_of(DepthImage depth, float focal_px = 285.F) {
  Frame frame;
  frame.camera = {.width = depth.width(), .height = depth.height(), .fx = focal_px, .fy = focal_px};
  frame.depth = std::move(depth);
  return frame;
}

DepthImage random_depth(Random& random, int width, int height) {
  DepthImage depth(width, height, 0);
  for (std::uint16_t& mm : depth) {
    if (random.below(5) != 0) mm = static_cast<std::uint16_t>(500 + random.below(4000));
  }
  return depth;
}

/// A network that tells classes by the sums of its windows: any will do.
Network any_network(std::uint64_t seed) {
  Random random(seed, 0);
  return test::random_network(random, {{8, 12, 16, 20, 24}, {0, 1, 1, 1, 1}, {20, 16, 12, 8}}, kParts);
}

std::vector<int> input_at(const NetworkInput& input, int u, int v) {
  const std::uint8_t* first = input.values.data() + std::ptrdiff_t(v * input.width + u) * kNetworkInputs;
  return {first, first + kNetworkInputs};
}

TEST(NetworkInput, TellsHowNearAPixelIsAndHowSteepTheSurface) {
  DepthImage depth(20, 10, 2000);
  for (int v = 0; v < 10; ++v) {
    for (int u = 10; u < 20; ++u) depth(u, v) = static_cast<std::uint16_t>(2000 + 10 * (u - 10));
  }
  depth(3, 3) = 0;
  NetworkInput input;
  fill_network_input(depth, 285.F, input);
  EXPECT_EQ(input.width, 32);
  EXPECT_EQ(input.height, 32);
  constexpr int zero = kNetworkZero, there = kNetworkZero + 32;
  // 2 / 2 m - .7 = .3 is 38.4 steps of 1 / 128: 10 coarse ones of four less 2.
  EXPECT_THAT(input_at(input, 5, 5), ElementsAre(zero + 10, zero - 2, there, zero, zero, zero, zero, zero));
  EXPECT_THAT(input_at(input, 3, 3), testing::Each(zero)) << "no reading";
  EXPECT_THAT(input_at(input, 25, 5), testing::Each(zero)) << "beyond the picture";
  EXPECT_EQ(input_at(input, 5, 3)[3], zero) << "beside a hole";
  // 40 mm over 4 pixels of 2040 / 285 mm, at 14: slope 1.397, 44.7 steps.
  EXPECT_EQ(input_at(input, 14, 5)[3], zero + 45);
  EXPECT_EQ(input_at(input, 14, 5)[4], zero);
  EXPECT_EQ(input_at(input, 1, 5)[3], zero) << "at the border";
}

TEST(NetworkInput, IsTheSameForHalfTheFocalLengthAtHalfTheDistance) {
  NetworkInput here, there;
  fill_network_input(DepthImage(40, 30, 3000), 570.F, here);
  fill_network_input(DepthImage(40, 30, 1500), 285.F, there);
  EXPECT_EQ(here.values, there.values);
}

TEST(NetworkInput, IsTheSameForEveryInstructionSet) {
  Random random(4, 0);
  for (const auto& size : {std::pair{1, 1}, std::pair{3, 6}, std::pair{21, 9}, std::pair{75, 53}}) {
    const int width = size.first, height = size.second;
    DepthImage depth = random_depth(random, width, height);
    depth(0, 0) = 65535;
    depth(width - 1, height - 1) = 1;
    NetworkInput expected;
    for_each_target([&](const char* target) {
      NetworkInput input;
      fill_network_input(depth, 525.F, input);
      if (expected.values.empty()) expected = input;
      EXPECT_EQ(input.values, expected.values) << target << ' ' << width << 'x' << height;
    });
  }
}

TEST(NetworkInput, IsClampedWhereCloser) {
  NetworkInput input;
  fill_network_input(DepthImage(8, 8, 1), 600.F, input);
  EXPECT_EQ(input_at(input, 4, 4)[0], 255);
}

TEST(NetworkLabeller, GivesTheSameForAnyNumberOfThreads) {
  Random random(5, 0);
  const Network network = any_network(1);
  const NetworkLabeller labeller(network, kParts);
  const Frame frame = frame_of(random_depth(random, 75, 53));
  Posteriors expected;
  {
    const ThreadLimit limit(1);
    labeller.label_into(frame, 0.7F, expected);
  }
  for (const int threads : {2, 7}) {
    const ThreadLimit limit(threads);
    Posteriors got;
    labeller.label_into(frame, 0.7F, got);
    EXPECT_EQ(got.sums, expected.sums);
    EXPECT_EQ(got.votes, expected.votes);
    EXPECT_EQ(got.part_votes, expected.part_votes);
    EXPECT_EQ(got.settled, expected.settled);
  }
}

TEST(NetworkLabeller, AnswersEveryPixelWithAReading) {
  Random random(6, 0);
  const NetworkLabeller labeller(any_network(2), kParts);
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{2, 3}, std::pair{33, 31}, std::pair{64, 32}}) {
    const Frame frame = frame_of(random_depth(random, width, height));
    const Posteriors out = labeller.label(frame);
    ASSERT_EQ(out.width, width);
    ASSERT_EQ(out.classes, kParts + 1);
    EXPECT_EQ(out.votes.width(), (width + kVoteStep - 1) / kVoteStep);
    EXPECT_EQ(out.votes.height(), (height + kVoteStep - 1) / kVoteStep);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        int sum = 0;
        for (int c = 0; c < out.classes; ++c) sum += out.at(u, v)[c];
        if (frame.depth(u, v) == 0) {
          EXPECT_EQ(sum, 0) << u << "," << v;
        } else {
          EXPECT_NEAR(sum, out.whole, out.classes) << u << "," << v;
        }
      }
    }
  }
}

TEST(NetworkLabeller, TakesBetweenItsPixelsWhatThoseOfTheSameDepthSay) {
  Random random(7, 0);
  DepthImage depth(32, 32, 1500);
  for (int v = 0; v < 32; ++v) {
    for (int u = 15; u < 32; ++u) depth(u, v) = 3000;
  }
  const Frame frame = frame_of(depth);
  const Posteriors out = NetworkLabeller(any_network(3), kParts).label(frame);
  for (int v = 0; v < 32; v += 2) {
    for (int c = 0; c < out.classes; ++c) {
      EXPECT_EQ(out.at(15, v)[c], out.at(16, v)[c]) << "column 15 is of the far half, 14 of the near one";
      EXPECT_NEAR(out.at(21, v)[c], 0.5 * (out.at(20, v)[c] + out.at(22, v)[c]), 1.0);
    }
  }
}

TEST(NetworkLabeller, MarksWhereTheBackgroundIsCertainAsSettled) {
  Network network = any_network(4);
  Convolution& classes = network.layers[std::size_t(network.classes_of)];
  std::ranges::fill(classes.scale, 1e-6F);
  std::ranges::fill(classes.offset, 0.F);
  classes.offset.back() = 32000.F;  // the background
  const Frame frame = frame_of(DepthImage(40, 40, 2000));
  Posteriors out;
  const NetworkLabeller labeller(network, kParts);
  labeller.label_into(frame, 0.7F, out);
  EXPECT_THAT(std::vector(out.settled.begin(), out.settled.end()), testing::Each(1));
  EXPECT_EQ(out.at(7, 7)[kParts], out.whole);
  labeller.label_into(frame, 2.F, out);
  EXPECT_TRUE(out.settled.empty()) << "with a gate above 1";
}

TEST(NetworkLabeller, LabelsTheSameWithoutCentres) {
  Random random(10, 0);
  const Network network = any_network(5);
  const Frame frame = frame_of(random_depth(random, 75, 53));
  const Posteriors with = NetworkLabeller(network, kParts).label(frame);
  const Posteriors without = NetworkLabeller(test::without_centres(network), kParts).label(frame);
  EXPECT_EQ(with.sums, without.sums);
  EXPECT_EQ(with.votes, without.votes);
  EXPECT_EQ(without.part_votes, PartVotes{});
}

TEST(NetworkLabeller, VotesForPartsAsTheNetworkSays) {
  Random random(11, 0);
  const Network network = any_network(6);
  const Frame frame = frame_of(random_depth(random, 75, 53));
  NetworkInput input;
  fill_network_input(frame.depth, frame.camera.fx, input);
  NetworkResult result;
  NetworkRunner(network, kParts).run(input, result);
  const NetworkLabeller labeller(network, kParts);
  Posteriors out;
  labeller.label_into(frame_of(random_depth(random, 200, 100)), 2.F, out);
  labeller.label_into(frame, 2.F, out);  // in the memory of a larger one
  EXPECT_EQ(out.part_votes.width, 10);
  EXPECT_EQ(out.part_votes.height, 7);
  ASSERT_EQ(out.part_votes.parts, kParts);
  ASSERT_EQ(out.part_votes.ways_mm.size(), 10U * 7U * kParts * 3U);
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 10; ++column) {
      EXPECT_TRUE(std::equal(out.part_votes.at(column, row), out.part_votes.at(column, row) + 3 * kParts,
                             result.centres.at(column, row)));
    }
  }
}

TEST(NetworkLabeller, RefusesPicturesThatAreTooLarge) {
  const NetworkLabeller labeller(any_network(4), kParts);
  EXPECT_THAT([&] { labeller.label(frame_of(DepthImage(16001, 1, 0))); }, ThrowsMessage<Error>(HasSubstr("16000")));
}

Model network_model() {
  Random random(8, 0);
  Model model;
  model.body = paper_body();
  model.network = std::make_shared<Network>(
      test::random_network(random, {{8, 12, 16, 20, 24}, {0, 1, 1, 1, 1}, {20, 16, 12, 8}}, model.body.part_count()));
  return model;
}

/// A labeller whose device, which runs the network as the processor does, is lost after one picture.
std::shared_ptr<const Labeller> lost_after_one(const Model& model) {
  const int parts = model.body.part_count();
  const auto runner = std::make_shared<const NetworkRunner>(*model.network, parts);
  const auto left = std::make_shared<std::atomic<int>>(1);
  return std::make_shared<NetworkLabeller>(
      [=](const NetworkInput& input, NetworkResult& out) {
        if ((*left)-- <= 0) throw DeviceError("loom:1: lost");
        runner->run(input, out);
      },
      parts);
}

TEST(NetworkModel, LabelsOnDevices) {
  Random random(9, 0);
  const Frame frame = frame_of(random_depth(random, 40, 30));
  const Model processor = on_device(network_model());
  const Posteriors expected = processor.labeller->label(frame);
  std::vector<std::string> heard;
  const LabellerDevices devices{{{"loom", [](const Model& model, int) { return lost_after_one(model); }}},
                                [&](const std::string& note) { heard.push_back(note); }};
  const Model model = on_device(network_model(), "loom:1", devices);
  EXPECT_EQ(model.network, nullptr);
  EXPECT_EQ(model.labeller->label(frame).sums, expected.sums);
  EXPECT_THROW(model.labeller->label(frame), DeviceError);
  const Model any = on_device(network_model(), "auto", devices);
  for (int n = 0; n < 3; ++n) {
    const Posteriors found = any.labeller->label(frame);
    EXPECT_EQ(found.sums, expected.sums);
    EXPECT_EQ(found.votes, expected.votes);
    EXPECT_EQ(found.part_votes, expected.part_votes);
  }
  EXPECT_THAT(heard, ElementsAre("loom:1: lost; the processor goes on"));
  EXPECT_THAT([&] { on_device(network_model(), "card", devices); },
              ThrowsMessage<UsageError>(HasSubstr("not known to this build")));
}

TEST(NetworkModel, HasNoForestBeside) {
  Model model = network_model();
  model.forest.trees.resize(1);
  EXPECT_THAT([&] { check(model); }, ThrowsMessage<Error>(HasSubstr("a forest and a network")));
}

}  // namespace
}  // namespace vesalius

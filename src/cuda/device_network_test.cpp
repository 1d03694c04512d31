#include "cuda/device_network.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cuda/cuda_labeller.h"
#include "cuda/test_forests.h"
#include "simulator/simulated_device.h"
#include "vesalius/error.h"
#include "vesalius/network/network_labeller.h"
#include "vesalius/network/test_networks.h"

namespace vesalius::gpu {
namespace {

using test::random_input;
using test::random_network;
using test::random_tangle;

constexpr int kParts = 3;
const test::NetworkShape kTinyShape = {{8, 12, 16, 20, 24}, {0, 1, 1, 1, 1}, {20, 16, 12, 8}};

std::shared_ptr<SimulatedDevice> simulated(const SimulatedDeviceOptions& options = {}) {
  return std::make_shared<SimulatedDevice>(options);
}

void expect_same(const WideImage& found, const WideImage& expected) {
  EXPECT_EQ(found.width, expected.width);
  EXPECT_EQ(found.height, expected.height);
  EXPECT_EQ(found.channels, expected.channels);
  EXPECT_TRUE(found.values == expected.values);  // not EXPECT_EQ, which would print them
}

void expect_same(const NetworkResult& found, const NetworkResult& expected) {
  expect_same(found.classes, expected.classes);
  expect_same(found.person, expected.person);
  expect_same(found.centres, expected.centres);
}

NetworkResult on_processor(const Network& network, int parts, const NetworkInput& input) {
  NetworkResult result;
  NetworkRunner(network, parts).run(input, result);
  return result;
}

TEST(DeviceNetwork, GivesTheProcessorsBitsForAnyConvolutions) {
  Random random(21);
  for (int n = 0; n < 12; ++n) {
    SCOPED_TRACE("network " + std::to_string(n));
    const int parts = 1 + int(random.below(30));
    const Network network = random_tangle(random, parts, 40);
    const int width = 32 * (1 + int(random.below(3))), height = 32 * (1 + int(random.below(2)));
    const NetworkInput input = random_input(random, width, height);
    NetworkResult found;
    DeviceNetwork(network, parts, simulated({.simulator = {.backwards = n % 2 == 1}})).run(input, found);
    expect_same(found, on_processor(network, parts, input));
  }
}

/// Sums that are as large as they can be; results beyond the range or half way between two integers.
TEST(DeviceNetwork, RoundsAndClampsAsTheProcessorDoes) {
  Random random(22);
  struct Numbers {
    int weight;
    float scale, offset;
  };
  constexpr float kTied = 1.F / (1 << 17);
  for (const Numbers& all : {Numbers{-128, 1e9F, -1e9F}, {127, 1e9F, 1e9F}, {127, kTied, 0.5F}, {-128, kTied, 0.5F}}) {
    Network network;
    const auto add = [&](const Convolution& c) {
      const int made = test::add_random(network, random, c);
      std::ranges::fill(network.layers.back().weights, static_cast<std::int8_t>(all.weight));
      std::ranges::fill(network.layers.back().scale, all.scale);
      std::ranges::fill(network.layers.back().offset, all.offset);
      return made;
    };
    const int half = add({.stride = 2, .inputs = kNetworkInputs, .outputs = 1024});
    std::ranges::fill(network.layers.back().weights, std::int8_t{127});
    std::ranges::fill(network.layers.back().offset, 255.F);
    network.classes_of = add({.input = half, .inputs = 1024, .outputs = kParts + 1, .wide = true}) - 1;
    const int quarter = add({.input = half, .stride = 2, .inputs = 1024, .outputs = 40});
    network.person_of = add({.input = quarter, .inputs = 40, .outputs = kPersonNumbers, .wide = true}) - 1;
    const NetworkInput input{32, 32, std::vector<std::uint8_t>(32 * 32 * kNetworkInputs, 255)};
    NetworkResult found;
    DeviceNetwork(network, kParts, simulated()).run(input, found);
    expect_same(found, on_processor(network, kParts, input));
  }
}

// Labels: threads
TEST(DeviceNetwork, RunsSeveralAtOnceAndOtherSizesInTurn) {
  Random random(23);
  const Network network = random_network(random, kTinyShape, kParts);
  const DeviceNetwork device(network, kParts, simulated());
  const std::vector<NetworkInput> inputs = {random_input(random, 64, 32), random_input(random, 32, 96)};
  const std::vector<NetworkResult> expected = {on_processor(network, kParts, inputs[0]),
                                               on_processor(network, kParts, inputs[1])};
  std::vector<std::thread> threads;
  threads.reserve(3);
  for (std::size_t t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      NetworkResult found;
      for (std::size_t n = t; n < t + 4; ++n) {
        device.run(inputs[n % 2], found);
        expect_same(found, expected[n % 2]);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(DeviceNetwork, MovesTheInputUpAndTheHeadsDown) {
  Random random(24);
  const auto device = simulated();
  const DeviceNetwork network(random_network(random, kTinyShape, kParts), kParts, device);
  const NetworkInput input = random_input(random, 64, 32);
  NetworkResult found;
  network.run(input, found);
  const std::size_t up = device->copied_to_device(), down = device->copied_to_host(), used = device->allocated_bytes();
  EXPECT_EQ(down, 2 * (found.classes.values.size() + found.person.values.size() + found.centres.values.size()));
  network.run(input, found);
  EXPECT_EQ(device->copied_to_device() - up, input.values.size());
  network.run(random_input(random, 32, 32), found);
  EXPECT_EQ(device->allocated_bytes(), used) << "memory is kept for the next picture";
}

TEST(DeviceNetwork, GivesNoCentresWhereTheNetworkHasNone) {
  Random random(28);
  const Network network = random_network(random, kTinyShape, kParts), without = test::without_centres(network);
  const NetworkInput input = random_input(random, 64, 32);
  NetworkResult found;
  DeviceNetwork(network, kParts, simulated()).run(input, found);
  EXPECT_EQ(found.centres.values.size(), 8U * 4U * kParts * kCentreNumbers);
  DeviceNetwork(without, kParts, simulated()).run(input, found);
  expect_same(found, on_processor(without, kParts, input));
  EXPECT_TRUE(found.centres.values.empty());
}

TEST(DeviceNetwork, SaysWhenADeviceIsTooSmallOrLost) {
  Random random(25);
  const Network network = random_network(random, kTinyShape, kParts);
  EXPECT_THAT([&] { DeviceNetwork(network, kParts, simulated({.memory_bytes = 1000})); },
              testing::ThrowsMessage<DeviceError>(testing::HasSubstr("simulated card: no room for")));
  const NetworkInput small = random_input(random, 32, 32), large = random_input(random, 96, 96);
  const DeviceNetwork crowded(network, kParts, simulated({.memory_bytes = 150'000}));
  NetworkResult found;
  EXPECT_THROW(crowded.run(large, found), DeviceError);
  crowded.run(small, found);  // a smaller picture still fits
  expect_same(found, on_processor(network, kParts, small));

  const int operations = 4 * int(network.layers.size()) + 4;  // numbers of each, its run, the input and the heads
  for (int after = 0; after <= operations; ++after) {
    const auto label = [&] { DeviceNetwork(network, kParts, simulated({.lost_after = after})).run(small, found); };
    if (after < operations) {
      EXPECT_THAT(label, testing::ThrowsMessage<DeviceError>(testing::HasSubstr("the device was lost"))) << after;
    } else {
      label();
    }
  }
}

TEST(DeviceNetwork, TakesNoOtherInputAndNetworkThanTheProcessor) {
  Random random(26);
  const DeviceNetwork network(random_network(random, kTinyShape, kParts), kParts, simulated());
  NetworkResult found;
  EXPECT_THAT([&] { network.run(random_input(random, 32, 48), found); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("expected multiples of 32")));
  EXPECT_THROW(DeviceNetwork({}, kParts, simulated()), Error);
}

TEST(MakeDeviceLabeller, LabelsByForestsAndNetworks) {
  Random random(27);
  Model by_network;
  by_network.body = paper_body();
  by_network.network =
      std::make_shared<const Network>(random_network(random, kTinyShape, by_network.body.part_count()));
  const DepthImage depth = test::random_scene(random, 75, 53);
  const Frame frame = depth_frame(depth, {75, 53, 70.F, 70.F, 37.F, 26.F});
  for (const Model& model : {by_network, Model(test::random_forest(random, {}))}) {
    const LabellerDevice simulator{"simulator",
                                   [](const Model& of, int) { return make_device_labeller(of, simulated()); }};
    const Model expected = on_device(model), found = on_device(model, "simulator", {{simulator}});
    for (const float gate : {0.7F, 2.F}) {
      Posteriors one, other;
      expected.labeller->label_into(frame, gate, one);
      found.labeller->label_into(frame, gate, other);
      test::expect_same(other, one, depth);
      EXPECT_EQ(one.votes.empty(), model.network == nullptr);
    }
  }
}

}  // namespace
}  // namespace vesalius::gpu

// Labels: threads
#define HWY_WANT_AVX3_DL  // as the kernels do

#include "vesalius/network/run_network.h"

#include <gmock/gmock.h>

#include <cfenv>
#include <cmath>
#include <thread>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"
#include "vesalius/error.h"
#include "vesalius/network/test_networks.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

struct Plain {
  int width;
  int height;
  int channels;
  std::vector<int> values;
};

int plain_value(const Plain& image, int x, int y, int c, int outside) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return outside;
  return image.values[static_cast<std::size_t>((y * image.width + x) * image.channels + c)];
}

std::int64_t plain_sum(const Convolution& c, const Plain& in, int x, int y, int output, int outside) {
  std::int64_t sum = 0;
  for (int row = 0; row < c.side; ++row) {
    for (int column = 0; column < c.side; ++column) {
      for (int i = 0; i < c.inputs; ++i) {
        const int u = x * c.stride + column - c.side / 2, v = y * c.stride + row - c.side / 2;
        const int weight =
            c.weights[static_cast<std::size_t>(((output * c.side + row) * c.side + column) * c.inputs + i)];
        sum += std::int64_t{weight} * plain_value(in, u, v, i, outside);
      }
    }
  }
  return sum;
}

/// The formula of Convolution, word by word.
Plain convolve_plainly(const Convolution& c, const Plain& in, const Plain* added, int outside) {
  Plain out{in.width / c.stride, in.height / c.stride, c.outputs, {}};
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int o = 0; o < c.outputs; ++o) {
        const auto at = static_cast<std::size_t>(o);
        const float product = c.scale[at] * float(plain_sum(c, in, x, y, o, outside));
        float value = product + c.offset[at];
        if (added != nullptr) {
          const int shrunk = out.width / added->width;
          const float more = c.added_scale * float(plain_value(*added, x / shrunk, y / shrunk, o, 0));
          value = value + more;
        }
        const double rounded = std::nearbyint(double{value});
        out.values.push_back(int(c.wide ? std::clamp(rounded, -32768.0, 32767.0) : std::clamp(rounded, 0.0, 255.0)));
      }
    }
  }
  return out;
}

NetworkResult run_plainly(const Network& network, const NetworkInput& input) {
  std::vector<Plain> made = {{input.width, input.height, kNetworkInputs, {input.values.begin(), input.values.end()}}};
  for (const Convolution& c : network.layers) {
    const Plain* added = c.added < 0 ? nullptr : &made[static_cast<std::size_t>(c.added)];
    made.push_back(
        convolve_plainly(c, made[static_cast<std::size_t>(c.input)], added, c.input == 0 ? kNetworkZero : 0));
  }
  const auto head = [&](int layer) -> WideImage {
    if (layer < 0) return {};
    const Plain& p = made[static_cast<std::size_t>(layer) + 1];
    return {p.width, p.height, p.channels, {p.values.begin(), p.values.end()}};
  };
  return {head(network.classes_of), head(network.person_of), head(network.centres_of)};
}

void expect_same(const WideImage& got, const WideImage& expected, const std::string& what) {
  EXPECT_EQ(got.width, expected.width) << what;
  EXPECT_EQ(got.height, expected.height) << what;
  EXPECT_EQ(got.channels, expected.channels) << what;
  EXPECT_TRUE(got.values == expected.values) << what;  // not EXPECT_EQ, which would print them
}

void expect_same(const NetworkResult& got, const NetworkResult& expected, const std::string& what) {
  expect_same(got.classes, expected.classes, "classes " + what);
  expect_same(got.person, expected.person, "votes " + what);
  expect_same(got.centres, expected.centres, "centres " + what);
}

/// On every instruction set and for 1, 2 and 7 threads.
void expect_plain_result(const Network& network, int parts, const NetworkInput& input) {
  const NetworkResult expected = run_plainly(network, input);
  for_each_target([&](const char* target) {
    const NetworkRunner runner(network, parts);
    NetworkResult result;
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      runner.run(input, result);
      expect_same(result, expected, std::string(target) + ", " + std::to_string(threads) + " threads");
    }
  });
}

TEST(NetworkRunner, ComputesTheFormulaOnEveryInstructionSetAndNumberOfThreads) {
  Random random(11);
  for (int n = 0; n < 8; ++n) {
    const int parts = 1 + int(random.below(30));
    const Network network = test::random_tangle(random, parts, 40);
    const int width = 32 * (1 + int(random.below(3))), height = 32 * (1 + int(random.below(2)));
    expect_plain_result(network, parts, test::random_input(random, width, height));
  }
}

TEST(NetworkRunner, ComputesTheFormulaInTheShapeOfAnEncoderAndDecoder) {
  Random random(12);
  expect_plain_result(test::random_network(random, {{12, 20, 33, 40, 17}, {0, 1, 1, 0, 1}, {40, 24, 20, 16}}, 25), 25,
                      test::random_input(random, 96, 64));
}

TEST(NetworkRunner, CountsSumsAtTheExtremesOfTheirRange) {
  for (const int sign : {-1, 1}) {
    for (const bool tied : {false, true}) {
      Random random(13);
      Network network;
      const auto add = [&](const Convolution& c) {
        const int made = test::add_random(network, random, c);
        std::ranges::fill(network.layers.back().weights, static_cast<std::int8_t>(sign < 0 ? -128 : 127));
        // Results end beyond the range or, tied, half way between two integers.
        std::ranges::fill(network.layers.back().scale, tied ? std::ldexp(1.F, -17) : 1e9F);
        std::ranges::fill(network.layers.back().offset, tied ? 0.5F : -1e9F);
        return made;
      };
      const int half = add({.stride = 2, .inputs = kNetworkInputs, .outputs = 1024});
      std::ranges::fill(network.layers.back().weights, std::int8_t{127});
      std::ranges::fill(network.layers.back().offset, 255.F);
      network.classes_of = add({.input = half, .inputs = 1024, .outputs = 3, .wide = true}) - 1;
      const int quarter = add({.input = half, .stride = 2, .inputs = 1024, .outputs = 40});
      network.person_of = add({.input = quarter, .inputs = 40, .outputs = kPersonNumbers, .wide = true}) - 1;
      NetworkInput input{32, 32, std::vector<std::uint8_t>(32 * 32 * kNetworkInputs, 255)};
      expect_plain_result(network, 2, input);
    }
  }
}

TEST(NetworkRunner, SeesNoReadingOutsideOfTheInputAndZeroOutsideOfTheRest) {
  Random random(14);
  Network network;
  const auto add_ones = [&](const Convolution& c, float scale) {
    const int made = test::add_random(network, random, c);
    std::ranges::fill(network.layers.back().weights, std::int8_t{1});
    std::ranges::fill(network.layers.back().scale, scale);
    std::ranges::fill(network.layers.back().offset, 0.F);
    return made;
  };
  const int half = add_ones({.stride = 2, .inputs = kNetworkInputs, .outputs = 1}, 1.F / (9 * kNetworkInputs));
  network.classes_of = add_ones({.input = half, .inputs = 1, .outputs = 2, .wide = true}, 1.F) - 1;
  network.person_of =
      add_ones({.input = half, .stride = 2, .inputs = 1, .outputs = kPersonNumbers, .wide = true}, 1.F) - 1;
  NetworkInput input{32, 64, std::vector<std::uint8_t>(32 * 64 * kNetworkInputs, kNetworkZero)};
  NetworkResult result;
  NetworkRunner(network, 1).run(input, result);
  ASSERT_EQ(result.classes.values.size(), 16U * 32U * 2U);
  EXPECT_EQ(result.classes.values[0], 4 * kNetworkZero) << "a corner has four neighbours";
  EXPECT_EQ(result.classes.values[2], 6 * kNetworkZero);
  EXPECT_EQ(result.classes.values[2 * 17], 9 * kNetworkZero);
  EXPECT_EQ(result.classes.values.back(), 4 * kNetworkZero);
  ASSERT_EQ(result.person.values.size(), 8U * 16U * kPersonNumbers);
  EXPECT_EQ(result.person.values[0], 4 * kNetworkZero);
  EXPECT_EQ(result.person.values.back(), 9 * kNetworkZero) << "the last of every second pixel is inside";
}

TEST(NetworkRunner, RunsSeveralAtOnceAndOtherSizesInTurn) {
  Random random(15);
  const Network network = test::random_network(random, {{8, 12, 16, 20, 24}, {0, 1, 1, 1, 1}, {20, 16, 12, 8}}, 4);
  const NetworkRunner runner(network, 4);
  const NetworkInput inputs[] = {test::random_input(random, 64, 32), test::random_input(random, 32, 96)};
  const NetworkResult expected[] = {run_plainly(network, inputs[0]), run_plainly(network, inputs[1])};
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      NetworkResult result;
      for (int n = t; n < t + 8; ++n) {
        runner.run(inputs[n % 2], result);
        expect_same(result, expected[n % 2], "thread " + std::to_string(t));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(NetworkRunner, GivesNoCentresWhereTheNetworkHasNone) {
  Random random(17);
  const Network network = test::random_network(random, {{8, 12, 16, 20, 24}, {0, 1, 1, 1, 1}, {20, 16, 12, 8}}, 25);
  const Network without = test::without_centres(network);
  const NetworkInput input = test::random_input(random, 64, 32);
  const NetworkRunner with(network, 25), none(without, 25);
  NetworkResult result;
  for (int turn = 0; turn < 2; ++turn) {
    with.run(input, result);
    EXPECT_EQ(result.centres.channels, 75);
    EXPECT_EQ(result.centres.values.size(), 8U * 4U * 75U);
    expect_same(result, run_plainly(network, input), "with centres");
    none.run(input, result);
    expect_same(result, run_plainly(without, input), "without centres");
    expect_same(result.centres, {}, "none");
  }
}

TEST(NetworkRunner, TakesNoOtherInputThanItSays) {
  Random random(16);
  const NetworkRunner runner(test::random_network(random, {{4, 4, 4, 4, 4}, {0, 0, 0, 0, 0}, {4, 4, 4, 4}}, 1), 1);
  NetworkResult result;
  const auto message =
      testing::ThrowsMessage<Error>(testing::HasSubstr("expected multiples of 32 and 8 values a pixel"));
  EXPECT_THAT([&] { runner.run(test::random_input(random, 32, 48), result); }, message);
  EXPECT_THAT([&] { runner.run({}, result); }, message);
  NetworkInput cut = test::random_input(random, 32, 32);
  cut.values.pop_back();
  EXPECT_THAT([&] { runner.run(cut, result); }, message);
  Network headless;
  EXPECT_THROW(NetworkRunner(headless, 1), Error);
}

}  // namespace
}  // namespace vesalius

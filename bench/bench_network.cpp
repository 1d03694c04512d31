#define HWY_WANT_AVX3_DL  // as the kernels do

#include "bench/bench_network.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "vesalius/base/test_targets.h"
#include "vesalius/network/test_networks.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kParts = 25;

void add(const std::string& name, const std::shared_ptr<const NetworkRunner>& runner, int threads) {
  benchmark::RegisterBenchmark(("network" + name).c_str(),
                               [=](benchmark::State& state) {
                                 const ThreadLimit limit(threads);
                                 Random random(2);
                                 const NetworkInput input = test::random_input(random, 320, 256);
                                 NetworkResult result;
                                 for (auto _ : state) runner->run(input, result);
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void add_shape(const std::string& name, const test::NetworkShape& shape) {
  Random random(1);
  const Network network = test::random_network(random, shape, kParts);
  const auto runner = [&] { return std::make_shared<const NetworkRunner>(network, kParts); };
  add("/" + name, runner(), 0);
  for_each_target([&](const char* target) { add(std::string(":") + target + "/" + name, runner(), 1); });
}

}  // namespace

void add_network_benchmarks() {
  add_shape("small", test::kSmallShape);
  add_shape("large", test::kLargeShape);
}

}  // namespace vesalius

#include "simulator/simulator.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "cuda/kernels.h"
#include "simulator/gpu_words.h"
#include "simulator/simulated_device.h"
#include "vesalius/error.h"

namespace vesalius::gpu {
namespace {

/// Every block adds up its values by halves, as a kernel would.
GPU_KERNEL void sum_kernel(const std::uint32_t* values, std::uint32_t* sums) {
  GPU_SHARED(std::uint32_t, part, 64);
  GPU_PHASE(thread) { part[thread] = values[block_x() * threads_in_block() + thread]; }
  for (unsigned half = threads_in_block() / 2; half > 0; half /= 2) {
    GPU_PHASE(thread) {
      if (thread < half) part[thread] += part[thread + half];
    }
  }
  GPU_LAST_PHASE(thread) {
    if (thread == 0) add(&sums[block_y()], part[0]);
  }
}

std::vector<std::uint32_t> sums(const SimulatorOptions& options, unsigned threads = 64) {
  std::vector<std::uint32_t> values(8 * std::size_t{threads}), out(2, 0);
  std::iota(values.begin(), values.end(), 1U);
  Simulator::run({8, 2, threads}, options, [&] { sum_kernel(values.data(), out.data()); });
  return out;
}

TEST(Simulator, RunsEveryThreadOfEveryBlockWithBarriersBetween) {
  const std::uint32_t expected = 512 * 513 / 2;
  for (const bool backwards : {false, true}) {
    EXPECT_THAT(sums({.backwards = backwards}), testing::ElementsAre(expected, expected));
  }
}

TEST(Simulator, ShowsABarrierThatIsLeftOut) {
  for (int barrier = 0; barrier < 6; ++barrier) {  // the one behind waits for a thread's own value
    const Faults faults{.left_out_barrier = barrier};
    const bool shown = sums({.faults = faults}) != sums({}) || sums({.backwards = true, .faults = faults}) != sums({});
    EXPECT_TRUE(shown) << "barrier " << barrier;
  }
}

TEST(Simulator, ChecksSharedMemoryAndShapes) {
  EXPECT_THAT([&] { sums({.faults = {.missing_shared = 1}}); },
              testing::ThrowsMessage<std::logic_error>("place 63 of a shared array of 63"));
  EXPECT_THROW(sums({}, 128), std::logic_error);
  EXPECT_THROW(sums({}, 0), std::logic_error);
  EXPECT_THROW(sums({}, 2048), std::logic_error);
}

TEST(SimulatedDevice, DoesNothingBeforeSomebodyWaits) {
  const auto device = std::make_shared<SimulatedDevice>();
  const auto stream = device->make_stream();
  const DeviceArray<int> array(device, 3);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 256, 0U);
  std::vector<int> sent{1, 2, 3}, back(3, 0);
  stream->copy_to_device(array.data(), sent.data(), array.bytes());
  stream->copy_to_host(back.data(), array.data(), array.bytes());
  sent[0] = 7;  // too early: a card may not have read it yet
  EXPECT_THAT(back, testing::Each(0));
  const auto begin = device->make_event(), end = device->make_event();
  stream->record(*begin);
  stream->clear(array.data(), array.bytes());
  stream->record(*end);
  stream->wait();
  EXPECT_THAT(back, testing::ElementsAre(7, 2, 3));
  EXPECT_EQ(array.data()[1], 0);
  EXPECT_GE(end->ms_since(*begin), 0.0);
}

TEST(SimulatedDevice, NoticesCopiesBesideItsMemory) {
  const auto device = std::make_shared<SimulatedDevice>();
  const auto stream = device->make_stream();
  const DeviceArray<int> array(device, 3);
  std::vector<int> host(8, 0);
  stream->copy_to_host(host.data(), array.data(), array.bytes() + 1);
  EXPECT_THROW(stream->wait(), std::logic_error);
  stream->clear(host.data(), 4);
  EXPECT_THROW(stream->wait(), std::logic_error);
}

TEST(SimulatedDevice, NoticesKernelsThatWriteBesideTheirMemory) {
  const auto device = std::make_shared<SimulatedDevice>();
  const auto stream = device->make_stream();
  const DeviceArray<std::uint16_t> depth(device, 64);
  const DeviceArray<std::uint8_t> states(device, 3);  // one for each sixteenth pixel: four
  const DeviceArray<std::uint16_t> sums(device, 64);
  stream->clear(depth.data(), depth.bytes());
  GateArguments gate{{depth.data(), 8, 8, 1, 8}, sums.data(), 1, 1, states.data()};
  stream->launch(gate, {1, 1, 32});
  EXPECT_THROW(stream->wait(), std::logic_error);
}

TEST(SimulatedDevice, HasKernelsThatAreToldApartByTheirNames) {
  std::set<std::string> names;
  for (const SimulatedKernel& kernel : simulated_label_kernels()) {
    EXPECT_TRUE(names.insert(kernel.name).second) << kernel.name;
  }
  EXPECT_EQ(names.size(), 10U);
}

TEST(SimulatedDevice, RefusesKernelsThatItWasNotMadeFor) {
  const auto device = std::make_shared<SimulatedDevice>(SimulatedDeviceOptions{}, std::vector<SimulatedKernel>{});
  const auto stream = device->make_stream();
  stream->launch(GateArguments{}, {1, 1, 32});
  EXPECT_THROW(stream->wait(), std::logic_error);
}

TEST(SimulatedDevice, HasNoMoreMemoryThanItWasGiven) {
  const auto device = std::make_shared<SimulatedDevice>(SimulatedDeviceOptions{.memory_bytes = 100});
  DeviceArray<std::uint8_t> most(device, 100);
  EXPECT_THROW(device->allocate(1), DeviceError);
  most = {};
  EXPECT_EQ(device->allocated_bytes(), 0U);
}

}  // namespace
}  // namespace vesalius::gpu

#include "simulator/simulator.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "vesalius/parallel.h"

namespace vesalius::gpu {
namespace {

constexpr int kAll = std::numeric_limits<int>::max();

struct SharedMemory {
  int line = 0;
  std::vector<std::max_align_t> values;
};

/// A block on its way. With a planted fault it runs several times: the phases before the barrier that is left out, then
/// the two phases around it thread by thread, then the rest.
struct Block {
  unsigned x = 0, y = 0, threads = 0;
  bool backwards = false, zeroed = false;
  Faults faults;
  int first_phase = 0, last_phase = kAll;  ///< that run now
  int only_thread = -1;                    ///< that runs now; below 0 all
  int next_phase = 0;
  std::vector<SharedMemory> shared;
};

thread_local Block* running = nullptr;

void run_phases(Block& block, int first, int last, int only_thread, const std::function<void()>& kernel) {
  block.first_phase = first;
  block.last_phase = last;
  block.only_thread = only_thread;
  block.next_phase = 0;
  kernel();
}

void run_block(Block& block, const std::function<void()>& kernel) {
  const int left_out = block.faults.left_out_barrier;
  if (left_out < 0) {
    run_phases(block, 0, kAll, -1, kernel);
    return;
  }
  run_phases(block, 0, left_out - 1, -1, kernel);
  for (unsigned i = 0; i < block.threads; ++i) {
    const unsigned thread = block.backwards ? block.threads - 1 - i : i;
    run_phases(block, left_out, left_out + 1, int(thread), kernel);
  }
  run_phases(block, left_out + 2, kAll, -1, kernel);
}

}  // namespace

void Simulator::run(const LaunchShape& shape, const SimulatorOptions& options, const std::function<void()>& kernel) {
  if (shape.threads == 0 || shape.threads > kMostThreads || shape.blocks_x == 0 || shape.blocks_y == 0) {
    throw std::logic_error("a kernel's shape that no card takes");
  }
  constexpr int kGrain = 4;
  const auto blocks = int(shape.blocks_x * shape.blocks_y);
  parallel_ranges(blocks, kGrain, [&](int begin, int end) {
    Block block{.threads = shape.threads,
                .backwards = options.backwards,
                .zeroed = options.zeroed,
                .faults = options.faults,
                .shared = {}};
    Block* const outer = running;
    running = &block;
    try {
      for (int i = begin; i < end; ++i) {
        block.x = static_cast<unsigned>(i) % shape.blocks_x;
        block.y = static_cast<unsigned>(i) / shape.blocks_x;
        block.shared.clear();
        run_block(block, kernel);
      }
    } catch (...) {
      running = outer;
      throw;
    }
    running = outer;
  });
}

unsigned Simulator::block_x() { return running->x; }
unsigned Simulator::block_y() { return running->y; }
unsigned Simulator::threads_in_block() { return running->threads; }

Simulator::Threads Simulator::phase() {
  const Block& block = *running;
  const int phase = running->next_phase++;
  if (phase < block.first_phase || phase > block.last_phase) return {0, 0, false};
  if (block.only_thread >= 0) return {block.only_thread, 1, false};
  return {0, int(block.threads), block.backwards};
}

std::size_t Simulator::shortened(std::size_t count) {
  return count - std::min(count, static_cast<std::size_t>(running->faults.missing_shared));
}

std::byte* Simulator::memory(int line, std::size_t bytes) {
  std::vector<SharedMemory>& all = running->shared;
  auto found = std::ranges::find(all, line, &SharedMemory::line);
  if (found == all.end()) {
    constexpr std::size_t kUnit = sizeof(std::max_align_t);
    found = all.insert(all.end(), {line, std::vector<std::max_align_t>((bytes + kUnit - 1) / kUnit)});
    auto* bytes_of = reinterpret_cast<unsigned char*>(found->values.data());
    const unsigned char garbage = 0xA5;
    std::fill_n(bytes_of, found->values.size() * kUnit, running->zeroed ? std::uint8_t{0} : garbage);
  }
  return reinterpret_cast<std::byte*>(found->values.data());
}

void throw_beyond_shared(std::size_t place, std::size_t count) {
  throw std::logic_error("place " + std::to_string(place) + " of a shared array of " + std::to_string(count));
}

}  // namespace vesalius::gpu

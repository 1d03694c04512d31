#pragma once

// Runs kernels (gpu.h) on the processor, block by block and within a block phase by phase, the threads of a phase one
// after the other. It is strict where cards are lenient: threads can run in either order, shared memory starts as
// garbage, and every access to it is checked. Faults can be planted, to see that tests find them.

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

#include "cuda/launch_shape.h"

namespace vesalius::gpu {

/// Mistakes that a kernel's author could make.
struct Faults {
  int left_out_barrier = -1;  ///< the barrier behind this phase, from 0 on; below 0 none
  int missing_shared = 0;     ///< elements by which all shared arrays are too short
};

struct SimulatorOptions {
  bool backwards = false;  ///< the last thread of a block runs first
  bool zeroed = false;     ///< memory starts as zeros: what follows from a fault stays within bounds
  Faults faults = {};
};

/// An array in shared memory.
template <class T>
class SharedArray {
 public:
  SharedArray(T* values, std::size_t count) : values_(values), count_(count) {}
  /// Throws std::logic_error for a place beyond the end.
  T& operator[](std::size_t place) const;

 private:
  T* values_;
  std::size_t count_;
};

/// The block that runs on this thread of the processor, as gpu.h sees it.
class Simulator {
 public:
  /// The threads that run a phase, to loop over.
  class Threads {
   public:
    class Iterator {
     public:
      Iterator(int at, int step) : at_(at), step_(step) {}
      unsigned operator*() const { return static_cast<unsigned>(at_); }
      Iterator& operator++() {
        at_ += step_;
        return *this;
      }
      bool operator!=(const Iterator& other) const { return at_ != other.at_; }

     private:
      int at_, step_;
    };
    Threads(int first, int count, bool backwards)
        : begin_(backwards ? first + count - 1 : first, backwards ? -1 : 1),
          end_(backwards ? first - 1 : first + count, backwards ? -1 : 1) {}
    Iterator begin() const { return begin_; }
    Iterator end() const { return end_; }

   private:
    Iterator begin_, end_;
  };

  /// Runs `kernel` for every block of `shape`, on all allowed threads of the processor (vesalius/parallel.h). Rethrows
  /// what it throws.
  static void run(const LaunchShape& shape, const SimulatorOptions& options, const std::function<void()>& kernel);

  static unsigned block_x();
  static unsigned block_y();
  static unsigned threads_in_block();
  static Threads phase();
  /// Returns the block's array that the given line of the kernel declares.
  template <class T>
  static SharedArray<T> shared(int line, std::size_t count) {
    const std::size_t given = shortened(count);
    return {reinterpret_cast<T*>(memory(line, count * sizeof(T))), given};
  }

 private:
  static std::size_t shortened(std::size_t count);
  static std::byte* memory(int line, std::size_t bytes);
};

[[noreturn]] void throw_beyond_shared(std::size_t place, std::size_t count);

template <class T>
T& SharedArray<T>::operator[](std::size_t place) const {
  if (place >= count_) throw_beyond_shared(place, count_);
  return values_[place];
}

}  // namespace vesalius::gpu

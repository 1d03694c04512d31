#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace vesalius::gpu {

/// The types of what kernels are told. Each has a `kName` of its own, as which figures, messages and devices know the
/// kernel.
template <class... Arguments>
struct KernelList {};

/// A kernel that is to run, by its name, and what it is told.
class KernelCall {
 public:
  template <class Arguments>
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): arguments say which kernel is meant
  KernelCall(const Arguments& arguments) : name_(Arguments::kName) {
    static_assert(std::is_trivially_copyable_v<Arguments> && sizeof(Arguments) <= sizeof(arguments_));
    std::memcpy(arguments_.data(), &arguments, sizeof(Arguments));
  }
  const char* name() const { return name_; }
  const void* arguments() const { return arguments_.data(); }

 private:
  const char* name_;
  alignas(std::max_align_t) std::array<std::byte, 256> arguments_{};
};

/// A kernel that is compiled for cards.
struct CardKernel {
  const char* name = nullptr;
  const void* code = nullptr;  ///< by which the runtime knows it
};

}  // namespace vesalius::gpu

#pragma once

#include <cstddef>
#include <string_view>

namespace vesalius {

/// Bytes of a cache line.
inline constexpr std::size_t kLineBytes = 64;

/// Zeroed memory directly from the system, in huge pages if it has them. With small pages, random reads over gigabytes
/// wait for the page table.
class HugeBuffer {
 public:
  /// Throws std::bad_alloc if the system has not enough memory.
  explicit HugeBuffer(std::size_t bytes);
  /// A copy of these bytes.
  explicit HugeBuffer(std::string_view bytes);
  ~HugeBuffer();
  HugeBuffer(HugeBuffer&& other) noexcept;
  HugeBuffer& operator=(HugeBuffer&& other) noexcept;

  std::byte* data() const { return memory_; }
  std::size_t size() const { return bytes_; }

 private:
  std::byte* memory_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace vesalius

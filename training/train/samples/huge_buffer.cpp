#include "train/samples/huge_buffer.h"

#include <sys/mman.h>

#include <cstring>
#include <new>
#include <utility>

namespace vesalius {

HugeBuffer::HugeBuffer(std::size_t bytes) : bytes_(bytes) {
  if (bytes == 0) return;
  void* mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  memory_ = static_cast<std::byte*>(mapped);
  madvise(mapped, bytes, MADV_HUGEPAGE);
}

HugeBuffer::HugeBuffer(std::string_view bytes) : HugeBuffer(bytes.size()) {
  if (!bytes.empty()) std::memcpy(memory_, bytes.data(), bytes.size());
}

HugeBuffer::~HugeBuffer() {
  if (memory_ != nullptr) munmap(memory_, bytes_);
}

HugeBuffer::HugeBuffer(HugeBuffer&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}

HugeBuffer& HugeBuffer::operator=(HugeBuffer&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

}  // namespace vesalius

#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "vesalius/error.h"

namespace vesalius {

/// Maps signed numbers to unsigned ones, such that small magnitudes give small results: 0, -1, 1, -2 ... become 0, 1,
/// 2, 3 ...
inline std::uint32_t zigzag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1U) ^ (value < 0 ? 0xFFFFFFFFU : 0U);
}
inline std::int32_t unzigzag(std::uint32_t code) {
  return static_cast<std::int32_t>((code >> 1U) ^ ((code & 1U) != 0 ? 0xFFFFFFFFU : 0U));
}

/// Appends little-endian numbers and texts to a string.
class ByteWriter {
 public:
  template <class T>
  void number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_ += static_cast<char>((value >> (8 * i)) & 0xFFU);
  }
  void real(float value) { number(std::bit_cast<std::uint32_t>(value)); }
  void real(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  /// Writes seven bits in each byte, the lowest first. The high bit of a byte says that another one follows.
  void varint(std::uint32_t value) {
    for (; value >= 0x80; value >>= 7U) bytes_ += static_cast<char>((value & 0x7FU) | 0x80U);
    bytes_ += static_cast<char>(value);
  }
  /// Writes the length as a u32, then the bytes.
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what ByteWriter wrote. All functions throw Error naming `name`, the position in bytes and what was expected.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[noreturn]] void fail(std::string_view what) const {
    throw Error(fmt::format("{}: damaged at byte {}: {}", name_, at_, what));
  }
  std::string_view take(std::size_t count, const char* what) {
    if (count > left()) fail(fmt::format("expected {} bytes of {}, {} are left", count, what, left()));
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  template <class T>
  T number(const char* what) {
    T value = 0;
    unsigned shift = 0;
    for (const char c : take(sizeof(T), what)) {
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(static_cast<unsigned char>(c)) << shift));
      shift += 8;
    }
    return value;
  }
  float real32(const char* what) { return std::bit_cast<float>(number<std::uint32_t>(what)); }
  double real64(const char* what) { return std::bit_cast<double>(number<std::uint64_t>(what)); }
  std::uint32_t varint(const char* what) {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const auto byte = number<std::uint8_t>(what);
      if (shift == 28 && byte > 0x0F) break;
      value |= static_cast<std::uint32_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    fail(fmt::format("{}: number does not fit 32 bits", what));
  }
  std::string_view text(const char* what) { return take(number<std::uint32_t>(what), what); }
  void expect_end() const {
    if (left() != 0) fail(fmt::format("expected the end, {} bytes are left", left()));
  }
  std::size_t left() const { return bytes_.size() - at_; }
  const std::string& name() const { return name_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  const std::string& name_;
};

}  // namespace vesalius

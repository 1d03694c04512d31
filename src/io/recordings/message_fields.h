#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/recordings/recording.h"

namespace vesalius {

/// Reads the fields of a ROS message one after the other. All functions throw Error naming `name`, the field and what
/// was expected.
class MessageFields {
 public:
  /// `layout` is ros1 or cdr. `name` must outlive this object.
  MessageFields(std::string_view bytes, MessageLayout layout, const std::string& name);

  std::uint8_t u8(const char* what) { return static_cast<std::uint8_t>(number(1, what)); }
  std::uint16_t u16(const char* what) { return static_cast<std::uint16_t>(number(2, what)); }
  std::uint32_t u32(const char* what) { return static_cast<std::uint32_t>(number(4, what)); }
  std::uint64_t u64(const char* what) { return number(8, what); }
  float real32(const char* what);
  double real64(const char* what);
  std::string_view text(const char* what);
  /// Returns a list of bytes.
  std::string_view bytes(const char* what);
  /// Returns `count` numbers.
  std::vector<double> reals64(std::size_t count, const char* what);
  /// Returns a list of numbers whose length stands before it.
  std::vector<double> list64(const char* what);
  /// Reads a std_msgs/Header and returns its time stamp in nanoseconds. `frame` receives its frame_id.
  std::int64_t header(std::string& frame);
  /// Returns the next bytes as they are.
  std::string_view take(std::size_t count, const char* what);
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::uint64_t number(std::size_t size, const char* what);

  std::string_view bytes_;
  bool aligned_, big_endian_ = false;
  const std::string& name_;
  std::size_t at_ = 0;
};

/// The fields of one Protocol Buffers message, by their numbers. Views into the message.
struct ProtobufFields {
  std::map<std::uint32_t, std::uint64_t> numbers;                ///< the last of each: varints and fixed 32 and 64 bits
  std::map<std::uint32_t, std::vector<std::string_view>> texts;  ///< all of each: bytes, texts, messages, packed lists
  std::map<std::uint32_t, std::vector<double>> reals;            ///< all of each that are fixed 64 bits, not packed

  std::uint64_t number(std::uint32_t field) const;
  std::string_view text(std::uint32_t field) const;
  /// Returns a repeated message or text.
  std::vector<std::string_view> all_texts(std::uint32_t field) const;
  /// Returns a repeated double, packed or not.
  std::vector<double> list64(std::uint32_t field) const;
};

/// Throws Error naming `name` if the bytes are no message.
ProtobufFields parse_protobuf(std::string_view bytes, const std::string& name);

/// Writes the fields of a ROS 2 message as little-endian CDR.
class CdrWriter {
 public:
  CdrWriter();
  void u8(std::uint8_t value) { number(value, 1); }
  void u32(std::uint32_t value) { number(value, 4); }
  void i32(std::int32_t value) { number(static_cast<std::uint32_t>(value), 4); }
  void real32(float value);
  void real64(double value);
  void text(std::string_view value);
  void bytes(std::string_view value);
  /// Writes a std_msgs/Header.
  void header(std::int64_t time_ns, std::string_view frame);
  const std::string& message() const { return bytes_; }

 private:
  void number(std::uint64_t value, std::size_t size);

  std::string bytes_;
};

}  // namespace vesalius

#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/byte_stream.h"

// What tasks and driver of a cluster send each other (docs/formats.md): bytes in an envelope with version and checksum.
namespace vesalius {

static_assert(std::endian::native == std::endian::little, "messages are little endian");

/// Appends arrays as well: a u64 with the number of elements, then their bytes.
class MessageWriter : public ByteWriter {
 public:
  template <class T>
  void array(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    number(static_cast<std::uint64_t>(values.size()));
    bytes().append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  template <class T>
  void array(const std::vector<T>& values) {
    array(std::span<const T>(values));
  }
};

/// Reads what MessageWriter wrote.
class MessageReader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  template <class T>
  std::vector<T> array(const char* what) {
    std::vector<T> values;
    array_into(values, what);
    return values;
  }
  /// The same into a vector whose memory is used again.
  template <class T>
  void array_into(std::vector<T>& values, const char* what) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto size = number<std::uint64_t>(what);
    if (size > left() / sizeof(T)) fail(fmt::format("{} numbers of {}, {} bytes are left", size, what, left()));
    values.resize(size);
    const std::string_view raw = take(size * sizeof(T), what);
    if (size > 0) std::memcpy(values.data(), raw.data(), raw.size());
  }
};

/// Returns a message in its envelope: compressed, with the version of all messages and a checksum.
std::string sealed(std::string_view message);
/// Returns the message in an envelope. Throws Error naming `name` if it is damaged or of another version.
std::string opened(std::string_view envelope, const std::string& name);

/// A message under a key, as tasks read and write it: a line of the key, a tab, and the envelope in base 64. Sorted
/// lines have the messages of a key side by side.
struct Record {
  std::string key;  ///< without tabs and line ends
  std::string message;
};

/// Returns the line, with its end.
std::string record_line(const Record& record);
/// Returns the record of a line. Throws Error naming its key and `name` if it is damaged.
Record parse_record(std::string_view line, const std::string& name);

/// Returns how this program was built. Programs that differ may not work on one training, since their bytes might.
std::string program_build();
/// Throws Error naming `name`, which another machine wrote, unless its program was built as this one.
void expect_this_build(const std::string& build, const std::string& name);

}  // namespace vesalius

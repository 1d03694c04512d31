#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "io/files/byte_stream.h"
#include "train/messages/training_messages.h"
#include "vesalius/camera.h"
#include "vesalius/forest.h"

// What tasks and driver of a cluster send each other (docs/formats.md): bytes in an envelope with version and checksum.
namespace vesalius {

static_assert(std::endian::native == std::endian::little, "messages are little endian");

/// Core types whose fields are named below: `visit_fields(visitor, const Camera&)` is one as well.
template <class T, class Type>
concept Is = std::same_as<std::remove_const_t<T>, Type>;

void visit_fields(auto& visit, Is<Camera> auto& of) {
  visit("width", of.width)("height", of.height)("fx", of.fx)("fy", of.fy)("cx", of.cx)("cy", of.cy);
}
void visit_fields(auto& visit, Is<Tree> auto& of) {
  visit("nodes", of.nodes)("leaves", of.leaves)("logits", of.logits);
}

/// What is written as it lies in memory: numbers, and structs of numbers without bytes between them.
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T> ||
    (std::is_class_v<T>&& std::has_unique_object_representations_v<T>);

/// Writes messages field by field (`visit_fields`); what may be long, texts too, behind a u64 with its number of
/// elements.
class MessageWriter : public ByteWriter {
 public:
  template <class T>
  MessageWriter& operator()(const char* name, const T& value) {
    if constexpr (Plain<T>) {
      append(&value, 1);
    } else if constexpr (HasFields<T>) {
      T::visit_fields(*this, value);
    } else if constexpr (requires { value.size(); }) {
      number(static_cast<std::uint64_t>(value.size()));
      if constexpr (Plain<typename T::value_type>) {
        append(value.data(), value.size());
      } else {
        for (const auto& element : value) (*this)(name, element);
      }
    } else {
      visit_fields(*this, value);
    }
    return *this;
  }

 private:
  template <class T>
  void append(const T* values, std::size_t count) {
    bytes().append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
};

template <class T>
std::string to_message(const T& value) {
  MessageWriter out;
  out("message", value);
  return std::move(out.bytes());
}

/// Reads what MessageWriter wrote. Memory is only taken for what may be in the bytes that are left.
class MessageReader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  template <class T>
  MessageReader& operator()(const char* name, T& value) {
    if constexpr (std::same_as<T, bool>) {
      value = number<std::uint8_t>(name) != 0;
    } else if constexpr (Plain<T>) {
      copy(name, &value, 1);
    } else if constexpr (HasFields<T>) {
      T::visit_fields(*this, value);
    } else if constexpr (requires { value.size(); }) {
      using Element = typename T::value_type;
      const auto size = number<std::uint64_t>(name);
      static const std::size_t least = least_bytes<Element>();
      if (size > left() / least) fail(fmt::format("{} elements of {}, {} bytes are left", size, name, left()));
      value.resize(size);
      if constexpr (Plain<Element>) {
        copy(name, value.data(), size);
      } else {
        for (Element& element : value) (*this)(name, element);
      }
    } else {
      visit_fields(*this, value);
    }
    return *this;
  }

 private:
  /// Returns the bytes of a message in which all that may be long is empty.
  template <class T>
  static std::size_t least_bytes() {
    MessageWriter out;
    out("message", T{});
    return out.bytes().size();
  }
  template <class T>
  void copy(const char* name, T* values, std::size_t count) {
    const std::string_view raw = take(count * sizeof(T), name);
    if (count > 0) std::memcpy(values, raw.data(), raw.size());
  }
};

/// Returns the message in these bytes. Throws Error naming `name` if they are damaged.
template <class T>
T from_message(std::string_view bytes, const std::string& name) {
  MessageReader in(bytes, name);
  T value;
  in("message", value);
  in.expect_end();
  return value;
}

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

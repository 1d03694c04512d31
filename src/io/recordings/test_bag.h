#pragma once

#include <bzlib.h>
#include <lz4frame.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/byte_stream.h"

namespace vesalius::test {

/// Returns a record of a ROS 1 bag, with fields of its header ("op=\x02").
inline std::string bag_record(const std::vector<std::string>& fields, std::string_view data) {
  ByteWriter header, record;
  for (const std::string& field : fields) header.text(field);
  record.text(header.bytes());
  record.text(data);
  return record.bytes();
}

template <class T>
std::string bag_field(const std::string& name, T value) {
  ByteWriter bytes;
  bytes.number(value);
  return name + "=" + bytes.bytes();
}

inline std::string bag_connection(std::uint32_t id, const std::string& topic, const std::string& type) {
  ByteWriter data;
  data.text("type=" + type);
  return bag_record({"op=\x07", bag_field("conn", id), "topic=" + topic}, data.bytes());
}

inline std::string bag_message(std::uint32_t id, std::uint64_t time_ns, std::string_view bytes) {
  const std::uint64_t time = (time_ns % 1'000'000'000) << 32U | time_ns / 1'000'000'000;
  return bag_record({"op=\x02", bag_field("conn", id), bag_field("time", time)}, bytes);
}

inline std::string packed_by(const std::string& method, const std::string& bytes) {
  if (method == "none") return bytes;
  if (method == "bz2") {
    std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
    auto size = static_cast<unsigned>(packed.size());
    BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()), static_cast<unsigned>(bytes.size()),
                             1, 0, 0);
    return packed.substr(0, size);
  }
  if (method != "lz4") throw std::runtime_error("no such compression: " + method);
  LZ4F_preferences_t small_blocks{};
  small_blocks.frameInfo.blockSizeID = LZ4F_max64KB;
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &small_blocks), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &small_blocks));
  return packed;
}

inline std::string bag_chunk(const std::string& method, const std::string& records) {
  return bag_record({"op=\x05", "compression=" + method, bag_field("size", static_cast<std::uint32_t>(records.size()))},
                    packed_by(method, records));
}

}  // namespace vesalius::test

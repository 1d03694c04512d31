#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "io/files/byte_stream.h"
#include "io/recordings/recording.h"
#include "io/recordings/recording_formats.h"

namespace vesalius::test {

/// Writes a ROS 1 bag of one chunk that was never closed.
class Bag {
 public:
  void put(const std::string& topic, const std::string& type, std::int64_t time_ns, const std::string& message) {
    const auto [found, is_new] = connections_.try_emplace(topic, connections_.size());
    const std::string connection = "conn=" + bytes_of(static_cast<std::uint32_t>(found->second));
    if (is_new) add(records_, {"op=\7", connection, "topic=" + topic}, fields({"topic=" + topic, "type=" + type}));
    const auto seconds = static_cast<std::uint32_t>(time_ns / kNanoseconds);
    const std::string time = bytes_of(seconds) + bytes_of(static_cast<std::uint32_t>(time_ns % kNanoseconds));
    add(records_, {"op=\2", connection, "time=" + time}, message);
  }
  std::string bytes() const {
    std::string all(kBagMagic);
    add_chunk(all, records_);
    return all;
  }
  /// Ends a chunk, of which `closed` writes several.
  void end_chunk() { chunks_.push_back(std::exchange(records_, {})); }
  /// Returns a bag that ends with a list of its chunks. `places` receives where they stand.
  std::string closed(std::vector<std::size_t>& places) const {
    std::string all;
    for (std::uint64_t index_pos = 1; index_pos != all.size();) {
      index_pos = all.size();
      places.clear();
      all = kBagMagic;
      add(all, {"op=\3", "index_pos=" + bytes_of(index_pos)}, "");
      for (const std::string& chunk : chunks_) {
        places.push_back(all.size());
        add_chunk(all, chunk);
      }
    }
    for (const std::size_t place : places) {
      add(all, {"op=\6", "chunk_pos=" + bytes_of(std::uint64_t{place}), "end_time=" + bytes_of(std::uint64_t{0})}, "");
    }
    return all;
  }

 private:
  static void add_chunk(std::string& to, const std::string& records) {
    add(to, {"op=\5", "compression=none", "size=" + bytes_of(static_cast<std::uint32_t>(records.size()))}, records);
  }
  template <class T>
  static std::string bytes_of(T value) {
    ByteWriter out;
    out.number(value);
    return out.bytes();
  }
  static std::string fields(std::initializer_list<std::string> all) {
    ByteWriter out;
    for (const std::string& one : all) out.text(one);
    return out.bytes();
  }
  static void add(std::string& to, std::initializer_list<std::string> header, const std::string& data) {
    to += bytes_of(static_cast<std::uint32_t>(fields(header).size())) + fields(header);
    to += bytes_of(static_cast<std::uint32_t>(data.size())) + data;
  }

  std::map<std::string, std::size_t> connections_;
  std::string records_;
  std::vector<std::string> chunks_;
};

}  // namespace vesalius::test

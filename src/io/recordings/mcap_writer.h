#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/descriptor.h"

namespace vesalius {

/// Writes an MCAP file of ROS 2 messages, as Foxglove, Rerun and rosbag2 open it. Messages are gathered into chunks,
/// packed with zstd; a chunk is in the file when it is full or older than a second, so that a process that is killed
/// loses no more. What it leaves has no summary, and open_mcap reads it.
class McapWriter {
 public:
  /// Creates `path`. Throws Error naming it if there is one already or it cannot be created.
  explicit McapWriter(const std::string& path);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Adds a topic. `type` is e.g. "sensor_msgs/msg/Image"; `definition` its fields as ROS 2 describes them. Returns its
  /// number for `write`.
  std::uint16_t add_topic(const std::string& topic, const std::string& type, const std::string& definition);
  /// Adds a message. Throws Error naming the path if the disk is full.
  void write(std::uint16_t topic, std::int64_t time_ns, std::string_view message);
  /// Writes what is left and the summary. Throws Error naming the path if the disk is full.
  void close();

 private:
  struct Channel {
    std::string schema_record, channel_record;
    std::uint64_t messages = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< time and place of the messages in the open chunk
  };
  void put(std::string_view bytes);
  void finish_chunk();

  std::string path_;
  Descriptor file_;
  std::uint64_t at_ = 0;  ///< bytes written
  std::vector<Channel> channels_;
  std::map<std::string, std::uint16_t> schemas_;
  std::string chunk_;
  std::int64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
  std::uint64_t messages_ = 0;
  std::string chunk_indices_;
  std::uint32_t chunks_ = 0;
  bool closed_ = false;
};

/// First and last bytes of an MCAP file.
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// What a record of an MCAP file is, by its first byte. Eight bytes of length follow, then the record.
enum class McapRecord : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F
};

/// Bytes before a record: what it is and its length.
inline constexpr std::uint64_t kMcapRecordHead = 9;

}  // namespace vesalius

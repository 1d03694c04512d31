#pragma once

#include <cstdint>
#include <string_view>

namespace vesalius {

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

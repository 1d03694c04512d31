#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/descriptor.h"

namespace vesalius {

/// Version of the datasets that this program writes and reads.
inline constexpr int kDatasetVersion = 3;

/// Throws Error naming `name` for files of another version.
void check_dataset_version(std::uint64_t version, const std::string& name);

/// The place of a frame in its shard.
struct ShardEntry {
  std::uint64_t offset = 0;  ///< bytes from the beginning of the file
  std::uint32_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH64, seed 0
};

/// The header of a shard.
struct ShardTable {
  std::uint64_t dataset_hash = 0;
  std::uint64_t first = 0;  ///< index of the first frame
  std::vector<ShardEntry> entries;
};

inline constexpr std::uint32_t kMostFramesPerShard = 4096;

/// Returns the XXH64 of the bytes with seed 0.
std::uint64_t checksum_of(std::string_view bytes);

/// Returns the bytes of a shard (docs/formats.md) that holds these encoded frames.
std::string serialise_shard(std::uint64_t dataset_hash, std::uint64_t first, const std::vector<std::string>& frames);

/// The largest size of a shard's header in bytes.
inline constexpr std::size_t kMostShardHeaderBytes = 48 + 12 * std::size_t{kMostFramesPerShard};

/// Reads the header of a shard from the first kMostShardHeaderBytes of its file, which has `file_bytes` bytes. Throws
/// Error naming `name` if the file is not a shard, is truncated, damaged or of a newer version.
ShardTable parse_shard_table(std::string_view beginning, std::uint64_t file_bytes, const std::string& name);

/// The file of a shard, read in parts. All functions throw Error naming the path.
class ShardFile {
 public:
  explicit ShardFile(std::string path);

  ShardTable table() const;
  /// Returns the encoded frame of an entry. Throws Error naming the frame by `index` if it does not match its checksum.
  std::string frame(const ShardEntry& entry, std::uint64_t index) const;

 private:
  std::string read(std::uint64_t offset, std::size_t count) const;

  std::string path_;
  OpenFile file_;
};

}  // namespace vesalius

#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/descriptor.h"

namespace vesalius {

/// Version of the datasets that this program writes and reads.
inline constexpr int kDatasetVersion = 2;

/// Throws Error naming `name` for files of another version.
void check_dataset_version(std::uint64_t version, const std::string& name);

/// Where a frame lies in its shard.
struct ShardEntry {
  std::uint64_t offset = 0;  ///< bytes from the beginning of the file
  std::uint32_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH64, seed 0
};

/// What the header of a shard says of it.
struct ShardTable {
  std::uint64_t dataset_hash = 0;
  std::uint64_t first = 0;  ///< index of the first frame
  std::vector<ShardEntry> entries;
};

inline constexpr std::uint32_t kMostFramesPerShard = 4096;

/// XXH64, seed 0.
std::uint64_t checksum_of(std::string_view bytes);

/// The bytes of a shard (docs/formats.md) of encoded frames.
std::string serialise_shard(std::uint64_t dataset_hash, std::uint64_t first, const std::vector<std::string>& frames);

/// Bytes that the header of any shard fits in.
inline constexpr std::size_t kMostShardHeaderBytes = 48 + 12 * std::size_t{kMostFramesPerShard};

/// Table of a shard whose file has `file_bytes` bytes, from the first kMostShardHeaderBytes of them. Throws Error
/// naming `name` for a file that is no shard, cut, damaged or of a newer version.
ShardTable parse_shard_table(std::string_view beginning, std::uint64_t file_bytes, const std::string& name);

/// A shard's file, read in parts. All throw Error naming the path.
class ShardFile {
 public:
  explicit ShardFile(std::string path);

  ShardTable table() const;
  /// The encoded frame of an entry; Error for one that does not fit its checksum, naming it by `index`.
  std::string frame(const ShardEntry& entry, std::uint64_t index) const;

 private:
  std::string read(std::uint64_t offset, std::size_t count) const;

  std::string path_;
  OpenFile file_;
};

}  // namespace vesalius

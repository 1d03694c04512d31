#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/dataset_shard.h"
#include "dataset/labelled_frame_codec.h"
#include "io/files/folder_lock.h"
#include "vesalius/base/body_model.h"

namespace vesalius {

/// Version of datasets that this program writes and the newest it reads. 1: without joints.
inline constexpr int kDatasetVersion = kFrameVersion;

/// What all frames of a dataset share.
struct DatasetInfo {
  std::string body_toml;                 ///< text of the body model whose parts are the labels
  std::string recipe;                    ///< how the frames are made; any text
  std::uint64_t seed = 0;                ///< of the run
  std::uint64_t frames = 0;              ///< in the whole dataset
  std::uint32_t frames_per_shard = 256;  ///< 1 to 4096
  std::vector<std::string> joints = {};  ///< names of each person's joints, of a dataset that has any; at most 255
  int version = kDatasetVersion;         ///< of the files; a dataset read may be older
};

/// Names what frames depend on: XXH64 over version, body, recipe, seed and shard size, but not over the number of
/// frames, so that a dataset can grow.
std::uint64_t dataset_hash(const DatasetInfo& info);

/// Frames [first, first + count).
struct FrameRange {
  std::uint64_t first = 0;
  std::uint32_t count = 0;
  friend bool operator==(const FrameRange&, const FrameRange&) = default;
};

/// Writes a dataset shard by shard: a shard appears whole or not at all, and those that are there count as done. Holds
/// one shard's compressed frames in memory. One process writes a folder at a time.
class DatasetWriter {
 public:
  /// Makes `folder`, or goes on with the dataset in it. Throws UsageError for info that cannot be meant, Error for a
  /// folder that cannot be made, has other files in it, or holds frames of another recipe, body, seed or shard size,
  /// and while another process writes there.
  DatasetWriter(std::string folder, const DatasetInfo& info);
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  /// What is still to be made, one range for each missing, cut, foreign or damaged shard. Reads all shards once.
  const std::vector<FrameRange>& missing() const { return missing_; }

  /// Adds the next frame of a missing range, from its first on; after the last one the shard is written. Throws Error
  /// for another frame than the next of a range, for another number of joints than the description names, as
  /// `encode_frame` does, and when the shard cannot be written.
  void write(std::uint64_t index, const LabelledFrame& labelled);
  /// The same for bytes that `encode_frame` made, on whatever thread.
  void write_encoded(std::uint64_t index, std::string bytes);

 private:
  void start();
  bool complete(std::uint64_t shard) const;
  void finish_shard();

  std::string folder_;
  DatasetInfo info_;
  std::uint64_t hash_;
  int part_count_;
  std::optional<FolderLock> lock_;
  std::vector<FrameRange> missing_;
  FrameRange shard_;  ///< being collected
  std::vector<std::string> frames_;
};

/// Reads frames of a dataset in any order. Safe to use from several threads.
class DatasetReader {
 public:
  /// Reads the description and every shard's table of contents. Throws Error for a folder that holds no dataset, for
  /// missing shards, and for the first one that is cut, damaged, foreign or of a newer version.
  explicit DatasetReader(std::string folder);

  std::uint64_t size() const { return info_.frames; }
  const DatasetInfo& info() const { return info_; }
  const BodyModel& body() const { return body_; }

  /// Throws Error naming file and frame for a damaged one; `index` must be below size().
  LabelledFrame read(std::uint64_t index, bool with_colour = true) const;

 private:
  std::string folder_;
  DatasetInfo info_;
  BodyModel body_;
  std::vector<ShardEntry> entries_;  ///< of all frames
};

/// Whether `path` is a folder with a labelled dataset.
bool is_dataset(const std::string& path);

}  // namespace vesalius

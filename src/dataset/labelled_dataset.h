#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset_folder.h"
#include "dataset/labelled_frame_codec.h"
#include "io/files/folder_lock.h"
#include "vesalius/base/body_model.h"

namespace vesalius {

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

}  // namespace vesalius

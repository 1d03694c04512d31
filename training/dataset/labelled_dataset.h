#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset_folder.h"
#include "dataset/labelled_frame_codec.h"
#include "folders/folder_lock.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// Writes a dataset shard by shard. A shard appears only when it is complete, and existing shards are not written
/// again. One shard's compressed frames are held in memory. Only one process at a time can write to a folder.
class DatasetWriter {
 public:
  /// Creates `folder`, or continues the dataset in it. Throws UsageError for an invalid `info`. Throws Error if the
  /// folder cannot be created, has other files in it, holds frames of another recipe, body, seed or shard size, or is
  /// being written by another process.
  DatasetWriter(std::string folder, const DatasetInfo& info);
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  /// The frames still to be written: one range for each shard that is missing, truncated, damaged or of another
  /// dataset. The constructor reads all shards once to find them.
  const std::vector<FrameRange>& missing() const { return missing_; }

  /// Adds the next frame of a missing range; the first call for a range takes its first frame. After the last frame of
  /// a range the shard is written. Throws Error if the frame is not the next one, its number of joints differs from the
  /// description, `encode_frame` throws, or the shard cannot be written.
  void write(std::uint64_t index, const LabelledFrame& labelled);
  /// Adds a frame that `encode_frame` has already encoded, possibly on another thread.
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
  FrameRange shard_;  ///< frames of the shard that is being collected
  std::vector<std::string> frames_;
};

/// Reads frames of a dataset in any order. It may be used from several threads.
class DatasetReader {
 public:
  /// Reads the description and every shard's header. Throws Error if the folder holds no dataset, a shard is missing,
  /// or one is truncated, damaged, of another dataset or of a newer version.
  explicit DatasetReader(std::string folder);

  std::uint64_t size() const { return info_.frames; }
  const DatasetInfo& info() const { return info_; }
  const BodyModel& body() const { return body_; }

  /// Returns frame `index`, which must be below size(). Throws Error naming file and frame if it is damaged.
  LabelledFrame read(std::uint64_t index, bool with_colour = true) const;

 private:
  std::string folder_;
  DatasetInfo info_;
  BodyModel body_;
  std::vector<ShardEntry> entries_;  ///< places of all frames
};

}  // namespace vesalius

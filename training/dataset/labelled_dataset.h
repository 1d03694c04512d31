#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/dataset_shard.h"
#include "dataset/labelled_frame_codec.h"
#include "folders/owned_folder.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

// The folder of a labelled dataset: dataset.json describes it, and NNNNNN.shard files hold its frames
// (docs/formats.md).
namespace vesalius {

/// The highest rate of clips, frames a second.
inline constexpr double kHighestRate_hz = 1000.0;

/// How frames form clips, which come one after the other and are equally long.
struct ClipLayout {
  std::uint32_t frames_per_clip = 0;  ///< 0: frames stand alone
  double rate_hz = 0.0;               ///< frames a second, up to kHighestRate_hz; 0 if frames stand alone

  /// Returns the number of the clip to which a frame belongs, or -1 if it stands alone.
  int clip_of(std::uint64_t index) const { return frames_per_clip == 0 ? -1 : int(index / frames_per_clip); }
  friend bool operator==(const ClipLayout&, const ClipLayout&) = default;
};

/// The facts that all frames of a dataset share.
struct DatasetInfo {
  std::string body_toml;                 ///< text of the body model whose parts are the labels
  std::string recipe;                    ///< says how the frames are made; any text
  std::uint64_t seed = 0;                ///< seed of the run
  std::uint64_t frames = 0;              ///< number of frames in the whole dataset
  std::uint32_t frames_per_shard = 256;  ///< 1 to 4096
  std::vector<std::string> joints = {};  ///< names of each person's joints, if there are any; at most 255
  ClipLayout clips = {};                 ///< how frames form clips, if they do
};

/// Returns a hash of everything that frames depend on: XXH64 over version, body, recipe, seed, shard size and clips.
/// The number of frames is left out, so that a dataset can grow.
std::uint64_t dataset_hash(const DatasetInfo& info);

/// The frames [first, first + count).
struct FrameRange {
  std::uint64_t first = 0;
  std::uint32_t count = 0;
  friend bool operator==(const FrameRange&, const FrameRange&) = default;
};

/// Returns whether `path` is a folder with a labelled dataset.
bool is_dataset(const std::string& path);

std::string description_path(const std::string& folder);
std::string shard_path(const std::string& folder, std::uint64_t shard);
std::uint64_t shard_count(const DatasetInfo& info);
FrameRange frames_of_shard(const DatasetInfo& info, std::uint64_t shard);

/// These write and read the text of dataset.json. Both throw Error naming `name`: writing for text that is not UTF-8,
/// reading for a text that is no description, is of another version, or whose hash does not match.
std::string serialise_description(const DatasetInfo& info);
DatasetInfo parse_description(std::string_view json, const std::string& name);

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

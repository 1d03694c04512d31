#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/dataset_shard.h"
#include "vesalius/base/frame.h"

// How a labelled dataset lies in its folder: dataset.json describes it, NNNNNN.shard hold its frames (docs/formats.md).
namespace vesalius {

/// What all frames of a dataset share.
struct DatasetInfo {
  std::string body_toml;                 ///< text of the body model whose parts are the labels
  std::string recipe;                    ///< how the frames are made; any text
  std::uint64_t seed = 0;                ///< of the run
  std::uint64_t frames = 0;              ///< in the whole dataset
  std::uint32_t frames_per_shard = 256;  ///< 1 to 4096
  std::vector<std::string> joints = {};  ///< names of each person's joints, of a dataset that has any; at most 255
};

/// Returns a name for what frames depend on: XXH64 over version, body, recipe, seed and shard size, but not over the
/// number of frames, so that a dataset can grow.
std::uint64_t dataset_hash(const DatasetInfo& info);

/// Frames [first, first + count).
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

/// Throws Error where people have joints, but not as many as the dataset names.
void check_joint_count(const LabelledFrame& labelled, const DatasetInfo& info);

/// Throws UsageError for numbers out of range and a body that is none.
void check(const DatasetInfo& info);

/// Text of dataset.json, and what it describes. Both throw Error (naming `name`): for texts that are no UTF-8, and for
/// one that is no description, of another version, or whose hash does not fit.
std::string serialise_description(const DatasetInfo& info);
DatasetInfo parse_description(std::string_view json, const std::string& name);

/// Throws Error naming `path` unless the shard has just these frames of the dataset.
void check_shard(const ShardTable& table, const FrameRange& expected, std::uint64_t dataset_hash,
                 const std::string& path);

}  // namespace vesalius

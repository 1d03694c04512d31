#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/clip_layout.h"
#include "dataset/dataset_shard.h"
#include "vesalius/frame.h"

// The folder of a labelled dataset: dataset.json describes it, and NNNNNN.shard files hold its frames
// (docs/formats.md).
namespace vesalius {

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

/// Returns a hash of everything that frames depend on: XXH64 over version, body, recipe, seed, shard size and
/// clips. The
/// number of frames is left out, so that a dataset can grow.
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

/// Throws Error if people have joints but not as many as the dataset names.
void check_joint_count(const LabelledFrame& labelled, const DatasetInfo& info);

/// Throws UsageError if a number is out of range or the text describes no body.
void check(const DatasetInfo& info);

/// These write and read the text of dataset.json. Both throw Error naming `name`: writing for text that is not UTF-8,
/// reading for a text that is no description, is of another version, or whose hash does not match.
std::string serialise_description(const DatasetInfo& info);
DatasetInfo parse_description(std::string_view json, const std::string& name);

/// Throws Error naming `path` unless the shard has exactly these frames of the dataset.
void check_shard(const ShardTable& table, const FrameRange& expected, std::uint64_t dataset_hash,
                 const std::string& path);

}  // namespace vesalius

#pragma once

#include <string>
#include <string_view>

#include "dataset/dataset_shard.h"
#include "dataset/labelled_dataset.h"

// How a labelled dataset lies in its folder; shared by its reader and its writer.
namespace vesalius {

std::string description_path(const std::string& folder);
std::string shard_path(const std::string& folder, std::uint64_t shard);
std::uint64_t shard_count(const DatasetInfo& info);
FrameRange frames_of_shard(const DatasetInfo& info, std::uint64_t shard);

/// Throws Error where people have joints, but not as many as the dataset names.
void check_joint_count(const LabelledFrame& labelled, const DatasetInfo& info);

/// Throws UsageError for numbers out of range and a body that is none.
void check(const DatasetInfo& info);

/// Text of dataset.json, and what it describes. Throw Error (naming `name`) for texts that are no UTF-8, and for one
/// that is no description, of a newer version, or whose hash does not fit.
std::string serialise_description(const DatasetInfo& info);
DatasetInfo parse_description(std::string_view json, const std::string& name);

/// Throws Error naming `path` unless the shard has just these frames of the dataset.
void check_shard(const ShardTable& table, const FrameRange& expected, std::uint64_t dataset_hash,
                 const std::string& path);

}  // namespace vesalius

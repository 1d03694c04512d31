#include "dataset/labelled_dataset.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "dataset/dataset_folder.h"
#include "io/files/read_file.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kMaxDescriptionBytes = std::size_t{1} << 22;

DatasetInfo read_description(const std::string& folder) {
  const std::string path = description_path(folder);
  return parse_description(read_file(path, kMaxDescriptionBytes), path);
}

}  // namespace

bool is_dataset(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(description_path(path), ignored);
}

DatasetReader::DatasetReader(std::string folder)
    : folder_(std::move(folder)),
      info_(read_description(folder_)),
      body_(parse_body_model(info_.body_toml, description_path(folder_))) {
  const std::uint64_t hash = dataset_hash(info_);
  const std::uint64_t shards = shard_count(info_);
  for (std::uint64_t shard = 0; shard < shards; ++shard) {
    const std::string path = shard_path(folder_, shard);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      throw Error(fmt::format("{}: missing, {} of {} shards come before it: make the dataset again to complete it",
                              path, shard, shards));
    }
    const ShardTable table = ShardFile(path).table();
    check_shard(table, frames_of_shard(info_, shard), hash, path);
    entries_.insert(entries_.end(), table.entries.begin(), table.entries.end());
  }
}

LabelledFrame DatasetReader::read(std::uint64_t index, bool with_colour) const {
  if (index >= entries_.size()) {
    throw Error(fmt::format("{}: frame {}, expected one below {}", folder_, index, entries_.size()));
  }
  const std::string path = shard_path(folder_, index / info_.frames_per_shard);
  const std::string bytes = ShardFile(path).frame(entries_[index], index);
  const std::string name = fmt::format("{}: frame {}", path, index);
  DatasetFrame frame = decode_frame(bytes, body_.part_count(), name, with_colour, info_.version);
  if (frame.index != index || frame.seed != info_.seed) {
    throw Error(fmt::format("{}: frame {}: holds frame {} of seed {}", path, index, frame.index, frame.seed));
  }
  with_context(name, [&] { check_joint_count(frame.labelled, info_); });
  return std::move(frame.labelled);
}

}  // namespace vesalius

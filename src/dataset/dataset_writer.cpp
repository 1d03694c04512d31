#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "dataset/dataset_folder.h"
#include "dataset/labelled_dataset.h"
#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/read_file.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFrameBytes = std::size_t{1} << 30;

/// What a killed writer left.
bool is_leftover(const std::string& name) {
  return name.find(".shard.tmp") != std::string::npos || name.starts_with("dataset.json.tmp");
}

/// Removes leftovers; whether anything else is in the folder.
bool tidy(const std::string& folder) {
  bool has_files = false;
  std::error_code error;
  std::vector<fs::path> leftovers;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_leftover(it->path().filename().string())) {
      leftovers.push_back(it->path());
    } else {
      has_files = true;
    }
  }
  if (error) throw Error(folder + ": folder cannot be read: " + error.message());
  for (const fs::path& path : leftovers) fs::remove(path, error);
  return has_files;
}

}  // namespace

DatasetWriter::DatasetWriter(std::string folder, const DatasetInfo& info)
    : folder_(std::move(folder)), info_(info), hash_(dataset_hash(info)) {
  check(info);
  if (info.version != kDatasetVersion) {
    throw UsageError(fmt::format("dataset of format {}, this program writes {}", info.version, kDatasetVersion));
  }
  part_count_ = parse_body_model(info.body_toml, "body of the dataset").part_count();
  lock_.emplace(folder_);
  start();
}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::start() {
  const bool has_files = tidy(folder_);
  const std::string path = description_path(folder_);
  if (has_files && !is_dataset(folder_)) {
    throw Error(folder_ + ": folder has other files in it, expected a new or empty one or a labelled dataset");
  }
  if (has_files) {
    const DatasetInfo there = parse_description(read_file(path), path);
    if (there.version != info_.version) {
      throw Error(fmt::format("{}: has frames of format {}, this program writes {}; expected a new or empty folder",
                              folder_, there.version, info_.version));
    }
    if (dataset_hash(there) != hash_ || there.joints != info_.joints) {
      throw Error(folder_ + ": has frames of another recipe, body, seed or shard size; expected a new or empty folder");
    }
  }
  write_file_atomically(path, serialise_description(info_));
  for (std::uint64_t shard = 0; shard < shard_count(info_); ++shard) {
    if (!complete(shard)) missing_.push_back(frames_of_shard(info_, shard));
  }
}

/// Whether the shard is there and every frame of it fits its checksum.
bool DatasetWriter::complete(std::uint64_t shard) const {
  const std::string path = shard_path(folder_, shard);
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return false;
  try {
    const ShardFile file(path);
    const ShardTable table = file.table();
    check_shard(table, frames_of_shard(info_, shard), hash_, path);
    std::uint64_t index = table.first;
    for (const ShardEntry& entry : table.entries) file.frame(entry, index++);
    return true;
  } catch (const Error&) {
    return false;  // made again
  }
}

void DatasetWriter::write(std::uint64_t index, const LabelledFrame& labelled) {
  check_joint_count(labelled, info_);
  write_encoded(index, encode_frame({index, info_.seed, labelled}, part_count_));
}

void DatasetWriter::write_encoded(std::uint64_t index, std::string bytes) {
  if (frames_.empty()) {
    const auto starts = [&](const FrameRange& range) { return range.first == index; };
    const auto found = std::find_if(missing_.begin(), missing_.end(), starts);
    if (found == missing_.end()) {
      throw Error(fmt::format("{}: frame {}, expected the first one of a missing shard", folder_, index));
    }
    shard_ = *found;
  }
  const std::uint64_t expected = shard_.first + frames_.size();
  if (index != expected) throw Error(fmt::format("{}: frame {}, expected {}", folder_, index, expected));
  if (bytes.size() > kMaxFrameBytes) throw Error(fmt::format("{}: frame {} has over 1 GiB", folder_, index));
  const std::string place = fmt::format("frame {}", index);
  ByteReader in(bytes, place);
  if (in.number<std::uint64_t>("index") != index || in.number<std::uint64_t>("seed") != info_.seed) {
    throw Error(fmt::format("{}: frame {}: was encoded as another frame", folder_, index));
  }
  frames_.push_back(std::move(bytes));
  if (frames_.size() == shard_.count) finish_shard();
}

void DatasetWriter::finish_shard() {
  const std::string path = shard_path(folder_, shard_.first / info_.frames_per_shard);
  const std::string bytes = serialise_shard(hash_, shard_.first, frames_);
  frames_.clear();
  write_file_atomically(path, bytes);
  missing_.erase(std::find(missing_.begin(), missing_.end(), shard_));
}

}  // namespace vesalius

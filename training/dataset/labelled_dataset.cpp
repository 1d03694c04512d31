#include "dataset/labelled_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFrameBytes = std::size_t{1} << 30;

/// Returns whether a file was left by a killed writer.
bool is_leftover(const std::string& name) {
  return name.find(".shard.tmp") != std::string::npos || name.starts_with("dataset.json.tmp");
}

/// Removes leftovers. Returns whether anything else is in the folder.
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

constexpr std::size_t kMaxDescriptionBytes = std::size_t{1} << 22;

DatasetInfo read_description(const std::string& folder) {
  const std::string path = description_path(folder);
  return parse_description(read_file(path, kMaxDescriptionBytes), path);
}

}  // namespace

DatasetWriter::DatasetWriter(std::string folder, const DatasetInfo& info)
    : folder_(std::move(folder)), info_(info), hash_(dataset_hash(info)) {
  check(info);
  part_count_ = parse_body_model(info.body_toml, "body of the dataset").part_count();
  lock_.emplace(folder_);
  start();
}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::start() {
  const bool has_files = tidy(folder_);
  if (has_files && !is_dataset(folder_)) {
    throw Error(folder_ + ": folder has other files in it, expected a new or empty one or a labelled dataset");
  }
  if (has_files) {
    const DatasetInfo there = read_description(folder_);
    if (dataset_hash(there) != hash_ || there.joints != info_.joints) {
      throw Error(folder_ + ": has frames of another recipe, body, seed or shard size; expected a new or empty folder");
    }
  }
  write_file_atomically(description_path(folder_), serialise_description(info_));
  for (std::uint64_t shard = 0; shard < shard_count(info_); ++shard) {
    if (!complete(shard)) missing_.push_back(frames_of_shard(info_, shard));
  }
}

/// Returns whether the shard exists and every frame of it matches its checksum.
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
    return false;  // the shard is written again
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

DatasetReader::DatasetReader(std::string folder)
    : folder_(std::move(folder)),
      info_(read_description(folder_)),
      body_(parse_body_model(info_.body_toml, description_path(folder_))) {
  const std::uint64_t hash = dataset_hash(info_);
  const std::uint64_t shards = shard_count(info_);
  for (std::uint64_t shard = 0; shard < shards; ++shard) {
    const std::string path = shard_path(folder_, shard);
    std::error_code ignored;
    if (!fs::exists(path, ignored)) {
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
  DatasetFrame frame = decode_frame(bytes, body_.part_count(), name, with_colour);
  if (frame.index != index || frame.seed != info_.seed) {
    throw Error(fmt::format("{}: frame {}: holds frame {} of seed {}", path, index, frame.index, frame.seed));
  }
  with_context(name, [&] { check_joint_count(frame.labelled, info_); });
  return std::move(frame.labelled);
}

}  // namespace vesalius

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "io/atomic_file.h"
#include "io/byte_stream.h"
#include "io/dataset_folder.h"
#include "io/labelled_dataset.h"
#include "io/read_file.h"
#include "vesalius/error.h"

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
  part_count_ = parse_body_model(info.body_toml, "body of the dataset").part_count();
  lock();
  try {
    start();
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

DatasetWriter::~DatasetWriter() { ::close(lock_); }

void DatasetWriter::lock() {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw Error(folder_ + ": folder cannot be made: " + error.message());
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) {
    throw Error(fmt::format("{}: folder cannot be read: {}", folder_, std::generic_category().message(errno)));
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  const int cause = errno;
  ::close(lock_);
  if (cause == EWOULDBLOCK) throw Error(folder_ + ": another process is writing there");
  throw Error(fmt::format("{}: folder cannot be locked: {}", folder_, std::generic_category().message(cause)));
}

void DatasetWriter::start() {
  const bool has_files = tidy(folder_);
  const std::string path = description_path(folder_);
  if (has_files && !is_dataset(folder_)) {
    throw Error(folder_ + ": folder has other files in it, expected a new or empty one or a labelled dataset");
  }
  if (has_files) {
    const DatasetInfo there = parse_description(read_file(path), path);
    if (dataset_hash(there) != hash_) {
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

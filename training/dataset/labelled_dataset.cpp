#include "dataset/labelled_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "dataset/labelled_frame_codec.h"
#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "vesalius/body_model.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFrameBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxDescriptionBytes = std::size_t{1} << 22;
constexpr std::uint64_t kMostFrames = std::uint64_t{1} << 32;

std::uint64_t number_of(const Json& json, const char* key, const std::string& name) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_unsigned()) {
    throw Error(fmt::format("{}: {}: expected a whole number from 0", name, key));
  }
  return found->get<std::uint64_t>();
}

std::string text_of(const Json& json, const char* key, const std::string& name) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) throw Error(fmt::format("{}: {}: expected a text", name, key));
  return found->get<std::string>();
}

std::vector<std::string> joints_of(const Json& json, const std::string& name) {
  const auto found = json.find("joints");
  std::vector<std::string> joints;
  if (found == json.end() || !found->is_array()) throw Error(name + ": joints: expected a list of names");
  for (const Json& joint : *found) {
    if (!joint.is_string()) throw Error(name + ": joints: expected a list of names");
    joints.push_back(joint.get<std::string>());
  }
  return joints;
}

double rate_of(const Json& json, const std::string& name) {
  const auto found = json.find("rate_hz");
  if (found == json.end() || !found->is_number()) throw Error(name + ": rate_hz: expected a number");
  return found->get<double>();
}

std::string hash_text(const DatasetInfo& info) { return fmt::format("{:016x}", dataset_hash(info)); }

/// Throws UsageError unless both numbers are 0 or both are in their range.
void check(const ClipLayout& clips) {
  const bool alone = clips.frames_per_clip == 0 && clips.rate_hz == 0.0;
  if (alone || (clips.frames_per_clip > 0 && clips.rate_hz > 0.0 && clips.rate_hz <= kHighestRate_hz)) return;
  throw UsageError(fmt::format("clips of {} frames at {} a second, expected both 0, or a rate up to {}",
                               clips.frames_per_clip, clips.rate_hz, kHighestRate_hz));
}

/// Throws UsageError if a number is out of range or the text describes no body.
void check(const DatasetInfo& info) {
  if (info.frames == 0 || info.frames > kMostFrames) {
    throw UsageError(fmt::format("dataset of {} frames, expected 1 to {}", info.frames, kMostFrames));
  }
  if (info.frames_per_shard == 0 || info.frames_per_shard > kMostFramesPerShard) {
    throw UsageError(fmt::format("{} frames per shard, expected 1 to {}", info.frames_per_shard, kMostFramesPerShard));
  }
  if (info.joints.size() > kMostJoints) {
    throw UsageError(fmt::format("{} joints, expected at most {}", info.joints.size(), kMostJoints));
  }
  check(info.clips);
  parse_body_model(info.body_toml, "body of the dataset");
}

/// Throws Error if people have joints but not as many as the dataset names.
void check_joint_count(const LabelledFrame& labelled, const DatasetInfo& info) {
  for (const auto& joints : labelled.joints) {
    if (joints.size() == info.joints.size()) continue;
    throw Error(fmt::format("person with {} joints, expected the {} that the dataset names", joints.size(),
                            info.joints.size()));
  }
}

/// Throws Error naming `path` unless the shard has exactly these frames of the dataset.
void check_shard(const ShardTable& table, const FrameRange& expected, std::uint64_t dataset_hash,
                 const std::string& path) {
  if (table.dataset_hash != dataset_hash) {
    throw Error(fmt::format("{}: made by another recipe, body, seed or shard size: {:016x}, expected {:016x}", path,
                            table.dataset_hash, dataset_hash));
  }
  if (table.first != expected.first || table.entries.size() != expected.count) {
    throw Error(fmt::format("{}: {} frames from {} on, expected {} from {} on", path, table.entries.size(), table.first,
                            expected.count, expected.first));
  }
}

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

DatasetInfo read_description(const std::string& folder) {
  const std::string path = description_path(folder);
  return parse_description(read_file(path, kMaxDescriptionBytes), path);
}

}  // namespace

std::uint64_t dataset_hash(const DatasetInfo& info) {
  ByteWriter hashed;
  hashed.number(std::uint32_t{kDatasetVersion});
  hashed.text(info.body_toml);
  hashed.text(info.recipe);
  hashed.number(info.seed);
  hashed.number(info.frames_per_shard);
  hashed.number(info.clips.frames_per_clip);
  hashed.real(info.clips.rate_hz);
  return checksum_of(hashed.bytes());
}

bool is_dataset(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(description_path(path), ignored);
}

std::string description_path(const std::string& folder) { return (fs::path(folder) / "dataset.json").string(); }

std::string shard_path(const std::string& folder, std::uint64_t shard) {
  return (fs::path(folder) / fmt::format("{:06}.shard", shard)).string();
}

std::uint64_t shard_count(const DatasetInfo& info) {
  return (info.frames + info.frames_per_shard - 1) / info.frames_per_shard;
}

FrameRange frames_of_shard(const DatasetInfo& info, std::uint64_t shard) {
  const std::uint64_t first = shard * info.frames_per_shard;
  return {first, static_cast<std::uint32_t>(std::min<std::uint64_t>(info.frames_per_shard, info.frames - first))};
}

std::string serialise_description(const DatasetInfo& info) {
  const Json json = {{"format", kDatasetVersion},
                     {"frames", info.frames},
                     {"frames_per_shard", info.frames_per_shard},
                     {"seed", info.seed},
                     {"hash", hash_text(info)},
                     {"frames_per_clip", info.clips.frames_per_clip},
                     {"rate_hz", info.clips.rate_hz},
                     {"joints", info.joints},
                     {"body", info.body_toml},
                     {"recipe", info.recipe}};
  try {
    return json.dump(1) + "\n";
  } catch (const Json::exception&) {
    throw Error("dataset: body or recipe is not UTF-8");
  }
}

DatasetInfo parse_description(std::string_view text, const std::string& name) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw Error(name + ": no description of a labelled dataset, expected a JSON object");
  check_dataset_version(number_of(json, "format", name), name);
  DatasetInfo info;
  info.frames = number_of(json, "frames", name);
  info.seed = number_of(json, "seed", name);
  const std::uint64_t per_shard = number_of(json, "frames_per_shard", name);
  if (per_shard > kMostFramesPerShard) throw Error(fmt::format("{}: {} frames per shard", name, per_shard));
  info.frames_per_shard = static_cast<std::uint32_t>(per_shard);
  const std::uint64_t per_clip = number_of(json, "frames_per_clip", name);
  if (per_clip >= kMostFrames) throw Error(fmt::format("{}: {} frames per clip", name, per_clip));
  info.clips.frames_per_clip = static_cast<std::uint32_t>(per_clip);
  info.clips.rate_hz = rate_of(json, name);
  info.body_toml = text_of(json, "body", name);
  info.recipe = text_of(json, "recipe", name);
  info.joints = joints_of(json, name);
  if (text_of(json, "hash", name) != hash_text(info)) throw Error(name + ": hash does not fit the other values");
  try {
    check(info);
  } catch (const Error& e) {  // an Error instead, since the file is at fault and not the command line
    throw Error(fmt::format("{}: {}", name, e.what()));
  }
  return info;
}

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

#include "dataset/dataset_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "dataset/labelled_frame_codec.h"
#include "io/files/byte_stream.h"
#include "vesalius/body_model.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

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

void check_joint_count(const LabelledFrame& labelled, const DatasetInfo& info) {
  for (const auto& joints : labelled.joints) {
    if (joints.size() == info.joints.size()) continue;
    throw Error(fmt::format("person with {} joints, expected the {} that the dataset names", joints.size(),
                            info.joints.size()));
  }
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

}  // namespace vesalius

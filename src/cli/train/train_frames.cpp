#include "cli/train/train_frames.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "assets/assets.h"
#include "io/files/atomic_file.h"
#include "io/files/read_file.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string absolute(const std::string& path) {
  return path.empty() ? path : fs::absolute(path).lexically_normal().string();
}

std::vector<std::string> absolute(std::vector<std::string> paths) {
  for (std::string& path : paths) path = absolute(path);
  return paths;
}

std::string hash_text(const TrainInput& input) { return fmt::format("{:016x}", input.hash); }

/// A folder of this process for texts that others read from files.
class TextFolder {
 public:
  TextFolder() {
    std::string pattern = (fs::temp_directory_path() / "vesalius-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw Error(pattern + ": folder cannot be made");
    folder_ = pattern;
  }
  ~TextFolder() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  TextFolder(const TextFolder&) = delete;
  TextFolder& operator=(const TextFolder&) = delete;

  std::string put(const std::string& name, const std::string& text) const {
    std::string path = folder_ + "/" + name;
    write_file_atomically(path, text);
    return path;
  }

 private:
  std::string folder_;
};

TrainSources sources_of(const Json& json, const TextFolder& texts) {
  TrainSources sources;
  sources.data = json.at("data").get<std::vector<std::string>>();
  int number = 0;
  for (const Json& recipe : json.at("recipes")) {
    const std::string name = fs::path(recipe.at("name").get<std::string>()).filename().string();
    sources.recipes.push_back(texts.put(fmt::format("{}-{}", ++number, name), recipe.at("text").get<std::string>()));
  }
  const auto body = json.at("body").get<std::string>();
  if (!body.empty()) sources.body = texts.put("body.toml", body);
  sources.count = json.at("count").get<int>();
  sources.render_seed = json.at("seed").get<std::uint64_t>();
  sources.assets.models = json.at("models").get<std::vector<std::string>>();
  sources.assets.motions = json.at("motions").get<std::string>();
  sources.assets.folder = json.at("assets").get<std::string>();
  return sources;
}

}  // namespace

std::string frames_text(const TrainSources& sources, const TrainInputs& inputs) {
  Json json{{"data", absolute(sources.data)},
            {"recipes", Json::array()},
            {"body", sources.body.empty() ? "" : read_file(sources.body)},
            {"count", sources.count},
            {"seed", sources.render_seed},
            {"models", absolute(sources.assets.models)},
            {"motions", absolute(sources.assets.motions)},
            // Tasks may run with another home folder, or none.
            {"assets", absolute(sources.assets.folder.empty() ? default_assets_folder() : sources.assets.folder)},
            {"inputs", Json::array()}};
  for (const std::string& recipe : sources.recipes) {
    json["recipes"].push_back({{"name", recipe}, {"text", read_file(recipe)}});
  }
  for (const TrainInput& input : inputs.inputs()) {
    json["inputs"].push_back({{"name", input.name}, {"hash", hash_text(input)}, {"frames", input.frames}});
  }
  return json.dump();
}

TaskContext::ReadFrame open_frames(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error("the sources of frames: damaged");
  const TextFolder texts;
  const auto inputs = std::make_shared<const TrainInputs>(sources_of(json, texts));
  const Json& expected = json.at("inputs");
  for (std::size_t i = 0; i < inputs->inputs().size(); ++i) {
    const TrainInput& input = inputs->inputs()[i];
    const auto hash = expected.at(i).at("hash").get<std::string>();
    if (hash_text(input) == hash && input.frames >= expected.at(i).at("frames").get<int>()) continue;
    throw Error(
        fmt::format("{}: would give other frames here (hash {}) than where training was begun ({}); expected "
                    "the same files and packages of `vesalius assets` on all machines",
                    expected.at(i).at("name").get<std::string>(), hash_text(input), hash));
  }
  return [inputs](std::uint64_t number) {
    std::uint64_t left = number;
    for (const TrainInput& input : inputs->inputs()) {
      if (left < static_cast<std::uint64_t>(input.frames)) {
        return with_context(fmt::format("{}: frame {}", input.name, left),
                            [&] { return input.frame(static_cast<int>(left)); });
      }
      left -= static_cast<std::uint64_t>(input.frames);
    }
    throw Error(fmt::format("frame {}: beyond the last one", number));
  };
}

}  // namespace vesalius::cli

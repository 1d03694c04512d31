#include "commands/train/train_frames.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "commands/cluster/cluster_flags.h"
#include "folders/temporary_folder.h"
#include "io/files/atomic_file.h"
#include "io/files/read_file.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string hash_text(const TrainInput& input) { return fmt::format("{:016x}", input.hash); }

TrainSources sources_of(const Json& json, const TemporaryFolder& texts) {
  const auto put = [&](const std::string& name, const Json& text) {
    write_file_atomically(texts.path(name), text.get<std::string>());
    return texts.path(name);
  };
  TrainSources sources;
  sources.data = json.at("data").get<std::vector<std::string>>();
  int number = 0;
  for (const Json& recipe : json.at("recipes")) {
    const std::string name = fs::path(recipe.at("name").get<std::string>()).filename().string();
    sources.recipes.push_back(put(fmt::format("{}-{}", ++number, name), recipe.at("text")));
  }
  if (!json.at("body").get<std::string>().empty()) sources.body = put("body.toml", json.at("body"));
  sources.count = json.at("count").get<int>();
  sources.render_seed = json.at("seed").get<std::uint64_t>();
  sources.assets.motions = json.at("motions").get<std::string>();
  sources.assets.folder = json.at("assets").get<std::string>();
  return sources;
}

}  // namespace

std::string frames_text(const TrainSources& sources, const TrainInputs& inputs) {
  Json json{{"data", for_tasks(sources.data)},
            {"recipes", Json::array()},
            {"body", sources.body.empty() ? "" : read_file(sources.body)},
            {"count", sources.count},
            {"seed", sources.render_seed},
            {"motions", for_tasks(sources.assets.motions)},
            {"assets", assets_for_tasks(sources.assets.folder)},
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
  const TemporaryFolder texts;
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
        return with_context(fmt::format("{}: frame {}", input.name, left), [&] { return input.frame(int(left)); });
      }
      left -= static_cast<std::uint64_t>(input.frames);
    }
    throw Error(fmt::format("frame {}: beyond the last one", number));
  };
}

}  // namespace vesalius::cli

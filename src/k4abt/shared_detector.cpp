#include "k4abt/shared_detector.h"

#include <k4abt.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "io/model/default_model.h"
#include "k4abt/guard.h"
#include "vesalius/model_file.h"

namespace vesalius::k4abt {
namespace {

std::string model_of(const char* model_path) {
  const std::string_view asked = model_path != nullptr ? model_path : "";
  const bool is_theirs = asked.ends_with(".onnx") || asked.ends_with(".ONNX");
  if (is_theirs) say_once("the model " + std::string(asked) + " is not of vesalius; its own is used");
  if (!asked.empty() && !is_theirs) return std::string(asked);
  if (const char* chosen = std::getenv("VESALIUS_MODEL"); chosen != nullptr && *chosen != '\0') return chosen;
  const std::string own_folder = folder_of_library(reinterpret_cast<const void*>(&k4abt_tracker_create));
  return find_default_model(model_folders(own_folder, VESALIUS_MODELS_FROM_K4ABT), "no model is named");
}

}  // namespace

std::shared_ptr<const Detector> shared_detector(const char* model_path) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const Detector>> known;
  const std::string path = model_of(model_path);
  const std::scoped_lock lock(mutex);
  std::weak_ptr<const Detector>& kept = known[path];
  std::shared_ptr<const Detector> detector = kept.lock();
  if (!detector) kept = detector = std::make_shared<const Detector>(load_model(path));
  return detector;
}

}  // namespace vesalius::k4abt

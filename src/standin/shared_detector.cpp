#include "standin/shared_detector.h"

#include <cstdlib>
#include <map>
#include <mutex>

#include "io/model/default_model.h"
#include "vesalius/model_file.h"

namespace vesalius::standin {

std::shared_ptr<const Detector> shared_detector(const std::string& model) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const Detector>> known;
  const std::scoped_lock lock(mutex);
  std::weak_ptr<const Detector>& kept = known[model];
  std::shared_ptr<const Detector> detector = kept.lock();
  if (!detector) kept = detector = std::make_shared<const Detector>(load_model(model));
  return detector;
}

std::string usual_model(const void* symbol, const std::string& models_from) {
  if (const char* chosen = std::getenv("VESALIUS_MODEL"); chosen != nullptr && *chosen != '\0') return chosen;
  return find_default_model(model_folders(folder_of_library(symbol), models_from), "no model is named");
}

}  // namespace vesalius::standin

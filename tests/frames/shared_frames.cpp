#include "shared_frames.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "io/model/text_trees.h"
#include "vesalius/image_file.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

/// Reads frames.csv, whose columns are set,frame,people,posture,has_rgb,has_mask.
std::map<std::string, int> people_of(const std::filesystem::path& shared, const std::string& set) {
  std::map<std::string, int> people;
  std::ifstream csv(shared / "real" / "frames.csv");
  std::string line;
  while (std::getline(csv, line)) {
    std::istringstream fields(line);
    std::string in_set, frame, count;
    std::getline(fields, in_set, ',');
    std::getline(fields, frame, ',');
    std::getline(fields, count, ',');
    if (in_set == set) people[frame] = std::stoi(count);
  }
  return people;
}

}  // namespace

std::optional<std::filesystem::path> shared_folder() {
  const char* named = std::getenv("VESALIUS_SHARED");
  const std::filesystem::path folder =
      named != nullptr ? std::filesystem::path(named) : std::filesystem::path(VESALIUS_SOURCE_DIR) / ".." / "shared";
  if (!std::filesystem::exists(folder / "real" / "frames.csv")) return std::nullopt;
  return folder;
}

std::vector<RealFrame> load_real_set(const std::filesystem::path& shared, const std::string& set) {
  const std::map<std::string, int> people = people_of(shared, set);
  const std::filesystem::path folder = shared / "real" / set;
  std::vector<RealFrame> frames;
  const auto source = open_source(folder.string());
  while (auto frame = source->next()) {
    RealFrame real;
    const auto known = people.find(frame->name);
    if (known != people.end()) real.people = known->second;
    const std::filesystem::path mask = folder / "mask" / (frame->name + ".png");
    if (std::filesystem::exists(mask)) {
      const ColourImage grey = read_colour(mask.string());
      real.mask = Mask(grey.width(), grey.height(), 0);
      for (std::size_t i = 0; i < grey.size(); ++i) real.mask[i] = grey[i].r != 0 ? 1 : 0;
    }
    real.frame = std::move(*frame);
    frames.push_back(std::move(real));
  }
  return frames;
}

Forest load_released_trees(const std::filesystem::path& shared) {
  std::vector<std::string> paths;
  for (int i = 1; i <= 3; ++i) {
    paths.push_back((shared / "reference" / ("pcl_tree_" + std::to_string(i) + ".txt.bz2")).string());
  }
  return import_text_trees(paths);
}

}  // namespace vesalius

#include "commands/train/train_session.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "cluster/message.h"
#include "commands/train/train_recipe.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecipeFile = "recipe.toml";

constexpr const char* kLeavesFile = "leaves";
constexpr const char* kClusterFolder = "cluster";  ///< folder of a training on a cluster (train_cluster.h)

bool is_ours(const std::string& name) {
  return name.starts_with("tree-") || name.starts_with(kRecipeFile) || name.starts_with(kLeavesFile) ||
         name == kClusterFolder;
}

/// Returns whether a killed run left this file half written.
bool is_leftover(const std::string& name) { return name.find(".tmp") != std::string::npos; }

std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    files.push_back(it->path());
  }
  if (error) throw Error(folder + ": folder cannot be read: " + error.message());
  return files;
}

/// Throws if the folder has files of another kind.
void expect_only_ours(const std::string& folder) {
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    if (is_ours(name)) continue;
    throw Error(fmt::format("{}: has another file in it, {}; expected a folder for trees that are being trained",
                            folder, name));
  }
}

}  // namespace

TrainSession::TrainSession(std::string folder, Forest forest, bool restart)
    : folder_(std::move(folder)), forest_(std::move(forest)) {
  lock_.emplace(folder_);
  expect_only_ours(folder_);
  tidy(restart);
  const std::string recipe_path = (fs::path(folder_) / kRecipeFile).string();
  if (fs::exists(recipe_path)) {
    const std::string difference = first_difference(read_file(recipe_path), forest_.recipe);
    if (difference.empty()) return;
    throw Error(fmt::format("{}: has trees of another training ({}); --restart removes them", folder_, difference));
  }
  tidy(true);  // trees without a recipe cannot be used
  write_file_atomically(recipe_path, forest_.recipe);
}

void TrainSession::tidy(bool all) const {
  for (const fs::path& file : files_in(folder_)) {
    const std::string name = file.filename().string();
    std::error_code error;
    if (is_ours(name) && (all || is_leftover(name))) fs::remove_all(file, error);
    if (error) throw Error(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
  }
}

std::string TrainSession::path(int number) const {
  return (fs::path(folder_) / fmt::format("tree-{:04}.forest", number)).string();
}

std::optional<Tree> TrainSession::load(int number) {
  std::error_code ignored;
  if (!fs::exists(path(number), ignored)) return std::nullopt;
  try {
    Forest forest = load_model(path(number)).forest;
    if (forest.recipe != forest_.recipe || forest.trees.size() != 1) return std::nullopt;
    return std::move(forest.trees.front());
  } catch (const Error&) {
    return std::nullopt;  // a damaged tree is grown again
  }
}

void TrainSession::save(int number, const Tree& tree) {
  Forest one_tree = forest_;
  one_tree.trees = {tree};
  save_model(one_tree, path(number));
}

std::string TrainSession::leaves_path() const { return (fs::path(folder_) / kLeavesFile).string(); }

std::optional<LeafState> TrainSession::load_leaves() {
  std::error_code ignored;
  if (!fs::exists(leaves_path(), ignored)) return std::nullopt;
  try {
    return from_message<LeafState>(opened(read_file(leaves_path()), leaves_path()), leaves_path());
  } catch (const Error&) {
    return std::nullopt;  // damaged leaves are learned again
  }
}

void TrainSession::save_leaves(const LeafState& state) {
  write_file_atomically(leaves_path(), sealed(to_message(state)));
}

void TrainSession::remove() {
  tidy(true);
  lock_.reset();
  std::error_code ignored;  // the folder remains if it has other files in it
  fs::remove(folder_, ignored);
}

}  // namespace vesalius::cli

#include "commands/synth/synth_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "downloads/assets.h"
#include "downloads/sha256.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "io/sources/camera_file.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

VisitAll all_options(synth::Recipe& recipe) {
  return [&recipe](OptionVisitor& visitor) { visit_options("", recipe, visitor); };
}

void set_camera(synth::SensorOptions& sensor, const std::string& path) {
  SourceOptions options;
  options.camera_file = path;
  const CameraFacts facts = find_camera_facts(options, {});
  if (!facts.fx) throw Error(path + ": expected a focal length, fx");
  sensor.width = facts.width.value_or(sensor.width);
  sensor.height = facts.height.value_or(sensor.height);
  sensor.fx = *facts.fx;
  sensor.fy = facts.fy.value_or(*facts.fx);
  sensor.cx = facts.cx.value_or(sensor.cx);
  sensor.cy = facts.cy.value_or(sensor.cy);
}

void apply_file(const RecipeRequest& request, synth::Recipe& recipe) {
  if (!request.file.empty()) read_options(request.file, all_options(recipe));
}

void apply_change(const RecipeRequest& request, synth::Recipe& recipe) {
  if (request.change) request.change(recipe);
}

constexpr const char* kTargetFolder = "targets/";
constexpr const char* kMotionList = "manifest.csv";

std::vector<std::string> paths_of(const AssetPackage& package) {
  std::vector<std::string> paths;
  for (const AssetFile& file : package.files) paths.push_back(file.path);
  return paths;
}

/// Returns the part of a path up to and including `data/`: MakeHuman's files keep the paths of its repository.
std::string data_folder(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const std::size_t at = path.find(kTargetFolder);
    if (at != std::string::npos) return at == 0 ? "." : path.substr(0, at - 1);
  }
  throw Error("the list of MakeHuman's files names no targets");
}

/// Returns all regular files below a folder, sorted.
std::vector<std::string> files_below(const std::string& folder) {
  std::vector<std::string> files;
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) files.push_back(entry.path().string());
    }
  } catch (const fs::filesystem_error& e) {
    throw Error(fmt::format("{}: {}", folder, e.code().message()));
  }
  std::ranges::sort(files);
  return files;
}

/// Reads files and adds each to a digest.
class Loader {
 public:
  explicit Loader(const AssetPlaces& places) : places_(places) {}

  void load_makehuman(const synth::Recipe& recipe, LoadedAssets& loaded) {
    if (recipe.body.kind == "builtin") return;
    const AssetPackage& package = asset_package("makehuman");
    if (!has_assets(package, places_.folder)) {
      if (recipe.body.kind == "makehuman") {
        throw Error("body.kind is makehuman, but the package is not there; `vesalius assets makehuman` fetches it");
      }
      return missing(package, "the built-in body", loaded);
    }
    std::vector<std::string> targets;
    const std::vector<std::string> paths = paths_of(package);
    for (const std::string& path : paths) {
      if (path.ends_with(".target")) targets.push_back(path);
    }
    loaded.assets.makehuman = std::make_shared<const synth::MakeHumanModel>(
        reader(package), synth::MakeHumanModel::files(data_folder(paths), targets));
  }

  void load_motions(const synth::Recipe& recipe, LoadedAssets& loaded) {
    if (recipe.pose.captured <= 0.F) return;
    if (!places_.motions.empty()) {
      const auto read = summed([](const std::string& path) { return read_file(path); });
      return take_motions(files_below(places_.motions), read, recipe, loaded);
    }
    const AssetPackage& package = asset_package("mocap");
    if (!has_assets(package, places_.folder)) {
      if (synth::asks_for_motions(recipe.pose)) {
        throw Error(
            "the recipe asks for motions (pose.captured, pose.include, pose.exclude), but the package mocap is not "
            "there; `vesalius assets mocap` fetches it, pose.captured = 0 does without");
      }
      return missing(package, places_.movements ? "sampled poses and movements" : "sampled poses", loaded);
    }
    take_motions(paths_of(package), reader(package), recipe, loaded);
  }

  std::string sum() { return sum_.finish(); }

 private:
  synth::ReadText reader(const AssetPackage& package) { return summed(asset_reader(package, places_.folder)); }

  synth::ReadText summed(synth::ReadText read) {
    return [this, read = std::move(read)](const std::string& path) {
      std::string bytes = read(path);
      sum_.update(bytes);
      return bytes;
    };
  }

  /// Loads motions. A list of descriptions among the files is used as such.
  void take_motions(const std::vector<std::string>& paths, const synth::ReadText& read, const synth::Recipe& recipe,
                    LoadedAssets& loaded) const {
    std::vector<synth::MotionFile> motions = synth::list_motions(paths);
    for (const std::string& path : paths) {
      if (path == kMotionList || path.ends_with(std::string("/") + kMotionList)) {
        synth::describe_motions(motions, read(path), path);
      }
    }
    motions = synth::choose_motions(motions, synth::motion_choice(recipe.pose));
    if (motions.empty())
      throw Error("no motion is left: expected .bvh or .amc files that pose.include and pose.exclude admit");
    synth::PoseLibrary library =
        synth::load_pose_library(motions, read, recipe.pose.library, synth::touch_m(recipe.pose));
    for (const std::string& line : library.skipped) loaded.notes.push_back(line);
    loaded.assets.captured = std::move(library.poses);
    if (!places_.movements) return;
    loaded.assets.movements = synth::load_movements(motions, read);
    const synth::MovementLibrary& movements = loaded.assets.movements;
    loaded.notes.push_back(
        fmt::format("movements from motion capture: {} walks, {} of people at one place, {} of lying down",
                    movements.gaits.size(), movements.stays.size(), movements.lie_downs.size()));
  }

  static void missing(const AssetPackage& package, const char* instead, LoadedAssets& loaded) {
    loaded.stand_ins.push_back(fmt::format("{} is not there, {} instead", package.name, instead));
    loaded.notes.push_back(fmt::format("{}; `vesalius assets {}` fetches it", loaded.stand_ins.back(), package.name));
  }

  const AssetPlaces& places_;
  Sha256 sum_;
};

}  // namespace

synth::Recipe make_recipe(const RecipeRequest& request) {
  synth::Recipe asked;
  apply_file(request, asked);
  apply_change(request, asked);
  synth::Recipe recipe;
  recipe.camera = synth::camera_placement(asked.mounting);
  apply_file(request, recipe);
  if (!request.sensor.empty()) recipe.sensor.preset = request.sensor;
  if (!request.camera.empty()) set_camera(recipe.sensor, request.camera);
  apply_change(request, recipe);
  check(recipe);
  return recipe;
}

std::string full_recipe(synth::Recipe recipe, const LoadedAssets& loaded) {
  std::string text = fmt::format("{}\n# vesalius {}\n# files: sha256 {}\n", options_toml(all_options(recipe)),
                                 VESALIUS_VERSION, loaded.sum);
  for (const std::string& line : loaded.stand_ins) text += fmt::format("# {}\n", line);
  return text;
}

std::string pose_counts(const synth::PoseOptions& options, const synth::BodiesAndMotions& assets) {
  constexpr int kDraws = 10000;
  std::vector<std::string> counts;
  if (!assets.captured.empty()) {
    counts.push_back(fmt::format("{} captured ({})", assets.captured.size(), synth::posture_counts(assets.captured)));
  }
  if (assets.captured.empty() || options.captured < 1.F) {
    std::vector<synth::SampledPose> drawn;
    drawn.reserve(kDraws);
    Random random(1);
    for (int i = 0; i < kDraws; ++i) {
      drawn.push_back(synth::sample_pose(options.sampler, random, synth::touch_m(options)));
    }
    counts.push_back(fmt::format("of {} sampled {}", kDraws, synth::posture_counts(drawn)));
  }
  return fmt::format("poses: {}", fmt::join(counts, "; "));
}

LoadedAssets load_assets(const synth::Recipe& recipe, const AssetPlaces& places) {
  AssetPlaces found = places;
  if (found.folder.empty()) found.folder = default_assets_folder();
  LoadedAssets loaded;
  Loader loader(found);
  loader.load_makehuman(recipe, loaded);
  loader.load_motions(recipe, loaded);
  loaded.sum = loader.sum();
  return loaded;
}

}  // namespace vesalius::cli

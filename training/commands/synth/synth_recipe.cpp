#include "commands/synth/synth_recipe.h"

#include <fmt/format.h>

#include "io/files/options_file.h"
#include "io/sources/camera_file.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius::cli {
namespace {

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

}  // namespace vesalius::cli

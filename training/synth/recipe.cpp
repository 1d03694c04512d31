#include "synth/recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::array<std::string_view, 3> kBodyKinds = {"auto", "makehuman", "builtin"};
constexpr int kMaxSide = 4096;

void visit(const std::string& prefix, SensorOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "preset", o.preset, {"", 0, 0, "Depth camera: its intrinsics, range and noise."});
  visitor.option(prefix + "width", o.width, {"pixels", 0, kMaxSide, "Width of the pictures; 0: the preset's."});
  visitor.option(prefix + "height", o.height, {"pixels", 0, kMaxSide, "Height of the pictures; 0: the preset's."});
  visitor.option(prefix + "fx", o.fx, {"pixels", 0, 1e5, "Horizontal focal length at that size; 0: the preset's."});
  visitor.option(prefix + "fy", o.fy, {"pixels", 0, 1e5, "Vertical focal length at that size; 0: as fx."});
  visitor.option(prefix + "cx", o.cx, {"pixels", -1, 1e5, "Principal point, column; -1: the preset's."});
  visitor.option(prefix + "cy", o.cy, {"pixels", -1, 1e5, "Principal point, row; -1: the preset's."});
  visitor.option(prefix + "noise", o.noise, {"", 0, 1, "Whether the sensor's noise and holes are added."});
  visitor.option(prefix + "colour", o.colour, {"", 0, 1, "Whether frames get a colour picture."});
  visit_options(prefix + "colour-", o.colour_camera, visitor);
  visit_options(prefix, o.variety, visitor);
  visit_options(prefix + "filter.", o.filter, visitor);
}

void visit(const std::string& prefix, PeopleOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "none", o.none, {"", 0, 1000, "Weight of pictures without people."});
  visitor.option(prefix + "one", o.one, {"", 0, 1000, "Weight of pictures with one person."});
  visitor.option(prefix + "two", o.two, {"", 0, 1000, "Weight of pictures with two people."});
  visitor.option(prefix + "three", o.three, {"", 0, 1000, "Weight of pictures with three people."});
  visitor.option(prefix + "four", o.four, {"", 0, 1000, "Weight of pictures with four people."});
  visitor.option(
      prefix + "cut-out", o.cut_out,
      {"", 0, 1, "Share of pictures with people from which all else is taken away, as background removal does."});
}

void visit(const std::string& prefix, BodyOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "kind", o.kind,
                 {"", 0, 0, "makehuman, builtin, or auto: makehuman where `vesalius assets` put its files."});
  visitor.option(prefix + "count", o.count, {"", 1, 10000, "How many different dressed bodies there are."});
  visit_options(prefix, o.people, visitor);
}

void visit(const std::string& prefix, PoseOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "captured", o.captured, {"", 0, 1, "Share of poses from motion capture, where it is there."});
  visitor.option(prefix + "mixed", o.mixed, {"", 0, 1, "Share of captured poses that get limbs of another one."});
  visitor.option(prefix + "mirrored", o.mirrored, {"", 0, 1, "Share of poses seen in a mirror."});
  visitor.option(prefix + "include", o.include,
                 {"", 0, 0, "Motions whose description has one of these words, separated by commas; empty: all."});
  visitor.option(prefix + "exclude", o.exclude, {"", 0, 0, "Motions whose description has one of these are left out."});
  visitor.option(prefix + "touch", o.touch_mm,
                 {"mm", 0, 100,
                  "How deep limbs may overlap where people press them together: hands and forearms against the body, "
                  "thighs. Elsewhere it is 30."});
  visit_options(prefix + "library.", o.library, visitor);
  visit_options(prefix + "sampler.", o.sampler, visitor);
}

/// Splits a list at its commas: "a, b c ,d" gives "a", "b c" and "d".
std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream stream(list);
  for (std::string word; std::getline(stream, word, ',');) {
    const std::size_t first = word.find_first_not_of(" \t");
    if (first == std::string::npos) continue;
    words.push_back(word.substr(first, word.find_last_not_of(" \t") - first + 1));
  }
  return words;
}

}  // namespace

void visit_options(const std::string& prefix, Recipe& recipe, OptionVisitor& visitor) {
  visitor.option(prefix + "mounting", recipe.mounting,
                 {"", 0, 0,
                  "room, ceiling or wheelchair: gives the camera options their defaults; a recipe that changes it "
                  "leaves those out."});
  visit(prefix + "sensor.", recipe.sensor, visitor);
  visit(prefix + "people.", recipe.people, visitor);
  visit(prefix + "body.", recipe.body, visitor);
  visit_options(prefix + "outfit.", recipe.outfit, visitor);
  visit(prefix + "pose.", recipe.pose, visitor);
  visit_options(prefix + "camera.", recipe.camera, visitor);
  visit_options(prefix + "scene.", recipe.scene, visitor);
  visit_options(prefix + "clip.", recipe.clip, visitor);
}

void check(const Recipe& recipe) {
  RangeCheck ranges;
  Recipe copy = recipe;
  visit_options("", copy, ranges);
  (void)camera_placement(recipe.mounting);
  check(recipe.camera);
  check(recipe.scene);
  check(recipe.body.people);
  if (std::ranges::find(kBodyKinds, recipe.body.kind) == kBodyKinds.end()) {
    throw UsageError(fmt::format("option body.kind is \"{}\", expected auto, makehuman or builtin", recipe.body.kind));
  }
  const PeopleOptions& p = recipe.people;
  if (!(p.none + p.one + p.two + p.three + p.four > 0.F)) {
    throw UsageError("options people.none to people.four are all 0, expected a weight above 0");
  }
  if (recipe.clip.seen_from >= recipe.clip.cameras) {
    throw UsageError(fmt::format("option clip.seen-from is {}, expected one below clip.cameras, {}",
                                 recipe.clip.seen_from, recipe.clip.cameras));
  }
  vesalius::check(sensor_of(recipe.sensor).camera);
}

Recipe checked(const Recipe& recipe) {
  check(recipe);
  return recipe;
}

std::string PoseOptions::default_exclusions() { return fmt::format("{}", fmt::join(MotionChoice{}.exclude, ", ")); }

bool asks_for_motions(const PoseOptions& options) {
  const PoseOptions usual;
  return options.captured > 0.F &&
         (options.captured != usual.captured || options.include != usual.include || options.exclude != usual.exclude);
}

float touch_m(const PoseOptions& options) { return options.touch_mm / 1000.F; }

MotionChoice motion_choice(const PoseOptions& options) {
  return {.include = words_of(options.include), .exclude = words_of(options.exclude)};
}

Sensor sensor_of(const SensorOptions& options) {
  Sensor sensor = find_sensor(options.preset);
  if ((options.width == 0) != (options.height == 0)) {
    throw UsageError("options sensor.width and sensor.height are given both or neither");
  }
  if (options.width > 0) {
    const bool own = options.fx > 0.F;  // a custom camera may see more than the preset
    sensor = (own ? reframed : resized)(sensor, options.width, options.height);
  }
  Camera camera = sensor.camera;
  if (options.fx > 0.F) camera.fx = camera.fy = options.fx;
  if (options.fy > 0.F) camera.fy = options.fy;
  if (options.cx >= 0.F) camera.cx = options.cx;
  if (options.cy >= 0.F) camera.cy = options.cy;
  sensor = with_camera(sensor, camera);
  if (!options.noise) sensor.kind = SensorKind::perfect;
  return sensor;
}

}  // namespace vesalius::synth

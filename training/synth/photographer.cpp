#include "synth/photographer.h"

#include <cmath>
#include <mutex>
#include <vector>

#include "synth/body/poser.h"
#include "synth/recipe.h"
#include "synth/sensor/colour_camera.h"
#include "synth/sensor/multipath.h"
#include "synth/sensor/render.h"
#include "synth/sensor/resample_depth.h"
#include "synth/sensor/sensor_noise.h"
#include "synth/sensor/sensor_variety.h"
#include "synth/sensor/stray_light.h"

namespace vesalius::synth {
namespace {

/// A pool of renderers. Each holds a device, so threads borrow one.
class RendererPool {
 public:
  template <class F>
  auto with(F&& work) {
    std::unique_ptr<Renderer> renderer = take();
    auto result = work(*renderer);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(renderer));
    return result;
  }

 private:
  std::unique_ptr<Renderer> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Renderer> renderer = std::move(idle_.back());
        idle_.pop_back();
        return renderer;
      }
    }
    return std::make_unique<Renderer>();
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<Renderer>> idle_;
};

void cut_people_out(DepthImage& depth, const LabelImage& labels) {
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (labels[i] == kBackground) depth[i] = 0;
  }
}

/// Adds what is known about camera and people, in the camera's frame.
void add_truth(const BuiltScene& built, LabelledFrame& out) {
  const Eigen::Isometry3f& camera_from_world = built.view.camera_from_world;
  out.up = camera_from_world.linear() * Eigen::Vector3f::UnitY();
  out.world_from_camera = camera_from_world.inverse();
  out.camera_height_m = out.world_from_camera->translation().y();
  for (const PlacedPerson& person : built.people) {
    std::vector<Eigen::Vector3f> parts;
    for (const Eigen::Vector3f& p : person.body.parts) parts.emplace_back(camera_from_world * p);
    out.parts.push_back(std::move(parts));
    out.joints.push_back(joint_points(person.body, camera_from_world));
    out.postures.emplace_back(to_string(person.posture));
  }
}

/// Returns the view of a camera whose focal length is not the one that is stated.
View seen_with(float true_focal_share, View view) {
  view.camera.fx *= true_focal_share;
  view.camera.fy *= true_focal_share;
  return view;
}

/// Moves the points of the truth to where the stated focal length has them.
void see_as_stated(float true_focal_share, LabelledFrame& out) {
  for (auto* people : {&out.parts, &out.joints}) {
    for (std::vector<Eigen::Vector3f>& points : *people) {
      for (Eigen::Vector3f& p : points) p.head<2>() *= true_focal_share;
    }
  }
}

}  // namespace

struct Photographer::State {
  const Recipe& recipe;
  std::uint64_t seed;
  Sensor sensor;
  RendererPool renderers;

  State(const Recipe& the_recipe, std::uint64_t the_seed)
      : recipe(the_recipe), seed(the_seed), sensor(sensor_of(the_recipe.sensor)) {}

  /// Returns the sensor with what is drawn anew for every camera.
  VariedSensor sensor_for(const PictureStreams& streams) const {
    VariedSensor drawn = draw_sensor(recipe.sensor.variety, sensor, random_for(seed, Purpose::camera, streams.camera));
    if (streams.is_clip) settle_border(drawn.sensor, random_for(seed, Purpose::noise, streams.camera));
    return drawn;
  }

  void filter(const PictureStreams& streams, DepthImage& depth, Image<std::uint32_t>& source) const {
    Random random = random_for(seed, Purpose::filter, streams.camera);
    if (random.uniform() < recipe.sensor.filter.share) apply(draw_filter(recipe.sensor.filter, random), depth, &source);
  }

  void add_noise(const PictureStreams& streams, ColourImage& colour) const {
    // No frame and no clip has this number.
    const std::uint64_t of_camera = ~streams.camera;
    const ColourCamera camera =
        draw_colour_camera(recipe.sensor.colour_camera, random_for(seed, Purpose::colour_noise, of_camera));
    expose(camera, colour);
    const Random noise = random_for(seed, Purpose::colour_noise, streams.frame);
    if (streams.is_clip) {
      add_colour_noise(colour, random_for(seed, Purpose::colour_noise, streams.camera), noise, camera.noise);
    } else {
      add_colour_noise(colour, noise, camera.noise);
    }
    record(camera, colour);
  }
};

Photographer::Photographer(const Recipe& recipe, std::uint64_t seed) : state_(std::make_unique<State>(recipe, seed)) {}

Photographer::~Photographer() = default;

const Camera& Photographer::camera() const { return state_->sensor.camera; }

LabelledFrame Photographer::take(const BuiltScene& built, const PictureStreams& streams, std::string name) const {
  State& s = *state_;
  RenderOptions options;
  options.colour = s.recipe.sensor.colour;
  options.projector = projector_of(s.sensor);
  const VariedSensor sensor = s.sensor_for(streams);
  const View view = seen_with(sensor.true_focal_share, built.view);
  Rendering seen = s.renderers.with([&](Renderer& renderer) { return renderer.render(built.scene, view, options); });

  LabelledFrame result;
  if (sensor.sensor.kind == SensorKind::time_of_flight) {
    add_multipath(sensor.multipath, seen);
    add_stray_light(sensor.stray_light, seen);
  }
  result.frame.name = std::move(name);
  result.frame.camera = s.sensor.camera;
  Image<std::uint32_t> source;
  result.frame.depth = sense(seen, sensor.sensor, random_for(s.seed, Purpose::noise, streams.frame), &source);
  s.filter(streams, result.frame.depth, source);
  apply(sensor.resampling, result.frame.depth, &source);
  result.labels = as_read(seen.labels, source);
  result.person = as_read(seen.person, source);
  const bool cut = random_for(s.seed, Purpose::cut_out, streams.camera).uniform() < s.recipe.people.cut_out;
  if (cut && !built.people.empty()) cut_people_out(result.frame.depth, result.labels);
  result.frame.colour = std::move(seen.colour);
  if (s.recipe.sensor.noise && !result.frame.colour.empty()) s.add_noise(streams, result.frame.colour);
  add_truth(built, result);
  see_as_stated(sensor.true_focal_share, result);
  return result;
}

}  // namespace vesalius::synth

#include "synth/generate.h"

#include <fmt/format.h>

#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "synth/body/builtin_body.h"
#include "synth/dress/dress.h"
#include "synth/pose/mix_poses.h"
#include "synth/sensor/noise_colour.h"
#include "synth/sensor/render.h"
#include "synth/sensor/sensor_noise.h"
#include "synth/skeleton_joints.h"
#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

/// The purpose of a stream of random numbers. Each purpose has a stream of its own, so that a change of one leaves the
/// others unchanged.
enum class Purpose : std::uint64_t { body, plan, scene, noise, colour_noise, cut_out, filter, matching };
constexpr std::uint64_t kPurposes = 8;

Random random_for(std::uint64_t seed, Purpose purpose, std::uint64_t index) {
  return Random(seed * kPurposes + static_cast<std::uint64_t>(purpose), index);
}

/// Draws an index with probability proportional to its weight.
std::size_t draw(const std::vector<float>& weights, Random& random) {
  double left = random.uniform() * std::accumulate(weights.begin(), weights.end(), 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    left -= weights[i];
    if (left < 0.0) return i;
  }
  return weights.size() - 1;
}

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

/// A body with its clothes.
struct Dressed {
  Poser poser;
  std::optional<BodyDetail> detail;  ///< empty if the recipe uses none

  Dressed(Poser the_poser, float detail_px) : poser(std::move(the_poser)) {
    if (detail_px > 0.F) detail.emplace(poser);
  }
};

void cut_people_out(DepthImage& depth, const LabelImage& labels) {
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (labels[i] == kBackground) depth[i] = 0;
  }
}

bool wants_makehuman(const Recipe& recipe, const Assets& assets) {
  if (recipe.body.kind == "makehuman" && assets.makehuman == nullptr) {
    throw Error("body.kind is makehuman, but its files are not there; `vesalius assets makehuman` fetches them");
  }
  return recipe.body.kind != "builtin" && assets.makehuman != nullptr;
}

}  // namespace

struct Generator::State {
  Recipe recipe;
  Assets assets;
  BodyModel body;
  std::uint64_t seed = 0;
  Sensor sensor;
  bool makehuman = false;

  mutable std::vector<std::once_flag> made;
  mutable std::vector<std::unique_ptr<Dressed>> people;
  mutable RendererPool renderers;

  State(const Recipe& the_recipe, Assets the_assets, const BodyModel& the_body, std::uint64_t the_seed)
      : recipe(the_recipe),
        assets(std::move(the_assets)),
        body(the_body),
        seed(the_seed),
        made(the_recipe.body.count),
        people(the_recipe.body.count) {
    check(recipe);
    sensor = sensor_of(recipe.sensor);
    makehuman = wants_makehuman(recipe, assets);
  }

  /// Makes body number k with its clothes, which depends only on (recipe, assets, seed, k).
  std::unique_ptr<Dressed> make_person(std::size_t k) const {
    Random random = random_for(seed, Purpose::body, k);
    const Population& who = recipe.body.people;
    const BodyMesh naked = makehuman ? make_body(*assets.makehuman, sample_factors(who, random), body)
                                     : make_builtin_body(sample_builtin_shape(who, random), body);
    const Outfit outfit = sample_outfit(recipe.outfit, random);
    return std::make_unique<Dressed>(Poser(std::make_shared<const BodyMesh>(dress(naked, outfit, body, random)), body),
                                     recipe.scene.detail_px);
  }

  const Dressed& person(std::size_t k) const {
    std::call_once(made[k], [&] { people[k] = make_person(k); });
    return *people[k];
  }

  SampledPose draw_pose(Random& random) const {
    const PoseOptions& o = recipe.pose;
    if (!assets.captured.empty() && random.uniform() < o.captured) {
      return synth::draw_pose(assets.captured, o.mixed, o.mirrored, random);
    }
    SampledPose drawn = sample_pose(o.sampler, random);
    if (random.uniform() < o.mirrored) drawn.pose = mirrored(drawn.pose);
    return drawn;
  }

  PersonPlan draw_person(Random& random) const {
    PersonPlan plan;
    const Dressed& dressed = person(random.below(recipe.body.count));
    plan.poser = &dressed.poser;
    if (dressed.detail) plan.detail = &*dressed.detail;
    const SampledPose drawn = draw_pose(random);
    plan.pose = drawn.pose;
    plan.posture = drawn.posture;
    plan.look = sample_look(recipe.outfit, random);
    return plan;
  }

  std::vector<PersonPlan> draw_people(Random& random) const {
    const PeopleOptions& p = recipe.people;
    std::vector<PersonPlan> plans(draw({p.none, p.one, p.two, p.three, p.four}, random));
    for (PersonPlan& plan : plans) plan = draw_person(random);
    return plans;
  }
};

Generator::Generator(const Recipe& recipe, Assets assets, const BodyModel& body, std::uint64_t seed)
    : state_(std::make_unique<State>(recipe, std::move(assets), body, seed)) {}

Generator::~Generator() = default;

BuiltScene Generator::scene(std::uint64_t index) const {
  const State& s = *state_;
  Random plan_random = random_for(s.seed, Purpose::plan, index);
  const std::vector<PersonPlan> plans = s.draw_people(plan_random);
  return build_scene(s.recipe.scene, s.recipe.camera, s.sensor.camera, plans, s.assets.models,
                     random_for(s.seed, Purpose::scene, index));
}

const Poser& Generator::body(std::size_t k) const { return state_->person(k).poser; }

SampledPose Generator::draw_pose(Random& random) const { return state_->draw_pose(random); }

LabelledFrame Generator::frame(std::uint64_t index) const {
  const State& s = *state_;
  const BuiltScene built = scene(index);
  RenderOptions options;
  options.colour = s.recipe.sensor.colour;
  options.projector = projector_of(s.sensor);
  Rendering seen =
      s.renderers.with([&](Renderer& renderer) { return renderer.render(built.scene, built.view, options); });

  LabelledFrame result;
  result.frame.name = fmt::format("{:08}", index);
  result.frame.camera = s.sensor.camera;
  const Random noise = random_for(s.seed, Purpose::noise, index);
  Image<std::uint32_t> source;
  Sensor sensor = s.sensor;
  if (s.recipe.sensor.matching_max > 1.F) {
    const double share = random_for(s.seed, Purpose::matching, index).uniform();
    sensor.matching_px *= static_cast<float>(std::pow(s.recipe.sensor.matching_max, share));
  }
  result.frame.depth = sense(seen, sensor, noise, &source);
  Random filter = random_for(s.seed, Purpose::filter, index);
  if (filter.uniform() < s.recipe.sensor.filter.share) {
    apply(draw_filter(s.recipe.sensor.filter, filter), result.frame.depth, &source);
  }
  result.labels = as_read(seen.labels, source);
  result.person = as_read(seen.person, source);
  if (!built.people.empty() && random_for(s.seed, Purpose::cut_out, index).uniform() < s.recipe.people.cut_out) {
    cut_people_out(result.frame.depth, result.labels);
  }
  result.frame.colour = std::move(seen.colour);
  if (s.recipe.sensor.noise && !result.frame.colour.empty()) {
    add_colour_noise(result.frame.colour, random_for(s.seed, Purpose::colour_noise, index));
  }
  result.up = built.view.camera_from_world.linear() * Eigen::Vector3f::UnitY();
  for (const PlacedPerson& person : built.people) {
    std::vector<Eigen::Vector3f> parts;
    for (const Eigen::Vector3f& p : person.body.parts) parts.emplace_back(built.view.camera_from_world * p);
    result.parts.push_back(std::move(parts));
    result.joints.push_back(joint_points(person.body, built.view.camera_from_world));
    result.postures.emplace_back(to_string(person.posture));
  }
  return result;
}

}  // namespace vesalius::synth

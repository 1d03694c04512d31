#include "synth/generate.h"

#include <fmt/format.h>

#include "synth/cast.h"
#include "synth/photographer.h"
#include "synth/random_streams.h"

namespace vesalius::synth {

struct Generator::State {
  Recipe recipe;
  BodiesAndMotions assets;
  BodyModel body;
  std::uint64_t seed = 0;
  Cast cast;
  Photographer photographer;

  State(const Recipe& the_recipe, BodiesAndMotions the_assets, const BodyModel& the_body, std::uint64_t the_seed)
      : recipe(checked(the_recipe)),
        assets(std::move(the_assets)),
        body(the_body),
        seed(the_seed),
        cast(recipe, assets.makehuman, assets.captured, body, seed),
        photographer(recipe, seed) {}
};

Generator::Generator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed)
    : state_(std::make_unique<State>(recipe, std::move(assets), body, seed)) {}

Generator::~Generator() = default;

BuiltScene Generator::scene(std::uint64_t index) const {
  const State& s = *state_;
  Random plan_random = random_for(s.seed, Purpose::plan, index);
  std::vector<PersonPlan> plans(s.cast.draw_count(plan_random));
  for (PersonPlan& plan : plans) plan = s.cast.draw_person(plan_random);
  return build_scene(s.recipe.scene, s.recipe.camera, s.photographer.camera(), plans,
                     random_for(s.seed, Purpose::scene, index));
}

const Poser& Generator::body(std::size_t k) const { return state_->cast.body(k); }

SampledPose Generator::draw_pose(Random& random) const { return state_->cast.draw_pose(random); }

LabelledFrame Generator::frame(std::uint64_t index) const {
  return state_->photographer.take(scene(index), {.frame = index, .camera = index}, fmt::format("{:08}", index));
}

}  // namespace vesalius::synth

#include "synth/cast.h"

#include <numeric>

#include "synth/body/makehuman.h"
#include "synth/dress/dress.h"
#include "synth/pose/pose_sampler.h"
#include "synth/recipe.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

/// Draws an index with probability proportional to its weight.
std::size_t draw(const std::vector<float>& weights, Random& random) {
  double left = random.uniform() * std::accumulate(weights.begin(), weights.end(), 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    left -= weights[i];
    if (left < 0.0) return i;
  }
  return weights.size() - 1;
}

bool wants_makehuman(const Recipe& recipe, bool is_there) {
  if (recipe.body.kind == "makehuman" && !is_there) {
    throw Error("body.kind is makehuman, but its files are not there; `vesalius assets makehuman` fetches them");
  }
  return recipe.body.kind != "builtin" && is_there;
}

}  // namespace

Cast::Dressed::Dressed(Poser the_poser, float detail_px) : poser(std::move(the_poser)) {
  if (detail_px > 0.F) detail.emplace(poser);
}

Cast::Cast(const Recipe& recipe, std::shared_ptr<const MakeHumanModel> makehuman,
           const std::vector<SampledPose>& captured, const BodyModel& body, std::uint64_t seed)
    : recipe_(recipe),
      captured_(captured),
      body_(body),
      seed_(seed),
      made_(recipe.body.count),
      people_(recipe.body.count) {
  if (wants_makehuman(recipe, makehuman != nullptr)) makehuman_ = std::move(makehuman);
}

/// Makes body number k with its clothes, which depends only on (recipe, assets, seed, k).
std::unique_ptr<Cast::Dressed> Cast::make_person(std::size_t k) const {
  Random random = random_for(seed_, Purpose::body, k);
  const Population& who = recipe_.body.people;
  const BodyMesh naked = make_body(makehuman_ ? *makehuman_ : builtin_bodies(), sample_factors(who, random), body_);
  const Outfit outfit = sample_outfit(recipe_.outfit, random);
  return std::make_unique<Dressed>(Poser(std::make_shared<const BodyMesh>(dress(naked, outfit, body_, random)), body_),
                                   recipe_.scene.detail_px);
}

const Cast::Dressed& Cast::person(std::size_t k) const {
  std::call_once(made_[k], [&] { people_[k] = make_person(k); });
  return *people_[k];
}

SampledPose Cast::draw_pose(Random& random) const {
  const PoseOptions& o = recipe_.pose;
  if (!captured_.empty() && random.uniform() < o.captured) {
    return synth::draw_pose(captured_, o.mixed, o.mirrored, random, touch_m(o));
  }
  SampledPose drawn = sample_pose(o.sampler, random, touch_m(o));
  if (random.uniform() < o.mirrored) drawn.pose = mirrored(drawn.pose);
  return drawn;
}

PersonPlan Cast::draw_person(Random& random) const {
  PersonPlan plan;
  const Dressed& dressed = person(random.below(recipe_.body.count));
  plan.poser = &dressed.poser;
  if (dressed.detail) plan.detail = &*dressed.detail;
  const SampledPose drawn = draw_pose(random);
  plan.pose = drawn.pose;
  plan.posture = drawn.posture;
  plan.look = sample_look(recipe_.outfit, random);
  return plan;
}

std::size_t Cast::draw_count(Random& random) const {
  const PeopleOptions& p = recipe_.people;
  return draw({p.none, p.one, p.two, p.three, p.four}, random);
}

}  // namespace vesalius::synth

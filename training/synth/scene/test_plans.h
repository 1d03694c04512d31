#pragma once

#include <memory>
#include <vector>

#include "synth/body/makehuman.h"
#include "synth/pose/pose_sampler.h"
#include "synth/scene/build_scene.h"

// Plans of people that the tests of scenes share.
namespace vesalius::synth::test {

inline constexpr Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

inline const std::vector<std::unique_ptr<Poser>>& posers() {
  static const std::vector<std::unique_ptr<Poser>> kPosers = [] {
    std::vector<std::unique_ptr<Poser>> made;
    Random random(3);
    for (int i = 0; i < 4; ++i) {
      made.push_back(std::make_unique<Poser>(
          std::make_shared<const BodyMesh>(make_body(builtin_bodies(), sample_factors({}, random), paper_body())),
          paper_body()));
    }
    return made;
  }();
  return kPosers;
}

inline PersonPlan plan_of(const SampledPose& sampled, std::uint32_t body) {
  PersonPlan plan;
  plan.poser = posers()[body % posers().size()].get();
  plan.pose = sampled.pose;
  plan.posture = sampled.posture;
  return plan;
}

inline std::vector<PersonPlan> draw_plans(int count, Random& random) {
  std::vector<PersonPlan> plans;
  for (int i = 0; i < count; ++i) plans.push_back(plan_of(sample_pose({}, random), random.next()));
  return plans;
}

inline BuiltScene build(std::uint64_t stream, int people, const CameraPlacement& placement = {}) {
  Random random(11, stream);
  return build_scene({}, placement, kCamera, draw_plans(people, random), Random(12, stream));
}

}  // namespace vesalius::synth::test

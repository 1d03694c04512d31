#include "vesalius/track/stance_model.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(StanceModel, AddsUpTheSignsOfAPosture) {
  const StanceModel model = parse_stance_model(
      "[lying]\nbias = 1\ntop = -4\nno_top = 0.5\ntrunk = 2\n[standing]\nbias = 0\nchest = 10\n", "memory");
  Posture posture;
  posture.stature_m = 2.F;
  const auto logistic = [](float x) { return 1.F / (1.F + std::exp(-x)); };
  EXPECT_NEAR(model.lying.probability(posture), logistic(1.5F), 1e-6F);
  posture.top_m = 1.F;
  posture.trunk_up = 0.5F;
  EXPECT_NEAR(model.lying.probability(posture), logistic(1.F - 4.F * 0.5F + 1.F), 1e-6F) << "metres over the stature";

  posture.hips_m = 0.8F;
  EXPECT_EQ(stance_probabilities(model, posture).lying, 0.F) << "whoever bends over";
  posture.hips_m = 0.6F;
  posture.chest_m = 0.2F;
  const StanceProbabilities of = stance_probabilities(model, posture);
  EXPECT_NEAR(of.lying + of.standing + of.sitting, 1.F, 1e-6F);
  EXPECT_NEAR(of.standing / (of.standing + of.sitting), logistic(1.F), 1e-5F);
  posture.chest_m.reset();
  const StanceProbabilities without = stance_probabilities(model, posture);
  EXPECT_NEAR(without.standing, without.sitting, 1e-6F) << "nobody knows without the floor";
}

TEST(StanceModel, RefusesWhatItDoesNotKnow) {
  const auto parse = [](const char* toml) { return [toml] { parse_stance_model(toml, "my.toml"); }; };
  EXPECT_THAT(parse("[lying]\nbias = 0\n"), ThrowsMessage<Error>(AllOf(HasSubstr("my.toml"), HasSubstr("standing"))));
  EXPECT_THAT(parse("[lying]\nbias = 0\nnose = 1\n[standing]\nbias = 0\n"),
              ThrowsMessage<Error>(AllOf(HasSubstr("my.toml:3"), HasSubstr("nose"), HasSubstr("chest"))));
  EXPECT_THAT(parse("[lying]\nbias = 1e9\n[standing]\nbias = 0\n"),
              ThrowsMessage<Error>(AllOf(HasSubstr("my.toml:2"), HasSubstr("bias"))));
}

}  // namespace
}  // namespace vesalius

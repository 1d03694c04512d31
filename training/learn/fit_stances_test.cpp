#include "learn/fit_stances.h"

#include <gmock/gmock.h>

#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// People of one stance whose chest is so high on average, and of whom the highest pixels are seen half of the time.
void draw(Stance stance, double chest_m, double trunk_up, int count, std::vector<StanceSample>& samples) {
  Random random(7 + static_cast<std::uint64_t>(stance));
  for (int i = 0; i < count; ++i) {
    StanceSample sample{{}, stance};
    sample.posture.stature_m = 1.7F;
    sample.posture.chest_m = static_cast<float>(random.normal(chest_m, 0.08));
    sample.posture.trunk_up = static_cast<float>(random.normal(trunk_up, 0.15));
    if (random.uniform() < 0.5) sample.posture.top_m = *sample.posture.chest_m + 0.3F;
    samples.push_back(sample);
  }
}

std::vector<StanceSample> drawn() {
  std::vector<StanceSample> samples;
  draw(Stance::standing, 1.2, 0.9, 400, samples);
  draw(Stance::sitting, 0.8, 0.9, 200, samples);
  draw(Stance::lying, 0.2, 0.1, 300, samples);
  return samples;
}

TEST(FitStances, TellsThePeopleThatItWasFittedTo) {
  const StanceFit fit = fit_stances(drawn(), {});
  for (const StanceAgreement& agreement : fit.agreement) {
    EXPECT_GT(agreement.right_after, 0.97 * static_cast<double>(agreement.samples)) << to_string(agreement.stance);
    if (agreement.stance == Stance::lying) continue;
    EXPECT_EQ(agreement.right_before, 0) << "a model without weights takes everybody for lying as soon as not";
  }
  EXPECT_EQ(fit.agreement[0].samples, 400);
}

TEST(FitStances, KnowsBedsAndPicturesWithoutFloor) {
  const StanceFit fit = fit_stances(drawn(), {});
  Posture in_bed;
  in_bed.stature_m = 1.7F;
  in_bed.chest_m = 0.65F;
  in_bed.trunk_up = 0.1F;
  EXPECT_GT(stance_probabilities(fit.model, in_bed).lying, 0.7F);
  Posture sits = in_bed;
  sits.trunk_up = 0.9F;
  EXPECT_GT(stance_probabilities(fit.model, sits).sitting, 0.7F);
  Posture without_floor;
  without_floor.trunk_up = 0.F;
  EXPECT_GT(stance_probabilities(fit.model, without_floor).lying, 0.9F);
  without_floor.trunk_up = 1.F;
  EXPECT_LT(stance_probabilities(fit.model, without_floor).lying, 0.1F);
}

TEST(FitStances, RefusesTooFewSamples) {
  std::vector<StanceSample> samples = drawn();
  std::erase_if(samples, [](const StanceSample& sample) { return sample.stance == Stance::sitting; });
  EXPECT_THAT([&] { fit_stances(samples, {}); }, ThrowsMessage<Error>(HasSubstr("0 people found sitting")));
}

}  // namespace
}  // namespace vesalius

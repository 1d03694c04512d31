#include "synth/dress/outfit.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

template <class F>
double share(const OutfitOptions& options, F&& has) {
  int count = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random random(9, i);
    if (has(sample_outfit(options, random))) ++count;
  }
  return count / 2000.0;
}

TEST(Outfit, FollowsTheGivenProbabilities) {
  OutfitOptions options;
  options.skirt = 0.3F;
  options.backpack = 0.7F;
  options.held = 0.F;
  options.hat = 1.F;
  // The standard deviation of a share of 2000 is at most 0.011.
  EXPECT_NEAR(share(options, [](const Outfit& o) { return o.skirt > 0.F; }), 0.3, 0.045);
  EXPECT_NEAR(share(options, [](const Outfit& o) { return o.backpack; }), 0.7, 0.045);
  EXPECT_EQ(share(options, [](const Outfit& o) { return o.held != Held::none; }), 0.0);
  EXPECT_EQ(share(options, [](const Outfit& o) { return o.hat != Hat::none; }), 1.0);
  EXPECT_NEAR(share(options, [](const Outfit& o) { return o.hair == Hair::bald; }), 0.08, 0.03);
}

TEST(Outfit, KeepsClothAndHairWithinTheirLimits) {
  const OutfitOptions options;
  EXPECT_EQ(share(options, [](const Outfit& o) { return o.top_m > 0.02F || o.bottom_m > 0.02F || o.hair_m > 0.05F; }),
            0.0);
  EXPECT_EQ(share(options, [](const Outfit& o) { return o.hair == Hair::bald && o.hair_m > 0.F; }), 0.0);
}

TEST(Outfit, AddsWhatIsCarriedAndLeavesTheRestAsItIs) {
  OutfitOptions options;
  EXPECT_EQ(share(options, [](const Outfit& o) { return o.bag == Bag::on_strap || o.held > Held::box; }), 0.0);
  options.carried = 0.5F;
  EXPECT_NEAR(share(options, [](const Outfit& o) { return o.bag == Bag::on_strap || o.held > Held::box; }), 0.5, 0.05);
  for (std::uint64_t i = 0; i < 50; ++i) {
    Random usual(9, i), carrying(9, i);
    const Outfit a = sample_outfit({}, usual), b = sample_outfit(options, carrying);
    EXPECT_EQ(a.hair_m, b.hair_m);
    EXPECT_EQ(a.backpack, b.backpack);
    EXPECT_EQ(a.left_hand, b.left_hand);
  }
}

TEST(Outfit, RefusesOptionsOutOfRange) {
  OutfitOptions options;
  options.skirt = 1.5F;
  Random random(1);
  EXPECT_THROW(sample_outfit(options, random), UsageError);
}

TEST(Look, HasTheReflectanceOfRealPeople) {
  int dark_hair = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    Random random(8, i);
    const auto look = sample_look({}, random);
    for (const Material& m : look) {
      EXPECT_TRUE(m.infrared >= 0.01F && m.infrared <= 1.F);
      EXPECT_GT(m.period_m, 0.F);
    }
    const Material& hair = look[static_cast<std::size_t>(Fabric::hair)];
    if (hair.infrared < 0.3F) ++dark_hair;
    const Material& skin = look[static_cast<std::size_t>(Fabric::skin)];
    EXPECT_GE(skin.colour.r, skin.colour.b);
    EXPECT_EQ(skin.texture, Texture::plain);
  }
  EXPECT_GT(dark_hair, 250);  // most hair is dark
}

TEST(Look, GivesDarkClothAndHairALowReflectance) {
  const auto share_dark = [](const OutfitOptions& options, Fabric fabric, float limit) {
    int dark = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
      Random random(9, i);
      if (sample_look(options, random)[static_cast<std::size_t>(fabric)].infrared < limit) ++dark;
    }
    return static_cast<float>(dark) / 300.F;
  };
  OutfitOptions options;
  options.dark_cloth = 0.F;
  options.dark_hair = 1.F;
  EXPECT_EQ(share_dark(options, Fabric::bottom, 0.3F), 0.F);
  EXPECT_EQ(share_dark(options, Fabric::hair, 0.081F), 1.F);
  options.dark_cloth = 0.5F;
  options.dark_hair = 0.F;
  EXPECT_NEAR(share_dark(options, Fabric::bottom, 0.201F), 0.5F, 0.09F);  // three standard deviations
  EXPECT_EQ(share_dark(options, Fabric::hair, 0.049F), 0.F);
}

TEST(Look, GivesClothThatIsDarkToTheEyeDarkColours) {
  OutfitOptions options;
  options.dark_cloth = 0.5F;
  options.dark_to_the_eye = 1.F;
  int dark = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Random random(9, i);
    const Material cloth = sample_look(options, random)[static_cast<std::size_t>(Fabric::top)];
    if (cloth.infrared > 0.201F) continue;
    ++dark;
    for (const Rgb& colour : {cloth.colour, cloth.second}) {
      EXPECT_LE(std::max({colour.r, colour.g, colour.b}), 74);  // a quarter of 255, and three quarters of {10, 10, 12}
    }
  }
  EXPECT_GT(dark, 100);
}

TEST(Look, IsTheSameForTheSameSeed) {
  Random a(5, 1);
  Random b(5, 1);
  EXPECT_EQ(sample_look({}, a)[2].colour, sample_look({}, b)[2].colour);
}

}  // namespace
}  // namespace vesalius::synth

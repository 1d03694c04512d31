#include "synth/sensor/shade.h"

#include <gtest/gtest.h>

#include <set>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Material striped(Texture texture) {
  Material material;
  material.colour = {200, 0, 0};
  material.second = {0, 0, 200};
  material.texture = texture;
  material.period_m = 0.1F;
  return material;
}

TEST(Shade, DrawsStripesLevelOnWallsAndAlongZOnFloors) {
  const Material material = striped(Texture::stripes);
  const Vector3f wall = Vector3f::UnitZ(), floor = Vector3f::UnitY();
  EXPECT_EQ(colour_at(material, {0.F, 1.F, 0.F}, wall), colour_at(material, {0.73F, 1.F, 2.F}, wall));
  EXPECT_NE(colour_at(material, {0.F, 1.F, 0.F}, wall), colour_at(material, {0.F, 1.1F, 0.F}, wall));
  EXPECT_EQ(colour_at(material, {0.F, 0.F, 0.F}, floor), colour_at(material, {0.F, 0.F, 0.73F}, floor));
  EXPECT_NE(colour_at(material, {0.F, 0.F, 0.F}, floor), colour_at(material, {0.1F, 0.F, 0.F}, floor));
}

TEST(Shade, ChangesChecksFromCellToCell) {
  const Material material = striped(Texture::checks);
  const Rgb here = colour_at(material, {0.F, 0.F, 0.F}, Vector3f::UnitY());
  EXPECT_NE(here, colour_at(material, {0.1F, 0.F, 0.F}, Vector3f::UnitY()));
  EXPECT_NE(here, colour_at(material, {0.F, 0.F, 0.1F}, Vector3f::UnitY()));
  EXPECT_EQ(here, colour_at(material, {0.1F, 0.F, 0.1F}, Vector3f::UnitY()));
  // The points of a floor are at y = 0, apart from rounding.
  EXPECT_EQ(here, colour_at(material, {0.F, -1e-6F, 0.F}, Vector3f::UnitY()));
}

TEST(Shade, MixesTwoColoursInSpeckle) {
  const Material material = striped(Texture::speckle);
  std::set<int> reds;
  for (int i = 0; i < 100; ++i) {
    const Rgb c = colour_at(material, {static_cast<float>(i) * 0.1F, 0.F, 0.F}, Vector3f::UnitY());
    EXPECT_NEAR(c.r + c.b, 200, 1);
    reds.insert(c.r);
  }
  EXPECT_GT(reds.size(), 40U);
}

TEST(Shade, DimsLightByTheSquareAndTheCosine) {
  const std::vector<Light> lights = {Light{{0.F, 2.F, 0.F}, 3.F}};
  EXPECT_NEAR(brightness(Vector3f::Zero(), Vector3f::UnitY(), lights, 0.1F), 0.1F + 3.F / 4.F, 1e-6F);
  const Vector3f tilted = Vector3f(1.F, 1.F, 0.F).normalized();
  EXPECT_NEAR(brightness(Vector3f::Zero(), tilted, lights, 0.F), 3.F / 4.F * std::sqrt(0.5F), 1e-6F);
  EXPECT_EQ(brightness(Vector3f::Zero(), -Vector3f::UnitY(), lights, 0.1F), 0.1F);
  EXPECT_EQ(lit({100, 200, 50}, 2.F), (Rgb{200, 255, 100}));
}

}  // namespace
}  // namespace vesalius::synth

#include "c/read_frame.h"

#include <gtest/gtest.h>

#include "c/guard.h"

namespace vesalius::c {
namespace {

LensCamera bent(double k1) { return {{16, 12, 10.F, 10.F, 7.5F, 5.5F}, *make_lens("plumb_bob", {k1, 0, 0, 0, 0})}; }

TEST(Rectifications, AreKeptForTheLastCameras) {
  const Rectifications kept;
  const auto first = kept.of(bent(0.1));
  EXPECT_EQ(kept.of(bent(0.1)), first);
  const auto second = kept.of(bent(0.2));
  EXPECT_NE(second, first);
  EXPECT_EQ(kept.of(bent(0.1)), first);
  for (int i = 0; i < 7; ++i) kept.of(bent(0.3 + i * 0.01));
  EXPECT_EQ(kept.of(bent(0.1)), first) << "used later than the second";
  EXPECT_NE(kept.of(bent(0.2)), second);
  LensCamera other = bent(0.1);
  other.camera.fx = 11.F;
  EXPECT_NE(kept.of(other), first);
}

TEST(ReadCamera, KnowsEachLens) {
  vesalius_camera given{};
  given.struct_size = sizeof given;
  given.width = given.height = 100;
  given.fx = given.fy = 50.F;
  EXPECT_EQ(read_camera(&given).lens.model, LensModel::pinhole);
  given.lens = VESALIUS_LENS_BROWN_CONRADY;
  EXPECT_EQ(read_camera(&given).lens.model, LensModel::pinhole) << "which bends nothing";
  given.distortion[0] = 0.1;
  EXPECT_EQ(read_camera(&given).lens.model, LensModel::brown_conrady);
  given.lens = VESALIUS_LENS_MODIFIED_BROWN_CONRADY;
  EXPECT_EQ(read_camera(&given).lens.model, LensModel::modified_brown_conrady);
  given.lens = VESALIUS_LENS_KANNALA_BRANDT;
  EXPECT_EQ(read_camera(&given).lens.model, LensModel::kannala_brandt);
  EXPECT_EQ(read_camera(&given).lens.k[0], 0.1);
}

TEST(ReadFrame, KeepsTimeAndTheWayUp) {
  const std::uint16_t depth[4] = {1, 2, 3, 4};
  vesalius_frame given{};
  given.struct_size = sizeof given;
  given.depth = depth;
  vesalius_camera camera{};
  camera.struct_size = sizeof camera;
  camera.width = camera.height = 2;
  camera.fx = camera.fy = 1.F;
  const Rectifications none;
  EXPECT_FALSE(read_frame(&given, &camera, none).time_s);
  EXPECT_FALSE(read_frame(&given, &camera, none).up);
  given.has_time = given.has_up = 1;
  given.time_s = 2.5;
  given.up[1] = -9.81F;
  const Frame frame = read_frame(&given, &camera, none);
  EXPECT_EQ(frame.time_s, 2.5);
  EXPECT_EQ(*frame.up, Eigen::Vector3f(0.F, -1.F, 0.F));
  EXPECT_EQ(frame.depth(1, 1), 4);
}

}  // namespace
}  // namespace vesalius::c

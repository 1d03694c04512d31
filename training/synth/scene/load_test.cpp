#include "synth/scene/load.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "synth/scene/test_plans.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

struct Carrier {
  PosedBody body;
  BodyOutline outline;
};

Carrier carrier_of(const SampledPose& pose, std::uint32_t number) {
  const Poser& poser = *posers()[number % posers().size()];
  Carrier carrier{poser.pose(pose.pose), {}};
  carrier.outline = outline_of(carrier.body, poser.mesh().stature_m);
  return carrier;
}

/// Returns the distance of a point from the surface of the nearest thing.
float distance_to(const Furniture& piece, const Vector3f& p) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const Vector3f& q : piece.mesh.vertices) nearest = std::min(nearest, (p - q).norm());
  for (const OrientedBox& box : piece.solids) nearest = std::min(nearest, -depth_inside(box, p));
  return nearest;
}

TEST(Load, IsAtTheHandsAndOutsideTheBody) {
  int carried = 0, boxes = 0;
  constexpr int kPeople = 200;
  for (std::uint64_t i = 0; i < kPeople; ++i) {
    Random random(71, i);
    const SampledPose pose = sample_pose(only(&PoseSamplerOptions::carrying), random);
    const Carrier carrier = carrier_of(pose, random.next());
    const std::optional<Furniture> load = make_load(carrier.body, carrier.outline, random);
    if (!load) continue;
    ++carried;
    EXPECT_FALSE(sinks_in(carrier.outline, load->solids)) << i;
    float lowest = std::numeric_limits<float>::infinity();
    for (const Vector3f& p : load->mesh.vertices) lowest = std::min(lowest, p.y());
    const bool box = lowest > 0.3F;
    boxes += box ? 1 : 0;
    for (const Bone hand : {Bone::l_hand, Bone::r_hand}) {
      const Vector3f palm = 0.5F * (carrier.body.joints[index(hand)] + carrier.body.ends[index(hand)]);
      EXPECT_LT(distance_to(*load, palm), box ? 0.2F : 0.35F)
          << i << ": the mesh of a handle has points at its ends only";
    }
  }
  EXPECT_GT(carried, kPeople / 3) << "a third lets bags hang instead";
  EXPECT_GT(boxes, carried / 4);
  EXPECT_LT(boxes, carried) << "some push something";
}

TEST(Load, IsNotGivenToHandsThatHang) {
  const Carrier carrier = carrier_of({}, 0);
  Random random(72);
  EXPECT_FALSE(make_load(carrier.body, carrier.outline, random));
}

}  // namespace
}  // namespace vesalius::synth

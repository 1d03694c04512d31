#include "eval/shrink_frame.h"

#include <gmock/gmock.h>

#include "vesalius/capsule_person.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

TEST(ShrinkFrame, EveryPixelKeepsItsPoint) {
  CapsuleScene scene;
  scene.people.emplace_back();
  const Frame frame = render(scene, {163, 121, 131.F, 129.F, 80.2F, 61.7F}, paper_body()).frame;
  for (const int factor : {1, 2, 3}) {
    const Frame small = shrink(frame, factor);
    ASSERT_EQ(small.depth.width(), 163 / factor);
    ASSERT_EQ(small.depth.height(), 121 / factor);
    EXPECT_NO_THROW(check(small));
    for (int v = 0; v < small.depth.height(); ++v) {
      for (int u = 0; u < small.depth.width(); ++u) {
        const Eigen::Vector3f whole = point_at(frame.camera, frame.depth, factor * u, factor * v);
        ASSERT_LT((point_at(small.camera, small.depth, u, v) - whole).norm(), 1e-4F);
        ASSERT_EQ(small.colour(u, v), frame.colour(factor * u, factor * v));
      }
    }
  }
  EXPECT_EQ(shrink(frame, 1).camera, frame.camera);
}

TEST(ShrinkFrame, EnlargedAgainOnTheSameGrid) {
  Mask mask(5, 3, 0);
  mask(2, 0) = 7;
  const Mask large = enlarge(shrink(mask, 2), 2, 5, 3);
  ASSERT_TRUE(large.same_size(mask));
  EXPECT_EQ(large(2, 0), 7);
  EXPECT_EQ(large(3, 1), 7);
  EXPECT_EQ(large(4, 1), 7);  // beyond the last whole step
  EXPECT_EQ(large(1, 0), 0);
  EXPECT_EQ(large(3, 2), 7);
}

TEST(ShrinkFrame, PeopleAndTraces) {
  std::vector<Person> people(1);
  people[0].mask = Mask(2, 2, 1);
  people[0].labels = LabelImage(2, 2, 3);
  people[0].box = {1, 0, 1, 2};
  people[0].skeleton.parts.resize(1);
  people[0].skeleton.parts[0].centre = {1, 2, 3};
  Trace trace;
  trace.labels = LabelImage(2, 2, 5);
  trace.candidates.resize(1);
  trace.candidates[0].grown = Mask(2, 2, 1);
  enlarge(people, 2, 4, 4);
  enlarge(trace, 2, 4, 4);
  EXPECT_EQ(people[0].mask, Mask(4, 4, 1));
  EXPECT_EQ(people[0].labels, LabelImage(4, 4, 3));
  EXPECT_EQ(people[0].box.u, 2);
  EXPECT_EQ(people[0].box.height, 4);
  EXPECT_EQ(people[0].skeleton.parts[0].centre, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(trace.labels, LabelImage(4, 4, 5));
  EXPECT_EQ(trace.candidates[0].grown, Mask(4, 4, 1));
}

TEST(ShrinkFrame, NothingLeft) {
  Frame frame;
  frame.camera = {3, 1, 5, 5, 1, 0};
  frame.depth = DepthImage(3, 1, 1000);
  EXPECT_THROW(shrink(frame, 2), Error);
  EXPECT_THROW(shrink(frame, 0), Error);
}

}  // namespace
}  // namespace vesalius

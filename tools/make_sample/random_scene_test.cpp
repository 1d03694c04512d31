#include "random_scene.h"

#include <gmock/gmock.h>

#include <set>

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};

TEST(RandomScene, PeopleStandApartOnTheFloorBeforeTheWall) {
  std::set<std::size_t> sizes;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const CapsuleScene scene = random_scene(1, i);
    sizes.insert(scene.people.size());
    for (const CapsulePerson& person : scene.people) {
      EXPECT_EQ(person.feet.y(), scene.floor_y_m);
      if (scene.wall_z_m > 0.F) {
        EXPECT_LT(person.feet.z() + 0.3F, scene.wall_z_m);
      }
      for (const CapsulePerson& other : scene.people) {
        if (&other != &person) {
          EXPECT_GE((other.feet - person.feet).norm(), 0.75F);
        }
      }
    }
  }
  EXPECT_EQ(sizes, (std::set<std::size_t>{0, 1, 2, 3}));
}

TEST(RandomScene, MostPeopleAreInView) {
  int people = 0, in_view = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const LabelledFrame labelled = random_frame(kCamera, 2, i);
    std::vector<int> pixels(labelled.parts.size(), 0);
    for (const std::uint8_t person : labelled.person) {
      if (person != kBackground) ++pixels[person];
    }
    for (const int count : pixels) {
      ++people;
      in_view += count > 150;
    }
  }
  EXPECT_GT(in_view, people * 0.9);
}

TEST(RandomScene, SameSeedAndIndexSameFrame) {
  EXPECT_EQ(random_frame(kCamera, 3, 5).frame.depth, random_frame(kCamera, 3, 5).frame.depth);
  EXPECT_NE(random_frame(kCamera, 3, 5).frame.depth, random_frame(kCamera, 3, 7).frame.depth);
  EXPECT_NE(random_frame(kCamera, 3, 5).frame.depth, random_frame(kCamera, 4, 5).frame.depth);
}

}  // namespace
}  // namespace vesalius

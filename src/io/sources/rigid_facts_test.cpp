#include "io/sources/rigid_facts.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace vesalius {
namespace {

TEST(RigidFacts, TellDirectionsByNames) {
  using enum CameraRole;
  const auto direction = [](const std::string& file, const std::string& key) {
    const auto facts = rigid_facts(
        parse_facts("{\"" + key + "\": {\"rotation\": [1,0,0,0,1,0,0,0,1], \"translation\": [0.1,0,0]}}", file), file);
    return facts.empty() ? std::pair(first, first) : std::pair(facts.front().from, facts.front().to);
  };
  for (const char* key : {"depth_to_color", "d2c", "Depth2RGB", "ir_to_rgb", "color_from_depth", "T_depth_rgb"}) {
    EXPECT_EQ(direction("a.json", key), std::pair(depth, colour)) << key;
  }
  for (const char* key : {"color_to_depth", "c2d", "rgb2ir", "depth_from_rgb"}) {
    EXPECT_EQ(direction("a.json", key), std::pair(colour, depth)) << key;
  }
  EXPECT_EQ(direction("a.json", "extrinsics"), std::pair(unsaid, unsaid));
  EXPECT_EQ(direction("depth_to_color.json", "extrinsics"), std::pair(depth, colour));
}

}  // namespace
}  // namespace vesalius

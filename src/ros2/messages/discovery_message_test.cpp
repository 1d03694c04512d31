#include "ros2/messages/discovery_message.h"

#include <gtest/gtest.h>

#include <string>

namespace vesalius::ros2 {
namespace {

using namespace std::string_literals;

TEST(DiscoveryMessage, LaysGidsOutAsTheDistributionHasThem) {
  const NodeEntities node{"/", "eye", {{1, 2}}, {{3}, {4}}};
  const auto gid = [](std::string first, std::size_t bytes) {
    first.resize(bytes, '\0');
    return first;
  };
  for (const std::size_t bytes : {kGidBytes, kOldGidBytes}) {
    const std::string expected = "\0\1\0\0"s + gid("\x9"s, bytes) + "\1\0\0\0"s + "\2\0\0\0/\0\0\0"s +
                                 "\4\0\0\0eye\0"s + "\1\0\0\0"s + gid("\1\2"s, bytes) + "\2\0\0\0"s +
                                 gid("\3"s, bytes) + gid("\4"s, bytes);
    EXPECT_EQ(discovery_message({9}, node, bytes), expected) << bytes;
  }
}

}  // namespace
}  // namespace vesalius::ros2

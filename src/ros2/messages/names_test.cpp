#include "ros2/messages/names.h"

#include <gmock/gmock.h>

#include <string>

#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

TEST(Names, AreThoseOfTheWire) {
  EXPECT_EQ(topic_on_wire("/camera/depth"), "rt/camera/depth");
  EXPECT_EQ(type_on_wire("sensor_msgs/Image"), "sensor_msgs::msg::dds_::Image_");
  EXPECT_EQ(long_type("sensor_msgs/Image"), "sensor_msgs/msg/Image");
  EXPECT_EQ(topic_from_wire("rt/camera/depth", "sensor_msgs::msg::dds_::Image_"),
            (TopicType{"/camera/depth", "sensor_msgs/Image"}));
}

TEST(Names, OfOthersAreNoTopics) {
  for (const auto& [topic, type] :
       {std::pair("rq/add", "sensor_msgs::msg::dds_::Image_"), std::pair("rt/", "sensor_msgs::msg::dds_::Image_"),
        std::pair("rt", "sensor_msgs::msg::dds_::Image_"),
        std::pair("ros_discovery_info", "rmw_dds_common::msg::dds_::X_"), std::pair("rt/x", "sensor_msgs::Image"),
        std::pair("rt/x", "::msg::dds_:"), std::pair("rt/x", "a::msg::dds_::_extra"), std::pair("", "")}) {
    EXPECT_FALSE(topic_from_wire(topic, type)) << topic << " " << type;
  }
}

TEST(Names, AreResolvedAsRos2Does) {
  EXPECT_EQ(resolve_name("/tf", "/robot", "eye", "x"), "/tf");
  EXPECT_EQ(resolve_name("points", "/robot", "eye", "x"), "/robot/points");
  EXPECT_EQ(resolve_name("~/points", "/robot", "eye", "x"), "/robot/eye/points");
  EXPECT_EQ(resolve_name("~/points", "/", "eye", "x"), "/eye/points");
  EXPECT_EQ(resolve_name("points", "/", "eye", "x"), "/points");
}

TEST(Names, ThatAreNoneAreRefused) {
  for (const char* name :
       {"", "/", "points", "/points/", "//points", "/3d", "/a b", "/a//b", "/a/2b", "/~", "/\xc3\xa4"}) {
    EXPECT_THROW(check_full_name(name, "topic"), UsageError) << name;
  }
  EXPECT_THROW(check_full_name("/" + std::string(247, 'a'), "topic"), UsageError);
  EXPECT_NO_THROW(check_full_name("/" + std::string(246, 'a'), "topic"));
  EXPECT_NO_THROW(check_full_name("/", "namespace", true));
  for (const char* name : {"", "a/b", "a-b", "9", "/a"})
    EXPECT_THROW(check_node_name(name, "node"), UsageError) << name;
  EXPECT_NO_THROW(check_node_name("_eye9", "node"));
}

}  // namespace
}  // namespace vesalius::ros2

#include "io/recordings/transform_messages.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/recordings/message_fields.h"

namespace vesalius {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

Isometry3d some(double angle, const Vector3d& shift) {
  return Translation3d(shift) * AngleAxisd(angle, Vector3d(1, 2, 3).normalized());
}

TEST(TransformTree, ConnectsFramesOverTheirAncestors) {
  const Isometry3d root_from_a = some(0.3, {1, 2, 3}), a_from_b = some(-0.7, {0, 1, 0}),
                   root_from_c = some(1, {4, 0, 1});
  TransformTree tree;
  tree.add({"a", "b", a_from_b});
  tree.add({"root", "a", root_from_a});
  tree.add({"root", "c", root_from_c});
  tree.add({"other", "d", some(0, {0, 0, 0})});
  EXPECT_TRUE(tree.find("c", "b")->isApprox(root_from_c.inverse() * root_from_a * a_from_b));
  EXPECT_TRUE(tree.find("root", "b")->isApprox(root_from_a * a_from_b));
  EXPECT_TRUE(tree.find("b", "a")->isApprox(a_from_b.inverse()));
  EXPECT_TRUE(tree.find("x", "x")->isApprox(Isometry3d::Identity())) << "a frame is itself, known or not";
  EXPECT_FALSE(tree.find("d", "b"));
  EXPECT_FALSE(tree.find("", ""));
}

TEST(TransformTree, EndsWhereFramesStandInEachOther) {
  TransformTree tree;
  tree.add({"a", "b", some(0.1, {1, 0, 0})});
  tree.add({"b", "a", some(0.1, {1, 0, 0})});
  EXPECT_FALSE(tree.find("c", "a"));
}

TEST(TransformTree, WhatMayMoveCountsUntilItDoes) {
  const Isometry3d here = some(0.2, {1, 2, 3}), there = some(0.3, {1, 2, 3});
  TransformTree tree;
  for (int i = 0; i < 3; ++i) tree.add({"base", "camera", here, true});
  EXPECT_TRUE(tree.find("base", "camera")->isApprox(here)) << "a driver of ROS 1 repeats it";
  tree.add({"base", "camera", there, true});
  tree.add({"base", "camera", here, true});
  EXPECT_FALSE(tree.find("base", "camera")) << "it moves";
  tree.add({"base", "camera", there});
  tree.add({"base", "camera", here, true});
  EXPECT_TRUE(tree.find("base", "camera")->isApprox(there)) << "tf_static rules";
  tree.add({"base", "lens", here, true});
  tree.add({"base", "lens", there});
  EXPECT_TRUE(tree.find("base", "lens")->isApprox(there)) << "whichever comes first";
}

TEST(TransformMessages, AreReadInBothLayoutsOfRos) {
  const auto parse = [](MessageLayout layout, const std::string& bytes) {
    EXPECT_TRUE(parse_transforms({"/tf", "tf/tfMessage", layout, 1}, bytes, "here").front().may_move);
    return parse_transforms({"/tf_static", "tf2_msgs/TFMessage", layout, 1}, bytes, "here");
  };
  CdrWriter cdr;
  cdr.u32(2);
  for (const char* child : {"b", "/c"}) {
    cdr.header(5, "/a");
    cdr.text(child);
    for (const double t : {1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0}) cdr.real64(t);
  }
  std::string ros1(
      "\1\0\0\0"
      "\7\0\0\0"
      "\0\0\0\0"
      "\0\0\0\0"
      "\1\0\0\0"
      "a"
      "\1\0\0\0"
      "c",
      26);
  for (const double t : {1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0}) ros1.append(reinterpret_cast<const char*>(&t), sizeof(t));
  for (const auto& all : {parse(MessageLayout::cdr, cdr.message()), parse(MessageLayout::ros1, ros1)}) {
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.back().parent, "a");
    EXPECT_EQ(all.back().child, "c");
    EXPECT_TRUE((all.back().parent_from_child * Vector3d(1, 1, 1)).isApprox(Vector3d(0, 1, 4)));  // half a turn about z
  }
  EXPECT_THAT(test::error_of([&] { parse(MessageLayout::ros1, ros1.substr(0, 40)); }),
              testing::HasSubstr("here: a message ends within the translation"));
}

TEST(TransformMessages, OfRealSenseLeadFromTheReferenceToTheStream) {
  const RecordedTopic topic{"/device_0/sensor_1/Color_0/tf/ref_1", "std_msgs/String", MessageLayout::cdr, 1};
  ASSERT_TRUE(is_transform(topic));
  CdrWriter out;
  // Column by column: a quarter turn about z.
  out.text("rotation=0.0,1.0,0.0,-1.0,0.0,0.0,0.0,0.0,1.0;translation=0.015,0.001,0.002");
  const auto all = parse_transforms(topic, out.message(), "here");
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].parent, "/device_0/tf/ref_1");
  EXPECT_EQ(all[0].child, "/device_0/sensor_1/Color_0");
  EXPECT_TRUE((all[0].parent_from_child.inverse() * Vector3d(1, 0, 0)).isApprox(Vector3d(0.015, 1.001, 0.002)));
}

TEST(TransformMessages, ThatAreNoneAreLeftOut) {
  CdrWriter out;
  out.u32(1);
  out.header(0, "a");
  out.text("b");
  for (int i = 0; i < 7; ++i) out.real64(0.0);
  EXPECT_TRUE(
      parse_transforms({"/tf_static", "tf2_msgs/TFMessage", MessageLayout::cdr, 1}, out.message(), "x").empty());
}

}  // namespace
}  // namespace vesalius

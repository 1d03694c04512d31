#include "io/files/ply.h"

#include <gmock/gmock.h>

#include <cstring>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::get;
using test::TemporaryFolder;
using testing::HasSubstr;

struct Scene {
  Frame frame{"f", 0.0, {3, 2, 2.F, 4.F, 1.F, 0.5F}, DepthImage(3, 2), {}};
  LabelImage labels{3, 2, kBackground};
  Image<std::uint8_t> person{3, 2, kBackground};
  BodyModel body;

  Scene() {
    frame.depth(2, 1) = 2000;
    frame.depth(0, 0) = 1000;
    labels(2, 1) = 1;
    person(2, 1) = 7;
    body.parts.resize(2);
    body.parts[1].colour = {10, 20, 30};
  }
  std::string cloud() const { return serialise_cloud(frame, labels, person, body); }
};

struct Vertex {
  float x, y, z;
  std::uint8_t r, g, b, label, person;
};

std::vector<Vertex> vertices(const std::string& cloud) {
  constexpr std::string_view kEnd = "end_header\n";
  const std::string_view data = std::string_view(cloud).substr(cloud.find(kEnd) + kEnd.size());
  EXPECT_EQ(data.size() % 17, 0U);
  std::vector<Vertex> all(data.size() / 17);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::memcpy(&all[i].x, data.data() + i * 17, 12);
    std::memcpy(&all[i].r, data.data() + i * 17 + 12, 5);
  }
  return all;
}

TEST(Ply, HasAVertexForEachReading) {
  const std::string cloud = Scene().cloud();
  EXPECT_TRUE(cloud.starts_with("ply\nformat binary_little_endian 1.0\nelement vertex 2\n"));
  const std::vector<Vertex> all = vertices(cloud);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].x, -0.5F);
  EXPECT_EQ(all[0].y, -0.125F);
  EXPECT_EQ(all[0].z, 1.F);
  EXPECT_EQ(all[0].label, kBackground);
  EXPECT_EQ(all[0].person, kBackground);
  EXPECT_EQ(all[0].r, 128);
  EXPECT_EQ(all[1].x, 1.F);
  EXPECT_EQ(all[1].y, 0.25F);
  EXPECT_EQ(all[1].z, 2.F);
  EXPECT_EQ(all[1].label, 1);
  EXPECT_EQ(all[1].person, 7);
  EXPECT_EQ(all[1].r, 10);
  EXPECT_EQ(all[1].g, 20);
  EXPECT_EQ(all[1].b, 30);
}

TEST(Ply, KeepsTheColourOfUnlabelledPoints) {
  Scene scene;
  scene.frame.colour = ColourImage(3, 2, {1, 2, 3});
  const std::vector<Vertex> all = vertices(scene.cloud());
  EXPECT_EQ(all[0].b, 3);
  EXPECT_EQ(all[1].b, 30);
}

TEST(Ply, RefusesWrongSizesAndLabels) {
  Scene small;
  small.labels = LabelImage(2, 2);
  EXPECT_THAT(error_of([&] { small.cloud(); }), HasSubstr("another size"));
  Scene unknown;
  unknown.labels(0, 0) = 2;
  const TemporaryFolder folder;
  EXPECT_THAT(
      error_of([&] { write_cloud(unknown.frame, unknown.labels, unknown.person, unknown.body, folder / "a.ply"); }),
      HasSubstr("a.ply: frame f: label 2, expected less than 2"));
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(Ply, WritesTheSameBytesAsItSerialises) {
  const TemporaryFolder folder;
  const Scene scene;
  write_cloud(scene.frame, scene.labels, scene.person, scene.body, folder / "a.ply");
  EXPECT_EQ(get(folder / "a.ply"), scene.cloud());
}

}  // namespace
}  // namespace vesalius

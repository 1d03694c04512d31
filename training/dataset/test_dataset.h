#pragma once

#include <limits>

#include "dataset/labelled_dataset.h"
#include "io/files/test_files.h"

// Helpers that the tests of labelled datasets share.
namespace vesalius::test {

inline const std::vector<std::string> kJoints = {"hip", "knee", "foot"};

/// Returns random depth, colour and truth of two people of the paper's body with kJoints; the second person has no
/// neck.
inline LabelledFrame random_labelled(std::uint64_t seed, bool colour = true) {
  LabelledFrame labelled;
  labelled.frame = random_frame("frame_" + std::to_string(seed), seed, 37, 23, colour);
  Random rng(seed, 1);
  labelled.labels = LabelImage(37, 23, kBackground);
  labelled.person = labelled.labels;
  for (std::size_t i = 0; i < labelled.labels.size(); ++i) {
    if (rng.below(2) == 0) continue;
    labelled.labels[i] = static_cast<std::uint8_t>(rng.below(25));
    labelled.person[i] = static_cast<std::uint8_t>(rng.below(2));
  }
  labelled.parts.resize(2);
  for (auto& parts : labelled.parts) {
    for (int p = 0; p < 25; ++p) parts.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), 2.0).cast<float>());
  }
  labelled.parts[1][10].fill(std::numeric_limits<float>::quiet_NaN());
  for (int person = 0; person < 2; ++person) {
    labelled.joints.emplace_back();
    for (std::size_t j = 0; j < kJoints.size(); ++j) {
      labelled.joints.back().push_back(Eigen::Vector3d(rng.normal(), rng.normal(), 2.0).cast<float>());
    }
  }
  return labelled;
}

inline void expect_same(const LabelledFrame& a, const LabelledFrame& b) {
  EXPECT_EQ(a.frame.name, b.frame.name);
  EXPECT_EQ(a.frame.time_s, b.frame.time_s);
  EXPECT_EQ(a.frame.camera, b.frame.camera);
  EXPECT_EQ(a.frame.depth, b.frame.depth);
  EXPECT_EQ(a.frame.colour, b.frame.colour);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.person, b.person);
  EXPECT_EQ(a.joints, b.joints);
  EXPECT_EQ(a.postures, b.postures);
  EXPECT_EQ(a.up, b.up);
  EXPECT_EQ(a.camera_height_m, b.camera_height_m);
  ASSERT_EQ(a.world_from_camera.has_value(), b.world_from_camera.has_value());
  if (a.world_from_camera) {
    EXPECT_EQ(a.world_from_camera->matrix(), b.world_from_camera->matrix());
  }
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    ASSERT_EQ(a.parts[i].size(), b.parts[i].size());
    for (std::size_t p = 0; p < a.parts[i].size(); ++p) {
      EXPECT_TRUE(a.parts[i][p] == b.parts[i][p] || (a.parts[i][p].hasNaN() && b.parts[i][p].hasNaN()));
    }
  }
}

/// Returns a pose of a camera in the world.
inline Eigen::Isometry3f camera_pose() {
  return Eigen::Translation3f(0.1F, 1.4F, -2.F) * Eigen::AngleAxisf(0.3F, Eigen::Vector3f(0.6F, 0.F, 0.8F));
}

inline DatasetInfo small_info(std::uint64_t frames = 10, std::uint32_t per_shard = 4) {
  return {paper_body().toml, "people = 2\n", 7, frames, per_shard, kJoints};
}

}  // namespace vesalius::test

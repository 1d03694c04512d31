#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "synth/body/poser.h"
#include "synth/generate.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr ClipTiming kShort{3.F, 20.0};

/// Returns a recipe of three people in small pictures without noise.
Recipe small_recipe() {
  Recipe recipe;
  recipe.sensor.width = 96;
  recipe.sensor.height = 72;
  recipe.sensor.noise = false;
  recipe.sensor.colour = false;
  recipe.body.kind = "builtin";
  recipe.body.count = 3;
  recipe.people = {.none = 0.F, .one = 0.F, .two = 0.F, .three = 1.F, .four = 0.F};
  recipe.clip.moving_share = 1.F;
  recipe.clip.walking_share = 1.F;
  return recipe;
}

ClipGenerator small_clips(const Recipe& recipe, const ClipTiming& timing = kShort) {
  return {recipe, {}, paper_body(), 4, timing};
}

/// Returns the side of the picture, relative to b, on which a is at a time: below or above 0; 0 if one is out of view.
float side_of(const View& view, const PersonTrack& a, const PersonTrack& b, float time_s) {
  const auto column = [&](const PersonTrack& person) -> std::optional<float> {
    const Eigen::Vector2f at = person.at(time_s).at;
    const Eigen::Vector3f p = view.camera_from_world * Eigen::Vector3f(at.x(), 0.95F, at.y());
    if (p.z() < 0.3F) return std::nullopt;
    const float u = view.camera.pixel(p).x();
    return u > 0.F && u < static_cast<float>(view.camera.width) ? std::optional(u) : std::nullopt;
  };
  const auto one = column(a), other = column(b);
  return one && other ? *one - *other : 0.F;
}

/// Returns whether two people pass before each other in the picture.
bool cross(const View& view, const PersonTrack& a, const PersonTrack& b, float seconds) {
  float before = 0.F;
  for (float time_s = 0.F; time_s < seconds; time_s += 0.1F) {
    const float side = side_of(view, a, b, time_s);
    if (side * before < 0.F) return true;
    before = side;
  }
  return false;
}

/// Returns the joints in the world: [frame][person][joint].
std::vector<std::vector<std::vector<Eigen::Vector3f>>> world_joints(const std::vector<LabelledFrame>& frames) {
  std::vector<std::vector<std::vector<Eigen::Vector3f>>> all;
  for (const LabelledFrame& frame : frames) {
    all.push_back(frame.joints);
    for (auto& person : all.back()) {
      for (Eigen::Vector3f& p : person) p = *frame.world_from_camera * p;
    }
  }
  return all;
}

std::vector<LabelledFrame> frames_of(const ClipGenerator& clips, std::uint64_t clip) {
  std::vector<LabelledFrame> frames(static_cast<std::size_t>(clips.frames_per_clip()));
  parallel_for(clips.frames_per_clip(), [&](int k) { frames[k] = clips.frame(clip, k); });
  return frames;
}

TEST(ClipGenerator, MakesAnyFrameAgainInAnyOrder) {
  Recipe recipe = small_recipe();
  recipe.sensor.noise = true;
  recipe.sensor.colour = true;
  recipe.sensor.filter.share = 0.5F;
  const ClipGenerator one = small_clips(recipe), other = small_clips(recipe);
  std::vector<LabelledFrame> forwards;
  {
    const ThreadLimit limit(1);
    for (std::uint64_t i = 55; i < 65; ++i) forwards.push_back(one.frame(i));  // the end of clip 0 and some of clip 1
  }
  const ThreadLimit limit(2);
  std::vector<LabelledFrame> backwards(forwards.size());
  parallel_for(static_cast<int>(backwards.size()), [&](int i) {
    const std::size_t at = backwards.size() - 1 - static_cast<std::size_t>(i);
    backwards[at] = other.frame(55 + at);
  });
  for (std::size_t i = 0; i < forwards.size(); ++i) {
    EXPECT_EQ(forwards[i].frame.name, backwards[i].frame.name);
    EXPECT_EQ(forwards[i].frame.depth, backwards[i].frame.depth);
    EXPECT_EQ(forwards[i].frame.colour, backwards[i].frame.colour);
    EXPECT_EQ(forwards[i].labels, backwards[i].labels);
    EXPECT_EQ(forwards[i].person, backwards[i].person);
    EXPECT_EQ(forwards[i].joints, backwards[i].joints);
    EXPECT_EQ(forwards[i].world_from_camera->matrix(), backwards[i].world_from_camera->matrix());
  }
  EXPECT_EQ(forwards[4].frame.name, "0000_000059");
  EXPECT_EQ(forwards[5].frame.name, "0001_000000");
  EXPECT_EQ(forwards[5].frame.time_s, 0.0);
  EXPECT_EQ(forwards[4].frame.time_s, 59 / 20.0);
}

TEST(ClipGenerator, ShowsTheSamePeopleToSeveralCameras) {
  Recipe recipe = small_recipe();
  recipe.clip.cameras = 3;
  recipe.clip.apart_deg = 100.F;
  std::vector<std::vector<LabelledFrame>> seen;
  for (recipe.clip.seen_from = 0; recipe.clip.seen_from < 3; ++recipe.clip.seen_from) {
    seen.push_back(frames_of(small_clips(recipe), 0));
  }
  const auto first = world_joints(seen[0]);
  std::vector<int> with_people(3);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto joints = world_joints(seen[c]);
    for (std::size_t k = 0; k < first.size(); ++k) {
      for (std::size_t who = 0; who < 3; ++who) {
        EXPECT_LT((joints[k][who][0] - first[k][who][0]).norm(), 1e-4F) << c << " " << k;
      }
      with_people[c] += std::ranges::any_of(seen[c][k].person, [](std::uint8_t p) { return p != kBackground; }) ? 1 : 0;
      EXPECT_EQ(seen[c][k].frame.time_s, seen[0][k].frame.time_s);
    }
    EXPECT_GT(with_people[c], 30) << "all look at the middle";
    // Cameras stand, at one height, each turned by 100 degrees from the one before.
    const Eigen::Isometry3f pose = *seen[c][0].world_from_camera, before = *seen[(c + 2) % 3][0].world_from_camera;
    EXPECT_EQ(pose.matrix(), seen[c].back().world_from_camera->matrix());
    EXPECT_NEAR(pose.translation().y(), before.translation().y(), 1e-4F);
    const float turn = Eigen::AngleAxisf(Eigen::Matrix3f(before.linear().transpose() * pose.linear())).angle();
    EXPECT_NEAR(turn * 57.29578F, c == 0 ? 160.F : 100.F, 0.1F);
  }
}

TEST(ClipGenerator, MovesTheSameBodiesContinuously) {
  const ClipGenerator clips = small_clips(small_recipe());
  const std::vector<LabelledFrame> frames = frames_of(clips, 0);
  const auto joints = world_joints(frames);
  ASSERT_EQ(joints[0].size(), 3U);
  float farthest_m = 0.F;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    ASSERT_EQ(joints[k].size(), 3U) << "out of view or not, all are listed";
    ASSERT_EQ(frames[k].postures.size(), 3U);
    ASSERT_EQ(frames[k].parts.size(), 3U);
    for (std::size_t who = 0; who < 3; ++who) {
      const auto& now = joints[k][who];
      for (const auto& [from, to] : {std::pair{Bone::l_thigh, Bone::l_shin}, {Bone::r_upper_arm, Bone::r_forearm}}) {
        EXPECT_NEAR((now[index(from)] - now[index(to)]).norm(),
                    (joints[0][who][index(from)] - joints[0][who][index(to)]).norm(), 1e-3F);
      }
      for (std::size_t other = 0; other < who; ++other) {
        Eigen::Vector3f apart = now[0] - joints[k][other][0];
        apart.y() = 0.F;
        EXPECT_GT(apart.norm(), 0.45F) << "frame " << k;
      }
      if (k == 0) continue;
      for (std::size_t j = 0; j < now.size(); ++j) {
        EXPECT_LT((now[j] - joints[k - 1][who][j]).norm() * 20.F, 10.F) << joint_names()[j] << " of frame " << k;
      }
      farthest_m = std::max(farthest_m, (now[0] - joints[0][who][0]).norm());
    }
  }
  EXPECT_GT(farthest_m, 0.5F) << "somebody goes somewhere";
}

TEST(ClipGenerator, KnowsWhereTheCameraIs) {
  const ClipGenerator clips = small_clips(small_recipe());
  Eigen::Vector3f before = Eigen::Vector3f::Zero();
  float moved_m = 0.F;
  for (int k = 0; k < clips.frames_per_clip(); k += 12) {
    const LabelledFrame f = clips.frame(2, k);
    const Eigen::Isometry3f& pose = *f.world_from_camera;
    EXPECT_TRUE(f.up->isApprox(pose.linear().transpose() * Eigen::Vector3f::UnitY(), 1e-5F));
    EXPECT_NEAR(*f.camera_height_m, pose.translation().y(), 1e-6F);
    int below = 0, floor = 0;
    for (int v = 0; v < f.frame.depth.height(); ++v) {
      for (int u = 0; u < f.frame.depth.width(); ++u) {
        if (f.frame.depth(u, v) == 0) continue;
        const float y = (pose * point_at(f.frame.camera, f.frame.depth, u, v)).y();
        below += y < -0.01F ? 1 : 0;
        floor += std::abs(y) < 0.005F && f.labels(u, v) == kBackground ? 1 : 0;
        // The floor's plane by what is known without the world: along `up`, the camera's height below it.
        if (std::abs(y) < 0.005F) {
          const float level = point_at(f.frame.camera, f.frame.depth, u, v).dot(*f.up) + *f.camera_height_m;
          EXPECT_NEAR(level, 0.F, 0.006F);
        }
      }
    }
    EXPECT_EQ(below, 0) << "frame " << k;
    EXPECT_GT(floor, 60) << "frame " << k;
    if (k > 0) moved_m += (pose.translation() - before).norm();
    before = pose.translation();
  }
  EXPECT_GT(moved_m, 0.005F);
}

TEST(ClipGenerator, LeavesTheRoomAsItIs) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 1.F, .one = 0.F, .two = 0.F, .three = 0.F, .four = 0.F};
  const ClipGenerator clips = small_clips(recipe);
  const LabelledFrame a = clips.frame(0, 0), b = clips.frame(0, 59);
  const Eigen::Isometry3f b_from_a = b.world_from_camera->inverse() * *a.world_from_camera;
  int met = 0, agree = 0;
  for (int v = 0; v < a.frame.depth.height(); ++v) {
    for (int u = 0; u < a.frame.depth.width(); ++u) {
      if (a.frame.depth(u, v) == 0) continue;
      const Eigen::Vector3f p = b_from_a * point_at(a.frame.camera, a.frame.depth, u, v);
      if (p.z() < 0.2F) continue;
      const Eigen::Vector2f pixel = b.frame.camera.pixel(p);
      const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
      if (!b.frame.depth.contains(x, y) || b.frame.depth(x, y) == 0) continue;
      ++met;
      agree += std::abs(1e-3F * static_cast<float>(b.frame.depth(x, y)) - p.z()) < 0.05F * p.z() ? 1 : 0;
    }
  }
  EXPECT_GT(met, 2000);
  EXPECT_GT(agree, met * 9 / 10);
}

TEST(ClipGenerator, LetsPeopleCross) {
  Recipe recipe = small_recipe();
  recipe.clip.moving_share = 0.F;
  recipe.clip.crossing_share = 1.F;
  recipe.clip.walking_share = 1.F;
  const ClipTiming timing{6.F, 30.0};
  const ClipGenerator clips = small_clips(recipe, timing);
  const Camera camera = clips.frame(0, 0).frame.camera;
  int with_crossing = 0;
  for (std::uint64_t c = 0; c < 4; ++c) {
    const auto clip = clips.clip(c);
    const View view{camera, clip->camera.at(0.F).inverse()};
    bool crossed = false;
    for (std::size_t i = 0; i < clip->people.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        crossed = crossed || cross(view, clip->people[i].track, clip->people[j].track, timing.seconds);
      }
    }
    with_crossing += crossed ? 1 : 0;
  }
  EXPECT_GE(with_crossing, 3) << "of 4";
}

TEST(ClipGenerator, DrawsNoiseForEachFrameAndTheCameraForEachClip) {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 1.F, .one = 0.F, .two = 0.F, .three = 0.F, .four = 0.F};
  recipe.clip.moving_share = 0.F;
  recipe.sensor.noise = true;
  recipe.sensor.colour = true;
  const ClipGenerator clips = small_clips(recipe);
  const auto empty_columns = [](const DepthImage& depth) {
    int columns = 0;
    while (columns < depth.width()) {
      for (int v = 0; v < depth.height(); ++v) {
        if (depth(columns, v) != 0) return columns;
      }
      ++columns;
    }
    return columns;
  };
  const auto brightness = [](const ColourImage& colour) {
    double sum = 0.0;
    for (const Rgb& pixel : colour) sum += pixel.g;
    return sum / static_cast<double>(colour.size());
  };
  for (std::uint64_t c = 0; c < 3; ++c) {
    const LabelledFrame a = clips.frame(c, 0), b = clips.frame(c, 30);
    EXPECT_NE(a.frame.depth, b.frame.depth);
    EXPECT_NE(a.frame.colour, b.frame.colour);
    EXPECT_NEAR(empty_columns(a.frame.depth), empty_columns(b.frame.depth), 1);
    EXPECT_NEAR(brightness(a.frame.colour), brightness(b.frame.colour), 1.0);
  }
}

TEST(ClipGenerator, GivesTheSameMotionAtAnyRate) {
  const Recipe recipe = small_recipe();
  const ClipGenerator slow = small_clips(recipe, {2.F, 10.0}), fast = small_clips(recipe, {2.F, 30.0});
  EXPECT_EQ(slow.frames_per_clip(), 20);
  EXPECT_EQ(fast.frames_per_clip(), 60);
  EXPECT_EQ(slow.frame(0, 7).joints, fast.frame(0, 21).joints);
}

/// Returns the recipe of one person alone before a camera that stands.
Recipe recipe_of_one() {
  Recipe recipe = small_recipe();
  recipe.people = {.none = 0.F, .one = 1.F, .two = 0.F, .three = 0.F, .four = 0.F};
  recipe.clip.moving_share = 0.F;
  return recipe;
}

/// Returns the greatest way of a joint from one frame to the next, metres.
float longest_step(const std::vector<LabelledFrame>& frames) {
  const auto joints = world_joints(frames);
  float longest = 0.F;
  for (std::size_t k = 1; k < joints.size(); ++k) {
    for (std::size_t j = 0; j < joints[k][0].size(); ++j) {
      longest = std::max(longest, (joints[k][0][j] - joints[k - 1][0][j]).norm());
    }
  }
  return longest;
}

TEST(ClipGenerator, LetsPeopleFallWithinASecondOrSo) {
  Recipe recipe = recipe_of_one();
  recipe.clip.falling_share = 1.F;
  const ClipGenerator clips(recipe, {}, paper_body(), 4, {4.F, 20.0});
  for (std::uint64_t clip = 0; clip < 3; ++clip) {
    const std::vector<LabelledFrame> frames = frames_of(clips, clip);
    ASSERT_EQ(frames.front().joints.size(), 1U);
    std::size_t first_down = 0, last_up = 0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (frames[k].postures.at(0) == "lying" && first_down == 0) first_down = k;
      if (frames[k].postures.at(0) == "standing") last_up = k;
    }
    EXPECT_GT(first_down, 0U);
    EXPECT_LT(last_up, first_down) << "nobody gets up";
    EXPECT_LE(first_down - last_up, 24U);
    EXPECT_LT(longest_step(frames), 0.42F) << "8.4 m/s";
  }
}

TEST(ClipGenerator, LetsWhoFellGetUpAgain) {
  Recipe recipe = recipe_of_one();
  recipe.clip.falling_share = recipe.clip.rising_share = 1.F;
  const ClipGenerator clips(recipe, {}, paper_body(), 4, {9.F, 20.0});
  const std::vector<LabelledFrame> frames = frames_of(clips, 0);
  std::vector<std::string> postures;
  for (const LabelledFrame& frame : frames) {
    const std::string& now = frame.postures.at(0);
    if (now == "standing" || now == "lying") postures.push_back(now);
  }
  postures.erase(std::unique(postures.begin(), postures.end()), postures.end());
  EXPECT_THAT(postures, testing::ElementsAre("standing", "lying", "standing"));
  EXPECT_LT(longest_step(frames), 0.42F) << "8.4 m/s";
}

TEST(ClipGenerator, LetsPeopleSitDownAndGetUp) {
  Recipe recipe = recipe_of_one();
  recipe.clip.walking_share = 0.F;
  recipe.clip.seating_share = 1.F;
  recipe.pose.sampler = {};
  recipe.pose.sampler.sitting = 1000.F;
  const ClipGenerator clips(recipe, {}, paper_body(), 4, {5.F, 20.0});
  int down = 0, up = 0;
  for (std::uint64_t clip = 0; clip < 8; ++clip) {
    const std::vector<LabelledFrame> frames = frames_of(clips, clip);
    ASSERT_EQ(frames.front().joints.size(), 1U);
    EXPECT_LT(longest_step(frames), 0.25F) << "5 m/s";
    const std::string first = frames.front().postures.at(0), last = frames.back().postures.at(0);
    down += first == "standing" && last == "sitting" ? 1 : 0;
    up += first == "sitting" && last == "standing" ? 1 : 0;
  }
  EXPECT_GE(down, 1);
  EXPECT_GE(up, 1);
  EXPECT_GE(down + up, 5) << "there is not always room before a seat";
}

TEST(ClipGenerator, RefusesTimesThatAreNone) {
  const auto make = [](float seconds, double rate_hz) {
    return [=] { small_clips(small_recipe(), {seconds, rate_hz}); };
  };
  EXPECT_THAT(make(0.F, 30.0), ThrowsMessage<UsageError>(HasSubstr("clips of 0 seconds")));
  EXPECT_THAT(make(std::nanf(""), 30.0), ThrowsMessage<UsageError>(HasSubstr("seconds")));
  EXPECT_THAT(make(3.F, -1.0), ThrowsMessage<UsageError>(HasSubstr("-1 frames a second")));
  EXPECT_THAT(make(1e6F, 30.0), ThrowsMessage<UsageError>(HasSubstr("at most 600")));
  const ClipGenerator clips = small_clips(small_recipe());
  EXPECT_THAT([&] { clips.frame(0, 60); },
              ThrowsMessage<Error>(HasSubstr("frame 60 of a clip, expected one below 60")));
  EXPECT_THAT([&] { clips.frame(0, -1); }, ThrowsMessage<Error>(HasSubstr("frame -1")));
}

}  // namespace
}  // namespace vesalius::synth

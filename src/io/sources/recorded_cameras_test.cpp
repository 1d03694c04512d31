#include "io/sources/recorded_cameras.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "io/sources/test_messages.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using test::Messages;
using test::random_frame;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;
const std::vector<double> kBrown{-0.25, 0.08, 2e-3, -1e-3, 0.0};
const std::vector<double> kRational{0.5, -2.7, 6e-4, 2e-4, 1.6, 0.38, -2.5, 1.5};

TEST(RecordedCameras, LensesOfDepthAreUndone) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 64, 48);
  const LensCamera camera{a.camera, make_lens("plumb_bob", kBrown).value()};
  Messages out(folder / "a.mcap");
  out.lens("/depth/camera_info", camera, "plumb_bob", kBrown, "depth_frame");
  out.depth("/depth/image", 0, a);
  out.colour("/rgb/image", 0, a);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(), IsEmpty());
  const Frame read = *source->next();
  const Rectification rectification(camera, a.camera);
  EXPECT_EQ(read.camera, a.camera);
  EXPECT_EQ(read.depth, rectification.depth(a.depth));
  EXPECT_EQ(read.colour, rectification.colour(a.colour)) << "it lies on the same grid";
  SourceOptions options;
  options.fx = 60.F;
  EXPECT_EQ(open_source(folder / "a.mcap", options)->next()->depth, a.depth) << "a camera of one's own has no lens";
}

TEST(RecordedCameras, RectifiedTopicsStayAsTheyAre) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 64, 48);
  Messages out(folder / "a.mcap");
  out.lens("/depth/camera_info", {a.camera, {}}, "plumb_bob", kBrown, "depth_frame");
  out.depth("/depth/image_rect", 0, a);
  out.colour("/depth/colour_rect", 0, a);
  out.close();
  const Frame read = *open_source(folder / "a.mcap")->next();
  EXPECT_EQ(read.depth, a.depth);
  EXPECT_EQ(read.colour, a.colour);
}

TEST(RecordedCameras, LensesThatAreNotKnownAreNoted) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 64, 48);
  Messages out(folder / "a.mcap");
  out.lens("/depth/camera_info", {a.camera, {}}, "ftheta", {0.1, 0.2}, "depth_frame");
  out.depth("/depth/image", 0, a);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("its model \"ftheta\" is not known")));
  EXPECT_EQ(source->next()->depth, a.depth);
}

/// Two cameras on a rig, as drivers describe it: each optical frame stands in its camera's, and that on the rig.
struct Rig {
  Frame depth = random_frame("a", 1, 64, 48, false);
  Frame colour = random_frame("b", 2, 96, 54);
  LensCamera depth_lens{depth.camera, make_lens("plumb_bob", kBrown).value()};
  LensCamera colour_lens{colour.camera, make_lens("rational_polynomial", kRational).value()};
  Isometry3d rig_from_depth = Translation3d(0.0, 0.02, 0.0) * AngleAxisd(0.02, Vector3d::UnitY());
  Isometry3d rig_from_colour = Translation3d(0.0, -0.03, 0.01) * AngleAxisd(-0.03, Vector3d::UnitX());
  Isometry3d optical = Isometry3d(AngleAxisd(-1.5707963267948966, Vector3d::UnitZ()) *
                                  AngleAxisd(-1.5707963267948966, Vector3d::UnitX()));

  void write(Messages& out, bool connected = true) const {
    out.transform("rig", "depth", rig_from_depth);
    out.transform("depth", "depth_optical", optical);
    out.transform(connected ? "rig" : "elsewhere", "colour", rig_from_colour);
    out.transform("colour", "colour_optical", optical);
    out.lens("/depth/camera_info", depth_lens, "plumb_bob", kBrown, "depth_optical");
    out.lens("/colour/camera_info", colour_lens, "rational_polynomial", kRational, "colour_optical");
    out.colour("/colour/image", 0, colour, "colour_optical");
    out.depth("/depth/image", 0, depth, "depth_optical");
  }
};

TEST(RecordedCameras, ColourOfAnotherCameraIsPutOnTheGridOfDepth) {
  const test::TemporaryFolder folder;
  const Rig rig;
  Messages out(folder / "a.mcap");
  rig.write(out);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(), IsEmpty());
  const Frame read = *source->next();
  EXPECT_EQ(read.depth, Rectification(rig.depth_lens, rig.depth.camera).depth(rig.depth.depth));
  const Isometry3d colour_from_depth = (rig.rig_from_colour * rig.optical).inverse() * rig.rig_from_depth * rig.optical;
  const ColourImage should =
      ColourRegistration(rig.depth.camera, rig.colour_lens, colour_from_depth)(read.depth, rig.colour.colour);
  ASSERT_TRUE(read.colour.same_size(should));
  // The transform came through quaternions, so that a place may be another 256th of a pixel.
  int differ = 0;
  for (std::size_t i = 0; i < should.size(); ++i) {
    const bool same = std::abs(read.colour[i].r - should[i].r) <= 2 && std::abs(read.colour[i].g - should[i].g) <= 2 &&
                      std::abs(read.colour[i].b - should[i].b) <= 2;
    differ += same ? 0 : 1;
  }
  EXPECT_LE(differ, 2);
  EXPECT_GT(std::ranges::count_if(should, [](const Rgb& c) { return c != Rgb{}; }), 500);
}

TEST(RecordedCameras, WithoutATransformThereIsNoColour) {
  const test::TemporaryFolder folder;
  Messages out(folder / "a.mcap");
  Rig().write(out, false);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(),
              ElementsAre(HasSubstr("no colour, since /colour/image is not registered to /depth/image")));
  EXPECT_TRUE(source->next()->colour.empty());
  SourceOptions options;
  options.colour_topic = "/colour/image";
  EXPECT_THAT(test::error_of([&] { open_source(folder / "a.mcap", options); }),
              HasSubstr("/colour/image has 96x54 pixels, /depth/image 64x48"));
}

TEST(RecordedCameras, UpIsTheMeanAccelerationInTheOpticalFrame) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  // The sensor's x is the camera's -y.
  out.transform("depth_frame", "imu_frame", Isometry3d(AngleAxisd(-1.5707963267948966, Vector3d::UnitZ())));
  out.camera("/depth/camera_info", a.camera);
  out.acceleration("/imu", 1000 * kMs, {9.6, 0.5, 0.0}, "imu_frame");
  out.acceleration("/imu", 1005 * kMs, {10.0, -0.5, 0.0}, "imu_frame");
  out.depth("/depth/image", 1020 * kMs, a);
  out.acceleration("/imu", 2000 * kMs, {14.0, 0.0, 0.0}, "imu_frame");
  out.depth("/depth/image", 2020 * kMs, a);  // the camera is shaken
  out.depth("/depth/image", 2990 * kMs, a);  // nothing was measured for half a second
  out.close();
  const auto source = open_source(folder / "a.mcap");
  const std::optional<Eigen::Vector3f> up = source->next()->up;
  ASSERT_TRUE(up);
  EXPECT_LT((*up - Eigen::Vector3f(0.F, -1.F, 0.F)).norm(), 1e-6F);
  EXPECT_FALSE(source->next()->up);
  EXPECT_FALSE(source->next()->up);
}

/// Written by rosbags (tests/recordings/other_side.py --fixtures): colour 5 cm to the right, the imu a quarter turn
/// about z.
TEST(RecordedCameras, OfABagOfOthersGoTogether) {
  const auto source = open_source(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_recording/rig.bag");
  EXPECT_THAT(source->notes(), IsEmpty());
  const Camera camera{16, 12, 14.5F, 15.F, 7.5F, 5.5F};
  DepthImage depth(16, 12);
  ColourImage colour(16, 12);
  for (int v = 0; v < 12; ++v) {
    for (int u = 0; u < 16; ++u) {
      depth(u, v) = static_cast<std::uint16_t>(u == v ? 0 : 1000 + 10 * v + u);
      colour(u, v) = {static_cast<std::uint8_t>(10 * u), static_cast<std::uint8_t>(20 * v), 7};
    }
  }
  depth = Rectification({camera, make_lens("plumb_bob", {-0.1, 0.01}).value()}, camera).depth(depth);
  const LensCamera seen{camera, make_lens("rational_polynomial", {0.1}).value()};
  const Frame read = *source->next();
  EXPECT_EQ(read.depth, depth);
  EXPECT_EQ(read.colour, ColourRegistration(camera, seen, Isometry3d(Translation3d(-0.05, 0, 0)))(depth, colour));
  EXPECT_LT((read.up.value() - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6F);
}

TEST(RecordedCameras, UpIsTheSameAfterASeek) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  for (int i = 0; i < 300; ++i) {
    out.acceleration("/imu", (10 * i + 1) * kMs, {0.3 * std::sin(i), -9.8, 0.001 * i}, "depth_frame");
    if (i % 10 == 0) out.depth("/depth/image", (10 * i + 2) * kMs, a);
  }
  out.close();
  const auto source = open_source(folder / "a.mcap");
  std::vector<Frame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  ASSERT_EQ(frames.size(), 30U);
  for (const std::size_t i : {29U, 12U, 0U}) {
    source->seek(*frames[i].time_s);
    EXPECT_EQ(source->next()->up, frames[i].up) << i;
  }
}

TEST(RecordedCameras, UpOfASensorThatNothingConnectsIsNotTaken) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  out.acceleration("/imu", 0, {0.0, -9.8, 0.0}, "elsewhere");
  out.depth("/depth/image", 0, a);
  out.close();
  EXPECT_FALSE(open_source(folder / "a.mcap")->next()->up);
}

}  // namespace
}  // namespace vesalius

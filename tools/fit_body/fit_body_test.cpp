#include "fit_body.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "capsule/capsule_person.h"
#include "commands/synth/frame_maker.h"
#include "commands/synth/synth_recipe.h"
#include "vesalius/error.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

class FitBody : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string refusal(const FitTask& fit) {
    try {
      fit_body(fit);
    } catch (const Error& e) {
      return e.what();
    }
    return "nothing";
  }

  /// Renders a clip of two people with built-in bodies.
  std::string clip() const {
    const synth::Recipe recipe = cli::make_recipe({.change = [](synth::Recipe& asked) {
      asked.sensor.width = 160;
      asked.sensor.height = 120;
      asked.body.kind = "builtin";
      asked.body.count = 2;
      asked.pose.captured = 0.F;
      asked.people.none = asked.people.one = asked.people.three = asked.people.four = 0.F;
      asked.people.two = 1.F;
    }});
    const cli::LoadedAssets loaded = cli::load_assets(recipe, {.folder = {}, .motions = {}, .movements = true});
    const cli::FrameMaker maker = cli::make_frame_maker(recipe, loaded.assets, paper_body(), 3, {5.F, {}});
    DatasetInfo info = cli::rendered_info(recipe, loaded, paper_body(), 3, maker.frames_in(1));
    info.clips = maker.clips;
    cli::write_dataset(path("clip"), maker, info, false);
    return path("clip");
  }

  const fs::path folder_ = fs::temp_directory_path() / ("vesalius_fit_body_" + std::to_string(::getpid()));
  const std::string small_ = VESALIUS_SOURCE_DIR "/data/models/small.forest";
  const std::string capsule_ = VESALIUS_SOURCE_DIR "/data/models/capsule.forest";
};

TEST_F(FitBody, FitsTheTrustToTheJointsOfClips) {
  const std::string recording = clip();
  const FittedBodyFile fitted = fit_body({.what = "trust", .sources = {recording}, .models = {small_}});
  EXPECT_THAT(fitted.told,
              ContainsRegex("trust in observed joints: [1-9][0-9]* of [1-9][0-9]* right; confidence and share"));
  const BodyTrust trust = parse_body_trust(fitted.toml, "trust.toml");
  EXPECT_NE(trust.observed.bias, builtin_trust().observed.bias);
  EXPECT_NEAR(trust.hidden.bias, builtin_trust().hidden.bias, 1e-3F) << "nobody is hidden unless asked for";
  EXPECT_THAT(refusal({.what = "stances", .sources = {recording}, .models = {small_}}),
              HasSubstr("fitting the stances: "));
}

TEST_F(FitBody, FitsTheJointSetOfTheTruth) {
  const Camera camera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};
  CapsuleScene scene;
  scene.people.emplace_back();
  const Frame frame = render(scene, camera, paper_body()).frame;
  fs::create_directories(folder_ / "frames/depth");
  std::ofstream(folder_ / "frames/meta.json")
      << R"({"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5, "width": 320, "height": 240})";
  std::ofstream(folder_ / "frames/frames.csv") << "frame,people\na,1\n";
  std::ofstream(folder_ / "frames/joints.csv") << "frame,joint,x_m,y_m,z_m\na,head,0,-0.6,2.5\na,l_knee,0.1,0.5,2.5\n";
  write_png(frame.depth, path("frames/depth/a.png"));
  const FittedBodyFile fitted = fit_body({.what = "joints", .sources = {path("frames")}, .models = {capsule_}});
  EXPECT_THAT(fitted.toml, StartsWith("[[joint_set]]\nname = \"nite15\"\n"));
  EXPECT_EQ(fitted.told, "joints fitted to 1 people\n");
  const FitTask by_two{.what = "joints", .sources = {path("frames")}, .models = {capsule_, capsule_}};
  EXPECT_EQ(fit_body(by_two).told, "joints fitted to 2 people\n");
  EXPECT_THAT(refusal({.what = "trust", .sources = {path("frames")}, .models = {capsule_, capsule_}}),
              HasSubstr("trust: 2 models, expected one"));
  EXPECT_THAT(refusal({.what = "trust", .sources = {path("frames")}, .models = {capsule_}}),
              HasSubstr("fitting the trust: expected fitted bodies"));
}

}  // namespace
}  // namespace vesalius

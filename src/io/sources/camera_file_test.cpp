#include "io/sources/camera_file.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/lens/lens.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ParseMeta, ReadsAllKeys) {
  const CameraFacts facts = parse_meta(
      R"json({"fx": 525, "fy": 526.5, "cx": 319.5, "cy": 239, "width": 640, "height": 480, "units": "mm (checked)",
          "sensor": "Kinect v1", "licence": ["any", {"thing": 1}]})json",
      "meta.json");
  EXPECT_EQ(facts.fx, 525.F);
  EXPECT_EQ(facts.fy, 526.5F);
  EXPECT_EQ(facts.cx, 319.5F);
  EXPECT_EQ(facts.cy, 239.F);
  EXPECT_EQ(facts.width, 640);
  EXPECT_EQ(facts.height, 480);
  EXPECT_EQ(facts.depth_scale, 1000.F);
  EXPECT_EQ(facts.sensor, "Kinect v1");
}

TEST(ParseMeta, LeavesMissingKeysUnknown) {
  const CameraFacts facts = parse_meta("{}", "meta.json");
  EXPECT_FALSE(facts.fx || facts.fy || facts.cx || facts.cy || facts.width || facts.height || facts.depth_scale);
}

TEST(ParseMeta, ReadsUnitsAndScale) {
  EXPECT_EQ(parse_meta(R"({"units": "m"})", "m").depth_scale, 1.F);
  EXPECT_EQ(parse_meta(R"({"units": "cm"})", "m").depth_scale, 100.F);
  EXPECT_EQ(parse_meta(R"({"units": "mm", "depth_scale": 5000})", "m").depth_scale, 5000.F);
}

TEST(ParseMeta, NamesTheFileAndTheKeyOfErrors) {
  const auto message = [](const char* text) { return error_of([&] { parse_meta(text, "meta.json"); }); };
  EXPECT_THAT(message("{\"fx\": "), HasSubstr("meta.json: not JSON"));
  EXPECT_THAT(message("[1]"), HasSubstr("meta.json: expected a JSON object"));
  EXPECT_THAT(message(R"({"fx": "525"})"), HasSubstr("meta.json: \"fx\": expected a number"));
  EXPECT_THAT(message(R"({"fx": -1})"), HasSubstr("\"fx\": expected a positive"));
  EXPECT_THAT(message(R"({"cy": 1e300})"), HasSubstr("\"cy\""));
  EXPECT_THAT(message(R"({"fx": 1e999})"), HasSubstr("meta.json"));
  EXPECT_THAT(message(R"({"width": 1.5})"), HasSubstr("\"width\""));
  EXPECT_THAT(message(R"({"units": "feet"})"), HasSubstr("\"units\": expected \"mm\""));
  EXPECT_THAT(message(R"({"units": 7})"), HasSubstr("\"units\""));
  EXPECT_THAT(message(R"({"depth_scale": 0})"), HasSubstr("\"depth_scale\""));
  EXPECT_THAT(message(R"({"rate_hz": 0})"), HasSubstr("\"rate_hz\": expected frames a second"));
}

TEST(ParseMeta, ReadsTheRate) {
  EXPECT_EQ(parse_meta(R"({"rate_hz": 29.97})", "m").rate_hz, 29.97);
  EXPECT_FALSE(parse_meta("{}", "m").rate_hz);
}

TEST(SerialiseMeta, IsReadBackExactly) {
  const Camera camera{320, 240, 285.63F, 1.F / 3.F * 900.F, 159.000015F, 119.7F};
  const CameraFacts facts = parse_meta(serialise_meta(camera, 5000.F), "meta.json");
  std::vector<std::string> notes;
  EXPECT_EQ(resolve_camera(facts, 320, 240, false, "here", notes), camera);
  EXPECT_EQ(facts.depth_scale, 5000.F);
  EXPECT_THAT(notes, IsEmpty());
}

constexpr const char* kCalibration = R"(image_width: 640
image_height: 480
camera_name: depth
camera_matrix:
  rows: 3
  cols: 3
  data: [570.5, 0, 314.5, 0, 571.5, 235.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [DISTORTION, 0, 0, 0, 0]
projection_matrix:
  rows: 3
  cols: 4
  data: [560.0, 0, 310.0, 0, 0, 561.0, 230.0, 0, 0, 0, 1, 0]
)";

std::string calibration(const std::string& distortion) {
  std::string text = kCalibration;
  return text.replace(text.find("DISTORTION"), 10, distortion);
}

TEST(ParseCameraInfo, ReadsCalibrationFiles) {
  const CameraFacts facts = parse_camera_info(calibration("0.0"), "camera_info.yaml");
  EXPECT_EQ(facts.fx, 570.5F);
  EXPECT_EQ(facts.fy, 571.5F);
  EXPECT_EQ(facts.cx, 314.5F);
  EXPECT_EQ(facts.cy, 235.5F);
  EXPECT_EQ(facts.width, 640);
  EXPECT_EQ(facts.height, 480);
  EXPECT_FALSE(facts.distorted);
  EXPECT_TRUE(facts.odd_lens.empty());
}

TEST(ParseCameraInfo, TakesTheRectifiedCameraOfADistortedLens) {
  const CameraFacts facts = parse_camera_info(calibration("-0.2"), "camera_info.yaml");
  EXPECT_EQ(facts.fx, 560.F);
  EXPECT_EQ(facts.fy, 561.F);
  EXPECT_EQ(facts.cx, 310.F);
  EXPECT_EQ(facts.cy, 230.F);
  ASSERT_TRUE(facts.distorted);
  EXPECT_EQ(facts.distorted->camera, (Camera{640, 480, 570.5F, 571.5F, 314.5F, 235.5F}));
  EXPECT_EQ(facts.distorted->lens, make_lens("plumb_bob", {-0.2}));
}

TEST(ParseCameraInfo, SaysWhichDistortionItDoesNotKnow) {
  std::string text = calibration("-0.2");
  text.replace(text.find("plumb_bob"), 9, "ftheta");
  const CameraFacts facts = parse_camera_info(text, "camera_info.yaml");
  EXPECT_FALSE(facts.distorted);
  EXPECT_EQ(facts.fx, 570.5F);
  std::vector<std::string> notes;
  resolve_camera(facts, 640, 480, true, "here", notes);
  EXPECT_THAT(notes,
              ElementsAre(HasSubstr("camera_info.yaml: lens distortion not removed, since its model \"ftheta\"")));
}

TEST(CameraFile, UndoesTheLensOfAFolderOfPictures) {
  const TemporaryFolder folder;
  const Frame frame = test::random_frame("a", 1, 64, 48);
  std::filesystem::create_directories(folder / "depth");
  std::filesystem::create_directories(folder / "rgb");
  write_png(frame.depth, folder / "depth/a.png");
  write_png(frame.colour, folder / "rgb/a.png");
  put(folder / "camera_info.yaml",
      "K: [60, 0, 31, 0, 61, 24, 0, 0, 1]\nD: [-0.3, 0.1, 0, 0, 0]\ndistortion_model: plumb_bob\n"
      "P: [55, 0, 32, 0, 0, 56, 23, 0, 0, 0, 1, 0]\n");
  const Camera to{64, 48, 55.F, 56.F, 32.F, 23.F};
  const Rectification rectification(
      {Camera{64, 48, 60.F, 61.F, 31.F, 24.F}, make_lens("plumb_bob", {-0.3, 0.1}).value()}, to);
  const auto source = open_source(folder.path());
  EXPECT_THAT(source->notes(), IsEmpty());
  const Frame read = *source->next();
  EXPECT_EQ(read.camera, to);
  EXPECT_EQ(read.depth, rectification.depth(frame.depth));
  EXPECT_EQ(read.colour, rectification.colour(frame.colour));
}

TEST(ParseCameraInfo, ReadsPrintedMessages) {
  const CameraFacts facts = parse_camera_info(
      "header: \n  seq: 1\nheight: 480\nwidth: 640\nD: [0.0, 0.0]\nK: [525.0, 0, 319.5, 0, 525.0, 239.5, 0, 0, "
      "1]\n---\n",
      "camera_info.yaml");
  EXPECT_EQ(facts.fx, 525.F);
  EXPECT_EQ(facts.cy, 239.5F);
}

TEST(ParseCameraInfo, NamesTheFileAndTheKeyOfErrors) {
  const auto message = [](const std::string& text) { return error_of([&] { parse_camera_info(text, "c.yaml"); }); };
  EXPECT_THAT(message(""), HasSubstr("c.yaml: expected a map"));
  EXPECT_THAT(message("a: ["), HasSubstr("c.yaml: not the YAML"));
  EXPECT_THAT(message("a: 1"), HasSubstr("\"camera_matrix\""));
  EXPECT_THAT(message("K: [1, 2]"), HasSubstr("a list of 9 numbers"));
  EXPECT_THAT(message("K: [a, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr("c.yaml: not the YAML"));
  EXPECT_THAT(message("K: [.nan, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr("positive number"));
  EXPECT_THAT(message("K: 5"), HasSubstr("a list of 9 numbers"));
  EXPECT_THAT(message(std::string(100000, '[')), HasSubstr("c.yaml"));
}

TEST(ResolveCamera, DefaultsToSquarePixelsAndTheCentre) {
  CameraFacts facts;
  facts.fx = 100.F;
  std::vector<std::string> notes;
  EXPECT_EQ(resolve_camera(facts, 64, 48, false, "here", notes), (Camera{64, 48, 100.F, 100.F, 31.5F, 23.5F}));
}

TEST(ResolveCamera, KnowsTheUsualFocalLengthsOfSensors) {
  const auto focal = [](const char* sensor, int width, int height, bool registered) {
    CameraFacts facts;
    facts.sensor = sensor;
    std::vector<std::string> notes;
    const float fx = resolve_camera(facts, width, height, registered, "here", notes).fx;
    EXPECT_THAT(notes, ElementsAre(HasSubstr(sensor)));
    return fx;
  };
  EXPECT_EQ(focal("Kinect v1/Xtion (OpenNI)", 640, 480, true), 525.F);
  EXPECT_EQ(focal("Asus Xtion", 320, 240, false), 262.5F);
  EXPECT_EQ(focal("Kinect v2", 512, 424, false), 365.F);
  EXPECT_EQ(focal("Azure Kinect", 320, 288, false), 252.F);
  EXPECT_EQ(focal("RealSense", 640, 480, true), 615.F);
  EXPECT_EQ(focal("Intel RealSense D435", 640, 480, false), 385.F);
}

TEST(ResolveCamera, RefusesUnknownFocalLengthsAndOtherSizes) {
  std::vector<std::string> notes;
  CameraFacts facts;
  EXPECT_THAT(error_of([&] { resolve_camera(facts, 640, 480, true, "DIR", notes); }),
              HasSubstr("DIR: no intrinsics: expected fx, fy, cx, cy in meta.json, a camera_info.yaml, or --fx"));
  facts.sensor = "Kinect v2";
  EXPECT_THAT(error_of([&] { resolve_camera(facts, 1920, 1080, true, "DIR", notes); }), HasSubstr("no intrinsics"));
  facts.fx = 500.F;
  facts.width = 320;
  facts.origin = "meta.json";
  EXPECT_THAT(error_of([&] { resolve_camera(facts, 640, 480, true, "DIR", notes); }),
              HasSubstr("meta.json: camera of 320x480 pictures, but DIR has 640x480"));
}

TEST(FindCameraFacts, PrefersOptionsToFilesAndNearFoldersToFarOnes) {
  const TemporaryFolder folder;
  put(folder / "near/camera_info.yaml", "K: [500, 0, 50, 0, 501, 40, 0, 0, 1]");
  put(folder / "near/meta.json", R"({"sensor": "Xtion", "units": "cm"})");
  put(folder / "far/meta.json", R"({"fx": 1, "cx": 2})");
  SourceOptions options;
  options.cx = 60.F;
  const CameraFacts facts = find_camera_facts(options, {folder / "near", folder / "far"});
  EXPECT_EQ(facts.fx, 500.F);
  EXPECT_EQ(facts.fy, 501.F);
  EXPECT_EQ(facts.cx, 60.F);
  EXPECT_EQ(facts.cy, 40.F);
  EXPECT_EQ(facts.depth_scale, 100.F);
  EXPECT_EQ(facts.sensor, "Xtion");
}

TEST(FindCameraFacts, TakesALoneFocalLengthForSquarePixels) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"fx": 500, "fy": 400})");
  SourceOptions options;
  options.fx = 300.F;
  EXPECT_FALSE(find_camera_facts(options, {folder.path()}).fy);
}

TEST(FindCameraFacts, TakesTheCameraFileInsteadOfThoseInFolders) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"fx": 500, "cx": 1})");
  SourceOptions options;
  options.camera_file = put(folder / "other.json", R"({"fx": 300})");
  const CameraFacts facts = find_camera_facts(options, {folder.path()});
  EXPECT_EQ(facts.fx, 300.F);
  EXPECT_FALSE(facts.cx);
  options.camera_file = folder / "none.yaml";
  EXPECT_THAT(error_of([&] { find_camera_facts(options, {}); }), HasSubstr("none.yaml: cannot be read"));
}

TEST(FindCameraFacts, RefusesBadOptions) {
  SourceOptions options;
  options.fx = -3.F;
  EXPECT_THAT(error_of([&] { find_camera_facts(options, {}); }), HasSubstr("options: \"fx\""));
  EXPECT_THROW(find_camera_facts(options, {}), UsageError) << "no file is at fault";
}

}  // namespace
}  // namespace vesalius

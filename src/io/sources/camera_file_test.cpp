#include "io/sources/camera_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/lens/lens.h"
#include "io/recordings/test_k4a.h"
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

TEST(ParseCamera, ReadsAllKeys) {
  const CameraFacts facts = parse_camera(
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

TEST(ParseCamera, LeavesMissingKeysUnknown) {
  const CameraFacts facts = parse_camera("{}", "meta.json");
  EXPECT_FALSE(facts.fx || facts.fy || facts.cx || facts.cy || facts.width || facts.height || facts.depth_scale);
}

TEST(ParseCamera, ReadsUnitsAndScale) {
  EXPECT_EQ(parse_camera(R"({"units": "m"})", "m").depth_scale, 1.F);
  EXPECT_EQ(parse_camera(R"({"units": "cm"})", "m").depth_scale, 100.F);
  EXPECT_EQ(parse_camera(R"({"units": "mm", "depth_scale": 5000})", "m").depth_scale, 5000.F);
  EXPECT_EQ(parse_camera(R"({"depth_scale": 0.0002})", "m").depth_scale, 5000.F) << "librealsense: metres a unit";
  EXPECT_EQ(parse_camera(R"({"fx": 9, "depth_scale": 0.1})", "m").depth_scale, 10000.F) << "BOP: millimetres a unit";
  EXPECT_EQ(parse_camera(R"({"fx": 9, "depth_scale": 1.0})", "m").depth_scale, 1000.F);
  EXPECT_EQ(parse_camera("DepthMapFactor: 5208.0\n", "m").depth_scale, 5208.F);
  EXPECT_EQ(parse_camera(R"({"camera": {"fx": 600, "scale": 6553.5}})", "m").depth_scale, 6553.5F);
}

TEST(ParseCamera, NamesTheFileAndTheKeyOfErrors) {
  const auto message = [](const char* text) { return error_of([&] { parse_camera(text, "meta.json"); }); };
  EXPECT_THAT(message("{\"fx\": "), HasSubstr("meta.json: not JSON"));
  EXPECT_THAT(message(""), HasSubstr("meta.json: no names with values, expected JSON"));
  EXPECT_THAT(message(R"({"fx": "wide"})"), HasSubstr("meta.json: \"fx\": expected a number"));
  EXPECT_THAT(message(R"({"fx": -1})"), HasSubstr("\"fx\": expected a positive"));
  EXPECT_THAT(message(R"({"fx": 0, "fy": 0})"), HasSubstr("\"fx\": expected a positive"));
  EXPECT_THAT(message(R"({"depth": {"K": [0, 0, 0, 0, 0, 0, 0, 0, 0]}})"), HasSubstr("\"K\": expected a positive"));
  EXPECT_THAT(message(R"({"cy": 1e300})"), HasSubstr("\"cy\""));
  EXPECT_THAT(message(R"({"fx": 1e999})"), HasSubstr("meta.json"));
  EXPECT_THAT(message(R"({"width": 1.5})"), HasSubstr("\"width\""));
  EXPECT_THAT(message(R"({"units": "feet"})"), HasSubstr("\"units\": expected \"mm\""));
  EXPECT_THAT(message(R"({"units": 7})"), HasSubstr("\"units\""));
  EXPECT_THAT(message(R"({"depth_scale": 0})"), HasSubstr("\"depth_scale\""));
  EXPECT_THAT(message(R"({"rate_hz": 0})"), HasSubstr("\"rate_hz\": expected frames a second"));
}

TEST(ParseCamera, ReadsTheRate) {
  EXPECT_EQ(parse_camera(R"({"rate_hz": 29.97})", "m").rate_hz, 29.97);
  EXPECT_FALSE(parse_camera("{}", "m").rate_hz);
}

TEST(SerialiseMeta, IsReadBackExactly) {
  const Camera camera{320, 240, 285.63F, 1.F / 3.F * 900.F, 159.000015F, 119.7F};
  CameraFacts facts = parse_camera(serialise_meta(camera, 5000.F), "meta.json");
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

TEST(ParseCamera, ReadsCalibrationFiles) {
  const CameraFacts facts = parse_camera(calibration("0.0"), "camera_info.yaml");
  EXPECT_EQ(facts.fx, 570.5F);
  EXPECT_EQ(facts.fy, 571.5F);
  EXPECT_EQ(facts.cx, 314.5F);
  EXPECT_EQ(facts.cy, 235.5F);
  EXPECT_EQ(facts.width, 640);
  EXPECT_EQ(facts.height, 480);
  EXPECT_FALSE(facts.distorted);
  EXPECT_TRUE(facts.odd_lens.empty());
}

TEST(ParseCamera, TakesTheRectifiedCameraOfADistortedLens) {
  const CameraFacts facts = parse_camera(calibration("-0.2"), "camera_info.yaml");
  EXPECT_EQ(facts.fx, 560.F);
  EXPECT_EQ(facts.fy, 561.F);
  EXPECT_EQ(facts.cx, 310.F);
  EXPECT_EQ(facts.cy, 230.F);
  ASSERT_TRUE(facts.distorted);
  EXPECT_EQ(facts.distorted->camera, (Camera{640, 480, 570.5F, 571.5F, 314.5F, 235.5F}));
  EXPECT_EQ(facts.distorted->lens, make_lens("plumb_bob", {-0.2}));
}

TEST(ParseCamera, SaysWhichDistortionItDoesNotKnow) {
  std::string text = calibration("-0.2");
  text.replace(text.find("plumb_bob"), 9, "ftheta");
  CameraFacts facts = parse_camera(text, "camera_info.yaml");
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

TEST(ParseCamera, ReadsPrintedMessages) {
  const CameraFacts facts = parse_camera(
      "header: \n  seq: 1\nheight: 480\nwidth: 640\nD: [0.0, 0.0]\nK: [525.0, 0, 319.5, 0, 525.0, 239.5, 0, 0, "
      "1]\n---\n",
      "camera_info.yaml");
  EXPECT_EQ(facts.fx, 525.F);
  EXPECT_EQ(facts.cy, 239.5F);
}

TEST(ParseCamera, NamesWhatIsWrongInYaml) {
  const auto message = [](const std::string& text) { return error_of([&] { parse_camera(text, "c.yaml"); }); };
  EXPECT_THAT(message("K: [1, 2]"), HasSubstr("c.yaml: \"K\": expected 3x3 numbers"));
  EXPECT_THAT(message("K: [a, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr("\"K\": expected 3x3 numbers"));
  EXPECT_THAT(message("K: [nan, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr("positive number"));
  EXPECT_THAT(message("K: 5"), HasSubstr("\"K\": expected 3x3 numbers"));
  EXPECT_THAT(message("fx: 9\nD: [a, b]"), HasSubstr("\"D\": expected a list of numbers"));
  EXPECT_THAT(message(std::string(100000, '[')), HasSubstr("c.yaml"));
  parse_camera("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", "deep.json");
  for (const char* text : {"<", "</a>", "<a", "<a><b></a>", "<a/>"}) error_of([&] { parse_camera(text, "c.xml"); });
  std::string aliases = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1) + ", ";
    aliases += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last + last + last + last + last + "1]\n";
  }
  parse_camera(aliases, "aliases.yaml");
}

struct Spelling {
  const char* tool;
  const char* text;
};

/// One camera as tools write it: fx 262.5, fy 263.5, cx 150, cy 110 for 320x240.
const std::vector<Spelling>& spellings() {
  static const std::vector<Spelling> all{
      {"librealsense", R"({"width": 320, "height": 240, "ppx": 150.0, "ppy": 110.0, "fx": 262.5, "fy": 263.5,
          "model": "distortion.brown_conrady", "coeffs": [0, 0, 0, 0, 0]})"},
      {"librealsense, printed", "[ 320x240  p[150 110]  f[262.5 263.5]  Brown Conrady [0 0 0 0 0] ]"},
      {"librealsense, printed before",
       "width: 320, height: 240, ppx: 150, ppy: 110, fx: 262.5, fy: 263.5, model: None, "
       "coeffs: [0, 0, 0, 0, 0]"},
      {"rs-enumerate-devices",
       "Device info:\n\tName : D435\n Intrinsic of \"Color\" / 640x480 / {RGB8}\n  Width: \t640\n"
       "  Height: \t480\n  PPX:\t1\n  PPY:\t2\n  Fx:\t600\n  Fy:\t600\n\n Intrinsic of \"Depth\" / 320x240 / {Z16}\n"
       "  Width: \t320\n  Height: \t240\n  PPX: \t150\n  PPY: \t110\n  Fx: \t262.5\n  Fy: \t263.5\n"
       "  Distortion: \tBrown Conrady\n  Coeffs: \t0 \t0 \t0 \t0 \t0\n  FOV (deg): \t62.7 x 49\n"},
      {"Open3D", R"({"width": 320, "height": 240, "intrinsic_matrix": [262.5, 0, 0, 0, 263.5, 0, 150.0, 110.0, 1]})"},
      {"Open3D, trajectory",
       R"({"class_name": "PinholeCameraParameters", "extrinsic": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],
          "intrinsic": {"width": 320, "height": 240, "intrinsic_matrix": [262.5, 0, 0, 0, 263.5, 0, 150, 110, 1]}})"},
      {"ORB-SLAM2",
       "%YAML:1.0\n\nCamera.fx: 262.5\nCamera.fy: 263.5\nCamera.cx: 150.0\nCamera.cy: 110.0\n\nCamera.k1: 0.0\n"
       "Camera.p1: 0.0\nCamera.width: 320\nCamera.height: 240\nViewer.PointSize: 2\n"},
      {"ORB-SLAM3",
       "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 262.5\nCamera1.fy: 263.5\n"
       "Camera1.cx: 150.0\nCamera1.cy: 110.0\nCamera1.k1: 0.0\nCamera.width: 320\nCamera.height: 240\n"},
      {"OpenCV",
       "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
       "   dt: d\n   data: [ 2.625e+02, 0., 150., 0., 2.635e+02, 110., 0., 0., 1. ]\n"
       "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n"},
      {"OpenCV, JSON",
       R"({"size": [320, 240], "cameraMatrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
          "data": [262.5, 0, 150, 0, 263.5, 110, 0, 0, 1]}})"},
      {"OpenCV, XML",
       "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- made today -->\n<image_width>320</image_width><image_height>240"
       "</image_height>\n<Camera_Matrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n "
       " <data>\n"
       "    2.625e+02 0. 150. 0. 2.635e+02 110. 0. 0. 1.</data></Camera_Matrix>\n</opencv_storage>\n"},
      {"ros2 topic echo",
       "header:\n  stamp:\n    sec: 1\n    nanosec: 2\n  frame_id: depth\nheight: 240\nwidth: 320\n"
       "distortion_model: plumb_bob\nd:\n- 0.0\n- 0.0\nk:\n- 262.5\n- 0.0\n- 150.0\n- 0.0\n- 263.5\n- 110.0\n- 0.0\n- "
       "0.0\n"
       "- 1.0\nr:\n- 1.0\np:\n- 5.0\nbinning_x: 0\nroi:\n  x_offset: 0\n  height: 0\n  width: 0\n---\n"},
      {"ROS as JSON, a mark of byte order",
       "\xEF\xBB\xBF{\"height\": 240, \"width\": 320, \"K\": [262.5, 0, 150, 0, 263.5, 110, 0, 0, 1]}"},
      {"numpy.savetxt",
       "2.625e+02 0.000e+00 1.500e+02\n0.000e+00 2.635e+02 1.100e+02\n0.000e+00 0.000e+00 1.000e+00\n"},
      {"NumPy, printed", "[[262.5   0.  150. ]\n [  0.  263.5 110. ]\n [  0.    0.    1. ]]"},
      {"4x4 of ScanNet", "262.5 0 150 0\r\n0 263.5 110 0\r\n0 0 1 0\r\n0 0 0 1\r\n"},
      {"one line of SUN RGB-D", "262.5 0 150 0 263.5 110 0 0 1\n"},
      {"four numbers", "262.5 263.5 150 110\n"},
      {"columns", "fx,fy,cx,cy\n262.5,263.5,150,110\n"},
      {"InfiniTAM",
       "640 480\n504 503\n352 272\n\n320 240\n262.5 263.5\n150 110\n\n1 0 0 0\n0 1 0 0\n0 0 1 0\n\n1135.09 0.08\n"},
      {"ScanNet's and BundleFusion's info.txt",
       "m_versionNumber = 4\nm_sensorName = StructureSensor\nm_colorWidth = 640\n"
       "m_colorHeight = 480\nm_depthWidth = 320\nm_depthHeight = 240\nm_depthShift = 1000\n"
       "m_calibrationColorIntrinsic = 600 0 300 0 0 600 200 0 0 0 1 0 0 0 0 1\n"
       "m_calibrationColorExtrinsic = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
       "m_calibrationDepthIntrinsic = 262.5 0 150 0 0 263.5 110 0 0 0 1 0 0 0 0 1\n"},
      {"NYU's camera_params.m",
       "% depth\nfx_rgb = 5.1885790117450188e+02;\nfx_d = 2.625e+02;\nfy_d = 2.635e+02;\ncx_d = 1.5e+02;\n"
       "cy_d = 1.1e+02;\nk1_d = 0;\n"},
      {"Orbbec's, nested",
       R"({"rgbIntrinsic": {"fx": 600, "fy": 600, "cx": 300, "cy": 200, "width": 640, "height": 480},
          "depthIntrinsic": {"fx": 262.5, "fy": 263.5, "cx": 150, "cy": 110, "width": 320, "height": 240},
          "depthDistortion": {"k1": 0, "k2": 0, "p1": 0, "p2": 0, "k3": 0}})"},
      {"Orbbec's, INI",
       "[ColorIntrinsic]\nfx=600\nfy=600\n[DepthIntrinsic]\nfx=262.5\nfy=263.5\ncx=150\ncy=110\nwidth=320\n"
       "height=240\n"},
      {"TOML",
       "width = 320\nheight = 240\n[color]\nfx = 600.0\n[depth]\nK = [[262.5, 0.0, 150.0], [0.0, 263.5, 110.0], [0.0, "
       "0.0, 1.0]]\n"},
      {"cameras by name", R"({"cameras": [{"name": "color", "K": [600, 0, 300, 0, 600, 200, 0, 0, 1]},
          {"name": "depth", "K": [262.5, 0, 150, 0, 263.5, 110, 0, 0, 1], "resolution": "320x240"}]})"},
      {"Kinect v2's",
       R"({"FocalLengthX": "262.5", "FocalLengthY": "263.5", "PrincipalPointX": "150", "PrincipalPointY": "110",
          "RadialDistortionSecondOrder": "0.09"})"},
      {"Kalibr",
       "cam0:\n  camera_model: pinhole\n  intrinsics: [262.5, 263.5, 150, 110]\n  distortion_coeffs: [0, 0, 0, 0]\n"
       "  distortion_model: radtan\n  resolution: [320, 240]\n  T_cam_imu:\n  - [1, 0, 0, 0]\n"},
      {"BOP", R"({"0": {"cam_K": [262.5, 0, 150, 0, 263.5, 110, 0, 0, 1], "depth_scale": 1.0}})"},
      {"NeRF", R"({"camera_angle_x": 0.69, "fl_x": 262.5, "fl_y": 263.5, "cx": 150, "cy": 110, "w": 320, "h": 240,
          "frames": [{"transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]})"},
      {"a dictionary of Python", "{'fx': 262.5, 'fy': 263.5, 'cx': 150.0, 'cy': 110.0, 'width': 320, 'height': 240}"},
      {"pairs",
       R"({"focal_length": [262.5, 263.5], "principal_point": [150, 110], "image_size": {"width": 320, "height": 240}})"},
      {"upper case", R"({"INTRINSICS": {"FX": 262.5, "FY": 263.5, "CX": 150, "CY": 110}})"}};
  return all;
}

TEST(ParseCamera, KnowsTheNamesThatToolsGive) {
  for (const auto& [tool, text] : spellings()) {
    CameraFacts facts = parse_camera(text, tool);
    std::vector<std::string> notes;
    EXPECT_EQ(resolve_camera(facts, 320, 240, false, tool, notes), (Camera{320, 240, 262.5F, 263.5F, 150.F, 110.F}))
        << tool;
    EXPECT_THAT(notes, IsEmpty()) << tool;
    EXPECT_FALSE(facts.distorted) << tool;
  }
}

TEST(ParseCamera, ReadsUtf16) {
  std::string text = "\xFF\xFE";
  for (const char c : std::string("fx: 262.5\r\nfy: 263.5\r\n")) text += {c, '\0'};
  EXPECT_EQ(parse_camera(text, "powershell.yaml").fy, 263.5F);
}

TEST(ParseCamera, TakesLensesFromSingleNumbersAndObjects) {
  const Lens lens = make_lens("plumb_bob", {0.1, -0.2, 0.01, 0.02, 0.3}).value();
  for (
      const char* text :
      {"Camera.fx: 262.5\nCamera.k1: 0.1\nCamera.k2: -0.2\nCamera.p1: 0.01\nCamera.p2: 0.02\nCamera.k3: 0.3\n",
       R"({"depthIntrinsic": {"fx": 262.5}, "depthDistortion": {"k1": 0.1, "k2": -0.2, "p1": 0.01, "p2": 0.02, "k3": 0.3},
            "rgbDistortion": {"k1": 9}})",
       R"({"fx": 262.5, "model": 4, "coeffs": [0.1, -0.2, 0.01, 0.02, 0.3]})"}) {
    const CameraFacts facts = parse_camera(text, "c");
    ASSERT_TRUE(facts.distorted) << text;
    EXPECT_EQ(facts.distorted->lens, lens) << text;
  }
  const CameraFacts fisheye = parse_camera(
      "Camera.type: \"KannalaBrandt8\"\nCamera1.fx: 262.5\nCamera1.k1: 0.1\nCamera1.k2: 0.2\nCamera1.k3: "
      "0.3\nCamera1.k4: 0.4\n",
      "c");
  ASSERT_TRUE(fisheye.distorted);
  EXPECT_EQ(fisheye.distorted->lens, make_lens("equidistant", {0.1, 0.2, 0.3, 0.4}));
}

TEST(ParseCamera, TakesAnAngleOfViewInDegreesWhereTheWidthIsKnown) {
  EXPECT_NEAR(parse_camera(R"({"hfov": 90, "width": 640, "height": 480})", "c").fx.value(), 320.F, 1e-3);
  EXPECT_FALSE(parse_camera(R"({"hfov": 1.5, "width": 640, "height": 480})", "c").fx) << "radians?";
  EXPECT_FALSE(parse_camera(R"({"fov": 90, "width": 640, "height": 480})", "c").fx) << "of which side?";
}

TEST(ParseCamera, ReadsColmapOstAndListsOfCameras) {
  CameraFacts facts = parse_camera("# Camera list\n1 PINHOLE 640 480 577.5 578.5 332 234\n", "cameras.txt");
  EXPECT_EQ(facts.fx, 577.5F);
  EXPECT_EQ(facts.fy, 578.5F);
  EXPECT_EQ(facts.cx, 331.5F);
  EXPECT_EQ(facts.cy, 233.5F);
  EXPECT_EQ(facts.width, 640);
  facts = parse_camera("1 SIMPLE_RADIAL 640 480 577.5 332 234 0.125\n", "cameras.txt");
  EXPECT_EQ(facts.fy, 577.5F);
  EXPECT_EQ(facts.cy, 233.5F);
  EXPECT_TRUE(facts.distorted);
  facts = parse_camera(
      "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[narrow_stereo]\n\ncamera matrix\n"
      "577.5 0 331.5\n0 578.5 233.5\n0 0 1\n\ndistortion\n0.1 0 0 0 0\n\nrectification\n1 0 0\n0 1 0\n0 0 1\n\n"
      "projection\n570 0 330 0\n0 571 230 0\n0 0 1 0\n",
      "ost.txt");
  EXPECT_EQ(facts.height, 480);
  EXPECT_EQ(facts.fy, 571.F);
  ASSERT_TRUE(facts.distorted);
  EXPECT_EQ(facts.distorted->camera.fx, 577.5F);
  const std::string list = R"([{"id": "color", "fx": 1155, "width": 1280}, {"id": "depth", "K": [5,0,1,0,5,1,0,0,1],
      "depth": {"fx": 577.5, "width": 640}}])";
  EXPECT_EQ(parse_camera(list, "cameras.json").fx, 577.5F);
  EXPECT_EQ(parse_camera("[500, 501, 320, 240]", "k.txt").fy, 501.F);
  const std::string wide("\xFE\xFF\0f\0x\0=\0005\0000\0000", 14);
  EXPECT_EQ(parse_camera(wide, "c.txt").fx, 500.F) << "UTF-16 of high bytes first";
}

TEST(ParseCamera, ReadsTheUnitOfInfinitam) {
  const CameraFacts facts = parse_camera("640 480\n504 503\n352 272\n\naffine 0.0002 0.0\n", "calib.txt");
  EXPECT_EQ(facts.depth_scale, 5000.F);
  EXPECT_EQ(facts.fx, 504.F);
}

TEST(ParseCamera, SaysWhatAFileOfAnotherKindIs) {
  EXPECT_THAT(error_of([] { parse_camera("PK\3\4", "k.npz"); }), HasSubstr("k.npz: a zip archive; unpack it first"));
  EXPECT_THAT(error_of([] { parse_camera("MATLAB 5.0 MAT-file, Platform: GLNXA64", "k.mat"); }),
              HasSubstr("a file of MATLAB, which is not read; write its depth as 16-bit PNG, a calibration as text"));
  const TemporaryFolder folder;
  put(folder / "calibration.npz", "PK\3\4");
  EXPECT_THAT(error_of([&] { find_camera_facts({}, {folder.path()}); }), HasSubstr("calibration.npz: a zip archive"));
}

TEST(ResolveCamera, RefusesFocalLengthsThatCannotBe) {
  std::vector<std::string> notes;
  for (const char* focal : {"0.9023", "1.93", "70000"}) {
    CameraFacts facts = parse_camera(fmt::format(R"({{"fx": {}}})", focal), "c.json");
    EXPECT_THAT(error_of([&] { resolve_camera(facts, 640, 480, false, "here", notes); }),
                testing::AllOf(HasSubstr("c.json: focal length"), HasSubstr("expected 64 to 12800 pixels")));
  }
  EXPECT_THAT(notes, testing::IsEmpty());
  for (const char* centre : {R"("cx": 0, "cy": 0)", R"("cx": 12, "cy": -6)", R"("cx": 1400, "cy": 240)"}) {
    notes.clear();
    CameraFacts facts = parse_camera(fmt::format(R"({{"fx": 577, "width": 640, {}}})", centre), "c.json");
    resolve_camera(facts, 640, 480, false, "here", notes);
    EXPECT_THAT(notes,
                testing::ElementsAre(testing::AllOf(HasSubstr("c.json: principal point"), HasSubstr("320, 240"))));
  }
}

TEST(ParseCamera, SaysWhatAFileWithoutFocalLengthHas) {
  CameraFacts facts = parse_camera(R"({"intrinsics": {"zoom": 262.5, "width": 320}})", "camera.json");
  std::vector<std::string> notes;
  EXPECT_THAT(error_of([&] { resolve_camera(facts, 320, 240, false, "here", notes); }),
              testing::AllOf(HasSubstr("camera.json: no focal length found, expected fx"),
                             HasSubstr("it has intrinsics, width, zoom")));
  const TemporaryFolder folder;
  SourceOptions options;
  options.camera_file = put(folder / "poses.txt", "0.99 0 0.1 1\n0 0.98 0 2\n0.1 0 1 3\n0 0 0 1\n");
  EXPECT_THAT(error_of([&] { find_camera_facts(options, {}); }), HasSubstr("poses.txt: no focal length found"));
  options.fx = 300.F;
  EXPECT_EQ(find_camera_facts(options, {}).fx, 300.F);
}

TEST(ResolveCamera, ScalesByWholeRatios) {
  for (const int by : {2, 3}) {
    CameraFacts facts = parse_camera(R"({"fx": 600, "fy": 660, "cx": 319.5, "cy": 200, "width": 960, "height": 720,
        "distortion_model": "plumb_bob", "d": [0.1, 0, 0, 0, 0]})",
                                     "big.json");
    std::vector<std::string> notes;
    const Camera camera = resolve_camera(facts, 960 / by, 720 / by, false, "here", notes);
    EXPECT_NEAR(camera.fx, 600.0 / by, 1e-3);
    EXPECT_NEAR(camera.fy, 660.0 / by, 1e-3);
    EXPECT_NEAR(camera.cx, 320.0 / by - 0.5, 1e-3) << "corners of pixels lie at halves";
    EXPECT_NEAR(camera.cy, 200.5 / by - 0.5, 1e-3);
    EXPECT_EQ(facts.distorted->camera, camera);
    EXPECT_THAT(notes, ElementsAre(HasSubstr("big.json: camera of 960x720 pictures, scaled to the")));
  }
  CameraFacts facts =
      parse_camera(R"({"fx": 300, "cx": 159.5, "cy": 119.5, "width": 320, "height": 240})", "small.json");
  std::vector<std::string> notes;
  EXPECT_EQ(resolve_camera(facts, 640, 480, false, "here", notes), (Camera{640, 480, 600.F, 600.F, 319.5F, 239.5F}));
  for (const auto& size : {std::pair(640, 360), {480, 360}, {320, 180}}) {
    CameraFacts other = parse_camera(R"({"fx": 300, "width": 320, "height": 240})", "c.json");
    EXPECT_THAT(error_of([&] { resolve_camera(other, size.first, size.second, false, "here", notes); }),
                HasSubstr("c.json: camera of 320x240 pictures, but here has " + std::to_string(size.first)));
  }
}

TEST(ResolveCamera, ScalesWhatHasTheCentreOfLargerPictures) {
  // Stray Scanner: the matrix is that of 1920x1440, depth is 256x192.
  CameraFacts facts = parse_camera("1605.3,0,960.5\n0,1605.3,718.2\n0,0,1\n", "camera_matrix.csv");
  std::vector<std::string> notes;
  const Camera camera = resolve_camera(facts, 256, 192, false, "here", notes);
  EXPECT_NEAR(camera.fx, 1605.3 / 7.5, 1e-3);
  EXPECT_NEAR(camera.cx, 961.0 / 7.5 - 0.5, 1e-3);
  EXPECT_THAT(notes,
              ElementsAre(HasSubstr("its centre is that of pictures 7.5 times as large as the 256x192 of here")));
}

TEST(ResolveCamera, TakesTheCameraOfTheSizeOfThePictures) {
  const char* both =
      R"({"depth": {"fx": 500, "width": 640, "height": 576}, "color": {"fx": 900, "width": 1280, "height": 720}})";
  for (const auto& [width, height, fx] : {std::tuple(640, 576, 500.F), {1280, 720, 900.F}}) {
    CameraFacts facts = parse_camera(both, "c.json");
    std::vector<std::string> notes;
    EXPECT_EQ(resolve_camera(facts, width, height, false, "here", notes).fx, fx);
  }
}

TEST(ResolveCamera, TakesTheModeOfAnAzureKinect) {
  for (const auto& [width, height, fx] : {std::tuple(640, 576, 512.F), {320, 288, 256.F}, {1280, 720, 576.F}}) {
    CameraFacts facts = parse_camera(test::k4a_json() + std::string("\0", 1), "calibration.json");
    std::vector<std::string> notes;
    EXPECT_EQ(resolve_camera(facts, width, height, false, "here", notes).fx, fx);
  }
  CameraFacts facts = parse_camera(test::k4a_json(), "calibration.json");
  std::vector<std::string> notes;
  EXPECT_THAT(error_of([&] { resolve_camera(facts, 222, 333, false, "here", notes); }),
              HasSubstr("calibration.json: calibration of an Azure Kinect, but pictures of 222x333"));
}

TEST(FindCameraFacts, FindsFilesByTheirNames) {
  for (const char* name : {"intrinsic.json", "INTRINSICS.JSON", "camera.yml", "camera-intrinsics.txt",
                           "Calibration.YAML", "depth_camera_info.yaml", "calib.txt", "cam_params.json"}) {
    const TemporaryFolder folder;
    put(folder / "rgb_camera.json", R"({"fx": 900})");
    put(folder / "camera_poses.txt", "no: [numbers");
    put(folder / name, std::string(name).ends_with("txt") ? "500 0 50 0 501 40 0 0 1" : "{\"fx\": 500}");
    EXPECT_EQ(find_camera_facts({}, {folder.path()}).fx, 500.F) << name;
  }
  const TemporaryFolder folder;
  put(folder / "camera.json", "{\"fx\": ");
  EXPECT_THAT(error_of([&] { find_camera_facts({}, {folder.path()}); }), HasSubstr("camera.json: not JSON"));
}

TEST(FindCameraFacts, ReadsAMatrixOfNumPy) {
  const TemporaryFolder folder;
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }";
  header.resize(118, ' ');
  std::string bytes = std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header;
  for (const double value : {500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0}) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  put(folder / "intrinsics.npy", bytes);
  const CameraFacts facts = find_camera_facts({}, {folder.path()});
  EXPECT_EQ(facts.fx, 500.F);
  EXPECT_EQ(facts.cy, 240.F);
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

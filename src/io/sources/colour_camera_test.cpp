#include "io/sources/colour_camera.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <string>

#include "io/files/test_files.h"
#include "io/lens/colour_registration.h"
#include "io/sources/camera_file.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using Eigen::Isometry3d;
using test::put;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Camera kDepth{64, 48, 58.5F, 59.F, 30.5F, 24.F}, kColour{100, 72, 90.F, 91.F, 51.F, 35.F};

Isometry3d depth_to_colour() {
  Isometry3d transform = Isometry3d::Identity();
  transform.linear() = Eigen::AngleAxisd(0.06, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  transform.translation() = Eigen::Vector3d(0.052, -0.011, 0.004);
  return transform;
}

/// Returns numbers of a matrix by rows.
std::string numbers(const Eigen::MatrixXd& matrix, const char* between = " ", double scale = 1.0) {
  std::string text;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      text += (text.empty() ? "" : between) + fmt::format("{:.9f}", matrix(row, column) * scale);
    }
  }
  return text;
}
std::string list(const Eigen::MatrixXd& matrix, double scale = 1.0) { return "[" + numbers(matrix, ", ", scale) + "]"; }

Eigen::Matrix3d matrix_of(const Camera& c) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return k;
}
Eigen::Matrix4d matrix4_of(const Camera& c) {
  Eigen::Matrix4d k = Eigen::Matrix4d::Identity();
  k.topLeftCorner<3, 3>() = matrix_of(c);
  return k;
}

std::string opencv(const std::string& name, const Eigen::MatrixXd& matrix) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n", name, matrix.rows(),
                     matrix.cols(), list(matrix));
}

std::string realsense(const Camera& c) {
  return fmt::format(
      R"("width": {}, "height": {}, "fx": {}, "fy": {}, "ppx": {}, "ppy": {}, "model": "none", "coeffs": [0,0,0,0,0])",
      c.width, c.height, c.fx, c.fy, c.cx, c.cy);
}

std::string info(const Camera& c) {
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n", c.width,
                     c.height, list(matrix_of(c)));
}

using Files = std::map<std::string, std::string>;

struct Rig {
  const char* tool;
  Files files;
};

/// The same two cameras as tools write them.
std::vector<Rig> rigs() {
  const Isometry3d there = depth_to_colour(), back = there.inverse();
  const Eigen::Matrix3d r = there.linear();
  const Eigen::Vector3d t = there.translation();
  // Both from a third frame, as the cameras of a scanner's reference.
  Isometry3d of_depth = Isometry3d::Identity();
  of_depth.translation() = Eigen::Vector3d(0.1, 0.02, 0);
  const Isometry3d of_colour = there * of_depth;
  const auto three = [](const Isometry3d& m) {
    return numbers(m.matrix().row(0)) + "\n" + numbers(m.matrix().row(1)) + "\n" + numbers(m.matrix().row(2)) + "\n";
  };
  const auto rows4 = [&](const Eigen::Matrix4d& m) {
    std::string text;
    for (int i = 0; i < 4; ++i) text += numbers(m.row(i)) + "\n";
    return text;
  };
  const auto infinitam = [](const Camera& c) {
    return fmt::format("{} {}\n{} {}\n{} {}\n\n", c.width, c.height, c.fx, c.fy, c.cx, c.cy);
  };
  const auto orbbec = [](const Camera& c) {
    return fmt::format(R"({{"fx": {}, "fy": {}, "cx": {}, "cy": {}, "width": {}, "height": {}}})", c.fx, c.fy, c.cx,
                       c.cy, c.width, c.height);
  };
  const auto sensor = [&](const Isometry3d& depth, const Isometry3d& colour) {
    return fmt::format(
        "m_versionNumber = 4\nm_colorWidth = {}\nm_colorHeight = {}\nm_depthWidth = {}\nm_depthHeight = {}\n"
        "m_depthShift = 1000\nm_calibrationColorIntrinsic = {}\nm_calibrationColorExtrinsic = {}\n"
        "m_calibrationDepthIntrinsic = {}\nm_calibrationDepthExtrinsic = {}\n",
        kColour.width, kColour.height, kDepth.width, kDepth.height, numbers(matrix4_of(kColour)),
        numbers(colour.matrix()), numbers(matrix4_of(kDepth)), numbers(depth.matrix()));
  };
  const Eigen::Quaterniond q(back.linear());
  const std::string stereo = "%YAML:1.0\n---\n";
  return {
      {"iai_kinect2",
       {{"calib_color.yaml", "%YAML:1.0\n" + opencv("cameraMatrix", matrix_of(kColour))},
        {"calib_ir.yaml", "%YAML:1.0\n" + opencv("cameraMatrix", matrix_of(kDepth))},
        {"calib_depth.yaml", "%YAML:1.0\ndepthShift: 0.0\n"},
        {"calib_pose.yaml", "%YAML:1.0\n" + opencv("rotation", r) + opencv("translation", t) + opencv("essential", r) +
                                opencv("fundamental", r)}}},
      {"OpenCV's stereo calibration, depth first",
       {{"intrinsics.yml", stereo + opencv("M1", matrix_of(kDepth)) + opencv("M2", matrix_of(kColour))},
        {"extrinsics.yml", stereo + opencv("R", r) + opencv("T", t) + opencv("R1", r) + opencv("P1", r)}}},
      {"OpenCV's stereo calibration, colour first",
       {{"stereo.yml", stereo + opencv("K1", matrix_of(kColour)) + opencv("D1", Eigen::MatrixXd::Zero(1, 5)) +
                           opencv("K2", matrix_of(kDepth)) + opencv("D2", Eigen::MatrixXd::Zero(1, 5)) +
                           opencv("R", back.linear()) + opencv("T", back.translation())}}},
      {"InfiniTAM", {{"calib.txt", infinitam(kColour) + infinitam(kDepth) + three(back) + "\n1135.09 0.0819\n"}}},
      {"BundleFusion", {{"info.txt", sensor(of_depth, of_colour)}}},
      {"ScanNet, exported",
       {{"intrinsic/intrinsic_color.txt", rows4(matrix4_of(kColour))},
        {"intrinsic/intrinsic_depth.txt", rows4(matrix4_of(kDepth))},
        {"intrinsic/extrinsic_color.txt", rows4(of_colour.matrix())},
        {"intrinsic/extrinsic_depth.txt", rows4(of_depth.matrix())}}},
      {"librealsense",
       {{"camera.json", fmt::format(R"({{"depth": {{{}}}, "color": {{{}}}, "depth_to_color": {{"rotation": {},
            "translation": {}}}}})",
                                    realsense(kDepth), realsense(kColour), list(r.transpose()), list(t))}}},
      {"librealsense, extrinsics of depth",
       {{"intrinsics_depth.json", fmt::format(R"({{"intrinsics": {{{}}}, "extrinsics": {{"rotation": {},
            "translation": {}}}}})",
                                              realsense(kDepth), list(r.transpose()), list(t))},
        {"intrinsics_color.json", fmt::format(R"({{"intrinsics": {{{}}}}})", realsense(kColour))}}},
      {"rs-enumerate-devices -c",
       {{"camera.txt",
         fmt::format(
             " Intrinsic of \"Depth\" / 64x48 / {{Z16}}\n  Width: \t64\n  Height: \t48\n  PPX: \t{}\n  PPY: \t{}\n"
             "  Fx: \t{}\n  Fy: \t{}\n  Distortion: \tBrown Conrady\n  Coeffs: \t0 \t0 \t0 \t0 \t0\n\n"
             " Intrinsic of \"Color\" / 100x72 / {{RGB8}}\n  Width: \t100\n  Height: \t72\n  PPX: \t{}\n  PPY: \t{}\n"
             "  Fx: \t{}\n  Fy: \t{}\n  Distortion: \tInverse Brown Conrady\n  Coeffs: \t0 \t0 \t0 \t0 \t0\n\n"
             "Extrinsic Parameters:\n"
             "Extrinsic from \"Depth\"\t  To\t  \"Color\" :\n Rotation Matrix:\n   {}\n   {}\n   {}\n\n"
             " Translation Vector: {}\n\n"
             "Extrinsic from \"Color\"\t  To\t  \"Depth\" :\n Rotation Matrix:\n   {}\n   {}\n   {}\n\n"
             " Translation Vector: {}\n",
             kDepth.cx, kDepth.cy, kDepth.fx, kDepth.fy, kColour.cx, kColour.cy, kColour.fx, kColour.fy,
             numbers(r.row(0)), numbers(r.row(1)), numbers(r.row(2)), numbers(t.transpose()),
             numbers(back.linear().row(0)), numbers(back.linear().row(1)), numbers(back.linear().row(2)),
             numbers(back.translation().transpose()))}}},
      {"Orbbec, millimetres",
       {{"camera_params.json", fmt::format(R"({{"depthIntrinsic": {}, "rgbIntrinsic": {}, "transform": {{"rot": {},
            "trans": {}}}}})",
                                           orbbec(kDepth), orbbec(kColour), list(r), list(t, 1000.0))}}},
      {"two of ROS with a transform by name",
       {{"depth_camera_info.yaml", info(kDepth)},
        {"color_camera_info.yaml", info(kColour)},
        {"color_to_depth.txt", rows4(back.matrix())}}},
      {"two of ROS with tf2_echo's message",
       {{"depth_camera_info.yaml", info(kDepth)},
        {"color_camera_info.yaml", info(kColour)},
        {"transform.yaml",
         fmt::format("header:\n  frame_id: camera_depth_optical_frame\nchild_frame_id: camera_color_optical_frame\n"
                     "transform:\n  translation:\n    x: {:.9f}\n    y: {:.9f}\n    z: {:.9f}\n  rotation:\n"
                     "    x: {:.9f}\n    y: {:.9f}\n    z: {:.9f}\n    w: {:.9f}\n",
                     back.translation().x(), back.translation().y(), back.translation().z(), q.x(), q.y(), q.z(),
                     q.w())}}},
      {"Kalibr",
       {{"camchain.yaml", fmt::format("cam0:\n  camera_model: pinhole\n  intrinsics: [{}, {}, {}, {}]\n"
                                      "  resolution: [{}, {}]\n"
                                      "cam1:\n  T_cn_cnm1:\n  - {}\n  - {}\n  - {}\n  - {}\n  camera_model: pinhole\n"
                                      "  intrinsics: [{}, {}, {}, {}]\n  resolution: [{}, {}]\n",
                                      kColour.fx, kColour.fy, kColour.cx, kColour.cy, kColour.width, kColour.height,
                                      list(back.matrix().row(0)), list(back.matrix().row(1)),
                                      list(back.matrix().row(2)), list(back.matrix().row(3)), kDepth.fx, kDepth.fy,
                                      kDepth.cx, kDepth.cy, kDepth.width, kDepth.height)}}}};
}

DepthImage some_depth() {
  DepthImage depth(kDepth.width, kDepth.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u)
      depth(u, v) = static_cast<std::uint16_t>(u > 20 && u < 40 ? 900 : 2000 + 7 * v);
  }
  return depth;
}

ColourImage some_colour(int width = kColour.width, int height = kColour.height) {
  ColourImage colour(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      colour(u, v) = {static_cast<std::uint8_t>(2 * u), static_cast<std::uint8_t>(3 * v), 100};
    }
  }
  return colour;
}

void put_pictures(const TemporaryFolder& folder, const ColourImage& colour) {
  put(folder / "depth/0.png", encode_png(some_depth()));
  put(folder / "color/0.png", encode_png(colour));
}

TEST(ColourOfAnotherCamera, IsPutOnTheGridOfDepthWhereverCalibrationsSayHow) {
  const ColourImage expected =
      ColourRegistration(kDepth, {kColour, {}}, depth_to_colour())(some_depth(), some_colour());
  for (const Rig& rig : rigs()) {
    SCOPED_TRACE(rig.tool);
    const TemporaryFolder folder;
    put_pictures(folder, some_colour());
    for (const auto& [name, text] : rig.files) put(folder / name, text);
    const auto source = open_source(folder.path());
    EXPECT_THAT(source->notes(), IsEmpty());
    const auto frame = source->next();
    EXPECT_NEAR(frame->camera.fx, kDepth.fx, 1e-4F);
    EXPECT_NEAR(frame->camera.cx, kDepth.cx, 1e-4F);
    ASSERT_TRUE(frame->colour.same_size(frame->depth));
    int other = 0;
    for (int v = 0; v < expected.height(); ++v) {
      for (int u = 0; u < expected.width(); ++u) other += frame->colour(u, v) == expected(u, v) ? 0 : 1;
    }
    EXPECT_LE(other, 3) << "pixels, which are rounded by the digits in the files";
  }
}

TEST(ColourOfAnotherCamera, OfScanNetLiesOnDepthWhateverItsExtrinsicsAre) {
  const TemporaryFolder folder;
  put_pictures(folder, some_colour());
  put(folder / "scene0000_00.txt",
      fmt::format("axisAlignment = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\ncolorHeight = 72\ncolorToDepthExtrinsics = {}\n"
                  "colorWidth = 100\ndepthHeight = 48\ndepthWidth = 64\nfx_color = {}\nfx_depth = {}\nfy_color = {}\n"
                  "fy_depth = {}\nmx_color = {}\nmx_depth = {}\nmy_color = {}\nmy_depth = {}\n",
                  numbers(depth_to_colour().matrix()), kColour.fx, kDepth.fx, kColour.fy, kDepth.fy, kColour.cx,
                  kDepth.cx, kColour.cy, kDepth.cy));
  const auto frame = open_source(folder.path())->next();
  EXPECT_EQ(frame->camera, kDepth);
  EXPECT_EQ(frame->colour,
            ColourRegistration(kDepth, {kColour, {}}, Isometry3d::Identity())(some_depth(), some_colour()));
}

TEST(ColourOfAnotherCamera, OfTheSameSizeIsRegisteredUnlessItsNameSaysSo) {
  const Camera colour{64, 48, 52.F, 52.F, 32.F, 23.F};
  const std::string json = fmt::format(
      R"({{"depth": {{{}}}, "color": {{{}}}, "d2c": {{"rotation": {}, "translation": {}}}}})", realsense(kDepth),
      realsense(colour), list(depth_to_colour().linear().transpose()), list(depth_to_colour().translation()));
  const ColourImage picture = some_colour(64, 48);
  for (const bool aligned : {false, true}) {
    const TemporaryFolder folder;
    put(folder / "camera.json", json);
    put(folder / "depth/0.png", encode_png(some_depth()));
    put(folder / (aligned ? "color_aligned/0.png" : "color/0.png"), encode_png(picture));
    const auto source = open_source(folder.path());
    const auto frame = source->next();
    if (aligned) {
      EXPECT_EQ(frame->colour, picture);
      EXPECT_THAT(source->notes(), IsEmpty());
    } else {
      EXPECT_EQ(frame->colour, ColourRegistration(kDepth, {colour, {}}, depth_to_colour())(some_depth(), picture));
      EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("colour is put on the grid of depth, as")));
    }
  }
}

TEST(ColourOfAnotherCamera, IsLeftOutWithWhatIsMissing) {
  const TemporaryFolder folder;
  put_pictures(folder, some_colour());
  put(folder / "depth_camera_info.yaml", info(kDepth));
  const auto note = [&] { return open_source(folder.path())->notes().at(0); };
  EXPECT_THAT(note(), testing::EndsWith("no colour, since that has 100x72 pixels and depth 64x48"));
  put(folder / "color_camera_info.yaml", info(kColour));
  EXPECT_THAT(note(), HasSubstr("rotation and translation between the cameras are not beside the pictures"));
  put(folder / "extrinsics.json", R"({"rotation": [1, 1, 1, 0, 1, 0, 0, 0, 1], "translation": [0, 0, 0]})");
  EXPECT_THAT(note(), HasSubstr("rotation and translation between the cameras")) << "that is no rotation";
  Camera other = kColour;
  other.width = 333;
  put(folder / "color_camera_info.yaml", info(other));
  EXPECT_THAT(note(), HasSubstr("the calibration of colour is of other pictures"));
}

}  // namespace
}  // namespace vesalius

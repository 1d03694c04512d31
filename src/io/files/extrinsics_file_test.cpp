#include "io/files/extrinsics_file.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

CameraExtrinsics somewhere() {
  CameraExtrinsics camera{"b/", Eigen::Isometry3f::Identity()};
  camera.first_from_this.linear() = Eigen::AngleAxisf(1.1F, Eigen::Vector3f(1.F, 2.F, -1.F).normalized()).matrix();
  camera.first_from_this.translation() = Eigen::Vector3f(1.F, -0.2F, 3.F);
  return camera;
}

TEST(ExtrinsicsFile, ReadsWhatItWrites) {
  const std::string text = extrinsics_json({{"a/", Eigen::Isometry3f::Identity()}, somewhere()});
  const auto cameras = parse_extrinsics(text, "rig.json", 2);
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[1].source, "b/");
  EXPECT_TRUE(cameras[1].first_from_this.isApprox(somewhere().first_from_this, 1e-6F));
}

TEST(ExtrinsicsFile, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) { return error_of([&] { parse_extrinsics(text, "rig.json", 2); }); };
  EXPECT_THAT(error("nothing"), HasSubstr(R"(rig.json: expected JSON with "cameras")"));
  EXPECT_THAT(error(R"({"cameras": []})"), HasSubstr("rig.json: 0 cameras, expected 2, one for each source"));
  const std::string first = R"({"cameras": [{"first_from_this": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}, )";
  EXPECT_THAT(error(first + "{}]}"), HasSubstr("rig.json: camera 1: first_from_this is missing"));
  EXPECT_THAT(error(first + R"({"first_from_this": [[1,0,0],[0,1,0],[0,0,1]]}]})"),
              HasSubstr("rig.json: camera 1: first_from_this: expected three rows of four numbers"));
  EXPECT_THAT(error(first + R"({"first_from_this": [[1,0,0,0],[0,1,0,0],[0,0,-1,0]]}]})"),
              HasSubstr("expected a rotation"));
  EXPECT_THAT(error(first + R"({"first_from_this": [[1,0,0,1e39],[0,1,0,0],[0,0,1,0]]}]})"), HasSubstr("camera 1"));
  EXPECT_THAT(error(R"({"cameras": [{"first_from_this": [[1,0,0,1],[0,1,0,0],[0,0,1,0]]}, {"first_from_this":
      [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})"),
              HasSubstr("rig.json: camera 0: expected the identity"));
}

}  // namespace
}  // namespace vesalius

#include "io/sources/pcd.h"

#include <gmock/gmock.h>

#include <bit>
#include <cstring>
#include <limits>

#include "io/files/test_files.h"
#include "io/sources/test_pcd_write.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_frame;
using test::serialise_pcd;
using testing::HasSubstr;

constexpr PcdEncoding kAll[] = {PcdEncoding::ascii, PcdEncoding::binary, PcdEncoding::binary_compressed};

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string with_size(const std::string& lines, int width, int height, const std::string& data) {
  return "# .PCD v.7\nVERSION .7\n" + lines + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " +
         std::to_string(height) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA " +
         data;
}

TEST(Pcd, KeepsEveryBitInEveryEncoding) {
  for (const bool colour : {true, false}) {
    const Frame frame = random_frame("f", 5, 37, 23, colour);
    for (const PcdEncoding encoding : kAll) {
      const PointGrid grid = parse_pcd(serialise_pcd(frame, encoding), "f.pcd");
      EXPECT_EQ(depth_of(grid), frame.depth);
      EXPECT_EQ(grid.colour, frame.colour);
    }
  }
}

TEST(Pcd, KeepsEveryMillimetre) {
  Frame frame;
  frame.camera = {256, 256, 200.F, 200.F, 127.5F, 127.5F};
  frame.depth = DepthImage(256, 256);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) frame.depth[i] = static_cast<std::uint16_t>(i);
  for (const PcdEncoding encoding : kAll) {
    EXPECT_EQ(depth_of(parse_pcd(serialise_pcd(frame, encoding), "f.pcd")), frame.depth);
  }
}

TEST(Pcd, SkipsOtherFieldsInAnyOrder) {
  std::string data = "binary\n";
  for (int i = 0; i < 4; ++i) {
    data +=
        raw(std::uint8_t{9}) + raw(1.0 + i) + raw(std::uint32_t{0x00102030} + i) + "abcdef" + raw(0.5F) + raw(-0.25F);
  }
  const PointGrid grid = parse_pcd(
      with_size("FIELDS label z rgba _ x y\nSIZE 1 8 4 2 4 4\nTYPE U F U I F F\nCOUNT 1 1 1 3 1 1", 2, 2, data),
      "f.pcd");
  EXPECT_EQ(grid.points_m(1, 1), Eigen::Vector3f(0.5F, -0.25F, 4.F));
  EXPECT_EQ(grid.colour(1, 0), (Rgb{0x10, 0x20, 0x31}));
  EXPECT_EQ(depth_of(grid)(0, 1), 3000);
}

TEST(Pcd, ReadsAsciiColourFromTheBitsOfAFloat) {
  // 2.3418052e-38 has the bits 0x00FF0000.
  const PointGrid grid = parse_pcd(with_size("FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1", 1, 2,
                                             "ascii\n0.1 0.2 1.5 2.3418052e-38\nnan nan nan nan\n"),
                                   "f.pcd");
  EXPECT_EQ(grid.colour(0, 0), (Rgb{255, 0, 0}));
  EXPECT_EQ(depth_of(grid)(0, 0), 1500);
  EXPECT_EQ(depth_of(grid)(0, 1), 0);
}

TEST(Pcd, RoundsAndBoundsDepth) {
  PointGrid grid{Image<Eigen::Vector3f>(5, 1, Eigen::Vector3f::Zero()), {}};
  const float z_m[] = {1.2346F, -2.F, 65.535F, 65.6F, std::numeric_limits<float>::infinity()};
  for (int i = 0; i < 5; ++i) grid.points_m(i, 0).z() = z_m[i];
  const DepthImage depth = depth_of(grid);
  EXPECT_THAT(std::vector<int>(depth.begin(), depth.end()), testing::ElementsAre(1235, 0, 65535, 0, 0));
}

TEST(Pcd, EstimatesTheCameraFromThePoints) {
  const Frame frame = random_frame("f", 6);
  const CameraFacts facts = estimate_camera(parse_pcd(serialise_pcd(frame, PcdEncoding::binary), "f.pcd"), "f.pcd");
  EXPECT_NEAR(*facts.fx, frame.camera.fx, 1e-3);
  EXPECT_NEAR(*facts.fy, frame.camera.fy, 1e-3);
  EXPECT_NEAR(*facts.cx, frame.camera.cx, 1e-3);
  EXPECT_NEAR(*facts.cy, frame.camera.cy, 1e-3);
}

TEST(Pcd, EstimatesTheCameraDespiteFewStrayPoints) {
  Frame frame = random_frame("f", 7);
  PointGrid grid = parse_pcd(serialise_pcd(frame, PcdEncoding::binary), "f.pcd");
  for (int u = 0; u < 30; u += 6) grid.points_m(u, 3) = {0.3F, -0.2F, 1.F};
  const CameraFacts facts = estimate_camera(grid, "f.pcd");
  EXPECT_NEAR(*facts.fx, frame.camera.fx, 0.05);
  EXPECT_NEAR(*facts.cy, frame.camera.cy, 0.05);
}

TEST(Pcd, RefusesPointsThatAreNoPinholeGrid) {
  const Frame frame = random_frame("f", 8);
  PointGrid mirrored = parse_pcd(serialise_pcd(frame, PcdEncoding::binary), "f.pcd");
  for (auto& point : mirrored.points_m) point.x() = -point.x();
  EXPECT_THAT(error_of([&] { estimate_camera(mirrored, "f.pcd"); }), HasSubstr("f.pcd: its points lie on no pinhole"));

  PointGrid random = mirrored;
  Random numbers(1);
  const auto metres = [&] { return static_cast<float>(numbers.uniform(0.5, 2.0)); };
  for (auto& point : random.points_m) point = {metres(), metres(), metres()};
  EXPECT_THROW(estimate_camera(random, "f.pcd"), Error);

  const PointGrid empty{Image<Eigen::Vector3f>(8, 8, Eigen::Vector3f::Zero()), {}};
  EXPECT_THROW(estimate_camera(empty, "f.pcd"), Error);
}

TEST(Pcd, RefusesEveryTruncation) {
  const Frame frame = random_frame("f", 9, 6, 4);
  for (const PcdEncoding encoding : kAll) {
    const std::string whole = serialise_pcd(frame, encoding);
    // The last number of an ascii file may lose digits without being noticed.
    const std::size_t last = encoding == PcdEncoding::ascii ? whole.rfind(' ') : whole.size() - 1;
    for (std::size_t size = 0; size <= last; ++size) {
      EXPECT_THROW(parse_pcd(whole.substr(0, size), "f.pcd"), Error) << "first " << size << " bytes";
    }
  }
}

TEST(Pcd, NamesTheFileAndTheLineOfErrors) {
  const std::string fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";
  const auto message = [](const std::string& text) { return error_of([&] { parse_pcd(text, "f.pcd"); }); };
  EXPECT_THAT(message(""), HasSubstr("f.pcd: empty file"));
  EXPECT_THAT(message("plain\n"), HasSubstr("f.pcd:1: expected a PCD header"));
  EXPECT_THAT(message("VERSION .7\nFIELDS x y\nSIZE 4 4 4\n"), HasSubstr("f.pcd:3: expected SIZE with a value"));
  EXPECT_THAT(message("FIELDS x y z\nTYPE F F Q\n"), HasSubstr("f.pcd:2: expected TYPE"));
  EXPECT_THAT(message("FIELDS x y z\nSIZE 4 4 9\n"), HasSubstr("f.pcd:2: expected SIZE of 1 to 8"));
  EXPECT_THAT(message("FIELDS x y z\nCOUNT 1 1 4294967295\n"), HasSubstr("COUNT of 1 to"));
  EXPECT_THAT(message("FIELDS x y z\nWIDTH -2\n"), HasSubstr("f.pcd:2"));
  EXPECT_THAT(message(with_size("FIELDS x y\nSIZE 4 4\nTYPE F F", 2, 2, "ascii\n")), HasSubstr("x, y and z"));
  EXPECT_THAT(message(with_size("FIELDS x y z\nSIZE 4 4 2\nTYPE F F I", 2, 2, "ascii\n")), HasSubstr("x, y and z"));
  EXPECT_THAT(message(with_size(fields, 2, 2, "zip\n")), HasSubstr("DATA ascii, binary"));
  EXPECT_THAT(message(with_size(fields, 4, 1, "ascii\n")), HasSubstr("HEIGHT 1: expected an organised cloud"));
  EXPECT_THAT(message(with_size(fields, 1, 2, "ascii\n1 2 3\n4 five 6\n")), HasSubstr("f.pcd: point 1: field y"));
  EXPECT_THAT(message("FIELDS x y z\nWIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n"), HasSubstr("POINTS 5, expected"));
}

TEST(Pcd, RefusesHostileSizesBeforeAllocating) {
  const std::string fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 60000\nHEIGHT ";
  const auto message = [](const std::string& text) { return error_of([&] { parse_pcd(text, "f.pcd"); }); };
  EXPECT_THAT(message(fields + "60000\nDATA binary\nabc"), HasSubstr("60000x60000"));
  EXPECT_THAT(message(fields + "1000\nDATA binary\nabc"), HasSubstr("truncated"));
  EXPECT_THAT(message(fields + "1000\nDATA ascii\nabc"), HasSubstr("truncated"));
  EXPECT_THAT(message(fields + "1000\nDATA binary_compressed\n" + raw(std::uint32_t{3}) +
                      raw(std::uint32_t{720000000}) + "abc"),
              HasSubstr("too few compressed bytes"));
}

TEST(Pcd, RefusesDamagedCompression) {
  std::string bytes = serialise_pcd(random_frame("f", 10, 6, 4), PcdEncoding::binary_compressed);
  const std::size_t data = bytes.find("binary_compressed\n") + 18 + 8;
  for (std::size_t i = data; i < bytes.size(); ++i) bytes[i] = '\xFF';
  EXPECT_THAT(error_of([&] { parse_pcd(bytes, "f.pcd"); }), HasSubstr("cannot be decompressed"));
}

}  // namespace
}  // namespace vesalius

#include "dataset/plane_codec.h"

#include <gmock/gmock.h>

#include <cmath>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

template <class T>
Image<T> random_image(int width, int height, std::uint32_t bound, std::uint64_t seed) {
  Random rng(seed);
  Image<T> image(width, height);
  for (T& value : image) value = static_cast<T>(rng.below(bound));
  return image;
}

DepthImage round_trip(const DepthImage& depth) {
  ByteWriter out;
  write_depth_plane(out, depth);
  const std::string name = "test";
  ByteReader in(out.bytes(), name);
  const DepthImage back = read_depth_plane(in, depth.width(), depth.height());
  in.expect_end();
  return back;
}

/// Returns a slanted wall with a sphere as a noisy sensor with disparity steps of 1/8 pixel reads it; a fifth of the
/// pixels are holes.
DepthImage sensed() {
  Random rng(4);
  DepthImage depth(320, 240);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const double z = 2000.0 + 3.0 * u + rng.normal(0.0, 3.0);
      const double eighths = std::round(8.0 * 43500.0 / z);
      depth(u, v) = u % 64 < 12 ? std::uint16_t{0} : static_cast<std::uint16_t>(std::lround(8.0 * 43500.0 / eighths));
    }
  }
  return depth;
}

TEST(DepthPlane, KeepsAnyDepth) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (const std::uint32_t bound : {1U, 2U, 3U, 300U, 9000U, 65536U}) {
      const auto depth = random_image<std::uint16_t>(31, 17, bound, seed);
      ASSERT_EQ(round_trip(depth), depth) << bound;
    }
  }
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1)}) {
    const auto depth = random_image<std::uint16_t>(width, height, 65536, 9);
    EXPECT_EQ(round_trip(depth), depth);
  }
  EXPECT_EQ(round_trip(sensed()), sensed());
}

TEST(DepthPlane, KeepsDepthInWhichEveryValueOccurs) {
  DepthImage depth(256, 256);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>((i * 40503U) & 0xFFFFU);
  EXPECT_EQ(round_trip(depth), depth);
}

TEST(DepthPlane, TakesLessThanHalfOfAPng) {
  ByteWriter out;
  write_depth_plane(out, sensed());
  EXPECT_LT(out.bytes().size(), 30000U);  // 76,800 pixels, 16 bits each
}

TEST(BytePlane, KeepsEveryByte) {
  const auto labels = random_image<std::uint8_t>(61, 33, 256, 5);
  ByteWriter out;
  write_byte_plane(out, labels);
  const std::string name = "test";
  ByteReader in(out.bytes(), name);
  EXPECT_EQ(read_byte_plane(in, 61, 33), labels);
  in.expect_end();
}

TEST(ColourPlane, CanBeReadOrSkipped) {
  Random rng(6);
  ColourImage colour(45, 22);
  const auto byte = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
  for (Rgb& c : colour) c = {byte(), byte(), byte()};
  ByteWriter out;
  write_colour_plane(out, colour);
  const std::string name = "test";
  ByteReader in(out.bytes(), name);
  EXPECT_EQ(read_colour_plane(in, 45, 22), colour);
  in.expect_end();
  ByteReader again(out.bytes(), name);
  skip_colour_plane(again);
  again.expect_end();
}

TEST(Planes, RefuseAnotherSizeThanTheirOwn) {
  ByteWriter out;
  write_depth_plane(out, sensed());
  const std::string name = "test";
  for (const auto& [width, height] : {std::pair(319, 240), std::pair(320, 241)}) {
    EXPECT_THAT(test::error_of([&, w = width, h = height] {
                  ByteReader in(out.bytes(), name);
                  read_depth_plane(in, w, h);
                }),
                HasSubstr("test: damaged at byte"));
  }
}

TEST(Planes, AllocateNoMoreThanThePictureNeeds) {
  ByteWriter bomb;
  bomb.number(std::uint32_t{0xFFFFFFFF});
  bomb.text("not zstd");
  const std::string name = "test";
  ByteReader in(bomb.bytes(), name);
  EXPECT_THAT(test::error_of([&] { read_byte_plane(in, 8, 8); }), HasSubstr("4294967295 bytes, expected 64 to 64"));
}

}  // namespace
}  // namespace vesalius

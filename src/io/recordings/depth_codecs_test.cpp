#include "io/recordings/depth_codecs.h"

#include <gmock/gmock.h>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "vesalius/base/random.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

Image<std::uint16_t> random_depth(std::uint64_t seed, int width, int height) {
  Random random(seed);
  Image<std::uint16_t> depth(width, height, 0);
  int z = 1500;
  for (std::uint16_t& value : depth) {
    if (random.uniform() < 0.1) z = static_cast<int>(random.uniform(0.0, 65535.0));
    z = std::clamp(z + static_cast<int>(random.uniform(-9.0, 9.0)), 0, 65535);
    value = static_cast<std::uint16_t>(random.uniform() < 0.2 ? 0 : z);
  }
  return depth;
}

std::string header(float scale, float offset) {
  ByteWriter out;
  out.number(std::uint32_t{0});
  out.real(scale);
  out.real(offset);
  return out.bytes();
}

TEST(Rvl, UnpacksWordsWorkedOutByHand) {
  // No empty pixel; two full ones: 5 (difference +5, zigzag 10 = 2 + 1 * 8) and 4 (difference -1, zigzag 1); one empty.
  // Nibbles: 0, 2, A 1, 1, 1, 0 and two to fill the word.
  ByteWriter words;
  words.number(std::uint32_t{0x02A11100});
  const Image<std::uint16_t> depth = unpack_rvl(words.bytes(), 3, 1, "rvl");
  EXPECT_EQ(depth(0, 0), 5);
  EXPECT_EQ(depth(1, 0), 4);
  EXPECT_EQ(depth(2, 0), 0);
  EXPECT_EQ(pack_rvl(depth), words.bytes());
}

TEST(Rvl, GivesBackAnyPicture) {
  for (int seed = 0; seed < 30; ++seed) {
    const Image<std::uint16_t> depth = random_depth(static_cast<std::uint64_t>(seed), 1 + seed, 37 - seed);
    EXPECT_EQ(unpack_rvl(pack_rvl(depth), depth.width(), depth.height(), "rvl"), depth) << seed;
  }
  EXPECT_EQ(unpack_rvl(pack_rvl(Image<std::uint16_t>(4, 4, 0)), 4, 4, "rvl"), Image<std::uint16_t>(4, 4, 0));
}

TEST(Rvl, RefusesWhatDoesNotFillThePicture) {
  const std::string packed = pack_rvl(random_depth(1, 20, 20));
  EXPECT_THAT(error_of([&] { unpack_rvl(packed, 40, 40, "a.bag"); }), AllOf(HasSubstr("a.bag"), HasSubstr("RVL")));
  EXPECT_THAT(error_of([&] { unpack_rvl(packed, 3, 3, "a.bag"); }),
              AllOf(HasSubstr("a.bag"), HasSubstr("more pixels than the picture has")));
  EXPECT_THAT(error_of([&] { unpack_rvl(std::string(4, '\0'), 3, 3, "a.bag"); }),
              AllOf(HasSubstr("a.bag"), HasSubstr("run of no pixels")));
  EXPECT_THAT(error_of([&] { unpack_rvl(packed, 1 << 20, 1 << 20, "a.bag"); }),
              AllOf(HasSubstr("a.bag"), HasSubstr("1048576x1048576")));
}

TEST(CompressedDepth, IsPngOrRvlBehindAHeader) {
  const Image<std::uint16_t> depth = random_depth(3, 21, 14);
  EXPECT_EQ(unpack_compressed_depth(header(0, 0) + encode_png(depth), "16UC1; compressedDepth png", "a"), depth);
  EXPECT_EQ(unpack_compressed_depth(header(0, 0) + encode_png(depth), "16UC1; compressedDepth", "a"), depth);
  EXPECT_EQ(unpack_compressed_depth(encode_png(depth), "16UC1; compressedDepth", "a"), depth) << "without its head";
  ByteWriter size;
  size.number(std::uint32_t{21});
  size.number(std::uint32_t{14});
  EXPECT_EQ(unpack_compressed_depth(header(0, 0) + size.bytes() + pack_rvl(depth), "16UC1; compressedDepth rvl", "a"),
            depth);
}

TEST(CompressedDepth, OfMetresWasStoredAsItsInverse) {
  Image<std::uint16_t> stored(3, 1, 0);
  stored(1, 0) = 120;  // 100 / (120 - 20) = 1 m
  stored(2, 0) = 20;   // infinitely far
  const auto depth =
      unpack_compressed_depth(header(100.F, 20.F) + encode_png(stored), "32FC1; compressedDepth png", "a");
  EXPECT_EQ(depth(0, 0), 0);
  EXPECT_EQ(depth(1, 0), 1000);
  EXPECT_EQ(depth(2, 0), 0);
}

TEST(CompressedDepth, RefusesDamage) {
  EXPECT_THAT(
      error_of([] { unpack_compressed_depth(encode_png(DepthImage(4, 3)), "32FC1; compressedDepth", "a.bag"); }),
      HasSubstr("without the 12 bytes"));
  EXPECT_THAT(error_of([] { unpack_compressed_depth("short", "16UC1; compressedDepth png", "a.bag"); }),
              AllOf(HasSubstr("a.bag"), HasSubstr("compressedDepth")));
  EXPECT_THAT(
      error_of([] { unpack_compressed_depth(header(0, 0) + "no picture", "16UC1; compressedDepth png", "a.bag"); }),
      AllOf(HasSubstr("a.bag"), HasSubstr("PNG")));
}

}  // namespace
}  // namespace vesalius

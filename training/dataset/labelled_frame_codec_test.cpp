#include "dataset/labelled_frame_codec.h"

#include <gmock/gmock.h>

#include <cmath>

#include "dataset/test_dataset.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_labelled;
using testing::HasSubstr;

constexpr int kParts = 25;

TEST(FrameCodec, KeepsEveryField) {
  for (const bool colour : {true, false}) {
    LabelledFrame labelled = random_labelled(3, colour);
    labelled.frame.time_s = 12.25;
    const std::string bytes = encode_frame({41, 7, labelled}, kParts);
    const DatasetFrame back = decode_frame(bytes, kParts, "test");
    EXPECT_EQ(back.index, 41U);
    EXPECT_EQ(back.seed, 7U);
    test::expect_same(back.labelled, labelled);
  }
}

TEST(FrameCodec, KeepsPosturesAndTheUpwardDirection) {
  LabelledFrame labelled = random_labelled(3);
  labelled.up = Eigen::Vector3f(0.F, -0.8F, 0.6F);
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
  labelled.postures = {"sitting", ""};
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
}

TEST(FrameCodec, RefusesPosturesAndDirectionsThatDoNotFit) {
  LabelledFrame labelled = random_labelled(3);
  labelled.postures = {"sitting"};
  EXPECT_THAT(error_of([&] { encode_frame({1, 2, labelled}, kParts); }), HasSubstr("postures of 1 people, expected 2"));
  labelled.postures.clear();
  labelled.up = Eigen::Vector3f(0.F, -2.F, 0.F);
  EXPECT_THAT(error_of([&] { encode_frame({1, 2, labelled}, kParts); }), HasSubstr("not of unit length"));
}

TEST(FrameCodec, KeepsWhereTheCameraIs) {
  LabelledFrame labelled = random_labelled(3);
  labelled.camera_height_m = 1.4F;
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
  labelled.world_from_camera = test::camera_pose();
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
  labelled.world_from_camera->linear() *= 2.F;
  EXPECT_THAT(error_of([&] { encode_frame({1, 2, labelled}, kParts); }), HasSubstr("camera's pose"));
  labelled.world_from_camera.reset();
  labelled.camera_height_m = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error_of([&] { encode_frame({1, 2, labelled}, kParts); }), HasSubstr("height is not finite"));
}

TEST(FrameCodec, TellsNoTimeFromTheTimeZero) {
  LabelledFrame labelled = random_labelled(3);
  for (const std::optional<double> time_s : {std::optional<double>{}, std::optional<double>{0.0}}) {
    labelled.frame.time_s = time_s;
    EXPECT_EQ(decode_frame(encode_frame({0, 0, labelled}, kParts), kParts, "test").labelled.frame.time_s, time_s);
  }
}

TEST(FrameCodec, LeavesOutColourIfNotWanted) {
  const LabelledFrame labelled = random_labelled(3);
  const DatasetFrame back = decode_frame(encode_frame({0, 0, labelled}, kParts), kParts, "test", false);
  EXPECT_TRUE(back.labelled.frame.colour.empty());
  EXPECT_EQ(back.labelled.frame.depth, labelled.frame.depth);
}

TEST(FrameCodec, KeepsEmptyRooms) {
  LabelledFrame labelled = random_labelled(3);
  labelled.parts.clear();
  labelled.joints.clear();
  labelled.labels.fill(kBackground);
  labelled.person.fill(kBackground);
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
}

TEST(FrameCodec, KeepsPeopleWithoutJoints) {
  LabelledFrame labelled = random_labelled(3);
  labelled.joints.clear();
  test::expect_same(decode_frame(encode_frame({1, 2, labelled}, kParts), kParts, "test").labelled, labelled);
}

TEST(FrameCodec, RefusesTruthThatDoesNotFit) {
  const auto complaint = [](const std::function<void(LabelledFrame&)>& change) {
    LabelledFrame labelled = random_labelled(3);
    change(labelled);
    return error_of([&] { encode_frame({5, 0, labelled}, kParts); });
  };
  EXPECT_THAT(complaint([](auto& f) { f.labels = LabelImage(3, 3, 0); }), HasSubstr("frame 5: labels and person"));
  EXPECT_THAT(complaint([](auto& f) { f.labels[4] = 25; }), HasSubstr("label 25, expected one below 25 or 255"));
  EXPECT_THAT(complaint([](auto& f) { f.person[4] = 2; }), HasSubstr("person 2 in the picture, expected one below 2"));
  EXPECT_THAT(complaint([](auto& f) { f.parts[1].pop_back(); }), HasSubstr("person with 24 parts, expected 25"));
  EXPECT_THAT(complaint([](auto& f) { f.parts[0][0].x() = std::numeric_limits<float>::infinity(); }),
              HasSubstr("infinite"));
  EXPECT_THAT(complaint([](auto& f) { f.joints.pop_back(); }), HasSubstr("joints of 1 people, expected 2 or none"));
  EXPECT_THAT(complaint([](auto& f) { f.joints[1].pop_back(); }), HasSubstr("person with 2 joints, expected 3"));
  EXPECT_THAT(complaint([](auto& f) { f.joints[0].resize(256); }), HasSubstr("256 joints, expected 1 to 255"));
  EXPECT_THAT(complaint([](auto& f) { f.joints[0][0].y() = std::numeric_limits<float>::quiet_NaN(); }),
              HasSubstr("joint is not finite"));
  EXPECT_THAT(complaint([](auto& f) { f.frame.name = std::string(256, 'x'); }), HasSubstr("name of more than 255"));
  EXPECT_THAT(complaint([](auto& f) { f.parts.resize(255, f.parts[0]); }), HasSubstr("255 people"));
}

// The checksum is not part of the codec: a damaged frame may decode as another valid frame, but never as an invalid
// one.
TEST(FrameCodec, GivesAnErrorOrAValidFrameForEveryDamage) {
  const std::string bytes = encode_frame({1, 2, random_labelled(3)}, kParts);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      try {
        check_truth(decode_frame(damaged, kParts, "test").labelled, kParts);
      } catch (const Error& e) {
        ASSERT_THAT(e.what(), testing::StartsWith("test"));
      }
    }
  }
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THAT(error_of([&] { decode_frame(bytes.substr(0, size), kParts, "test"); }), HasSubstr("test: damaged at"));
  }
  EXPECT_THAT(error_of([&] { decode_frame(bytes + "x", kParts, "test"); }), HasSubstr("expected the end"));
}

TEST(FrameCodec, RefusesTooLargePicturesBeforeAllocating) {
  std::string bytes = encode_frame({1, 2, random_labelled(3)}, kParts);
  const std::size_t width_at = 8 + 8 + 1 + 4 + random_labelled(3).frame.name.size() + 8;
  ASSERT_EQ(bytes[width_at], 37);
  bytes[width_at + 3] = '\x10';
  EXPECT_THAT(error_of([&] { decode_frame(bytes, kParts, "test"); }), HasSubstr("picture of 268435493x23"));
}

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

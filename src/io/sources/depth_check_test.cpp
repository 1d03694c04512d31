#include "io/sources/depth_check.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "io/files/stored_depth.h"
#include "io/files/test_files.h"
#include "io/sources/test_messages.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::put;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kMeta = R"({"fx": 130, "width": 160, "height": 120})";

/// A wall and a floor, 1.5 to 4 m away, with the noise of a sensor and some holes.
DepthImage room(std::uint64_t seed = 1) {
  Random rng(seed);
  DepthImage depth(160, 120);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double mm = v < 60 ? 4000.0 - 2.0 * u : 4000.0 - 2.0 * u - 35.0 * (v - 60);
      if (rng.below(10) != 0) depth(u, v) = static_cast<std::uint16_t>(mm + 9.0 * rng.uniform());
    }
  }
  return depth;
}

template <class Change>
DepthImage changed(DepthImage depth, Change change) {
  for (std::uint16_t& value : depth) value = static_cast<std::uint16_t>(change(value));
  return depth;
}

std::string folder_of(const TemporaryFolder& folder, const DepthImage& stored) {
  put(folder / "meta.json", kMeta);
  put(folder / "depth/0.png", encode_png(stored));
  return folder.path();
}

std::string tum_of(const TemporaryFolder& folder, const DepthImage& stored) {
  put(folder / "depth.txt", "1.5 depth/0.png\n");
  return folder_of(folder, stored);
}

/// Expects one note that names the flag, and no note and the depth of the room with `options`.
void expect_remedy(const std::string& uri, const std::string& flag, const SourceOptions& options,
                   const DepthImage& right = room()) {
  EXPECT_THAT(open_source(uri)->notes(), ElementsAre(HasSubstr(flag))) << uri;
  const auto source = open_source(uri, options);
  EXPECT_THAT(source->notes(), IsEmpty());
  EXPECT_EQ(source->next()->depth, right);
}

SourceOptions scaled(float scale) {
  SourceOptions options;
  options.depth_scale = scale;
  return options;
}

SourceOptions with_bits(DepthBits bits) {
  SourceOptions options;
  options.depth_bits = bits;
  return options;
}

TEST(DepthCheck, SaysNothingOfRooms) {
  const TemporaryFolder folder;
  const auto source = open_source(folder_of(folder, room()));
  EXPECT_THAT(source->notes(), IsEmpty());
  EXPECT_EQ(source->next()->depth, room()) << "what was looked at is given";
  EXPECT_FALSE(source->next());
  source->seek(0.0);
  EXPECT_EQ(source->next()->name, "0");
}

TEST(DepthCheck, SaysNothingOfTablesAndOfKinectsDepthOfTables) {
  const TemporaryFolder near, tum;
  EXPECT_THAT(open_source(folder_of(near, changed(room(), [](int mm) { return mm / 5; })))->notes(), IsEmpty());
  EXPECT_THAT(open_source(tum_of(tum, changed(room(), [](int mm) { return mm / 5 * 5; })))->notes(), IsEmpty());
}

TEST(DepthCheck, NamesTheScale) {
  const TemporaryFolder tum, tenths, centimetres;
  expect_remedy(tum_of(tum, room()), "--depth-scale 1000", scaled(1000.F));
  const DepthImage tenth = changed(room(), [](int mm) { return 10 * mm; });
  expect_remedy(folder_of(tenths, tenth), "--depth-scale 10000", scaled(10000.F));
  const DepthImage coarse = changed(room(), [](int mm) { return mm / 16; });  // of a smaller room
  expect_remedy(folder_of(centimetres, coarse), "--depth-scale 100", scaled(100.F),
                changed(coarse, [](int cm) { return 10 * cm; }));
}

/// Depth as a Kinect v1 gives it, by eighths of a pixel of disparity, of a deeper room.
DepthImage coarse_room() {
  return changed(room(),
                 [](int mm) { return mm == 0 ? 0 : int(std::lround(348000.0 / std::round(348000.0 / (1.5 * mm)))); });
}

TEST(DepthCheck, NamesAllScalesThatFit) {
  const TemporaryFolder fives, any;
  EXPECT_THAT(
      open_source(folder_of(fives, changed(room(), [](int mm) { return 7 * mm; })))->notes(),
      ElementsAre(HasSubstr("with --depth-scale 5000 (TUM), 10000, 4000 (Matterport) or 6553.5 (Replica) it is")));
  EXPECT_THAT(open_source(folder_of(any, changed(room(), [](int mm) { return 5 * mm; })))->notes(),
              ElementsAre(HasSubstr("with --depth-scale 5000 (TUM) it is a room's, 1.")))
      << "multiples of 5";
}

TEST(DepthCheck, KnowsCoarseUnitsByTheStepsOfTheCamera) {
  const TemporaryFolder centimetres, kitti, millimetres;
  EXPECT_THAT(open_source(folder_of(centimetres, changed(coarse_room(), [](int mm) { return mm / 10; })))->notes(),
              ElementsAre(HasSubstr("--depth-scale 100 (centimetres)")));
  EXPECT_THAT(open_source(folder_of(kitti, changed(coarse_room(), [](int mm) { return mm * 256 / 1000; })))->notes(),
              ElementsAre(HasSubstr("256 (KITTI) it is a room's")));
  EXPECT_THAT(open_source(folder_of(millimetres, coarse_room()))->notes(), IsEmpty());
}

TEST(DepthCheck, FloatsOfMetresBesideAScaleOfMillimetres) {
  const TemporaryFolder folder;
  std::string pfm = "Pf 160 120 -1\n";
  for (const std::uint16_t mm : room()) {
    const float metres = 1e-3F * mm;
    pfm.append(reinterpret_cast<const char*>(&metres), sizeof(metres));
  }
  put(folder / "meta.json", R"({"fx": 130, "depth_scale": 1000})");
  put(folder / "depth/0.pfm", pfm);
  EXPECT_THAT(open_source(folder.path())->notes(), ElementsAre(HasSubstr("--depth-scale 1 (metres)")));
}

TEST(DepthCheck, SeesSwappedBytesAndRotatedBits) {
  const TemporaryFolder swapped, rotated;
  const DepthImage other = changed(room(), [](int mm) { return mm << 8 | mm >> 8; });
  expect_remedy(folder_of(swapped, other), "--depth-bits swapped", with_bits(DepthBits::swapped));
  const DepthImage left = changed(room(), [](int mm) { return mm << 3 | mm >> 13; });
  expect_remedy(folder_of(rotated, left), "--depth-bits rotated", with_bits(DepthBits::rotated));
}

TEST(DepthCheck, SaysThatThereIsNoDepthAfterFiveFrames) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  for (int i = 0; i < 5; ++i) put(folder / "depth/" + std::to_string(i) + ".png", encode_png(DepthImage(160, 120)));
  EXPECT_THAT(open_source(folder.path())->notes(), ElementsAre(HasSubstr("hardly any depth")));
  put(folder / "depth/4.png", encode_png(room()));
  const auto source = open_source(folder.path());
  EXPECT_THAT(source->notes(), IsEmpty()) << "cameras may begin with empty frames";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(source->next()->name, std::to_string(i));
}

TEST(DepthCheck, KnowsTheRawDisparityOfKinects) {
  const TemporaryFolder folder;
  const auto raw = [](int mm) { return mm == 0 ? 2047 : int(1091.5 - 348000.0 / mm); };
  EXPECT_THAT(open_source(folder_of(folder, changed(room(), raw)))->notes(), ElementsAre(HasSubstr("disparity")));
}

TEST(DepthCheck, AFirstFrameThatCannotBeReadFailsWhenItIsAskedFor) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  put(folder / "depth/0.png", encode_png(DepthImage(160, 120)));
  put(folder / "depth/1.png", "no picture");
  put(folder / "depth/2.png", encode_png(room()));
  const auto source = open_source(folder.path());
  EXPECT_EQ(source->next()->name, "0");
  EXPECT_THAT(test::error_of([&] { source->next(); }), HasSubstr("1.png"));
  EXPECT_EQ(source->next()->name, "2");
}

/// Writes a recording of one picture with 32 or 16 bits a pixel.
template <class T>
std::string recording_of(const TemporaryFolder& folder, const std::string& encoding, double factor, bool big_endian,
                         bool says_so) {
  const DepthImage depth = room();
  std::string bytes;
  for (const std::uint16_t mm : depth) {
    const T value = static_cast<T>(factor * mm);
    std::string one(sizeof(T), '\0');
    std::memcpy(one.data(), &value, sizeof(T));
    if (big_endian) std::ranges::reverse(one);
    bytes += one;
  }
  PictureMessage picture;
  picture.time_ns = 1;
  picture.frame = "depth_frame";
  picture.width = depth.width();
  picture.height = depth.height();
  picture.encoding = encoding;
  picture.row_bytes = static_cast<std::uint32_t>(sizeof(T)) * static_cast<std::uint32_t>(depth.width());
  picture.big_endian = says_so;
  picture.data = bytes;
  const std::string path = folder / "r.mcap";
  test::Messages out(path);
  out.camera("/depth/camera_info", {160, 120, 130.F, 130.F, 80.F, 60.F});
  out.put("/depth/image", "sensor_msgs/msg/Image", 1, picture_message(picture));
  out.close();
  return path;
}

TEST(DepthCheck, FloatsOfMillimetresTakeAScale) {
  const TemporaryFolder folder, metres;
  expect_remedy(recording_of<float>(folder, "32FC1", 1.0, false, false), "--depth-scale 1000", scaled(1000.F));
  EXPECT_THAT(open_source(recording_of<float>(metres, "32FC1", 1e-3, false, false))->notes(), IsEmpty());
}

TEST(DepthCheck, SeesAByteOrderThatIsNotAsTheMessageSays) {
  const TemporaryFolder whole, lies, real, right;
  const SourceOptions swapped = with_bits(DepthBits::swapped);
  expect_remedy(recording_of<std::uint16_t>(whole, "16UC1", 1.0, true, false), "--depth-bits swapped", swapped);
  expect_remedy(recording_of<std::uint16_t>(lies, "16UC1", 1.0, false, true), "--depth-bits swapped", swapped);
  expect_remedy(recording_of<float>(real, "32FC1", 1e-3, true, false), "--depth-bits swapped", swapped);
  EXPECT_THAT(open_source(recording_of<std::uint16_t>(right, "16UC1", 1.0, true, true))->notes(), IsEmpty());
}

TEST(DepthCheck, BitsAreRestoredOneByOne) {
  for (int value = 0; value <= 0xFFFF; value += 7) {
    const auto rotated = std::rotl(static_cast<std::uint16_t>(value), 3);
    EXPECT_EQ(restored(rotated, DepthBits::rotated), value);
    EXPECT_EQ(restored(restored(static_cast<std::uint16_t>(value), DepthBits::swapped), DepthBits::swapped), value);
  }
}

TEST(OpenSource, SaysHowFramesAreTurned) {
  const TemporaryFolder folder;
  const std::string uri = folder_of(folder, room());
  EXPECT_FALSE(open_source(uri)->next()->quarter_turns);
  SourceOptions options;
  options.turn = 270;
  const auto source = open_source(uri, options);
  const Frame frame = *source->next();
  EXPECT_EQ(frame.quarter_turns, 3);
  EXPECT_EQ(frame.depth, room()) << "it stays as it is";
  EXPECT_EQ(source->size(), 1);
  options.turn = 45;
  EXPECT_THAT(test::error_of([&] { open_source(uri, options); }), HasSubstr("0, 90, 180 or 270"));
}

}  // namespace
}  // namespace vesalius

#include <gmock/gmock.h>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "io/recordings/recording_formats.h"
#include "io/recordings/test_k4a.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 320, kHeight = 288, kColourWidth = 64, kColourHeight = 36;

/// Returns the bytes of a number, the highest first, without zeros before it.
std::string big_endian(std::uint64_t value, std::size_t least = 1) {
  std::string bytes;
  for (; value != 0 || bytes.size() < least; value >>= 8U)
    bytes.insert(bytes.begin(), static_cast<char>(value & 0xFFU));
  return bytes;
}

std::string element(std::uint64_t id, const std::string& content) {
  std::string size = big_endian(content.size(), 8);
  size[0] = '\x01';
  return big_endian(id) + size + content;
}
std::string element(std::uint64_t id, std::uint64_t number) { return element(id, big_endian(number)); }

/// A file as the recorder of Azure Kinects lays it out; tests/recordings has such as ffmpeg writes.
struct Mkv {
  std::string calibration = test::k4a_json();
  bool has_infrared = false, knows_size = true;
  std::string clusters;

  static std::string track(int number, int type, const std::string& name, const std::string& codec,
                           const std::string& fourcc, int width, int height) {
    std::string entry = element(0xD7, number) + element(0x73C5, 100 + number) + element(0x83, type) +
                        element(0x536E, name) + element(0x86, codec);
    if (width > 0) {
      ByteWriter header;
      for (const std::uint32_t value : {40, width, height}) header.number(value);
      header.number(std::uint16_t{1});
      header.number(std::uint16_t{16});
      header.bytes() += fourcc;
      for (int i = 0; i < 5; ++i) header.number(std::uint32_t{0});
      entry += element(0x63A2, header.bytes()) + element(0xE0, element(0xB0, width) + element(0xBA, height));
    }
    return element(0xAE, entry);
  }

  void add(int track, int time_ms, const std::string& packet) {
    const std::string block =
        std::string("\x80", 1).replace(0, 1, 1, static_cast<char>(0x80 | track)) + std::string("\0\0\x80", 3) + packet;
    clusters +=
        element(0x1F43B675, element(0xE7, std::uint64_t{1000} * static_cast<unsigned>(time_ms)) + element(0xA3, block));
  }

  std::string bytes() const {
    const std::string info = element(0x1549A966, element(0x2AD7B1, 1000));  // times are microseconds
    std::string tracks = track(1, 1, "COLOR", "V_MS/VFW/FOURCC", "BGRA", kColourWidth, kColourHeight);
    if (has_infrared) tracks += track(4, 1, "IR", "V_MS/VFW/FOURCC", "b16g", kWidth, kHeight);
    tracks +=
        track(2, 1, "DEPTH", "V_MS/VFW/FOURCC", "b16g", kWidth, kHeight) + track(3, 17, "IMU", "S_K4A/IMU", "", 0, 0);
    const std::string file = element(0x466E, "calibration.json") + element(0x4660, "application/octet-stream") +
                             element(0x46AE, 7) + element(0x465C, calibration);
    const std::string tag =
        element(0x63C0, "") + element(0x67C8, element(0x45A3, "K4A_START_OFFSET_NS") + element(0x4487, "2000000000"));
    const std::string segment = info + element(0x1654AE6B, tracks) + element(0x1941A469, element(0x61A7, file)) +
                                element(0x1254C367, element(0x7373, tag)) + clusters;
    std::string head =
        element(0x1A45DFA3, element(0x4286, 1) + element(0x42F7, 1) + element(0x42F2, 4) + element(0x42F3, 8) +
                                element(0x4282, "matroska") + element(0x4287, 4) + element(0x4285, 2));
    if (knows_size) return head + element(0x18538067, segment);
    return head + big_endian(0x18538067) + "\x01" + std::string(7, '\xFF') + segment;
  }
};

DepthImage depth_of(int i) {
  DepthImage depth(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) depth(u, v) = static_cast<std::uint16_t>(u == v ? 0 : 1000 + 300 * i + u + v);
  }
  return depth;
}

ColourImage colour_of(int i) {
  ColourImage colour(kColourWidth, kColourHeight);
  for (int v = 0; v < kColourHeight; ++v) {
    for (int u = 0; u < kColourWidth; ++u) {
      colour(u, v) = {static_cast<std::uint8_t>(4 * u), static_cast<std::uint8_t>(7 * v),
                      static_cast<std::uint8_t>(20 * i)};
    }
  }
  return colour;
}

std::string packet(const DepthImage& depth) {
  std::string bytes;
  for (const std::uint16_t z : depth) bytes += big_endian(z, 2);
  return bytes;
}

std::string packet(const ColourImage& colour) {
  std::string bytes;
  for (const Rgb& c : colour) bytes += {static_cast<char>(c.b), static_cast<char>(c.g), static_cast<char>(c.r), '\xFF'};
  return bytes;
}

std::string measured(std::uint64_t time_ns, const Eigen::Vector3f& m_s2) {
  ByteWriter out;
  out.number(time_ns);
  for (const float axis : m_s2) out.real(axis);
  out.number(time_ns);
  for (int i = 0; i < 3; ++i) out.real(0.F);
  return out.bytes();
}

Mkv five_frames() {
  Mkv file;
  for (int i = 0; i < 5; ++i) {
    file.add(3, 33 * i, measured(2'000'000'000U + 33'000'000U * static_cast<unsigned>(i) - 1, {0.F, 0.F, -9.8F}));
    file.add(1, 33 * i + 1, packet(colour_of(i)));
    file.add(2, 33 * i, packet(depth_of(i)));
  }
  return file;
}

class MkvRecording : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_mkv()) GTEST_SKIP() << "built without libavformat";
  }
  std::string put(const Mkv& file) const { return test::put(folder_ / "a.mkv", file.bytes()); }

  test::TemporaryFolder folder_;
  const Camera camera_{kWidth, kHeight, 256.F, 245.76F, 164.62F, 160.38F};
};

TEST_F(MkvRecording, GivesFramesWithColourAndUp) {
  const auto source = open_source(put(five_frames()));
  EXPECT_THAT(source->notes(), IsEmpty());
  const LensCamera colour_camera{{kColourWidth, kColourHeight, 28.8F, 28.8F, 31.5F, 18.46F}, {}};
  const ColourRegistration registration(camera_, colour_camera, Eigen::Isometry3d(Eigen::Translation3d(-0.032, 0, 0)));
  for (int i = 0; i < 5; ++i) {
    const std::optional<Frame> frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_DOUBLE_EQ(frame->time_s.value(), 2.0 + 0.033 * i);
    EXPECT_NEAR(frame->camera.fy, camera_.fy, 1e-3);
    EXPECT_NEAR(frame->camera.cy, camera_.cy, 1e-3);
    EXPECT_EQ(frame->depth, depth_of(i));
    const ColourImage should = registration(frame->depth, colour_of(i));
    int differ = 0;
    for (std::size_t p = 0; p < should.size(); ++p) {
      differ += std::abs(frame->colour[p].r - should[p].r) + std::abs(frame->colour[p].g - should[p].g) > 2 ? 1 : 0;
    }
    EXPECT_LT(differ, 100) << "of " << should.size();
    EXPECT_LT((frame->up.value() - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6F);
  }
  EXPECT_FALSE(source->next());
}

TEST_F(MkvRecording, UndoesTheLensOfDepth) {
  test::K4aText text;
  text.depth_lens = "0.5,-0.2,0.1,0.7,-0.1,0,0,0,0.001,-0.002";
  Mkv file = five_frames();
  file.calibration = test::k4a_json(text);
  const Frame frame = *open_source(put(file))->next();
  const Lens lens = make_lens("rational_polynomial", {0.5, -0.2, -0.002, 0.001, 0.1, 0.7, -0.1, 0}).value();
  EXPECT_EQ(frame.depth, Rectification({frame.camera, lens}, frame.camera).depth(depth_of(0)));
}

TEST_F(MkvRecording, SeeksByTime) {
  const auto source = open_source(put(five_frames()));
  const std::optional<TimeSpan> span = source->span();
  ASSERT_TRUE(span);
  EXPECT_DOUBLE_EQ(span->first_s, 2.0);
  EXPECT_DOUBLE_EQ(span->last_s, 2.132);
  source->seek(2.05);
  EXPECT_EQ(source->next()->depth, depth_of(2));
  source->seek(0.0);
  EXPECT_EQ(source->next()->depth, depth_of(0));
  source->seek(3.0);
  EXPECT_FALSE(source->next());
}

TEST_F(MkvRecording, CutShortGivesItsWholeFramesAndOneNote) {
  const std::string whole = five_frames().bytes();
  const std::size_t frame = packet(depth_of(0)).size() + packet(colour_of(0)).size();
  test::put(folder_ / "cut.mkv", whole.substr(0, whole.size() - frame * 3 / 2));
  const auto source = open_source(folder_ / "cut.mkv");
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("cut short at byte ")));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(source->next()->depth, depth_of(i));
  EXPECT_FALSE(source->next());
}

TEST_F(MkvRecording, WithoutAnEndSaysSo) {
  Mkv file = five_frames();
  file.knows_size = false;
  const auto source = open_source(put(file));
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("has no end")));
  int frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, 5);
}

TEST_F(MkvRecording, GoesOnAfterAFrameThatIsDamaged) {
  Mkv file;
  file.add(2, 0, packet(depth_of(0)));
  file.add(2, 33, packet(depth_of(1)).substr(0, 1000));
  file.add(2, 66, packet(depth_of(2)));
  const auto source = open_source(put(file));
  EXPECT_EQ(source->next()->depth, depth_of(0));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("320x288 16UC1 with 1000 bytes"));
  EXPECT_EQ(source->next()->depth, depth_of(2));
}

TEST_F(MkvRecording, TakesInfraredForNoDepth) {
  Mkv file;
  file.has_infrared = true;
  file.add(4, 0, packet(depth_of(1)));
  file.add(2, 0, packet(depth_of(0)));
  EXPECT_EQ(open_source(put(file))->next()->depth, depth_of(0));
}

TEST_F(MkvRecording, NamesWhatIsWrong) {
  Mkv file;
  file.calibration = "{}";
  file.add(2, 0, packet(depth_of(0)));
  EXPECT_THAT(error_of([&] { open_source(put(file)); }),
              HasSubstr("a.mkv: calibration.json: no \"CalibrationInformation\""));
  test::put(folder_ / "b.mkv", "\x1A\x45\xDF\xA3 and nothing of the kind");
  EXPECT_THAT(error_of([&] { open_source(folder_ / "b.mkv"); }), HasSubstr("b.mkv: not Matroska that can be read"));
}

TEST(OpenMkv, IsOpenedOrNamesThePackage) {
  if (has_mkv()) GTEST_SKIP() << "built with libavformat";
  EXPECT_THAT(error_of([&] { open_mkv("a.mkv"); }), HasSubstr("libavformat-dev"));
}

}  // namespace
}  // namespace vesalius

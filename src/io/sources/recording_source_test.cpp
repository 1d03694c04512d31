#include "io/sources/recording_source.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/frame_recorder.h"
#include "io/sources/test_bag.h"
#include "io/sources/test_messages.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::Messages;
using test::random_frame;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Frame> all_of(FrameSource& source) {
  std::vector<Frame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::string record(const std::string& path, const std::vector<Frame>& frames) {
  FrameRecorder recorder(path, 30.0);
  for (const Frame& frame : frames) recorder.write(frame);
  recorder.close();
  return path;
}

constexpr std::int64_t kMs = 1'000'000;

TEST(RecordingSource, GivesBackFramesAsTheyWereRecorded) {
  const test::TemporaryFolder folder;
  std::vector<Frame> frames;
  for (int i = 0; i < 50; ++i) {
    frames.push_back(random_frame("f", static_cast<std::uint64_t>(i)));
    frames.back().time_s = 3.0 + 0.25 * i;
    if (i % 3 != 0) frames.back().up = Eigen::Vector3f(0.1F, -1.F, 0.02F * static_cast<float>(i)).normalized();
  }
  const auto source = open_source(record(folder / "a.mcap", frames));
  EXPECT_EQ(source->size(), 50);
  EXPECT_THAT(source->notes(), IsEmpty());
  const std::vector<Frame> back = all_of(*source);
  ASSERT_EQ(back.size(), frames.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].depth, frames[i].depth);
    EXPECT_EQ(back[i].colour, frames[i].colour);
    EXPECT_EQ(back[i].camera, frames[i].camera);
    EXPECT_EQ(back[i].time_s, frames[i].time_s);
    ASSERT_EQ(back[i].up.has_value(), frames[i].up.has_value()) << i;
    const Eigen::Vector3f none(0.F, 0.F, 0.F);
    EXPECT_LT((back[i].up.value_or(none) - frames[i].up.value_or(none)).norm(), 2e-7F) << i;
  }
  EXPECT_EQ(back[1].name, "3.250000000");
}

TEST(RecordingSource, GivesTimesToFramesWithout) {
  const test::TemporaryFolder folder;
  const auto source = open_source(record(folder / "a.mcap", {random_frame("a", 1), random_frame("b", 2)}));
  EXPECT_EQ(source->next()->name, "0.000000000");
  EXPECT_EQ(source->next()->name, "0.033333333");
}

TEST(RecordingSource, TakesTheColourNearestInTime) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1), b = random_frame("b", 2), c = random_frame("c", 3);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  out.depth("/depth/image", 1000 * kMs, a);
  out.depth("/depth/image", 1033 * kMs, b);  // comes before the colour of the first
  out.colour("/rgb/image", 1010 * kMs, a);
  out.colour("/rgb/image", 1030 * kMs, b);
  out.depth("/depth/image", 1200 * kMs, c);  // no colour within 50 ms
  out.colour("/rgb/image", 1300 * kMs, c);
  out.close();
  const std::vector<Frame> frames = all_of(*open_source(folder / "a.mcap"));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].colour, a.colour);
  EXPECT_EQ(frames[1].colour, b.colour);
  EXPECT_TRUE(frames[2].colour.empty());
}

TEST(RecordingSource, TakesColourThatStandsFarFromDepthInTheFile) {
  constexpr int kFrames = 70;
  for (const bool depth_first : {true, false}) {
    const test::TemporaryFolder folder;
    Messages out(folder / "a.mcap");
    const auto frame_of = [](int i) { return random_frame("f", static_cast<std::uint64_t>(i)); };
    out.camera("/depth/camera_info", frame_of(0).camera);
    for (const bool is_depth : {depth_first, !depth_first}) {
      for (int i = 0; i < kFrames; ++i) {
        is_depth ? out.depth("/depth/image", 33 * i * kMs, frame_of(i))
                 : out.colour("/rgb/image", (33 * i + 1) * kMs, frame_of(i));
      }
    }
    out.close();
    const auto source = open_source(folder / "a.mcap");
    EXPECT_THAT(source->notes(), IsEmpty());
    const std::vector<Frame> frames = all_of(*source);
    ASSERT_EQ(frames.size(), std::size_t{kFrames});
    for (int i = 0; i < kFrames; ++i) EXPECT_EQ(frames[std::size_t(i)].colour, frame_of(i).colour) << i;
    source->seek(1.0);
    const auto later = source->next();
    ASSERT_TRUE(later);
    EXPECT_EQ(later->colour, frame_of(31).colour) << later->name;
  }
}

TEST(RecordingSource, MessagesInAnotherOrderThanTheirTimesAreOnOneClock) {
  const Frame a = random_frame("a", 1);
  for (const bool falling : {true, false}) {  // or the second half before the first
    const test::TemporaryFolder folder;
    Messages out(folder / "a.mcap");
    out.camera("/depth/camera_info", a.camera);
    for (int i = 0; i < 20; ++i) {
      const std::int64_t time_ns = 33 * kMs * (falling ? 20 - i : 1 + (i + 10) % 20);
      out.depth("/depth/image", time_ns, a);
      out.colour("/rgb/image", time_ns + kMs, a);
    }
    out.close();
    const auto source = open_source(folder / "a.mcap");
    EXPECT_THAT(source->notes(), IsEmpty()) << falling;
    const auto without = [](const Frame& frame) { return frame.colour.empty(); };
    EXPECT_LE(std::ranges::count_if(all_of(*source), without), 1) << "that after a jump back";
  }
}

TEST(RecordingSource, ABagWithZerosBetweenItsChunksLosesOne) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  test::Bag bag;
  for (int i = 0; i < 3; ++i) {
    ByteWriter image;
    for (const int word : {0, 0, i, 0, a.depth.height(), a.depth.width()}) image.number(word);
    image.text("16UC1");
    image.number(std::uint8_t{0});
    image.number(2 * a.depth.width());
    image.text({reinterpret_cast<const char*>(a.depth.data()), 2 * a.depth.size()});
    bag.put("/depth/image", "sensor_msgs/Image", i + 1, image.bytes());
    bag.end_chunk();
  }
  std::vector<std::size_t> places;
  std::string bytes = bag.closed(places);
  const std::string whole = bytes;
  std::fill_n(bytes.begin() + std::ptrdiff_t(places[1]), 60, '\0');
  SourceOptions options;
  options.fx = 40.F;
  auto source = open_source(test::put(folder / "a.bag", bytes), options);
  EXPECT_EQ(source->next()->name, "0.000000001");
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr(fmt::format("a.bag: damaged at byte {}", places[1])));
  EXPECT_TRUE(source->next());
  EXPECT_FALSE(source->next());
  bytes = whole;
  std::fill_n(bytes.begin() + std::ptrdiff_t(bytes.find("type=")), 5, '\0');
  EXPECT_THAT(error_of([&] { open_source(test::put(folder / "b.bag", bytes), options); }), HasSubstr("b.bag: no depth"))
      << "nobody knows the topic";
  bytes = whole;
  std::fill_n(bytes.begin() + std::ptrdiff_t(bytes.find("op=\2")) - 4, 9, '\0');
  source = open_source(test::put(folder / "a.bag", bytes), options);
  EXPECT_THAT(error_of([&] { source->next(); }),
              HasSubstr(fmt::format("a.bag: damaged in the chunk that ends at byte {}", places[1])));
  EXPECT_TRUE(source->next());
}

TEST(RecordingSource, BearsColourAnyTimeAway) {
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  const Frame a = random_frame("a", 1);
  for (const auto& [depth_ns, colour_ns] : {std::pair(kLast, kFirst), {kFirst, kLast}, {kFirst, kFirst + 1}}) {
    const test::TemporaryFolder folder;
    Messages out(folder / "a.mcap");
    out.camera("/depth/camera_info", a.camera);
    // Headers without a time: that of the recording counts.
    out.put("/rgb/image", "sensor_msgs/msg/Image", colour_ns, colour_message(a.colour, 0, "depth_frame"));
    out.put("/depth/image", "sensor_msgs/msg/Image", depth_ns, depth_message(a.depth, 0, "depth_frame"));
    out.close();
    const std::vector<Frame> frames = all_of(*open_source(folder / "a.mcap"));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].depth, a.depth);
    EXPECT_EQ(frames[0].colour.empty(), colour_ns != kFirst + 1);
  }
}

TEST(RecordingSource, LeavesOutColourOfAnotherPlaceAndSaysSo) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  out.depth("/depth/image", 0, a);
  out.colour("/rgb/image", 0, a, "rgb_frame");
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("no colour, since /rgb/image is not registered to /depth/image")));
  EXPECT_TRUE(source->next()->colour.empty());
  SourceOptions options;
  options.colour_topic = "/rgb/image";
  EXPECT_EQ(open_source(folder / "a.mcap", options)->next()->colour, a.colour);
}

TEST(RecordingSource, PrefersDepthRegisteredToColour) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1), b = random_frame("b", 2, 40, 30);
  Messages out(folder / "a.mcap");
  out.camera("/camera/depth/camera_info", a.camera, "depth_frame");
  out.camera("/camera/aligned_depth_to_color/camera_info", b.camera, "color_frame");
  out.depth("/camera/depth/image_rect_raw", 0, a);
  out.depth("/camera/aligned_depth_to_color/image_raw", 0, b, "color_frame");
  out.colour("/camera/color/image_raw", 0, b, "color_frame");
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("there is also /camera/depth/image_rect_raw")));
  const Frame frame = *source->next();
  EXPECT_EQ(frame.depth, b.depth);
  EXPECT_EQ(frame.colour, b.colour);
  EXPECT_EQ(frame.camera, b.camera);
  SourceOptions options;
  options.depth_topic = "/camera/depth/image_rect_raw";
  EXPECT_EQ(open_source(folder / "a.mcap", options)->next()->camera, a.camera);
}

TEST(RecordingSource, SaysWhatItMisses) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages colour_alone(folder / "colour.mcap");
  colour_alone.colour("/rgb/image", 0, a);
  colour_alone.close();
  EXPECT_THAT(error_of([&] { open_source(folder / "colour.mcap"); }),
              AllOf(HasSubstr("colour.mcap"), HasSubstr("no depth, expected a topic")));
  Messages no_camera(folder / "depth.mcap");
  no_camera.depth("/depth/image", 0, a);
  no_camera.close();
  EXPECT_THAT(error_of([&] { open_source(folder / "depth.mcap"); }), HasSubstr("no intrinsics"));
  SourceOptions options;
  options.fx = 50.F;
  EXPECT_EQ(open_source(folder / "depth.mcap", options)->next()->camera.fx, 50.F);
  options.depth_topic = "/other";
  EXPECT_THAT(error_of([&] { open_source(folder / "depth.mcap", options); }),
              AllOf(HasSubstr("/other"), HasSubstr("expected /depth/image")));
}

TEST(RecordingSource, GoesOnAfterAFrameThatIsDamaged) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  out.depth("/depth/image", 0, a);
  out.put("/depth/image", "sensor_msgs/msg/Image", kMs, depth_message(a.depth, kMs, "depth_frame").substr(0, 200));
  out.depth("/depth/image", 2 * kMs, random_frame("b", 2, 20, 10));
  out.depth("/depth/image", 3 * kMs, a);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  EXPECT_EQ(source->next()->name, "0.000000000");
  EXPECT_THAT(error_of([&] { source->next(); }),
              AllOf(HasSubstr("a.mcap"), HasSubstr("a message ends within the picture")));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("20x10 pixels, expected 37x23 as before"));
  EXPECT_EQ(source->next()->name, "0.003000000");
  EXPECT_FALSE(source->next());
}

/// Expects `source` to give `frames` from number `first` on, at most `most` of them.
void expect_rest(FrameSource& source, const std::vector<Frame>& frames, std::size_t first, std::size_t most) {
  for (std::size_t i = first; i < std::min(frames.size(), first + most); ++i) {
    const auto frame = source.next();
    ASSERT_TRUE(frame) << i;
    ASSERT_EQ(frame->name, frames[i].name);
    ASSERT_EQ(frame->time_s, frames[i].time_s);
    ASSERT_EQ(frame->depth, frames[i].depth) << i;
    ASSERT_EQ(frame->colour, frames[i].colour) << i;
  }
  if (first + most >= frames.size()) {
    ASSERT_FALSE(source.next());
  }
}

/// Expects every frame, and moments beside it, to be found, in an order that goes back and forth.
void expect_seeks(const std::string& path) {
  const std::vector<Frame> frames = all_of(*open_source(path));
  ASSERT_FALSE(frames.empty());
  const auto source = open_source(path);
  ASSERT_TRUE(source->span());
  EXPECT_EQ(source->span()->first_s, *frames.front().time_s);
  EXPECT_EQ(source->span()->last_s, *frames.back().time_s);
  const auto not_before = [&](double time_s) {
    const auto found = std::ranges::find_if(frames, [&](const Frame& f) { return *f.time_s >= time_s; });
    return static_cast<std::size_t>(found - frames.begin());
  };
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double time_s = *frames[k * 7 % frames.size()].time_s;
    for (const double to_s : {time_s, time_s + 1e-3, time_s - 1e-3}) {
      source->seek(to_s);
      expect_rest(*source, frames, not_before(to_s), 4);
    }
  }
  for (const double to_s : {-1e300, 0.0, std::nan("")}) {
    source->seek(to_s);
    expect_rest(*source, frames, 0, frames.size());
  }
  source->seek(*frames[frames.size() / 3].time_s);
  expect_rest(*source, frames, not_before(*frames[frames.size() / 3].time_s), frames.size());
  for (const double to_s : {*frames.back().time_s + 1e-3, 1e300}) {
    source->seek(to_s);
    EXPECT_FALSE(source->next());
  }
}

/// Depth 30 times and colour 23 times a second, each written late by a share of its own, half an hour after it was
/// taken by a clock that runs `drift` faster.
void record_two_rates(const std::string& path, int first, int last, double drift) {
  Messages out(path);
  const Frame any = random_frame("a", 1);
  const auto recorded = [drift](std::int64_t taken_ns) {
    return static_cast<std::int64_t>(1.8e12) + static_cast<std::int64_t>(static_cast<double>(taken_ns) * drift);
  };
  struct Picture {
    std::int64_t recorded_ns, taken_ns;
    bool is_depth;
  };
  std::vector<Picture> pictures;
  Random rng(7);
  for (std::int64_t taken_ns = first * 1000 * kMs; taken_ns < last * 1000 * kMs; taken_ns += 1000 * kMs / 30)
    pictures.push_back({recorded(taken_ns) + rng.below(20) * kMs, taken_ns, true});
  for (std::int64_t taken_ns = first * 1000 * kMs + 5 * kMs; taken_ns < last * 1000 * kMs; taken_ns += 1000 * kMs / 23)
    pictures.push_back({recorded(taken_ns) + (30 + rng.below(40)) * kMs, taken_ns, false});
  std::ranges::sort(pictures, {}, &Picture::recorded_ns);
  out.put("/depth/camera_info", "sensor_msgs/msg/CameraInfo", pictures.front().recorded_ns,
          calibration_message(any.camera, 0, "depth_frame"));
  for (const auto& [recorded_ns, taken_ns, is_depth] : pictures) {
    const Frame frame = random_frame("f", static_cast<std::uint64_t>(taken_ns));
    out.put(is_depth ? "/depth/image" : "/rgb/image", "sensor_msgs/msg/Image", recorded_ns,
            is_depth ? depth_message(frame.depth, taken_ns, "depth_frame")
                     : colour_message(frame.colour, taken_ns, "depth_frame"));
  }
  out.close();
}

TEST(RecordingSource, SeeksToEveryFrame) {
  const test::TemporaryFolder folder;
  record_two_rates(folder / "a.mcap", 10, 15, 1.0);
  const std::vector<Frame> frames = all_of(*open_source(folder / "a.mcap"));
  EXPECT_EQ(frames.size(), 151U);
  EXPECT_GT(std::ranges::count_if(frames, [](const Frame& f) { return !f.colour.empty(); }), 140);
  expect_seeks(folder / "a.mcap");
}

TEST(RecordingSource, SeeksInARecordingCutShort) {
  const test::TemporaryFolder folder;
  record_two_rates(folder / "a.mcap", 10, 14, 1.0);
  const std::string bytes = test::get(folder / "a.mcap");
  test::put(folder / "cut.mcap", bytes.substr(0, bytes.size() * 4 / 5));
  expect_seeks(folder / "cut.mcap");
}

TEST(RecordingSource, SeeksWhereTheClocksDrift) {
  const test::TemporaryFolder folder;
  for (const double drift : {0.5, 1.5}) {
    const std::string path = folder / (std::to_string(drift) + ".mcap");
    record_two_rates(path, 100, 104, drift);
    expect_seeks(path);
  }
}

TEST(RecordingSource, SeeksInAFolderOfSeveralFiles) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "bag");
  test::put(folder / "bag/metadata.yaml", "");
  for (int i = 0; i < 3; ++i)
    record_two_rates(folder / ("bag/" + std::to_string(i) + ".mcap"), 10 + 2 * i, 12 + 2 * i, 1.0);
  expect_seeks(folder / "bag");
}

TEST(RecordingSource, NamesFramesOfOneTimeAlikeAfterASeek) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  for (const std::int64_t time_ns : {kMs, 2 * kMs, 2 * kMs, 2 * kMs, 3 * kMs}) out.depth("/depth/image", time_ns, a);
  out.close();
  const auto source = open_source(folder / "a.mcap");
  source->seek(0.002);
  std::vector<std::string> names;
  for (const Frame& frame : all_of(*source)) names.push_back(frame.name);
  EXPECT_THAT(names, ElementsAre("0.002000000", "0.002000000_2", "0.002000000_3", "0.003000000"));
}

TEST(RecordingSource, NamesThousandsOfFramesOfOneTimeShortlyAndSoon) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 2, 2);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", {2, 2, 4.F, 4.F, 0.5F, 0.5F});
  constexpr int kMany = 20'000;
  for (int i = 0; i < kMany; ++i)
    out.put("/depth/image", "sensor_msgs/msg/Image", i * kMs, depth_message(a.depth, 5 * kMs, "depth_frame"));
  out.close();
  const std::clock_t start = std::clock();
  const auto source = open_source(folder / "a.mcap");
  std::set<std::string> names;
  while (const auto frame = source->next()) names.insert(frame->name);
  EXPECT_EQ(names.size(), kMany);
  EXPECT_TRUE(names.contains("0.005000000_20000"));
  EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 10.0);
}

TEST(RecordingSource, SeekPassesOverDamageBeforeItAlone) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Messages out(folder / "a.mcap");
  out.camera("/depth/camera_info", a.camera);
  for (int i = 0; i < 6; ++i) {
    const std::string message = depth_message(a.depth, i * kMs, "depth_frame");
    out.put("/depth/image", "sensor_msgs/msg/Image", i * kMs, i % 3 == 1 ? message.substr(0, 200) : message);
  }
  out.close();
  const auto source = open_source(folder / "a.mcap");
  source->seek(0.003);
  EXPECT_EQ(source->next()->name, "0.003000000");
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("a message ends within the picture"));
  EXPECT_EQ(source->next()->name, "0.005000000");
  source->seek(0.004);
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("a message ends within the picture"));
  EXPECT_EQ(source->next()->name, "0.005000000");
}

/// Written by the tools of others from pictures worked out below (tests/recordings/other_side.py --fixtures).
class Fixtures : public testing::TestWithParam<const char*> {};

TEST_P(Fixtures, AreReadAsTheyWereMade) {
  const auto source = open_source(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_recording/" + GetParam());
  EXPECT_EQ(source->size(), 3);
  const std::vector<Frame> frames = all_of(*source);
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const Frame& frame = frames[static_cast<std::size_t>(i)];
    ASSERT_EQ(frame.depth.width(), 16);
    ASSERT_EQ(frame.depth.height(), 12);
    ASSERT_TRUE(frame.colour.same_size(frame.depth));
    EXPECT_EQ(frame.camera, (Camera{16, 12, 14.5F, 15.F, 7.5F, 5.5F}));
    for (int v = 0; v < 12; ++v) {
      for (int u = 0; u < 16; ++u) {
        ASSERT_EQ(frame.depth(u, v), u == v ? 0 : 1000 + 100 * i + 10 * v + u) << u << " " << v;
        ASSERT_EQ(frame.colour(u, v), (Rgb{static_cast<std::uint8_t>(10 * u), static_cast<std::uint8_t>(20 * v), 7}));
      }
    }
  }
  EXPECT_EQ(frames[1].name, "1700000000.033000000");
}

TEST_P(Fixtures, AreSeekable) { expect_seeks(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_recording/" + GetParam()); }

INSTANTIATE_TEST_SUITE_P(OfOthers, Fixtures,
                         testing::Values("plain.bag", "bz2.bag", "lz4.bag", "plain.db3", "zstd.db3", "zstd.mcap",
                                         "lz4.mcap", "loose.mcap", "foxglove.mcap"));

}  // namespace
}  // namespace vesalius

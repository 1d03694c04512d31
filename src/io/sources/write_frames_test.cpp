#include "io/sources/write_frames.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "io/files/test_files.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::get;
using test::put;
using test::random_frame;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Frame> sample_frames() { return {random_frame("a1", 1), random_frame("a2", 2), random_frame("a10", 3)}; }

void write_all(FrameFormat format, const std::string& folder, const std::vector<Frame>& frames,
               WriteOptions options = {}) {
  if (!options.frame_rate) options.frame_rate = 30.F;
  const auto writer = make_frame_writer(format, folder, options);
  for (const Frame& frame : frames) writer->write(frame);
  writer->close();
}

std::vector<Frame> read_all(const std::string& folder) {
  const auto source = open_source(folder);
  EXPECT_THAT(source->notes(), IsEmpty());
  std::vector<Frame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  return frames;
}

void expect_same_pictures(const std::vector<Frame>& got, const std::vector<Frame>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].depth, expected[i].depth) << i;
    EXPECT_EQ(got[i].colour, expected[i].colour) << i;
    EXPECT_EQ(got[i].camera, expected[i].camera) << i;
  }
}

TEST(WriteFrames, ConvertsEveryFormatToEveryOtherWithoutLoss) {
  const TemporaryFolder folder;
  const std::vector<Frame> frames = sample_frames();
  constexpr FrameFormat kFormats[] = {FrameFormat::folder, FrameFormat::tum};
  for (const FrameFormat from : kFormats) {
    for (const FrameFormat to : kFormats) {
      const std::string base = folder / (std::to_string(static_cast<int>(from)) + std::to_string(static_cast<int>(to)));
      write_all(from, base + "/from", frames);
      const std::vector<Frame> between = read_all(base + "/from");
      expect_same_pictures(between, frames);
      write_all(to, base + "/to", between);
      const std::vector<Frame> back = read_all(base + "/to");
      expect_same_pictures(back, frames);
      for (std::size_t i = 0; i < back.size() && to != FrameFormat::tum; ++i) EXPECT_EQ(back[i].name, between[i].name);
    }
  }
}

TEST(WriteFrames, WritesFramesWithoutColour) {
  const TemporaryFolder folder;
  const std::vector<Frame> frames = {random_frame("a", 1, 20, 10, false)};
  for (const FrameFormat format : {FrameFormat::folder, FrameFormat::tum}) {
    const std::string out = folder / std::to_string(static_cast<int>(format));
    write_all(format, out, frames);
    expect_same_pictures(read_all(out), frames);
    EXPECT_FALSE(fs::exists(out + "/rgb"));
  }
}

TEST(WriteFrames, KeepsTimesInTum) {
  const TemporaryFolder folder;
  std::vector<Frame> frames = sample_frames();
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].time_s = 1305031102.160407 + static_cast<double>(i);
  write_all(FrameFormat::tum, folder / "out", frames);
  const std::vector<Frame> back = read_all(folder / "out");
  EXPECT_EQ(back[0].name, "1305031102.160407");
  EXPECT_EQ(back[2].time_s, 1305031104.160407);
  EXPECT_THAT(get(folder / "out/depth.txt"), HasSubstr("\n1305031102.160407 depth/1305031102.160407.png\n"));
}

TEST(WriteFrames, RefusesTumWithoutTimes) {
  const TemporaryFolder folder;
  const auto writer = make_frame_writer(FrameFormat::tum, folder / "out");
  EXPECT_THAT(error_of([&] { writer->write(random_frame("a", 1)); }), HasSubstr("frame a has no time"));
  WriteOptions options;
  options.frame_rate = 10.F;
  write_all(FrameFormat::tum, folder / "rated", sample_frames(), options);
  const std::vector<Frame> rated = read_all(folder / "rated");
  EXPECT_EQ(rated.at(0).time_s, 0.0);
  EXPECT_EQ(rated.at(2).time_s, 0.2);
}

TEST(WriteFrames, NumbersFramesOfOneName) {
  const TemporaryFolder folder;
  std::vector<Frame> frames;
  for (const char* name : {"a", "a_2", "a", "b", "a"}) frames.push_back(random_frame(name, frames.size()));
  write_all(FrameFormat::folder, folder / "out", frames);
  std::vector<std::string> names;
  for (const Frame& frame : read_all(folder / "out")) names.push_back(frame.name);
  EXPECT_THAT(names, testing::ElementsAre("a", "a_2", "a_3", "a_4", "b"));
  for (Frame& frame : frames) frame.time_s = 1.5;
  write_all(FrameFormat::tum, folder / "tum", frames);
  EXPECT_THAT(get(folder / "tum/depth.txt"),
              HasSubstr("\n1.500000 depth/1.500000.png\n1.500000 depth/1.500000_2.png\n"));
}

TEST(WriteFrames, RefusesDepthThatDoesNotFitTum) {
  const TemporaryFolder folder;
  Frame frame = random_frame("far", 1);
  frame.depth(0, 0) = 13108;
  EXPECT_THAT(error_of([&] { write_all(FrameFormat::tum, folder / "a", {frame}); }),
              HasSubstr("frame far: depth of 13108 mm, expected at most 13107 at 5000 units per metre"));
  WriteOptions options;
  options.tum_units_per_m = 1000.F;
  write_all(FrameFormat::tum, folder / "b", {frame}, options);
  expect_same_pictures(read_all(folder / "b"), {frame});
}

TEST(WriteFrames, RefusesFramesThatDoNotFitTheFolder) {
  const TemporaryFolder folder;
  put(folder / "full/old.png", "x");
  EXPECT_THAT(error_of([&] { make_frame_writer(FrameFormat::folder, folder / "full"); }), HasSubstr("has files in it"));
  EXPECT_THAT(error_of([&] { make_frame_writer(FrameFormat::folder, folder / "full/old.png"); }),
              HasSubstr("folder cannot be made"));
  const auto writer = make_frame_writer(FrameFormat::folder, folder / "out");
  writer->write(random_frame("a", 1));
  EXPECT_THAT(error_of([&] { writer->write(random_frame("b", 2, 20, 20)); }), HasSubstr("another camera"));
  for (const char* name : {"", "../b", "b/c", ".b"}) {
    EXPECT_THAT(error_of([&] { writer->write(random_frame(name, 2)); }), HasSubstr("expected a file name"));
  }
  EXPECT_THROW(parse_frame_format("bag"), UsageError);
  EXPECT_EQ(parse_frame_format("tum"), FrameFormat::tum);
  WriteOptions coarse;
  coarse.tum_units_per_m = 100.F;
  EXPECT_THROW(make_frame_writer(FrameFormat::tum, folder / "coarse", coarse), UsageError);
}

TEST(WriteFrames, KeepsWhereUpIs) {
  const TemporaryFolder folder;
  for (const FrameFormat format : {FrameFormat::folder, FrameFormat::tum}) {
    std::vector<Frame> frames = sample_frames();
    for (int i = 0; i < 3; ++i) {
      frames[i].name = "00" + std::to_string(2 * i);
      frames[i].time_s = 2 * i / 4.0;
      if (i != 1) frames[i].up = Eigen::Vector3f(0.6F, -0.8F, 0.1F * float(i)).normalized();
    }
    WriteOptions options;
    options.frame_rate = 4.F;
    const std::string path = folder / std::to_string(static_cast<int>(format));
    write_all(format, path, frames, options);
    const std::vector<Frame> got = read_all(path);
    ASSERT_EQ(got.size(), 3U);
    for (const int i : {0, 2}) {
      ASSERT_TRUE(got[i].up) << i;
      EXPECT_TRUE(got[i].up->isApprox(*frames[i].up, 1e-4F)) << i;
    }
    EXPECT_FALSE(got[1].up) << "the first is half a second old";
  }
  write_all(FrameFormat::folder, folder / "without", sample_frames());
  EXPECT_FALSE(fs::exists(folder / "without/imu.csv"));
}

}  // namespace
}  // namespace vesalius

#include "film/video.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::get;
using test::random_frame;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(VideoWriter, WritesPicturesThatPlayersRead) {
  const TemporaryFolder folder;
  VideoWriter writer(folder / "a.avi", 25.0);
  for (const Rgb colour : {Rgb{40, 90, 20}, Rgb{120, 90, 20}, Rgb{200, 90, 20}})
    writer.write(ColourImage(64, 48, colour));
  writer.close();
  EXPECT_EQ(folder.file_count(), 1U);
  cv::VideoCapture video(folder / "a.avi", cv::CAP_OPENCV_MJPEG);
  EXPECT_DOUBLE_EQ(video.get(cv::CAP_PROP_FPS), 25.0);
  cv::Mat picture;
  for (const int level : {40, 120, 200}) {
    ASSERT_TRUE(video.read(picture));
    ASSERT_EQ(picture.size(), cv::Size(64, 48));
    const cv::Vec3b bgr = picture.at<cv::Vec3b>(24, 32);
    EXPECT_NEAR(bgr[2], level, 6);
    EXPECT_NEAR(bgr[1], 90, 6);
    EXPECT_NEAR(bgr[0], 20, 6);
  }
  EXPECT_FALSE(video.read(picture));
}

TEST(VideoWriter, WritesTheSameBytesForTheSamePictures) {
  const TemporaryFolder folder;
  const ColourImage picture = random_frame("f", 1, 320, 240).colour;
  for (const char* name : {"a.avi", "b.avi"}) {
    VideoWriter writer(folder / name, 30.0);
    for (int i = 0; i < 5; ++i) writer.write(picture);
    writer.close();
  }
  EXPECT_EQ(get(folder / "a.avi"), get(folder / "b.avi"));
}

TEST(VideoWriter, LeavesNoFileUnlessClosed) {
  const TemporaryFolder folder;
  {
    VideoWriter writer(folder / "a.avi", 25.0);
    writer.write(ColourImage(64, 48));
  }
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(VideoWriter, RefusesWrongUse) {
  const TemporaryFolder folder;
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 25.0), UsageError);
  EXPECT_THROW(VideoWriter(folder / "a.avi", 0.0), UsageError);
  EXPECT_THAT(error_of([&] { VideoWriter(folder / "a.avi", 25.0).close(); }), HasSubstr("a.avi: no pictures"));
  VideoWriter writer(folder / "b.avi", 25.0);
  EXPECT_THAT(error_of([&] { writer.write({}); }), HasSubstr("b.avi: empty picture"));
  writer.write(ColourImage(64, 48));
  EXPECT_THAT(error_of([&] { writer.write(ColourImage(48, 64)); }), HasSubstr("48x64, expected 64x48"));
  EXPECT_THAT(error_of([&] { VideoWriter(folder / "none/a.avi", 25.0); }), HasSubstr("none/a.avi: cannot be written"));
}

TEST(VideoWriter, ThrowsOnAFullDisk) {
  const TemporaryFolder folder;
  const ColourImage picture = random_frame("f", 1, 320, 240).colour;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{200000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  {
    VideoWriter writer(folder / "a.avi", 25.0);
    EXPECT_THAT(error_of([&] {
                  for (int i = 0; i < 40; ++i) writer.write(picture);
                  writer.close();
                }),
                HasSubstr("a.avi: "));
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(folder.file_count(), 0U);
}

}  // namespace
}  // namespace vesalius

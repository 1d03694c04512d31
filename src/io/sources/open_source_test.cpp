#include "vesalius/open_source.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "io/files/test_files.h"
#include "io/recordings/test_k4a.h"
#include "io/sources/test_messages.h"
#include "io/sources/test_pcd_write.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::put;
using test::random_frame;
using test::serialise_pcd;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* kMeta = R"({"fx": 41.3, "fy": 40.7, "cx": 17.2, "cy": 12.9, "units": "mm"})";

void put_depth(const std::string& path, const Image<std::uint16_t>& depth) { put(path, encode_png(depth)); }
void put_colour(const std::string& path, const ColourImage& colour) { put(path, encode_png(colour)); }

std::vector<Frame> all_frames(FrameSource& source) {
  std::vector<Frame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<std::string> names(const std::vector<Frame>& frames) {
  std::vector<std::string> all;
  for (const Frame& frame : frames) all.push_back(frame.name);
  return all;
}

std::string open_error(const std::string& uri, const SourceOptions& options = {}) {
  return error_of([&] { open_source(uri, options); });
}

TEST(FolderSource, ReadsFramesInOrderWithTheirColour) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  std::map<std::string, Frame> written;
  for (const char* name : {"f10", "f2", "f1"}) {
    const Frame frame = written[name] = random_frame(name, written.size());
    put_depth(folder / "depth/" + name + ".png", frame.depth);
    if (frame.name != "f2") put_colour(folder / "rgb/" + name + ".png", frame.colour);
  }
  put(folder / "depth/._f1.png", "left by another system");
  put(folder / "depth/readme.txt", "text");
  const auto source = open_source(folder.path());
  EXPECT_EQ(source->size(), 3);
  const std::vector<Frame> frames = all_frames(*source);
  EXPECT_THAT(names(frames), ElementsAre("f1", "f2", "f10"));
  for (const Frame& frame : frames) {
    EXPECT_EQ(frame.depth, written[frame.name].depth);
    EXPECT_EQ(frame.camera, written[frame.name].camera);
    EXPECT_EQ(frame.colour, frame.name == "f2" ? ColourImage() : written[frame.name].colour);
  }
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("1 of 3 frames have no colour")));
}

TEST(FolderSource, ReadsCameraInfoAColorFolderAndJpeg) {
  const TemporaryFolder folder;
  put(folder / "camera_info.yml", "{width: 37, height: 23, K: [50, 0, 18, 0, 51, 11, 0, 0, 1]}");
  put_depth(folder / "depth/a.png", random_frame("a", 1).depth);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(23, 37, CV_8UC3, cv::Scalar(0, 0, 250)), jpeg);
  put(folder / "color/a.JPG", std::string(jpeg.begin(), jpeg.end()));
  const auto frame = open_source("folder:" + folder.path())->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->camera, (Camera{37, 23, 50.F, 51.F, 18.F, 11.F}));
  EXPECT_NEAR(frame->colour(5, 5).r, 250, 5);
}

TEST(FolderSource, ReadsAFolderOfDepthFiles) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  const Frame frame = random_frame("a", 3);
  put_depth(folder / "depth/a.png", frame.depth);
  // For the folder named depth the camera lies one folder up.
  for (const std::string& uri : {folder / "depth", folder / "depth/", "png:" + folder / "depth"}) {
    const auto frames = all_frames(*open_source(uri));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].depth, frame.depth);
    EXPECT_EQ(frames[0].camera, frame.camera);
  }
}

TEST(FolderSource, TakesTheScaleFromUnitsAndOptions) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"fx": 50, "depth_scale": 5000})");
  DepthImage depth(4, 3, 5000);
  put_depth(folder / "a.png", depth);
  EXPECT_EQ(open_source(folder.path())->next()->depth(0, 0), 1000);
  SourceOptions options;
  options.depth_scale = 10000.F;
  EXPECT_EQ(open_source(folder.path(), options)->next()->depth(0, 0), 500);
}

TEST(FolderSource, NotesASensorWithoutFocalLength) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"sensor": "Kinect v1"})");
  put_depth(folder / "depth/a.png", DepthImage(160, 120, 900));
  const auto source = open_source(folder.path());
  EXPECT_EQ(source->next()->camera, (Camera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F}));
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("131.2 pixels assumed, usual for \"Kinect v1\"")));
}

TEST(FolderSource, NamesBadFramesAndGoesOn) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  const Frame frame = random_frame("a", 3);
  const std::string png = encode_png(frame.depth);
  put(folder / "depth/0.png", png);
  put(folder / "depth/1.png", "");
  put(folder / "depth/2.png", png.substr(0, png.size() / 2));
  put_depth(folder / "depth/3.png", DepthImage(8, 8, 1));
  put(folder / "depth/5.png", encode_png(frame.colour));
  put(folder / "depth/6.png", png);
  put(folder / "rgb/6.jpg", "\xFF\xD8\xFF\xE0 no more");
  fs::create_symlink("nowhere", folder / "depth/7.png");
  put(folder / "depth/8.png", png);
  const auto source = open_source(folder.path());
  ASSERT_TRUE(source->next());
  for (const char* expected :
       {"1.png: empty file", "2.png: truncated PNG", "3.png: 8x8 pixels, expected the size of the first, 37x23",
        "5.png: 8-bit colour PNG, expected 16-bit grey", "rgb/6.jpg: truncated JPEG",
        "7.png: cannot be read: No such file"}) {
    EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr(expected));
  }
  EXPECT_EQ(source->next()->name, "8");
  EXPECT_FALSE(source->next());
}

TEST(FolderSource, ABadFirstFrameIsOneFrame) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  put(folder / "depth/0.png", "");
  put_depth(folder / "depth/2.png", random_frame("a", 3).depth);
  put(folder / "depth.txt", "0.5 depth/0.png\n0.6 depth/1.png\n0.7 depth/2.png\n");
  for (const std::string& uri : {"folder:" + folder.path(), folder.path()}) {
    const auto source = open_source(uri);
    EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("0.png: empty file"));
    if (uri == folder.path()) {
      EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("1.png: cannot be read"));
    }
    EXPECT_TRUE(source->next());
    EXPECT_FALSE(source->next());
  }
}

TEST(FolderSource, GoesWithoutColourOfAnotherSize) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  const Frame frame = random_frame("a", 3);
  put_depth(folder / "depth/0.png", frame.depth);
  put_colour(folder / "rgb/0.png", ColourImage(64, 36));
  const auto source = open_source(folder.path());
  const auto read = source->next();
  EXPECT_EQ(read->depth, frame.depth);
  EXPECT_TRUE(read->colour.empty());
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("no colour, since that has 64x36 pixels and depth 37x23")));
  std::vector<std::string> items;
  for (const SourceItem& item : source->contents()) {
    items.push_back(item.name + " " + item.holds + " " + std::to_string(item.count) + " " + item.use +
                    item.why.substr(0, 9));
  }
  EXPECT_THAT(
      items, ElementsAre("depth/*.png png 37x23 1 depth", "meta.json json 1 calibration", "rgb/*.png png 1 no colour"));
}

TEST(FolderSource, PutsColourOfAnAzureKinectOnTheGridOfDepth) {
  const TemporaryFolder folder;
  put(folder / "calibration.json", test::k4a_json());
  put_depth(folder / "depth/0.png", DepthImage(320, 288, 2000));
  put_colour(folder / "color/0.png", ColourImage(1280, 720, {10, 20, 30}));
  const auto source = open_source(folder.path());
  EXPECT_THAT(source->notes(), IsEmpty());
  const auto frame = source->next();
  EXPECT_EQ(frame->camera.fx, 256.F);
  ASSERT_TRUE(frame->colour.same_size(frame->depth));
  EXPECT_EQ(frame->colour(160, 144), (Rgb{10, 20, 30}));
}

TEST(SinglePng, FindsColourBesideItByName) {
  const TemporaryFolder folder;
  put(folder / "intrinsics.txt", "41.3 0 17.2\n0 40.7 12.9\n0 0 1\n");
  const Frame frame = random_frame("frame-000000.depth", 4);
  put_depth(folder / "frame-000000.depth.png", frame.depth);
  put_colour(folder / "frame-000000.color.png", frame.colour);
  const auto read = open_source(folder / "frame-000000.depth.png")->next();
  EXPECT_EQ(read->colour, frame.colour);
  EXPECT_EQ(read->camera, frame.camera);
}

TEST(SinglePng, FindsColourAndCameraBesideIt) {
  const TemporaryFolder folder;
  put(folder / "meta.json", kMeta);
  const Frame frame = random_frame("a.b", 4);
  put_depth(folder / "depth/a.b.png", frame.depth);
  put_colour(folder / "rgb/a.b.png", frame.colour);
  const auto frames = all_frames(*open_source(folder / "depth/a.b.png"));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].name, "a.b");
  EXPECT_EQ(frames[0].colour, frame.colour);
  EXPECT_EQ(frames[0].camera, frame.camera);
}

TEST(SinglePng, TakesTheGivenColourAndCamera) {
  const TemporaryFolder folder;
  const Frame frame = random_frame("a", 4);
  put_depth(folder / "a.png", frame.depth);
  put_colour(folder / "c.png", frame.colour);
  SourceOptions options;
  options.fx = 30.F;
  options.colour_file = folder / "c.png";
  const auto read = open_source(folder / "a.png", options)->next();
  EXPECT_EQ(read->colour, frame.colour);
  EXPECT_EQ(read->camera, (Camera{37, 23, 30.F, 30.F, 18.F, 11.F}));
}

void put_tum(const TemporaryFolder& folder, const DepthImage& depth, const ColourImage& colour) {
  put(folder / "depth.txt", "# depth maps\n1.5 depth/b.png\n1.0 depth/a.png\n");
  put(folder / "rgb.txt", "1.011 rgb/x.png\n1.6 rgb/y.png\n");
  for (const char* name : {"a", "b"}) put_depth(folder / "depth/" + name + ".png", depth);
  for (const char* name : {"x", "y"}) put_colour(folder / "rgb/" + name + ".png", colour);
}

TEST(TumSource, PairsByTimeAndScalesBy5000) {
  const TemporaryFolder folder;
  put_tum(folder, DepthImage(640, 480, 10000), ColourImage(640, 480, {1, 2, 3}));
  const auto source = open_source(folder.path());
  const std::vector<Frame> frames = all_frames(*source);
  EXPECT_THAT(names(frames), ElementsAre("1.0", "1.5"));
  EXPECT_EQ(frames[1].time_s, 1.5);
  EXPECT_EQ(frames[0].depth(3, 4), 2000);
  EXPECT_EQ(frames[0].colour(3, 4), (Rgb{1, 2, 3}));
  EXPECT_TRUE(frames[1].colour.empty());
  EXPECT_EQ(frames[0].camera, (Camera{640, 480, 525.F, 525.F, 319.5F, 239.5F}));
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("1 of 2 depth pictures have no colour within 0.02 s"),
                                           HasSubstr("no intrinsics given; those of the TUM benchmark")));
}

TEST(TumSource, ReadsAssociationsInBothOrders) {
  for (const char* line : {"1.0 rgb/x.png 1.01 depth/a.png\n", "1.01,depth/a.png,1.0,rgb/x.png\r\n"}) {
    const TemporaryFolder folder;
    put_depth(folder / "depth/a.png", DepthImage(640, 480, 10000));
    put_colour(folder / "rgb/x.png", ColourImage(640, 480, {1, 2, 3}));
    put(folder / "Associations.txt", std::string("# both\n") + line);
    const auto frame = open_source(folder.path())->next();
    EXPECT_EQ(frame->time_s, 1.01);
    EXPECT_EQ(frame->depth(3, 4), 2000);
    EXPECT_EQ(frame->colour(3, 4), (Rgb{1, 2, 3}));
  }
}

TEST(TumSource, FindsPicturesOfListsFromOtherMachines) {
  for (const char* line :
       {"1.0 depth\\a.png 1.0 rgb\\x.png", "1.0 C:\\me\\rec\\depth\\a.png 1.0 C:\\me\\rec\\rgb\\x.png",
        "1.0 /home/me/rec/rgb/x.png 1.0 /home/me/rec/depth/a.png"}) {
    const TemporaryFolder folder;
    put_depth(folder / "depth/a.png", DepthImage(640, 480, 10000));
    put_colour(folder / "rgb/x.png", ColourImage(640, 480, {1, 2, 3}));
    put(folder / "associations.txt", line);
    const auto frame = open_source(folder.path())->next();
    EXPECT_EQ(frame->depth(3, 4), 2000) << line;
    EXPECT_EQ(frame->colour(3, 4), (Rgb{1, 2, 3})) << line;
  }
}

TEST(TumSource, TakesNumbersOfFramesForNoTimes) {
  const TemporaryFolder folder;
  std::string lines;
  for (int i = 0; i < 12; ++i) {
    put_depth(folder / ("depth/" + std::to_string(i) + ".png"), DepthImage(640, 480, 10000));
    put_colour(folder / ("rgb/" + std::to_string(i) + ".png"),
               ColourImage(640, 480, {static_cast<std::uint8_t>(i), 2, 3}));
    lines += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
  }
  put(folder / "associations.txt", lines);
  const auto source = open_source(folder.path());
  const std::vector<Frame> frames = all_frames(*source);
  EXPECT_THAT(names(frames), SizeIs(12));
  EXPECT_EQ(frames[11].name, "11");
  EXPECT_EQ(frames[11].time_s, 11.0 / 30.0);
  EXPECT_EQ(frames[11].colour(0, 0), (Rgb{11, 2, 3}));
  EXPECT_THAT(source->notes().front(),
              HasSubstr("associations.txt: numbers of frames, no times; they count as 30 a second"));
  put(folder / "meta.json", R"({"fx": 525, "rate_hz": 10})");
  EXPECT_EQ(all_frames(*open_source(folder.path()))[11].time_s, 1.1);
}

TEST(TumSource, TakesTheScaleThatIsGiven) {
  const TemporaryFolder folder;
  put_tum(folder, DepthImage(640, 480, 10000), ColourImage(640, 480));
  SourceOptions options;
  options.depth_scale = 2000.F;
  EXPECT_EQ(open_source("tum:" + folder.path(), options)->next()->depth(0, 0), 5000);
}

TEST(TumSource, NeedsACameraForOtherSizes) {
  const TemporaryFolder folder;
  put_tum(folder, DepthImage(32, 24, 10000), ColourImage(32, 24));
  EXPECT_THAT(open_error(folder.path()), HasSubstr("no intrinsics"));
  put(folder / "meta.json", R"({"fx": 26.25})");
  EXPECT_EQ(open_source(folder.path())->next()->camera.fx, 26.25F);
}

TEST(TumSource, NamesBadLists) {
  const TemporaryFolder folder;
  put(folder / "depth.txt", "# nothing\n");
  EXPECT_THAT(open_error(folder.path()), HasSubstr("depth.txt: no frames"));
  put(folder / "depth.txt", "1.0 depth/none.png\n");
  EXPECT_THAT(open_error(folder.path()), HasSubstr("depth/none.png: cannot be read"));
  put(folder / "depth.txt", "one depth/none.png\n");
  EXPECT_THAT(open_error(folder.path()), HasSubstr("depth.txt:1: expected"));
}

TEST(PcdSource, ReadsAFileAndAFolder) {
  const TemporaryFolder folder;
  const Frame first = random_frame("a2", 5);
  const Frame second = random_frame("a10", 6, 37, 23, false);
  put(folder / "a2.pcd", serialise_pcd(first, PcdEncoding::binary_compressed));
  put(folder / "a10.pcd", serialise_pcd(second, PcdEncoding::ascii));
  const auto source = open_source(folder.path());
  EXPECT_EQ(source->size(), 2);
  const std::vector<Frame> frames = all_frames(*source);
  EXPECT_THAT(names(frames), ElementsAre("a2", "a10"));
  EXPECT_EQ(frames[0].depth, first.depth);
  EXPECT_EQ(frames[0].colour, first.colour);
  EXPECT_EQ(frames[1].depth, second.depth);
  EXPECT_NEAR(frames[1].camera.fx, second.camera.fx, 1e-3);
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("a2.pcd: intrinsics estimated from its points: fx 41.30")));

  put(folder / "meta.json", kMeta);
  const auto single = open_source("pcd:" + folder / "a10.pcd");
  EXPECT_EQ(single->next()->camera, second.camera);
  EXPECT_THAT(single->notes(), IsEmpty());
}

std::vector<std::string> names_from(FrameSource& source, double time_s) {
  source.seek(time_s);
  return names(all_frames(source));
}

TEST(OpenSource, SeeksInFramesWithoutTimesAsAtThirtyASecond) {
  const TemporaryFolder folder;
  put(folder / "a/meta.json", kMeta);
  for (const char* name : {"0", "1", "2", "3"}) {
    const Frame frame = random_frame(name, 1);
    put_depth(folder / "a/depth/" + name + ".png", frame.depth);
    put(folder / "b/" + name + ".pcd", serialise_pcd(frame, PcdEncoding::binary));
  }
  for (const char* kind : {"a", "b"}) {
    const auto source = open_source(folder / kind);
    ASSERT_TRUE(source->span());
    EXPECT_EQ(source->span()->first_s, 0.0);
    EXPECT_EQ(source->span()->last_s, 0.1);
    EXPECT_THAT(names_from(*source, 2 / kUsualRate), ElementsAre("2", "3"));
    EXPECT_THAT(names_from(*source, 0.034), ElementsAre("2", "3"));
    EXPECT_THAT(names_from(*source, -5.0), ElementsAre("0", "1", "2", "3"));
    EXPECT_THAT(names_from(*source, 0.101), IsEmpty());
    EXPECT_THAT(names_from(*source, 0.1), ElementsAre("3"));
  }
}

TEST(OpenSource, BeginsWhereItIsTold) {
  const TemporaryFolder folder;
  put_tum(folder, DepthImage(640, 480, 10000), ColourImage(640, 480));
  const auto whole = open_source(folder.path());
  EXPECT_EQ(whole->span()->first_s, 1.0);
  EXPECT_EQ(whole->span()->last_s, 1.5);
  EXPECT_THAT(names_from(*whole, 1.2), ElementsAre("1.5"));
  SourceOptions options;
  options.start_s = 0.1;
  const auto late = open_source(folder.path(), options);
  EXPECT_EQ(late->size(), -1);
  EXPECT_THAT(late->notes(), SizeIs(2));
  EXPECT_THAT(names(all_frames(*late)), ElementsAre("1.5"));
  EXPECT_THAT(names_from(*late, 0.0), ElementsAre("1.0", "1.5"));
  options.start_s = 0.0;
  EXPECT_THAT(names(all_frames(*open_source(folder.path(), options))), ElementsAre("1.0", "1.5"));
  options.start_s = 0.5;
  EXPECT_THAT(names(all_frames(*open_source(folder.path(), options))), ElementsAre("1.5"));
}

TEST(OpenSource, RefusesAStartThatIsNone) {
  const TemporaryFolder folder;
  put_tum(folder, DepthImage(640, 480, 10000), ColourImage(640, 480));
  SourceOptions options;
  for (const double start_s : {0.6, -1.0, std::nan("")}) {
    options.start_s = start_s;
    EXPECT_THAT(open_error(folder.path(), options), HasSubstr("expected 0 to 0.500 s"));
    EXPECT_THROW(open_source(folder.path(), options), UsageError);
  }
  EXPECT_THAT(open_error("realsense:", options), HasSubstr("realsense:: a camera begins now"));
}

TEST(OpenSource, NamesWhatIsNotASource) {
  const TemporaryFolder folder;
  EXPECT_THAT(open_error(folder / "none"), HasSubstr("none: No such file or directory, expected a folder"));
  for (const char* name : {"k4a:", "openni2", "/dev/video0"}) {
    EXPECT_THAT(open_error(name), AllOf(HasSubstr("openni2:, freenect:, realsense:"), HasSubstr("vesalius cameras")));
  }
  EXPECT_THAT(open_error(folder / "none"), Not(HasSubstr("a camera")));
  EXPECT_THAT(open_error(""), HasSubstr("expected a folder"));
  EXPECT_THAT(open_error(folder.path()), HasSubstr(folder.path() + ": no frames, expected depth/*.png"));
  EXPECT_THAT(open_error("pcd:" + folder.path()), HasSubstr("no frames, expected *.pcd"));
  EXPECT_THAT(open_error(put(folder / "a.txt", "x")), HasSubstr("a.txt: unknown kind of file"));
  EXPECT_THAT(open_error(put(folder / "a.NPZ", "x")), HasSubstr("a.NPZ: depth of .npz, expected PNG of 16 bits"));
  EXPECT_THAT(open_error("tum:" + folder / "a.txt"), HasSubstr("a.txt: a file, expected a folder"));
  EXPECT_THAT(open_error(put(folder / "a.png", "")), HasSubstr("a.png: empty file"));
  EXPECT_THAT(open_error(put(folder / "a.pcd", "")), HasSubstr("a.pcd: empty file"));
  EXPECT_THAT(open_error(folder.path()), HasSubstr("PNG and PCD files in one folder"));
  fs::create_directory(folder / "depth");
  EXPECT_THAT(open_error(folder.path()), HasSubstr("depth: no frames"));
  put_depth(folder / "depth/a.png", DepthImage(4, 4, 1));
  EXPECT_THAT(open_error(folder.path()), HasSubstr("no intrinsics"));
  SourceOptions options;
  options.colour_file = folder / "c.png";
  EXPECT_THROW(open_source(folder.path(), options), UsageError);
}

TEST(OpenSource, RefusesAFolderWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryFolder folder;
  fs::create_directory(folder / "shut");
  ASSERT_EQ(chmod((folder / "shut").c_str(), 0), 0);
  EXPECT_THAT(open_error(folder / "shut"), HasSubstr("Permission denied"));
}

/// A recording of three frames by the tools of others.
std::string recording_of_others(const std::string& name) {
  return test::get(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_recording/" + name);
}

TEST(OpenSource, KnowsARecordingByItsContentWhereTheNameDoesNotTell) {
  const TemporaryFolder folder;
  for (const char* name : {"x.bag.active", "x.bag.orig", "noname", "x.avi"}) {
    const auto source = open_source(put(folder / name, recording_of_others("plain.bag")));
    EXPECT_THAT(all_frames(*source), SizeIs(3)) << name;
  }
  EXPECT_THAT(all_frames(*open_source(put(folder / "x.sqlite3", recording_of_others("plain.db3")))), SizeIs(3));
  SourceOptions options;
  options.fx = 50.F;
  EXPECT_THAT(all_frames(*open_source(put(folder / "picture", encode_png(random_frame("a", 1).depth)), options)),
              SizeIs(1));
}

TEST(OpenSource, SaysWhatAnUnknownFileIs) {
  const TemporaryFolder folder;
  EXPECT_THAT(open_error(put(folder / "a.zip", std::string("PK\3\4", 4) + "...")),
              HasSubstr("a zip archive; unpack it"));
  EXPECT_THAT(open_error(put(folder / "a.bag", "\x1F\x8B\x08 packed")), HasSubstr("gunzip"));
  EXPECT_THAT(open_error(put(folder / "a.db3", "<!DOCTYPE html>\n<title>Sign in")),
              HasSubstr("a web page, not the file"));
  EXPECT_THAT(open_error(put(folder / "a.xyz", "anything")), HasSubstr("unknown kind of file"));
}

TEST(OpenSource, FoldersOfOneRecordingNeedNoMetadata) {
  const TemporaryFolder folder;
  put(folder / "one/rosbag.db3", recording_of_others("plain.db3"));
  put(folder / "one/notes.txt", "");
  put(folder / "split/x_0.bag", recording_of_others("plain.bag"));
  put(folder / "split/x_1.bag", recording_of_others("bz2.bag"));
  put(folder / "split/x_2.bag.active", recording_of_others("lz4.bag"));
  put(folder / "dated/run_2024-01-02-10-00-00_0.mcap", recording_of_others("zstd.mcap"));
  put(folder / "dated/run_2024-01-02-10-05-00_1.mcap", recording_of_others("lz4.mcap"));
  for (const auto& [name, frames] : std::map<std::string, int>{{"one", 3}, {"split", 9}, {"dated", 6}}) {
    const auto source = open_source(folder / name);
    EXPECT_EQ(source->size(), frames) << name;
    EXPECT_THAT(all_frames(*source), SizeIs(static_cast<std::size_t>(frames))) << name;
  }
}

TEST(OpenSource, ARecordingComesBeforeAPictureThatIsNoDepth) {
  const TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  test::Messages out(folder / "rec.mcap");
  out.camera("/depth/camera_info", a.camera);
  out.depth("/depth/image", 0, a);
  out.close();
  put_colour(folder / "screenshot.png", ColourImage(64, 36));
  EXPECT_EQ(open_source(folder.path())->next()->depth, a.depth);
}

TEST(OpenSource, PartsOfARecordingAreOrderedByTheirNumbers) {
  const TemporaryFolder folder;
  for (const int part : {0, 2, 10}) {
    test::Messages out((fs::create_directories(folder / "bag"), folder / ("bag/x_" + std::to_string(part) + ".mcap")));
    out.camera("/depth/camera_info", random_frame("a", 1).camera);
    out.depth("/depth/image", std::int64_t{1'000'000'000} * part, random_frame("a", 1));
    out.close();
  }
  EXPECT_THAT(names(all_frames(*open_source(folder / "bag"))),
              ElementsAre("0.000000000", "2.000000000", "10.000000000"));
}

TEST(OpenSource, RecordingsThatAreNoPartsOfOneAreNotMixed) {
  const TemporaryFolder folder;
  put(folder / "all/kitchen.bag", recording_of_others("plain.bag"));
  put(folder / "all/hall.bag", recording_of_others("plain.bag"));
  EXPECT_THAT(open_error(folder / "all"),
              HasSubstr("2 recordings, such as hall.bag and kitchen.bag: expected one of them"));
}

TEST(OpenSource, APackedPartIsNotReadTwice) {
  const TemporaryFolder folder;
  put(folder / "bag/metadata.yaml", "");
  put(folder / "bag/x_0.db3", recording_of_others("plain.db3"));
  put(folder / "bag/x_0.db3.zstd", "left by ros2 bag play");
  EXPECT_THAT(all_frames(*open_source(folder / "bag")), SizeIs(3));
}

TEST(MakeFrame, CopiesRowsWithStrides) {
  const Camera camera{2, 2, 10.F, 10.F, 0.5F, 0.5F};
  const std::uint16_t depth_mm[] = {1, 2, 99, 3, 4, 99};
  const std::uint8_t rgb[] = {1, 2, 3, 4, 5, 6, 0, 7, 8, 9, 10, 11, 12, 0};
  const Frame frame = make_frame(camera, depth_mm, 6, rgb, 7);
  EXPECT_THAT(std::vector<int>(frame.depth.begin(), frame.depth.end()), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(frame.colour(1, 1), (Rgb{10, 11, 12}));
  const Frame packed = make_frame(camera, depth_mm, 0);
  EXPECT_EQ(packed.depth(1, 1), 3);
  EXPECT_TRUE(packed.colour.empty());
}

TEST(MakeFrame, RefusesUnusableBuffers) {
  const Camera camera{2, 2, 10.F, 10.F, 0.5F, 0.5F};
  const std::uint16_t depth_mm[4] = {};
  EXPECT_THAT(error_of([&] { make_frame(camera, nullptr, 0); }), HasSubstr("no depth"));
  EXPECT_THAT(error_of([&] { make_frame(camera, depth_mm, 3); }), HasSubstr("strides 3"));
  EXPECT_THROW(make_frame(Camera{0, 2, 1.F, 1.F, 0.F, 0.F}, depth_mm, 0), Error);
  EXPECT_THROW(make_frame(Camera{1 << 20, 1 << 20, 1.F, 1.F, 0.F, 0.F}, depth_mm, 0), Error);
}

/// Returns the folder of development data; empty if there is none.
std::string shared_folder() {
  const char* given = std::getenv("VESALIUS_SHARED");
  const std::string folder = given != nullptr ? given : std::string(VESALIUS_SOURCE_DIR) + "/../shared";
  return fs::is_directory(folder + "/real") ? folder : "";
}

// Labels: real
TEST(RealFrames, AllOpenAsTheirTableSays) {
  const std::string shared = shared_folder();
  if (shared.empty()) GTEST_SKIP() << "no development data: set VESALIUS_SHARED";
  std::map<std::string, std::map<std::string, bool>> has_colour;  // by set and frame
  std::istringstream list(test::get(shared + "/real/frames.csv"));
  std::string line;
  std::getline(list, line);
  while (std::getline(list, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_GE(cells.size(), 5U) << line;
    has_colour[cells[0]][cells[1]] = cells[4] == "1";
  }
  ASSERT_FALSE(has_colour.empty());
  for (const auto& [set, frames] : has_colour) {
    const auto source = open_source(shared + "/real/" + set);
    EXPECT_EQ(source->size(), static_cast<int>(frames.size())) << set;
    while (const auto frame = source->next()) {
      ASSERT_TRUE(frames.count(frame->name)) << set << ' ' << frame->name;
      EXPECT_EQ(!frame->colour.empty(), frames.at(frame->name)) << set << ' ' << frame->name;
      EXPECT_EQ(frame->depth.width(), set == "fallseq" ? 320 : 640) << set;
    }
  }
}

}  // namespace
}  // namespace vesalius

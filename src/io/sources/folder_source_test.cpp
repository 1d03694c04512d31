#include "io/sources/folder_source.h"

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

#include "io/files/test_files.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(NaturalLess, ComparesNumbersByValue) {
  const std::vector<std::string> ordered = {"1", "01", "2", "10", "a", "a1b", "a1c", "a02", "a2", "a2b", "a10", "b"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      const bool equal_numbers = (ordered[i] == "1" && ordered[j] == "01") || (ordered[i] == "01" && ordered[j] == "1");
      if (!equal_numbers) {
        EXPECT_EQ(natural_less(ordered[i], ordered[j]), i < j) << ordered[i] << ' ' << ordered[j];
      }
    }
  }
  EXPECT_NE(natural_less("1", "01"), natural_less("01", "1"));
}

TEST(ListFiles, ListsOnlyTheWantedKinds) {
  const TemporaryFolder folder;
  for (const char* name : {"b10.png", "b9.PNG", "._b1.png", "c.jpg", "d.txt", "png"}) put(folder / name, "");
  std::vector<std::string> names;
  for (const auto& path : list_files(folder.path(), {".png", ".jpg"})) names.push_back(path.filename().string());
  EXPECT_THAT(names, ElementsAre("b9.PNG", "b10.png", "c.jpg"));
  EXPECT_THAT(error_of([&] { list_files(folder / "none", {".png"}); }),
              HasSubstr("none: folder cannot be read: No such"));
}

/// Returns the times of the frames that are called so, with this meta.json.
std::vector<double> times_of(const std::vector<std::string>& names, const std::string& meta) {
  const TemporaryFolder folder;
  for (const std::string& name : names) put(folder / "depth/" + name + ".png", "");
  put(folder / "meta.json", meta);
  std::vector<double> times_s;
  for (const FrameFiles& files : list_folder(folder.path(), {}).frames) times_s.push_back(files.time_s.value_or(-1.0));
  return times_s;
}

TEST(ListFolder, TakesTimesFromTheRateAndTheNumbersOfFrames) {
  const std::string meta = R"({"rate_hz": 4})";
  EXPECT_THAT(times_of({"002", "003", "010"}, meta), ElementsAre(0.5, 0.75, 2.5));
  EXPECT_THAT(times_of({"a2", "a3", "a10"}, meta), ElementsAre(0.0, 0.25, 0.5));
  EXPECT_THAT(times_of({"1", "01"}, meta), ElementsAre(0.0, 0.25));  // the numbers do not rise
  EXPECT_THAT(times_of({"1", "2"}, "{}"), ElementsAre(-1.0, -1.0));
}

TEST(ParsePictureName, FindsRolesKeysAndTimes) {
  using Role = PictureName::Role;
  struct Row {
    const char* stem;
    Role role;
    const char* key;
    std::optional<double> time_s;
  };
  for (const auto& [stem, role, key, time_s] : std::vector<Row>{
           {"frame-000000.depth", Role::depth, "frame-000000", {}},
           {"frame-000000.color", Role::colour, "frame-000000", {}},
           {"depth_0000", Role::depth, "0000", {}},
           {"RGB_0000", Role::colour, "0000", {}},
           {"0001-depth", Role::depth, "0001", {}},
           {"colorImage12", Role::colour, "12", {}},
           {"rgbd_scene_1", Role::unknown, "rgbd_scene_1", {}},
           {"d", Role::unknown, "d", {}},
           {"d-1294886360.208451-2996770081", Role::depth, "1294886360.208451-2996770081", 1294886360.208451},
           {"out_Depth_1534422894873.58374023", Role::depth, "out_1534422894873.58374023", 1534422894.87358374},
           {"1700000000.033", Role::unknown, "1700000000.033", 1700000000.033},
           {"1700000000_033000", Role::unknown, "1700000000_033000", 1700000000.033},
           {"1700000000033", Role::unknown, "1700000000033", 1700000000.033},
           {"1700000000033000", Role::unknown, "1700000000033000", 1700000000.033},
           {"1700000000033000000", Role::unknown, "1700000000033000000", 1700000000.033},
           {"0.033333", Role::unknown, "0.033333", 0.033333},
           {"0000000000000012", Role::unknown, "0000000000000012", {}},
           {"1.5", Role::unknown, "1.5", {}}}) {
    const PictureName name = parse_picture_name(stem);
    EXPECT_EQ(name.role, role) << stem;
    EXPECT_EQ(name.key, key) << stem;
    EXPECT_EQ(name.time_s.has_value(), time_s.has_value()) << stem;
    EXPECT_NEAR(name.time_s.value_or(0.0), time_s.value_or(0.0), 1e-5) << stem;
  }
}

/// Returns "depth colour" of each frame of a folder with these files.
std::vector<std::string> pairs_of(const std::vector<std::string>& files) {
  const TemporaryFolder folder;
  for (const std::string& file : files) put(folder / file, "");
  std::vector<std::string> pairs;
  const auto relative = [&](const std::string& path) {
    return path.empty() ? "-" : std::filesystem::relative(path, folder.path()).string();
  };
  for (const FrameFiles& f : list_folder(folder.path(), {}).frames) {
    pairs.push_back(relative(f.depth) + " " + relative(f.colour));
  }
  return pairs;
}

TEST(ListFolder, PairsDepthAndColourByName) {
  using testing::ElementsAre;
  EXPECT_THAT(
      pairs_of({"frame-000000.depth.png", "frame-000000.color.png", "frame-000000.pose.txt", "frame-000001.depth.png"}),
      ElementsAre("frame-000000.depth.png frame-000000.color.png", "frame-000001.depth.png -"));
  EXPECT_THAT(pairs_of({"depth_0000.png", "rgb_0000.jpg"}), ElementsAre("depth_0000.png rgb_0000.jpg"));
  EXPECT_THAT(pairs_of({"Depth/000001.PNG", "Color/000001.JPG", "Infrared/000001.png"}),
              ElementsAre("Depth/000001.PNG Color/000001.JPG"));
  EXPECT_THAT(pairs_of({"depth/depth_7.png", "rgb/rgb_7.png", "depth_vis/depth_7.png"}),
              ElementsAre("depth/depth_7.png rgb/rgb_7.png"));
  EXPECT_THAT(pairs_of({"depth/depth_7.png", "depth/height_7.png"}),
              ElementsAre("depth/depth_7.png -", "depth/height_7.png -"));
  EXPECT_THAT(pairs_of({"depth/image_7.png", "image/image_7.jpg"}), ElementsAre("depth/image_7.png image/image_7.jpg"));
  EXPECT_THAT(pairs_of({"depth_images/0007.png", "RGB/frame7.png"}),
              ElementsAre("depth_images/0007.png RGB/frame7.png"));
  EXPECT_THAT(pairs_of({"depth/0000001-000000000000.png", "depth/0000002-000000033369.png",
                        "rgb/0000001-000000004000.jpg", "rgb/0000002-000000037000.jpg"}),
              ElementsAre("depth/0000001-000000000000.png rgb/0000001-000000004000.jpg",
                          "depth/0000002-000000033369.png rgb/0000002-000000037000.jpg"));
  EXPECT_THAT(pairs_of({"depth/1_left.png", "depth/1_right.png", "rgb/x1.png"}),
              ElementsAre("depth/1_left.png -", "depth/1_right.png -"));
  EXPECT_THAT(pairs_of({"0001.png", "0001.jpg"}), ElementsAre("0001.png 0001.jpg"));
  EXPECT_THAT(pairs_of({"depth/0000103.png", "image/x.jpg"}), ElementsAre("depth/0000103.png image/x.jpg"));
  EXPECT_THAT(pairs_of({"d-1294886360.208451-29.pgm", "d-1294886361.0-29.pgm", "r-1294886360.210000-7.ppm"}),
              ElementsAre("d-1294886360.208451-29.pgm r-1294886360.210000-7.ppm", "d-1294886361.0-29.pgm -"));
  EXPECT_THAT(pairs_of({"a.png", "b.png", "d.png"}), ElementsAre("a.png -", "b.png -", "d.png -"));
  EXPECT_THAT(pairs_of({"0.npy", "0.pgm", "1.pgm"}), ElementsAre("0.pgm -", "1.pgm -"));
}

TEST(ListFolder, NamesOfPicturesCountMoreThanThatOfTheirFolder) {
  const TemporaryFolder folder;
  const std::string recording = folder / "my_depth_recording";
  for (const char* name : {"color_0.png", "depth_0.png", "left_0.png"}) put(recording + "/" + name, "");
  const FrameList list = list_folder(recording, {});
  ASSERT_EQ(list.frames.size(), 1U);
  EXPECT_THAT(list.frames[0].depth, HasSubstr("depth_0.png"));
  EXPECT_THAT(list.frames[0].colour, HasSubstr("color_0.png"));
}

TEST(ListFolder, TakesColourWhoseNameIsThatOfDepthWithoutTheWord) {
  EXPECT_THAT(pairs_of({"desk_1_1.png", "desk_1_1_depth.png", "desk_1_1_mask.png"}),
              ElementsAre("desk_1_1_depth.png desk_1_1.png"));
  EXPECT_THAT(pairs_of({"left000001.png", "depth000001.png", "right000001.png"}),
              ElementsAre("depth000001.png left000001.png"));
  EXPECT_THAT(pairs_of({"gt_depth/1.png", "left/1.png", "right/1.png"}), ElementsAre("gt_depth/1.png left/1.png"));
  EXPECT_THAT(pairs_of({"depth/1.png", "left/1.png", "rgb_small/1.png"}), ElementsAre("depth/1.png rgb_small/1.png"));
  EXPECT_THAT(pairs_of({"depth/left_1.png", "depth/right_1.png"}),
              ElementsAre("depth/left_1.png -", "depth/right_1.png -"));
}

TEST(ListFolder, TakesNoPictureForDepthThatCannotBeWhereOneCan) {
  const std::string colours = encode_png(ColourImage(8, 6)), grey = "P5 2 2 255\n1234";
  const std::string depth = encode_png(DepthImage(8, 6)), array = "\x93NUMPY";
  const auto depths_of = [](const std::map<std::string, std::string>& files) {
    const TemporaryFolder folder;
    for (const auto& [name, bytes] : files) put(folder / name, bytes);
    std::vector<std::string> depths;
    for (const FrameFiles& f : list_folder(folder.path(), {}).frames) {
      depths.push_back(std::filesystem::relative(f.depth, folder.path()).string());
    }
    return depths;
  };
  EXPECT_THAT(depths_of({{"depth_color/1.png", colours}, {"depth_raw/1.png", depth}}), ElementsAre("depth_raw/1.png"));
  EXPECT_THAT(depths_of({{"depth_1.png", colours}, {"depth_1.npy", array}}), ElementsAre("depth_1.npy"));
  EXPECT_THAT(depths_of({{"1_depth.png", depth}, {"1_depth_colored.png", colours}, {"1_depth_c.pgm", grey}}),
              ElementsAre("1_depth.png"));
  EXPECT_THAT(depths_of({{"1.png", "cut"}, {"2.png", depth}}), ElementsAre("1.png", "2.png"));
  EXPECT_THAT(depths_of({{"depth_1.png", colours}, {"depth_2.png", colours}}),
              ElementsAre("depth_1.png", "depth_2.png"))
      << "none can";
}

TEST(ListFolder, MasksOfDepthAreNoDepth) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"fx": 50})");
  for (const char* name : {"0_depth.png", "0_depth_mask.png", "1_depth.png", "1_depth_mask.png"}) {
    put(folder / name, encode_png(DepthImage(64, 48, 1000)));
  }
  EXPECT_EQ(open_source(folder.path())->size(), 2);
}

TEST(ListFolder, SaysWhyColourIsNotTaken) {
  const auto notes_of = [](const std::vector<std::string>& files) {
    const TemporaryFolder folder;
    for (const std::string& file : files) put(folder / file, "");
    return list_folder(folder.path(), {}).notes;
  };
  EXPECT_THAT(notes_of({"depth/1.png", "rgb/1.gif"}),
              ElementsAre(HasSubstr("no colour: rgb/*.gif: not read, expected")));
  EXPECT_THAT(notes_of({"depth/1.png", "rgb.mp4"}), ElementsAre(HasSubstr("films are not read; ffmpeg -i")));
  EXPECT_THAT(notes_of({"depth/1.png", "iphone/1.jpg"}), ElementsAre(HasSubstr("iphone/*.jpg: its name does not say")));
  EXPECT_THAT(notes_of({"depth/1.png", "masks/1.jpg", "preview.jpg", "rgb.txt", "color_k.npy"}), testing::IsEmpty());
  const TemporaryFolder folder;
  put(folder / "D1.png", encode_png(DepthImage(8, 6)));
  put(folder / "C1.png", encode_png(ColourImage(8, 6)));
  put(folder / "A1_mask.png", encode_png(ColourImage(8, 6)));
  EXPECT_THAT(list_folder(folder.path(), {}).notes, ElementsAre(HasSubstr("no colour: C1.png: its name does not say")));
}

TEST(ListFolder, TakesTimesThatAreNames) {
  using testing::ElementsAre;
  EXPECT_THAT(times_of({"1700000000.033000", "1700000000.5", "1700000000.000000"}, "{}"),
              ElementsAre(1700000000.0, 1700000000.033, 1700000000.5));
  EXPECT_THAT(pairs_of({"depth/1700000000000.png", "depth/1700000000033.png", "depth/1700000000066.png",
                        "rgb/1700000000037.jpg", "rgb/1700000000004.jpg", "rgb/1700000000100.jpg"}),
              ElementsAre("depth/1700000000000.png rgb/1700000000004.jpg",
                          "depth/1700000000033.png rgb/1700000000037.jpg", "depth/1700000000066.png -"));
}

TEST(ListFolder, SaysWhatThereIsWhereNothingIsOfDepth) {
  const TemporaryFolder folder;
  put(folder / "depth/0.npz", "");
  put(folder / "depth/1.npz", "");
  put(folder / "depth/2.jpg", "");
  put(folder / "rgb/0.png", "");
  EXPECT_THAT(error_of([&] { list_folder(folder.path(), {}); }),
              testing::AllOf(HasSubstr("depth: no frames, expected 16-bit depth PNG files\n"), HasSubstr("depth/*.npz"),
                             HasSubstr("2  not taken: depth of .npz, expected PNG of 16 bits"),
                             HasSubstr("JPEG loses depth"), HasSubstr("rgb/*.png")));
}

/// A folder as a tool leaves it, whose camera has the focal length 210 for 256x192 pixels.
struct Layout {
  const char* tool;
  const char* depth;
  const char* colour;
  const char* calibration;
  const char* text;
  int colour_width = 256;
};

TEST(ListFolder, FindsCalibrationsWhereToolsPutThem) {
  const std::vector<Layout> layouts{
      {"Stray Scanner", "depth/000000.png", "rgb/000000.png", "camera_matrix.csv",
       "1575.0,0.0,959.5\n0.0,1575.0,719.5\n0.0,0.0,1.0\n", 1920},
      {"ScanNet++", "depth/frame_000010.png", "rgb/frame_000010.jpg", "pose_intrinsic_imu.json",
       R"({"frame_000010": {"poses": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]],
           "intrinsic": [[1575, 0, 959.5], [0, 1575, 719.5], [0, 0, 1]]}})",
       1920},
      {"Record3D", "depth/0.png", "rgb/0.jpg", "metadata.json",
       R"({"w": 960, "h": 720, "K": [787.5, 0, 0, 0, 787.5, 0, 479.5, 359.5, 1], "fps": 60})", 960},
      {"3D Scanner App", "depth_00000.png", "frame_00000.jpg", "frame_00000.json",
       R"({"intrinsics": [1575, 0, 959.5, 0, 1575, 719.5, 0, 0, 1], "time": 1.5})", 1920},
      {"Polycam", "depth/1000.png", "images/1000.jpg", "cameras/1000.json",
       R"({"fx": 840, "fy": 840, "cx": 511.5, "cy": 383.5, "width": 1024, "height": 768})", 1024},
      {"ARKitScenes", "lowres_depth/1_6845.400.png", "lowres_wide/1_6845.400.png", "lowres_wide_intrinsics/1_6.pincam",
       "256 192 210 210 127.5 95.5"},
      {"Matterport", "matterport_depth_images/0b_d0_0.png", "matterport_color_images/0b_i0_0.jpg",
       "matterport_camera_intrinsics/0b_intrinsics_0.txt", "256 192 210 210 127.5 95.5 0 0 0 0 0\n"},
      {"SceneNN", "depth/depth00001.png", "image/image00001.png", "asus.ini", "fx=210\nfy=210\ncx=127.5\ncy=95.5\n"},
      {"ORB-SLAM3", "depth/0.png", "rgb/0.png", "TUM1.yaml",
       "%YAML:1.0\nCamera.type: \"PinHole\"\nCamera1.fx: 210\nCamera1.fy: 210\nCamera1.cx: 127.5\nCamera1.cy: 95.5\n"},
      {"ZED", "depth/0.png", "color/0.png", "SN12345.conf",
       "[LEFT_CAM_HD]\nfx=525\nfy=525\ncx=640\ncy=360\n[LEFT_CAM_VGA]\nfx=210\nfy=210\ncx=127.5\ncy=95.5\n"},
      {"Panoptic", "kinectdepth/N_0.png", "kinectcolor/N_0.png", "kcalibration.json",
       R"({"sensors": [{"K_depth": [[210, 0, 127.5], [0, 210, 95.5], [0, 0, 1]],
           "K_color": [[1060, 0, 959.5], [0, 1060, 539.5], [0, 0, 1]]}]})"}};
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.tool);
    const TemporaryFolder folder;
    put(folder / layout.depth, encode_png(DepthImage(256, 192, 2000)));
    put(folder / layout.colour,
        encode_png(ColourImage(layout.colour_width, layout.colour_width * 3 / 4, {10, 20, 30})));
    put(folder / layout.calibration, layout.text);
    const auto frame = open_source(folder.path())->next();
    EXPECT_NEAR(frame->camera.fx, 210.0, 1e-3);
    EXPECT_NEAR(frame->camera.cx, 127.5, 0.5);
    ASSERT_TRUE(frame->colour.same_size(frame->depth));
    EXPECT_EQ(frame->colour(128, 96), (Rgb{10, 20, 30}));
  }
}

TEST(ListFolder, TakesACalibrationFromAboveWithANote) {
  const TemporaryFolder folder;
  put(folder / "cam_params.json", R"({"camera": {"w": 64, "h": 48, "fx": 50, "cx": 31, "cy": 23, "scale": 6553.5}})");
  put(folder / "room0/results/depth000000.png", encode_png(DepthImage(64, 48, 6554)));
  const auto source = open_source(folder / "room0/results");
  EXPECT_EQ(source->next()->depth(0, 0), 1000);
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("no calibration beside the pictures; taken from")));
  put(folder / "room0/results/intrinsics.txt", "60 60 31 23\n");
  EXPECT_EQ(open_source(folder / "room0/results")->next()->camera.fx, 60.F) << "the nearer one";
}

TEST(ListFolder, NamesTheFolderThatHasFrames) {
  const TemporaryFolder folder;
  put(folder / "cam_1/depth/0.png", encode_png(DepthImage(64, 48, 1000)));
  put(folder / "notes.txt", "hello");
  EXPECT_THAT(error_of([&] { open_source(folder.path()); }), HasSubstr("cam_1 has some"));
}

TEST(ListFolder, NamesFramesThatLieDeep) {
  for (const char* file : {"mav0/cam0/data/000001.png", "2024/day 1/rec_0.mcap", "a/b/c/depth/0.png", "x/cloud.pcd"}) {
    const TemporaryFolder folder;
    put(folder / "none/of/them.txt", "hello");
    put(folder / file, encode_png(DepthImage(64, 48, 1000)));
    const std::string has = std::filesystem::path(file).parent_path().string();
    const std::string above = has.substr(0, has.find("/depth"));
    EXPECT_THAT(error_of([&] { open_source(folder.path()); }), HasSubstr(above + " has some")) << file;
  }
}

}  // namespace
}  // namespace vesalius

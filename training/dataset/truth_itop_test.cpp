#include "dataset/truth_itop.h"

#include "dataset/open_truth.h"
#include "dataset/test_hdf5.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kPixels = 320 * 240;

/// Files of `rows` frames in the form of ITOP; the second frame is not valid. Frame r shows a wall at r + 2 m, its
/// first r pixels have part 3, and joint j is at (0.1 j, 1, 2.5).
struct Files {
  test::TemporaryFolder folder;
  std::string depth = folder / "ITOP_side_test_depth_map.h5";
  std::string labels = folder / "ITOP_side_test_labels.h5";

  explicit Files(hsize_t rows, hsize_t label_rows = 0, hsize_t joints = 15) {
    if (label_rows == 0) label_rows = rows;
    const hid_t half = test::half_float();
    std::vector<float> metres, parts, xyz, valid;
    for (hsize_t row = 0; row < rows; ++row) {
      metres.insert(metres.end(), kPixels, static_cast<float>(row) + 2.F);
    }
    metres[1] = 0.F;
    metres[2] = std::numeric_limits<float>::quiet_NaN();
    metres[3] = 0.0001F;
    metres[kPixels - 1] = 1.5F;
    for (hsize_t row = 0; row < label_rows; ++row) {
      parts.insert(parts.end(), kPixels, -1.F);
      std::fill_n(parts.end() - kPixels, row, 3.F);
      for (hsize_t j = 0; j < joints; ++j) xyz.insert(xyz.end(), {0.1F * static_cast<float>(j), 1.F, 2.5F});
      valid.push_back(row == 1 ? 0.F : 1.F);
    }
    test::Hdf5Writer(depth).put("data", {rows, 240, 320}, metres, half, {1, 240, 320});
    test::Hdf5Writer file(labels);
    file.put("is_valid", {label_rows}, valid, H5T_STD_U8LE);
    file.put("segmentation", {label_rows, 240, 320}, parts, H5T_STD_I8LE, {1, 240, 320});
    file.put("real_world_coordinates", {label_rows, joints, 3}, xyz, half);
    H5Tclose(half);
  }
};

TEST(Itop, ReadsPersonJointsAndMask) {
  const Files files(3);
  ASSERT_TRUE(is_itop(files.depth));
  const auto source = open_truth(files.depth);
  EXPECT_EQ(source->size(), 2);
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("1 of 3 frames have no valid labels")));
  const auto first = source->next();
  EXPECT_EQ(first->frame.name, "000000");
  EXPECT_EQ(first->frame.depth.width(), 320);
  EXPECT_EQ(first->frame.depth(0, 0), 2000);
  for (const int u : {1, 2, 3}) EXPECT_EQ(first->frame.depth(u, 0), 0) << u;
  EXPECT_EQ(first->frame.depth(319, 239), 1500);
  EXPECT_EQ(first->truth.people, 1);
  EXPECT_TRUE(first->truth.mask.empty());  // no pixel is marked
  const auto third = source->next();
  EXPECT_EQ(third->frame.name, "000002");
  EXPECT_EQ(third->truth.mask(1, 0), 1);
  EXPECT_EQ(third->truth.mask(2, 0), 0);
  EXPECT_EQ(third->truth.joint_set, "itop15");
  EXPECT_EQ(third->truth.joint_names.at(3), "l_shoulder");
  ASSERT_EQ(third->truth.joints.size(), 1U);
  EXPECT_LT((third->truth.joints[0].at(3) - Eigen::Vector3f(0.3F, -1.F, 2.5F)).norm(), 1e-3F);  // y points down here
  EXPECT_FALSE(source->next());
}

/// The data set relates metres and pixels by its own formula; our camera must give the same pixel.
TEST(Itop, CameraProjectsJointsAsTheDataSetDoes) {
  const Files files(1);
  const auto frame = open_itop(files.depth, 1)->next();
  const Eigen::Vector2f pixel = frame->frame.camera.pixel({0.7F, -0.35F, 2.F});  // y up: 0.35
  EXPECT_NEAR(pixel.x(), 160.F + 0.7F / (0.0035F * 2.F), 1e-3F);
  EXPECT_NEAR(pixel.y(), 120.F - 0.35F / (0.0035F * 2.F), 1e-3F);
}

TEST(Itop, StepCountsValidFramesOnly) {
  const Files files(5);
  const auto source = open_itop(files.depth, 2);
  EXPECT_EQ(source->size(), 2);
  EXPECT_EQ(source->next()->frame.name, "000000");
  EXPECT_EQ(source->next()->frame.name, "000003");
}

TEST(Itop, RefusesFilesThatDoNotFit) {
  const auto error = [](const Files& files) { return test::error_of([&] { open_truth(files.depth); }); };
  EXPECT_THAT(error(Files(2, 3)), HasSubstr("_labels.h5: 3 rows, expected 2 as in the depth maps"));
  EXPECT_THAT(error(Files(1, 1, 14)),
              HasSubstr("real_world_coordinates: shape 1x14x3, expected any number of rows of"));
  const Files files(1);
  std::filesystem::remove(files.labels);
  EXPECT_THAT(error(files), HasSubstr("_labels.h5: cannot be read, expected an HDF5 file"));
}

}  // namespace
}  // namespace vesalius

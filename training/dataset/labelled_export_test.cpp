#include "dataset/labelled_export.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "dataset/test_dataset.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_labelled;
using testing::HasSubstr;

TEST(LabelledExport, IsReadAsAFolderOfFrames) {
  test::TemporaryFolder folder;
  LabelledExporter exporter(folder / "out", paper_body(), test::kJoints);
  for (const std::uint64_t i : {1U, 2U}) exporter.write(random_labelled(i));
  const auto source = open_source(folder / "out");
  for (const std::uint64_t i : {1U, 2U}) {
    const LabelledFrame expected = random_labelled(i);
    const std::optional<Frame> frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->name, expected.frame.name);
    EXPECT_EQ(frame->camera, expected.frame.camera);
    EXPECT_EQ(frame->depth, expected.frame.depth);
    EXPECT_EQ(frame->colour, expected.frame.colour);
    EXPECT_EQ(read_png8(folder / ("out/labels/" + frame->name + ".png")), expected.labels);
    EXPECT_EQ(read_png8(folder / ("out/person/" + frame->name + ".png")), expected.person);
  }
  EXPECT_FALSE(source->next());
}

TEST(LabelledExport, NamesThePartsAndSaysWhichAreMissing) {
  test::TemporaryFolder folder;
  const LabelledFrame labelled = random_labelled(1);
  LabelledExporter(folder / "out", paper_body(), test::kJoints).write(labelled);
  const auto json = nlohmann::json::parse(test::get(folder / "out/truth/frame_1.json"));
  EXPECT_EQ(json["frame"], "frame_1");
  ASSERT_EQ(json["people"].size(), 2U);
  EXPECT_EQ(json["people"][1]["index"], 1);
  EXPECT_TRUE(json["people"][1]["parts_m"]["neck"].is_null());
  const auto& knee = json["people"][0]["parts_m"]["l_knee"];
  const int index = paper_body().find_part("l_knee");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(knee[axis].get<float>(), labelled.parts[0][index][axis], 6e-5F);
  }
  const auto& foot = json["people"][1]["joints_m"]["foot"];
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(foot[axis].get<float>(), labelled.joints[1][2][axis], 6e-5F);
  }
  EXPECT_EQ(test::get(folder / "out/body.toml"), paper_body().toml);
}

TEST(LabelledExport, RefusesWhatItCannotWrite) {
  test::TemporaryFolder folder;
  LabelledExporter exporter(folder / "out", paper_body(), test::kJoints);
  LabelledFrame wrong = random_labelled(1);
  wrong.labels[0] = 99;
  EXPECT_THAT(error_of([&] { exporter.write(wrong); }), HasSubstr("frame frame_1: label 99"));
  LabelledFrame unnamed = random_labelled(1);
  for (auto& joints : unnamed.joints) joints.pop_back();
  EXPECT_THAT(error_of([&] { exporter.write(unnamed); }), HasSubstr("person with 2 joints, expected 3"));
  LabelledFrame escaping = random_labelled(1);
  escaping.frame.name = "../../escaped";
  EXPECT_THAT(error_of([&] { exporter.write(escaping); }), HasSubstr("expected a file name"));
  exporter.write(random_labelled(1));
  EXPECT_THAT(error_of([&] { exporter.write(random_labelled(1)); }), HasSubstr("two frames named"));
  EXPECT_THAT(error_of([&] { LabelledExporter again(folder / "out", paper_body(), test::kJoints); }),
              HasSubstr("has files in it"));
}

}  // namespace
}  // namespace vesalius

#include "dataset/labelled_folder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "dataset/test_dataset.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_labelled;
using testing::HasSubstr;

/// A folder with the random frames 1, 2 and 3. The third shows nobody.
struct Exported {
  test::TemporaryFolder folder;
  Exported() {
    LabelledExporter exporter(path(), paper_body(), test::kJoints);
    for (const std::uint64_t i : {1U, 2U, 3U}) exporter.write(frame(i));
  }
  std::string path() const { return folder / "out"; }
  static LabelledFrame frame(std::uint64_t i) {
    LabelledFrame labelled = random_labelled(i);
    labelled.up = Eigen::Vector3f(0.F, -0.8F, 0.6F);
    labelled.postures = {"standing", "sitting"};
    if (i != 3) return labelled;
    labelled.postures.clear();
    labelled.parts.clear();
    labelled.joints.clear();
    labelled.labels.fill(kBackground);
    labelled.person.fill(kBackground);
    return labelled;
  }
};

void expect_near(const std::vector<std::vector<Eigen::Vector3f>>& a,
                 const std::vector<std::vector<Eigen::Vector3f>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].size(), b[i].size());
    for (std::size_t p = 0; p < a[i].size(); ++p) {
      EXPECT_TRUE((a[i][p].hasNaN() && b[i][p].hasNaN()) || (a[i][p] - b[i][p]).cwiseAbs().maxCoeff() < 6e-5F);
    }
  }
}

TEST(LabelledFolder, ReadsWhatWasExported) {
  const Exported exported;
  ASSERT_TRUE(is_labelled_folder(exported.path()));
  const LabelledFolder folder(exported.path());
  ASSERT_EQ(folder.size(), 3U);
  EXPECT_EQ(folder.body().toml, paper_body().toml);
  EXPECT_EQ(folder.joint_names(), test::kJoints);
  for (const std::uint64_t i : {2U, 0U, 1U}) {
    const LabelledFrame expected = Exported::frame(i + 1);
    const LabelledFrame read = folder.read(i);
    EXPECT_EQ(read.frame.name, expected.frame.name);
    EXPECT_EQ(read.postures, expected.postures);
    EXPECT_EQ(read.up, expected.up);
    EXPECT_EQ(read.frame.camera, expected.frame.camera);
    EXPECT_EQ(read.frame.depth, expected.frame.depth);
    EXPECT_EQ(read.frame.colour, expected.frame.colour);
    EXPECT_EQ(read.labels, expected.labels);
    EXPECT_EQ(read.person, expected.person);
    expect_near(read.parts, expected.parts);
    expect_near(read.joints, expected.joints);
    EXPECT_TRUE(folder.read(i, false).frame.colour.empty());
  }
}

TEST(LabelledFolder, IsTruthForEvaluation) {
  const Exported exported;
  const auto truth = open_truth(exported.path(), 2);
  EXPECT_EQ(truth->size(), 2);
  EXPECT_EQ(truth->part_names(), part_names_of(paper_body()));
  const auto first = truth->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->truth.people, 2);
  EXPECT_EQ(first->truth.labels, Exported::frame(1).labels);
  const auto last = truth->next();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->truth.people, 0);
  EXPECT_FALSE(truth->next());
}

TEST(LabelledFolder, HashesItsContent) {
  const Exported one;
  const Exported two;
  const std::uint64_t hash = LabelledFolder(one.path()).content_hash();
  EXPECT_EQ(hash, LabelledFolder(two.path()).content_hash());
  std::filesystem::copy_file(two.path() + "/labels/frame_1.png", two.path() + "/labels/frame_2.png",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(hash, LabelledFolder(two.path()).content_hash());
}

TEST(LabelledFolder, NamesTheFileThatIsWrong) {
  const auto complaint = [](const std::function<void(const std::string&)>& harm) {
    const Exported exported;
    harm(exported.path());
    return error_of([&] { LabelledFolder(exported.path()).read(0); });
  };
  const auto put = [](const char* name, const char* text) {
    return [=](const std::string& path) { test::put(path + name, text); };
  };
  EXPECT_THAT(complaint([](const std::string& path) { std::filesystem::remove(path + "/labels/frame_1.png"); }),
              HasSubstr("labels/frame_1.png"));
  EXPECT_THAT(complaint([](const std::string& path) { std::filesystem::remove(path + "/meta.json"); }),
              HasSubstr("no intrinsics"));
  EXPECT_THAT(complaint([](const std::string& path) {
                std::filesystem::remove(path + "/meta.json");
                test::put(path + "/camera_info.yaml", "K: [50, 0, 9, 0, 50, 7, 0, 0, 1]\nD: [0.1, 0, 0, 0, 0]\n");
              }),
              HasSubstr("a distorted lens, expected labels of a pinhole camera"));
  EXPECT_THAT(complaint(put("/body.toml", "name = ")), HasSubstr("body.toml"));
  EXPECT_THAT(complaint(put("/truth/frame_1.json", "{")), HasSubstr("truth/frame_1.json: no \"people\""));
  EXPECT_THAT(complaint(put("/truth/frame_1.json", R"({"people": [7]})")), HasSubstr("no \"parts_m\""));
  EXPECT_THAT(complaint(put("/truth/frame_1.json", R"({"people": []})")), HasSubstr("frame frame_1: person"));
}

TEST(LabelledFolder, RefusesOtherFolders) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(is_labelled_folder(folder.path()));
  EXPECT_FALSE(is_labelled_folder(folder / "nothing"));
}

TEST(LabelledFolder, KnowsItsClipsAndWhereTheCameraIs) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "out";
  LabelledFrame labelled = random_labelled(1);
  labelled.camera_height_m = 1.375F;
  labelled.world_from_camera = test::camera_pose();
  {
    LabelledExporter exporter(path, paper_body(), test::kJoints, {2, 25.0});
    for (int i = 0; i < 4; ++i) {
      labelled.frame.name = "000" + std::to_string(i / 2) + "_00000" + std::to_string(i % 2);
      labelled.frame.time_s = 0.04 * (i % 2);
      exporter.write(labelled);
    }
  }
  const LabelledFolder read(path);
  EXPECT_EQ(read.clips(), (ClipLayout{2, 25.0}));
  const LabelledFrame last = read.read(3);
  EXPECT_EQ(last.frame.time_s, 0.04);
  EXPECT_EQ(last.camera_height_m, 1.375F);
  EXPECT_TRUE(last.world_from_camera->isApprox(*labelled.world_from_camera, 1e-6F));
  const auto source = open_truth(path);
  for (const int clip : {0, 0, 1, 1}) {
    const FrameTruth truth = source->next()->truth;
    EXPECT_EQ(truth.sequence, clip);
    EXPECT_EQ(truth.ids.size(), 2U);
    EXPECT_EQ(truth.camera_height_m, 1.375F);
  }
  for (const auto& [text, complaint] : {std::pair{"[]", "frames_per_clip"},
                                        {R"({"frames_per_clip": 0, "rate_hz": 30})", "expected 1 to"},
                                        {R"({"frames_per_clip": 2, "rate_hz": -1})", "rate_hz"}}) {
    test::put(path + "/clips.json", text);
    EXPECT_THAT(error_of([&] { LabelledFolder(path).size(); }), HasSubstr(complaint));
  }
}

TEST(LabelledFolder, HasFramesThatStandAlone) {
  const Exported exported;
  const auto source = open_truth(exported.path());
  const FrameTruth truth = source->next()->truth;
  EXPECT_EQ(truth.sequence, -1);
  EXPECT_TRUE(truth.ids.empty());
}

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

#include "export/write_people.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "export/test_people.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;
using test::kFrames;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

TEST(ToCsv, HasARowForEachFrameAndPerson) {
  const PeopleRecord record = test::people();
  const std::vector<std::string> rows = split(to_csv(record, 1), '\n');
  ASSERT_EQ(rows.size(), 1U + 2 * kFrames - 2);
  EXPECT_EQ(rows[0],
            "frame,time_s,person,score,nose_x_m,nose_y_m,nose_z_m,nose_confidence,nose_state,"
            "l_wrist_x_m,l_wrist_y_m,l_wrist_z_m,l_wrist_confidence,l_wrist_state");
  EXPECT_EQ(rows[1], "\"a,0\",0.000000,1,0.9000,0.1000,-0.5000,2.0000,0.8000,observed,,,,0.0000,none");
}

TEST(ToTrc, HasTheRowsOfOnePersonWithYUp) {
  const PeopleRecord record = test::people();
  const std::vector<std::string> rows = split(to_trc(record, 1, 7, "walk.trc"), '\n');
  EXPECT_EQ(rows[0], "PathFileType\t4\t(X/Y/Z)\twalk.trc");
  EXPECT_EQ(rows[2], "25.00\t25.00\t5\t2\tmm\t25.00\t1\t5");
  EXPECT_EQ(rows[3], "Frame#\tTime\tnose\t\t\tl_wrist\t\t");
  EXPECT_EQ(rows[4], "\t\tX1\tY1\tZ1\tX2\tY2\tZ2");
  ASSERT_EQ(rows.size(), 6U + 5);
  EXPECT_EQ(rows[6], "1\t0.000000\t1100.000\t500.000\t-2000.000\t\t\t");
  EXPECT_EQ(rows[7], "2\t0.040000\t\t\t\t\t\t") << "the frame in which nobody of that id is";
  EXPECT_THROW(to_trc(record, 1, 8, "x"), Error);
  EXPECT_THAT(people_in(record), testing::ElementsAre(1, 7));
}

TEST(ToCoco, HasKeypointsInPixelsWithTheirVisibility) {
  PeopleRecord record = test::people();
  record.frames[1].picture = "1.jpg";
  const json coco = json::parse(to_coco(record, 1));
  EXPECT_EQ(coco.at("images").at(0).at("file_name"), "a,0.png") << "as detect --save colour writes it";
  EXPECT_EQ(coco.at("images").at(1).at("file_name"), "1.jpg");
  EXPECT_EQ(coco.at("images").size(), kFrames);
  EXPECT_EQ(coco.at("annotations").size(), 2U * kFrames - 2);
  const json& first = coco.at("annotations").at(0);
  EXPECT_EQ(first.at("keypoints"), (json{345.0, 109.5, 2, 0.0, 0.0, 0}));
  EXPECT_EQ(first.at("num_keypoints"), 1);
  EXPECT_EQ(first.at("bbox"), (json{10, 20, 30, 40}));
  EXPECT_EQ(coco.at("categories").at(0).at("keypoints"), (json{"nose", "l_wrist"}));
}

TEST(ToK4abt, HasTheKeysOfTheOfflineProcessor) {
  const json k4a = json::parse(to_k4abt(test::people(), "walk.jsonl"));
  EXPECT_EQ(k4a.at("joint_names"), (json{"PELVIS", "WRIST_LEFT"}));
  EXPECT_EQ(k4a.at("bone_list").size(), 31U);
  const json& frame = k4a.at("frames").at(2);
  EXPECT_EQ(frame.at("frame_id"), 2);
  EXPECT_EQ(frame.at("timestamp_usec"), 80000);
  EXPECT_EQ(frame.at("num_bodies"), 1) << "the second person is away";
  EXPECT_EQ(frame.at("bodies").at(0).at("joint_positions").at(0), (json{100.0, 200.0, 2000.0}));
  EXPECT_EQ(frame.at("bodies").at(0).at("joint_orientations").at(1), (json{0.5, -0.5, 0.5, -0.5}));
  EXPECT_EQ(frame.at("bodies").at(0).at("joint_orientations").at(0), (json{1.0, 0.0, 0.0, 0.0}));
}

TEST(ZxyDegrees, GiveTheRotationBack) {
  Random random(4);
  const auto about = [](double degrees, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis);
  };
  for (int i = 0; i < 200; ++i) {
    const auto turn = [&] { return random.uniform(-180.0, 180.0); };
    const double x = i % 20 == 0 ? (i % 40 == 0 ? 90.0 : -90.0) : turn();
    const Eigen::Quaterniond rotation = about(turn(), Eigen::Vector3d::UnitZ()) * about(x, Eigen::Vector3d::UnitX()) *
                                        about(turn(), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d angles = zxy_degrees(rotation);
    const Eigen::Quaterniond back = about(angles[0], Eigen::Vector3d::UnitZ()) *
                                    about(angles[1], Eigen::Vector3d::UnitX()) *
                                    about(angles[2], Eigen::Vector3d::UnitY());
    EXPECT_LT(rotation.angularDistance(back), 1e-6) << angles.transpose();
  }
}

/// Where bones' heads and ends are in every frame of a BVH file, centimetres, read as its format says.
std::map<std::string, std::vector<Eigen::Vector3d>> places_in_bvh(const std::string& text) {
  struct Node {
    std::string name;
    int parent;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    int channels = 0;
  };
  std::vector<Node> nodes;
  std::vector<int> open;
  std::istringstream in(text);
  std::string word;
  while (in >> word && word != "MOTION") {
    if (word == "ROOT" || word == "JOINT" || word == "End") {
      std::string name;
      in >> name;
      if (word == "End") name = nodes[open.back()].name + " end";
      nodes.push_back({name, open.empty() ? -1 : open.back()});
    } else if (word == "{") {
      open.push_back(static_cast<int>(nodes.size()) - 1);
    } else if (word == "}") {
      open.pop_back();
    } else if (word == "OFFSET") {
      for (double& axis : nodes.back().offset) in >> axis;
    } else if (word == "CHANNELS") {
      in >> nodes.back().channels;
    }
  }
  int frames = 0;
  double step = 0.0;
  in >> word >> frames >> word >> word >> step;
  std::map<std::string, std::vector<Eigen::Vector3d>> places;
  for (int f = 0; f < frames; ++f) {
    std::vector<Eigen::Vector3d> at(nodes.size());
    std::vector<Eigen::Quaterniond> turn(nodes.size(), Eigen::Quaterniond::Identity());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      Eigen::Vector3d place = nodes[n].offset;
      if (nodes[n].channels == 6) {
        for (double& axis : place) in >> axis;
      }
      const int parent = nodes[n].parent;
      at[n] = parent < 0 ? place : Eigen::Vector3d(at[parent] + turn[parent] * place);
      turn[n] = parent < 0 ? Eigen::Quaterniond::Identity() : turn[parent];
      for (const int axis : {2, 0, 1}) {
        double degrees = 0.0;
        if (nodes[n].channels > 0) in >> degrees;
        turn[n] = turn[n] * Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::Unit(axis));
      }
      places[nodes[n].name].push_back(at[n]);
    }
  }
  return places;
}

TEST(ToBvh, PutsJointsWhereTheBodyHasThem) {
  const PeopleRecord record = test::people();
  const std::vector<MovingSkeleton> skeletons = moving_skeletons(record, 1);
  ASSERT_EQ(skeletons.size(), 1U);
  const std::string bvh = to_bvh(skeletons[0]);
  EXPECT_THAT(bvh, testing::StartsWith("HIERARCHY\nROOT Hips\n"));
  EXPECT_THAT(bvh, testing::HasSubstr("Frames: 6\nFrame Time: 0.040000\n"));
  const auto places = places_in_bvh(bvh);
  for (std::size_t f = 0; f < kFrames; ++f) {
    const RecordedPerson& person = record.frames[f].people[0];
    for (const auto& [bone, name] : {std::pair{0, "Hips"}, std::pair{1, "Spine"}, std::pair{2, "LeftUpLeg"}}) {
      const Eigen::Vector3d head = person.body->bones[bone].head.cast<double>();
      const Eigen::Vector3d expected = 100.0 * Eigen::Vector3d(head.x(), -head.y(), -head.z());
      EXPECT_LT((places.at(name)[f] - expected).norm(), 0.02) << name << " in frame " << f;
    }
    const Eigen::Vector3d tail = person.body->bones[2].tail.cast<double>();
    EXPECT_LT((places.at("LeftUpLeg end")[f] - 100.0 * Eigen::Vector3d(tail.x(), -tail.y(), -tail.z())).norm(), 0.02);
  }
}

TEST(MovingSkeletons, GoOnWhereAPersonIsAwayAndSayWhenNobodyHasABody) {
  const PeopleRecord record = test::people();
  const std::vector<MovingSkeleton> all = moving_skeletons(record, std::nullopt);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].id, 7);
  ASSERT_EQ(all[1].poses.size(), 5U);
  EXPECT_EQ(all[1].poses[1].root_m, all[1].poses[0].root_m);
  EXPECT_DOUBLE_EQ(all[1].poses[1].time_s, 0.08);
  EXPECT_THAT([&] { moving_skeletons(record, 3); }, testing::ThrowsMessage<Error>(testing::HasSubstr("person 3")));
  EXPECT_THROW(moving_skeletons(parse_people(test::lines(false), "x", {}), std::nullopt), Error);
}

}  // namespace
}  // namespace vesalius

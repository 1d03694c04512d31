#include "ros2/messages/people_topics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "io/recordings/camera_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/people_messages.h"
#include "ros2/messages/test_people.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

class Kept final : public MessageSink {
 public:
  bool wants(const Topic& topic) override { return !unwanted.contains(topic.name); }
  void put(const Topic& topic, std::int64_t time_ns, std::string_view message) override {
    EXPECT_FALSE(unwanted.contains(topic.name));
    messages[topic.name] = message;
    types[topic.name] = topic.type;
    latched[topic.name] = topic.latched;
    times.insert(time_ns);
  }
  void end(const std::string& topic) override { ended.insert(topic); }

  std::set<std::string> unwanted, ended;
  std::map<std::string, std::string> messages, types;
  std::map<std::string, bool> latched;
  std::set<std::int64_t> times;
};

const LabelledFrame& truth() {
  static const LabelledFrame made = test::two_people(160, 120);
  return made;
}
const Stamp kStamp{5'000'000'007, "camera"};
const std::string kPlace = "test";

std::string no_line() { return "{}"; }

MessageFields fields(const std::string& message) { return {message, MessageLayout::cdr, kPlace}; }

PictureMessage picture(const Kept& kept, const std::string& topic) {
  return parse_picture({topic, "sensor_msgs/Image", MessageLayout::cdr}, kept.messages.at(topic), kPlace);
}

TEST(PeopleTopics, WriteEveryTopicOnceForAFrame) {
  Kept kept;
  PeopleTopics(paper_body(), {.name_space = "/robot", .node = "eye", .frames = true}, kept)
      .write(truth().frame, test::tracked(truth()), no_line, kStamp);
  std::vector<std::string> names;
  for (const auto& [name, type] : kept.types)
    names.push_back(name + " " + type + (kept.latched.at(name) ? " latched" : ""));
  EXPECT_THAT(
      names,
      UnorderedElementsAre(
          "/humans/bodies/p12/roi hri_msgs/NormalizedRegionOfInterest2D",
          "/humans/bodies/p12/skeleton2d hri_msgs/Skeleton2D",
          "/humans/bodies/p3/roi hri_msgs/NormalizedRegionOfInterest2D",
          "/humans/bodies/p3/skeleton2d hri_msgs/Skeleton2D", "/humans/bodies/tracked hri_msgs/IdsList latched",
          "/robot/eye/body_index sensor_msgs/Image", "/robot/eye/camera_info sensor_msgs/CameraInfo",
          "/robot/eye/color/camera_info sensor_msgs/CameraInfo", "/robot/eye/color/image_rect sensor_msgs/Image",
          "/robot/eye/depth/camera_info sensor_msgs/CameraInfo", "/robot/eye/depth/image_rect sensor_msgs/Image",
          "/robot/eye/labels sensor_msgs/Image", "/robot/eye/markers visualization_msgs/MarkerArray",
          "/robot/eye/people std_msgs/String", "/robot/eye/points sensor_msgs/PointCloud2", "/tf tf2_msgs/TFMessage"));
  EXPECT_THAT(kept.times, ElementsAre(kStamp.time_ns));
  for (const auto& [name, type] : kept.types) EXPECT_FALSE(message_definition(type).empty()) << "for recordings";
}

TEST(PeopleTopics, IndicesArePlacesInTheListOfBodies) {
  Kept kept;
  TrackedFrame people = test::tracked(truth());
  people.people.insert(people.people.begin(), test::person_of(truth(), 0, 1));
  people.people.front().state = TrackState::lost;  // is not among them
  PeopleTopics(paper_body(), {}, kept).write(truth().frame, people, no_line, kStamp);
  MessageFields ids = fields(kept.messages.at("/humans/bodies/tracked"));
  std::string frame;
  EXPECT_EQ(ids.header(frame), kStamp.time_ns);
  EXPECT_EQ(frame, "camera");
  ASSERT_EQ(ids.u32("count"), 2U);
  EXPECT_EQ(ids.text("id"), "p3");
  EXPECT_EQ(ids.text("id"), "p12");
  const PictureMessage index = picture(kept, "/vesalius/body_index"), labels = picture(kept, "/vesalius/labels");
  EXPECT_EQ(index.encoding, "mono8");
  EXPECT_EQ(index.time_ns, kStamp.time_ns);
  for (std::size_t i = 0; i < truth().person.size(); ++i) {
    ASSERT_EQ(static_cast<std::uint8_t>(index.data[i]), truth().person.data()[i]);
    ASSERT_EQ(static_cast<std::uint8_t>(labels.data[i]), truth().labels.data()[i]);
  }
}

struct CloudPoint {
  float x, y, z;
  std::uint32_t rgb, label, body;
};

TEST(CloudMessage, HasAPointForEachPixelOfAPerson) {
  Kept kept;
  PeopleTopics(paper_body(), {}, kept).write(truth().frame, test::tracked(truth()), no_line, kStamp);
  MessageFields cloud = fields(kept.messages.at("/vesalius/points"));
  std::string frame;
  cloud.header(frame);
  EXPECT_EQ(cloud.u32("height"), 1U);
  const std::uint32_t count = cloud.u32("width");
  std::vector<std::string> names;
  const std::uint32_t field_count = cloud.u32("fields");
  for (std::uint32_t i = 0; i < field_count; ++i) {
    names.emplace_back(cloud.text("name"));
    EXPECT_EQ(cloud.u32("offset"), 4 * i);
    EXPECT_EQ(cloud.u8("type"), i < 4 ? 7 : 6) << "float32 and uint32";
    EXPECT_EQ(cloud.u32("count"), 1U);
  }
  EXPECT_THAT(names, ElementsAre("x", "y", "z", "rgb", "label", "body"));
  EXPECT_EQ(cloud.u8("byte order"), 0);
  EXPECT_EQ(cloud.u32("step"), sizeof(CloudPoint));
  EXPECT_EQ(cloud.u32("row"), count * sizeof(CloudPoint));
  const std::string_view data = cloud.bytes("data");
  EXPECT_EQ(cloud.u8("dense"), 1);
  ASSERT_EQ(data.size(), count * sizeof(CloudPoint));
  std::size_t next = 0;
  const Frame& f = truth().frame;
  for (int v = 0; v < f.depth.height(); ++v) {
    for (int u = 0; u < f.depth.width(); ++u) {
      if (truth().person(u, v) == kBackground || f.depth(u, v) == 0) continue;
      ASSERT_LT(next, count);
      CloudPoint point;
      std::memcpy(&point, data.data() + next++ * sizeof point, sizeof point);
      const Eigen::Vector3f at = point_at(f.camera, f.depth, u, v);
      ASSERT_EQ(Eigen::Vector3f(point.x, point.y, point.z), at);
      ASSERT_EQ(point.label, truth().labels(u, v));
      ASSERT_EQ(point.body, truth().person(u, v) == 0 ? 3U : 12U);
      const Rgb colour = f.colour(u, v);
      ASSERT_EQ(point.rgb, (colour.r << 16U | colour.g << 8U | colour.b));
    }
  }
  EXPECT_EQ(next, count);
  EXPECT_GT(count, 500U);
}

TEST(CloudMessage, OfAWholeFrameHasItsRows) {
  Frame frame;
  frame.camera = {2, 2, 1.F, 1.F, 0.F, 0.F};
  frame.depth = DepthImage(2, 2);
  frame.depth(1, 0) = 1000;
  const Image<std::uint8_t> nobody(2, 2, kBackground);
  const std::string message = cloud_message(frame, nobody, nobody, {}, CloudExtent::frame, 0, "c");
  MessageFields cloud = fields(message);
  std::string id;
  cloud.header(id);
  EXPECT_EQ(cloud.u32("height"), 2U);
  EXPECT_EQ(cloud.u32("width"), 2U);
  CloudPoint points[4];
  ASSERT_GT(message.size(), sizeof points + 1);
  std::memcpy(points, message.data() + message.size() - 1 - sizeof points, sizeof points);
  EXPECT_TRUE(std::isnan(points[0].x));
  EXPECT_EQ(points[1].z, 1.F);
  EXPECT_EQ(points[1].label, 255U);
  EXPECT_EQ(points[1].body, 0U);
  EXPECT_EQ(message.back(), 0) << "some are no numbers";
}

TEST(HriMessages, AreInPartsOfThePicture) {
  const TrackedPerson person = test::person_of(truth(), 0, 3);
  const Camera& camera = truth().frame.camera;
  const std::string region = *region_message(person, camera, 1, "c");
  MessageFields box = fields(region);
  std::string frame;
  box.header(frame);
  EXPECT_EQ(box.real32("xmin"), static_cast<float>(person.person.box.u) / 160.F);
  EXPECT_EQ(box.real32("ymin"), static_cast<float>(person.person.box.v) / 120.F);
  EXPECT_EQ(box.real32("xmax"), static_cast<float>(person.person.box.u + person.person.box.width) / 160.F);
  EXPECT_EQ(box.real32("ymax"), static_cast<float>(person.person.box.v + person.person.box.height) / 120.F);
  EXPECT_EQ(box.real32("c"), 0.75F);
  const NamedJoints joints(paper_body());
  const std::string skeleton = skeleton_message(person, joints, camera, 1, "c");
  MessageFields points = fields(skeleton);
  points.header(frame);
  std::vector<Eigen::Vector3f> all;
  for (int i = 0; i < 18; ++i) {
    const float x = points.real32("x"), y = points.real32("y"), c = points.real32("c");
    all.emplace_back(x, y, c);
  }
  const Eigen::Vector2f elbow = camera.pixel(joints.find(person, "r_elbow")->position);
  EXPECT_NEAR(all[3].x(), (elbow.x() + 0.5F) / 160.F, 1e-6);
  EXPECT_NEAR(all[3].y(), (elbow.y() + 0.5F) / 120.F, 1e-6);
  EXPECT_GT(all[3].z(), 0.F);
  EXPECT_LT(all[2].x(), all[5].x()) << "the right shoulder is left in the picture of somebody who faces it";
  EXPECT_LT(all[0].y(), all[8].y());
}

TEST(HriMessages, HaveZerosForWhatIsNotInThePicture) {
  TrackedPerson person = test::person_of(truth(), 0, 3);
  person.person.box = {};
  EXPECT_FALSE(region_message(person, truth().frame.camera, 1, "c"));
  for (auto& set : person.person.joints) {
    for (Joint& joint : set) joint.position = {-50.F, 0.F, 1.F};
  }
  const std::string message = skeleton_message(person, NamedJoints(paper_body()), truth().frame.camera, 1, "c");
  MessageFields points = fields(message);
  std::string frame;
  points.header(frame);
  for (int i = 0; i < 18 * 3; ++i) EXPECT_EQ(points.real32("number"), 0.F);
}

TEST(PeopleTopics, EndThoseOfBodiesThatAreGone) {
  Kept kept;
  PeopleTopics topics(paper_body(), {}, kept);
  TrackedFrame people = test::tracked(truth());
  topics.write(truth().frame, people, no_line, kStamp);
  EXPECT_TRUE(kept.ended.empty());
  people.people.pop_back();
  topics.write(truth().frame, people, no_line, kStamp);
  EXPECT_THAT(kept.ended, UnorderedElementsAre("/humans/bodies/p12/roi", "/humans/bodies/p12/skeleton2d"));
  topics.clear(kStamp);
  EXPECT_TRUE(kept.ended.contains("/humans/bodies/p3/roi"));
  MessageFields ids = fields(kept.messages.at("/humans/bodies/tracked"));
  std::string frame;
  ids.header(frame);
  EXPECT_EQ(ids.u32("count"), 0U);
}

TEST(PeopleTopics, GoUnderOtherNames) {
  Kept kept;
  PeopleTopicsOptions options;
  options.remap = {{"/tf", "/robot/tf"}, {"/vesalius/points", "/cloud"}};
  PeopleTopics(paper_body(), options, kept).write(truth().frame, test::tracked(truth()), no_line, kStamp);
  EXPECT_TRUE(kept.types.contains("/robot/tf"));
  EXPECT_TRUE(kept.types.contains("/cloud"));
  EXPECT_FALSE(kept.types.contains("/tf"));
  options.remap = {{"/tf", "tf"}};
  EXPECT_THROW(PeopleTopics(paper_body(), options, kept), UsageError);
  EXPECT_THROW(PeopleTopics(paper_body(), {.id_prefix = "3"}, kept), UsageError);
}

TEST(PeopleTopics, MakeNothingThatNobodyWants) {
  Kept kept;
  kept.unwanted = {"/vesalius/body_index",  "/vesalius/labels",
                   "/vesalius/points",      "/vesalius/markers",
                   "/vesalius/people",      "/tf",
                   "/vesalius/camera_info", "/humans/bodies/p3/skeleton2d"};
  const auto line = [] {
    ADD_FAILURE() << "nobody wants the line";
    return std::string();
  };
  PeopleTopics(paper_body(), {}, kept).write(truth().frame, test::tracked(truth()), line, kStamp);
  EXPECT_TRUE(kept.types.contains("/humans/bodies/p3/roi"));
}

}  // namespace
}  // namespace vesalius::ros2

// The node of `vesalius ros2` with people who are known beforehand, so that nothing but the messages takes time.
//
// usage: ros2_sender DOMAIN rate SECONDS READERS   all topics at 30 Hz with pictures of 640x480, once /vesalius/labels
// has
//                                                  so many readers; prints how long writing took
//        ros2_sender DOMAIN types                  one message of each type to /to/<type>, which must come back from
//                                                  /from/<type> byte by byte; prints a line for each
//        ros2_sender DOMAIN latched SECONDS        one message for each latched topic, then waits

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <thread>

#include "ros2/dds/node_sink.h"
#include "ros2/messages/people_topics.h"
#include "ros2/messages/test_people.h"
#include "vesalius/error.h"

namespace {

using namespace vesalius;
using namespace std::chrono;
using Clock = steady_clock;

constexpr int kRate = 30;

bool wait_for(const std::function<bool()>& holds) {
  const auto end = Clock::now() + seconds(20);
  while (!holds()) {
    if (Clock::now() >= end) return false;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return true;
}

std::string no_line() { return "{}"; }

int rate(ros2::Node& node, int length_s, int readers) {
  const LabelledFrame truth = ros2::test::two_people(640, 480);
  const TrackedFrame people = ros2::test::tracked(truth);
  ros2::NodeSink sink(node);
  ros2::PeopleTopicsOptions options;
  options.frames = true;
  ros2::PeopleTopics topics(paper_body(), options, sink);
  topics.write(truth.frame, people, no_line, {0, "camera"});  // now all topics are there
  const ros2::Topic labels{"/vesalius/labels", "sensor_msgs/Image"};
  if (!wait_for([&] { return sink.readers(labels) >= readers; })) {
    std::cerr << "ros2_sender: no readers\n";
    return 1;
  }
  std::this_thread::sleep_for(seconds(1));  // for the readers of the other topics
  double longest_ms = 0.0, sum_ms = 0.0;
  const int frames = length_s * kRate;
  const auto start = Clock::now();
  for (int i = 1; i <= frames; ++i) {
    std::this_thread::sleep_until(start + i * nanoseconds(1'000'000'000 / kRate));
    const auto before = Clock::now();
    topics.write(truth.frame, people, no_line, {i * 1'000'000'000LL, "camera"});
    const double took_ms = duration<double, std::milli>(Clock::now() - before).count();
    longest_ms = std::max(longest_ms, took_ms);
    sum_ms += took_ms;
  }
  const double took_s = duration<double>(Clock::now() - start).count();
  sink.wait_until_read(seconds(5));
  std::cout << "{\"frames\": " << frames << ", \"seconds\": " << took_s << ", \"write_ms\": " << sum_ms / frames
            << ", \"longest_ms\": " << longest_ms << "}\n";
  return 0;
}

/// Keeps one message of each type.
class Keep final : public ros2::MessageSink {
 public:
  bool wants(const ros2::Topic&) override { return true; }
  void put(const ros2::Topic& topic, std::int64_t, std::string_view message) override {
    messages[topic.type] = message;
  }
  void end(const std::string&) override {}

  std::map<std::string, std::string> messages;
};

int types(ros2::Node& node) {
  const LabelledFrame truth = ros2::test::two_people(320, 240);
  Keep keep;
  ros2::PeopleTopics topics(paper_body(), {.frames = true}, keep);
  topics.write(truth.frame, ros2::test::tracked(truth), [] { return R"({"people": []})"; },
               {1'234'567'890'123'456'789, "camera"});
  ros2::NodeEntities entities{"/robot", "camera", {{1, 2, 3}}, {{4}, {5}}};
  keep.messages["rmw_dds_common/ParticipantEntitiesInfo"] = discovery_message({7, 8, 9}, entities, ros2::kGidBytes);
  int failed = 0;
  for (const auto& [type, message] : keep.messages) {
    std::string name = type;
    std::ranges::replace(name, '/', '_');
    const auto from = node.subscribe("/from/" + name, type, {});
    const auto to = node.advertise("/to/" + name, type, {});
    std::string back;
    const bool came = wait_for([&, &sent_message = message] {  // clang 14 captures no binding by itself
      // What was sent before both sides knew each other is lost.
      to->publish(sent_message);
      node.wait(milliseconds(100));
      if (auto next = from->take()) back = *next;
      return !back.empty();
    });
    // Whole words go over the wire.
    const std::string sent = message + std::string((4 - message.size() % 4) % 4, '\0');
    const bool same = came && back == sent;
    if (!same) ++failed;
    std::cout << type << ": " << (same ? "same" : came ? "different" : "lost") << ", " << message.size() << " bytes\n";
  }
  return failed == 0 ? 0 : 1;
}

int latched(ros2::Node& node, int length_s) {
  ros2::NodeSink sink(node);
  ros2::PeopleTopics topics(paper_body(), {}, sink);
  const LabelledFrame truth = ros2::test::two_people(64, 48);
  const ros2::Stamp stamp{42, "camera"};
  topics.write_camera_pose("base_link", Eigen::Isometry3d::Identity(), stamp);
  topics.write(truth.frame, ros2::test::tracked(truth), no_line, stamp);
  std::cout << "written" << std::endl;
  std::this_thread::sleep_for(seconds(length_s));
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) return 2;
  const std::string mode = argv[2];
  const auto number = [&](int i) { return i < argc ? std::atoi(argv[i]) : 0; };
  ros2::NodeOptions options;
  options.domain = number(1);
  options.localhost = true;
  options.say = [](const std::string& line) { std::cerr << line + "\n"; };
  ros2::Node node(options);
  if (mode == "rate") return rate(node, number(3), number(4));
  if (mode == "types") return types(node);
  return latched(node, number(3));
} catch (const vesalius::Error& e) {
  std::cerr << "ros2_sender: " << e.what() << "\n";
  return 1;
}

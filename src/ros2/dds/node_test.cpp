#include "ros2/dds/node.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

#include "io/recordings/message_fields.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::ElementsAre;

/// Tests that run at the same time do not hear each other.
NodeOptions alone(const std::string& name = "tester") {
  NodeOptions options;
  options.name = name;
  options.domain = 1 + static_cast<int>(::getpid() % 200);
  options.localhost = true;
  return options;
}

std::string text_message(const std::string& text) {
  CdrWriter out;
  out.text(text);
  return out.message();
}

std::vector<std::string> take_all(Node& node, Subscription& from, std::size_t expected) {
  std::vector<std::string> messages;
  const auto end = std::chrono::steady_clock::now() + milliseconds(10'000);
  while (messages.size() < expected && std::chrono::steady_clock::now() < end) {
    node.wait(milliseconds(100));
    while (auto message = from.take()) messages.push_back(std::move(*message));
  }
  return messages;
}

bool wait_for(const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + milliseconds(10'000);
  while (!holds()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    ::usleep(10'000);
  }
  return true;
}

TEST(Node, PassesBytesAsTheyAre) {
  Node node(alone());
  const auto from = node.subscribe("/texts", "std_msgs/String", {});
  const auto to = node.advertise("/texts", "std_msgs/String", {});
  ASSERT_TRUE(wait_for([&] { return to->readers() == 1; }));
  to->publish(text_message("abc"));                        // a whole number of words
  to->publish(text_message("five5"));                      // padded with zeros
  to->publish(text_message(std::string(3'000'000, 'x')));  // in fragments
  EXPECT_THAT(take_all(node, *from, 3), ElementsAre(text_message("abc"), text_message("five5") + std::string(2, '\0'),
                                                    text_message(std::string(3'000'000, 'x')) + std::string(3, '\0')));
  EXPECT_TRUE(to->wait_until_read(milliseconds(5000)));
}

TEST(Node, LatchedTopicsGiveTheLastMessageToLateReaders) {
  Node node(alone());
  const auto to = node.advertise("/latched", "std_msgs/String", {.latched = true});
  const auto passing = node.advertise("/passing", "std_msgs/String", {});
  for (const char* text : {"aaa", "bbb", "ccc"}) {
    to->publish(text_message(text));
    passing->publish(text_message(text));
  }
  const auto late = node.subscribe("/latched", "std_msgs/String", {.latched = true});
  const auto missed = node.subscribe("/passing", "std_msgs/String", {});
  EXPECT_THAT(take_all(node, *late, 1), ElementsAre(text_message("ccc")));
  EXPECT_FALSE(late->take());
  EXPECT_FALSE(missed->take());
}

TEST(Node, SaysWhichEndpointsItHas) {
  Node node(alone("teller"));
  const auto to = node.advertise("/texts", "std_msgs/String", {});
  NodeOptions options = alone("listener");
  Node listener(options);
  ASSERT_TRUE(wait_for([&] { return !listener.published().empty(); }));
  EXPECT_THAT(listener.published(), ElementsAre(TopicType{"/texts", "std_msgs/String"}));
  EXPECT_TRUE(node.published().empty()) << "its own do not count";
}

TEST(Node, ForgetsWhatIsNoLongerPublished) {
  Node node(alone("teller")), listener(alone("listener"));
  auto to = node.advertise("/texts", "std_msgs/String", {});
  ASSERT_TRUE(wait_for([&] { return listener.published().size() == 1; }));
  to.reset();
  EXPECT_TRUE(wait_for([&] { return listener.published().empty(); }));
}

TEST(Node, RefusesNamesAndDomains) {
  NodeOptions options = alone();
  options.domain = 233;
  EXPECT_THROW(Node{options}, UsageError);
  options = alone("two words");
  EXPECT_THROW(Node{options}, UsageError);
  options = alone();
  options.name_space = "robot";
  EXPECT_THROW(Node{options}, UsageError);
  Node node(alone());
  EXPECT_THROW(node.advertise("/3d", "std_msgs/String", {}), UsageError);
}

TEST(Node, SaysWhatIsWrongWithTheUsersSettings) {
  ::setenv("CYCLONEDDS_URI", "<CycloneDDS><Domain><Nonsense/></Domain></CycloneDDS>", 1);
  try {
    Node node(alone());
    ADD_FAILURE() << "took them";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("Nonsense"));
  }
  ::unsetenv("CYCLONEDDS_URI");
  Node node(alone());
}

}  // namespace
}  // namespace vesalius::ros2

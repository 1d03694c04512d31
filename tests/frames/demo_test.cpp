// What a newcomer sees first: the default model on the pictures of data/demo and data/rooms.

#include <gmock/gmock.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/detect_stream.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/track_people.h"

namespace vesalius {
namespace {

using testing::Contains;
using testing::ElementsAre;

const std::string kData = VESALIUS_SOURCE_DIR "/data/";

// Labels: statistics
TEST(Demo, FollowsThreePeopleOfWhomOneFallsAndOneSitsDown) {
  const Detector detector(load_model(kData + "models/default.model"));
  PeopleTracker tracker = make_tracker(detector, {});
  const auto source = open_source(kData + "demo");
  int frames = 0;
  std::map<int, int> seen;
  std::map<int, std::vector<Stance>> stances;
  stream_frames(*source, detector, tracker, {}, [&](const FoundFrame& found) {
    ++frames;
    for (const TrackedPerson& person : found.people.people) ++seen[person.id];
    for (const StanceEvent& event : found.people.events) stances[event.id].push_back(event.stance);
    return !found.error;
  });
  EXPECT_EQ(frames, 120);
  EXPECT_THAT(seen, ElementsAre(std::pair(1, 120), std::pair(2, 120), testing::Pair(3, testing::Ge(95)))) << "ids hold";
  EXPECT_THAT(stances[1], Contains(Stance::fallen));
  EXPECT_EQ(stances[1].back(), Stance::standing) << "again";
  EXPECT_THAT(stances[2], ElementsAre(Stance::standing));
  EXPECT_THAT(stances[3], ElementsAre(Stance::standing, Stance::sitting));
}

// The forest labelled the hands of a man in black trousers, which give no depth, as legs, and was sure of it.
TEST(Rooms, LegsWithoutDepthAreNotSeenAtTheHands) {
  const Detector detector(load_model(kData + "models/default.model"));
  const BodyModel& body = detector.body();
  const auto source = open_source(kData + "rooms");
  std::optional<Frame> frame = source->next();
  while (frame && frame->name != "46") frame = source->next();
  ASSERT_TRUE(frame);
  const std::vector<Person> people = detector.detect(*frame);
  ASSERT_EQ(people.size(), 2U);
  const std::vector<SkeletonPart>& parts = people.front().skeleton.parts;
  const auto part = [&](const std::string& name) { return parts.at(std::size_t(body.find_part(name))); };
  for (const char* hand : {"l_hand", "r_hand"}) {
    ASSERT_EQ(part(hand).state, State::observed) << hand;
    for (const char* leg : {"l_thigh", "r_thigh", "l_knee", "r_knee", "l_leg", "r_leg", "l_foot", "r_foot"}) {
      if (part(leg).state != State::observed) continue;
      EXPECT_GT((part(leg).centre - part(hand).centre).norm(), 0.3F) << leg << " at " << hand;
    }
  }
}

}  // namespace
}  // namespace vesalius

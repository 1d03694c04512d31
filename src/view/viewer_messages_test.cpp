#include "view/viewer_messages.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json option_named(const PeopleOptions& options, const std::string& name) {
  const json message = json::parse(options_message(options, {}, true));
  for (const json& option : message.at("options")) {
    if (option.at("name") == name) return option;
  }
  return {};
}

std::string refusal(const std::string& name, const std::string& value) {
  PeopleOptions options;
  try {
    set_option(options, name, value);
  } catch (const Error& e) {
    return e.what();
  }
  return "taken";
}

TEST(ViewerMessages, DescribeEveryOption) {
  PeopleOptions options;
  options.detect.search.min_parts = 9;
  const json changed = option_named(options, "search.min-parts");
  EXPECT_EQ(changed.at("value"), 9);
  EXPECT_EQ(changed.at("default"), PeopleOptions().detect.search.min_parts);
  EXPECT_EQ(changed.at("type"), "integer");
  EXPECT_LT(changed.at("low"), changed.at("high"));
  EXPECT_NE(changed.at("help"), "");
  EXPECT_EQ(option_named(options, "refine.min-score").at("value"), 0.8) << "not 0.800000011920929";
  EXPECT_EQ(option_named(options, "refine.second-pass").at("value"), true);
}

TEST(ViewerMessages, OptionsOfTrackingAreThoseOfWhoeverFollows) {
  PeopleOptions options;
  set_option(options, "track.hidden", "1.5");
  EXPECT_EQ(options.track.hidden_s, 1.5F);
  const json option = option_named(options, "track.hidden");
  EXPECT_EQ(option.at("value"), 1.5);
  EXPECT_EQ(option.at("default"), 3.0);
  set_option(options, "fit.surface", "0.04");
  EXPECT_EQ(options.fit.surface_m, 0.04F);
  EXPECT_EQ(option_named(options, "fit.surface").at("value"), 0.04);
  const std::string alone = options_message(options, {}, false);
  EXPECT_THAT(alone, Not(HasSubstr("track.")));
  EXPECT_THAT(alone, Not(HasSubstr("fit.")));
  EXPECT_THAT(refusal("track.confirm", "0"), HasSubstr("expected 1 to 1000"));
}

TEST(ViewerMessages, OptionsAreSetAsTheyAreGiven) {
  PeopleOptions options;
  set_option(options, "refine.min-score", "0.25");
  set_option(options, "refine.max-overlap", "1");  // a whole number is a number too
  set_option(options, "search.min-parts", "7");
  set_option(options, "refine.second-pass", "false");
  set_option(options, "grow.appearance", "\"texture\"");
  EXPECT_FLOAT_EQ(options.detect.refine.min_score, 0.25F);
  EXPECT_FLOAT_EQ(options.detect.refine.max_overlap, 1.F);
  EXPECT_EQ(options.detect.search.min_parts, 7);
  EXPECT_FALSE(options.detect.refine.second_pass);
  EXPECT_EQ(options.detect.grow.appearance, "texture");
}

TEST(ViewerMessages, UnfitOptionsAreRefusedAndChangeNothing) {
  EXPECT_THAT(refusal("refine.min-score", "2"), HasSubstr("expected 0 to 1"));
  EXPECT_THAT(refusal("refine.min-scor", "0.5"), HasSubstr("refine.min-score"));
  EXPECT_THAT(refusal("search.min-parts", "1.5"), HasSubstr("search.min-parts"));
  EXPECT_THAT(refusal("search.min-parts", "\"x\""), HasSubstr("search.min-parts"));
  EXPECT_THAT(refusal("refine.second-pass", "[]"), HasSubstr("expected a number, a text, true or false"));
  EXPECT_THAT(refusal("refine.min-score = 0.1\nsearch.min-parts", "7"), HasSubstr("no such option"));
}

TEST(ViewerMessages, StateTellsWhatIsKnown) {
  PlayerState player;
  player.span = TimeSpan{1.0, 3.5};
  player.loop = TimeSpan{2.0, 3.0};
  ViewerState state;
  state.page_ms = 12.345;
  state.recording = "bad\xff.mcap";
  const json with = json::parse(state_message(state, player));
  EXPECT_EQ(with.at("span_s"), (json{1.0, 3.5}));
  EXPECT_EQ(with.at("loop_s"), (json{2.0, 3.0}));
  EXPECT_EQ(with.at("page_ms"), 12.35);
  EXPECT_EQ(with.at("result_ms"), nullptr);
  EXPECT_EQ(with.at("saved"), nullptr);
  EXPECT_EQ(json::parse(state_message({}, {})).at("span_s"), nullptr);
}

TEST(ViewerMessages, StateTellsWhereTheLastRecordingLies) {
  ViewerState state;
  state.saved = SavedRecording{"/here/a.mcap", 12, 3456};
  EXPECT_EQ(json::parse(state_message(state, {})).at("saved"),
            (json{{"path", "/here/a.mcap"}, {"frames", 12}, {"bytes", 3456}}));
}

TEST(ViewerMessages, SourcesTellWhatCanBeOpened) {
  const ChoiceList list{"a", {{"b.mcap", false, true, 5}, {"c", true, false, {}}}, 3};
  const json told = json::parse(sources_message(list, {{"openni2:1", "Xtion"}}));
  EXPECT_EQ(told.at("folder"), "a");
  EXPECT_EQ(told.at("entries").at(0), (json{{"name", "b.mcap"}, {"folder", false}, {"opens", true}, {"bytes", 5}}));
  EXPECT_EQ(told.at("entries").at(1), (json{{"name", "c"}, {"folder", true}, {"opens", false}}));
  EXPECT_EQ(told.at("left_out"), 3);
  EXPECT_EQ(told.at("cameras").at(0), (json{{"source", "openni2:1"}, {"name", "Xtion"}}));
  EXPECT_EQ(json::parse(no_sources_message("x", "why")).at("error"), "why");
}

TEST(ViewerMessages, TellWhatHappened) {
  TrackedPerson person;
  person.id = 3;
  person.state = TrackState::tracked;
  person.stance = Stance::standing;
  Happenings happenings;
  for (const double at_s : {0.5, 1.0, 1.5}) {
    TrackedFrame frame{at_s, {}, {}, {}};
    if (at_s > 0.5) frame.people.push_back(person);
    if (at_s > 1.0) frame.events.push_back({3, 1.25, Stance::fallen});
    happenings.add(at_s, frame, 1.0, 5.0);
  }
  EXPECT_EQ(json::parse(happenings_message(happenings)), json::parse(R"({"type":"happened","known_s":[[0.5,1.5]],
      "seen_s":[[0.5,1.5]],"events":[{"at_s":1.0,"id":3,"what":"came","before":"unknown"},
      {"at_s":1.25,"id":3,"what":"fallen","before":"standing"}]})"));
}

TEST(ViewerMessages, HelloDescribesTheBody) {
  const json hello = json::parse(hello_message({"frames/", "default.forest", ".", false}, paper_body()));
  EXPECT_EQ(hello.at("body").at("parts").size(), 25U);
  EXPECT_EQ(hello.at("body").at("parts").at(3).at("name"), paper_body().parts[3].name);
  EXPECT_EQ(hello.at("body").at("links").size(), 24U);
  EXPECT_EQ(hello.at("source"), "frames/");
  EXPECT_EQ(hello.at("track"), false);
  EXPECT_EQ(hello.at("choice"), nullptr);
  EXPECT_EQ(json::parse(hello_message({"", "", ".", true, "/home/recordings"}, paper_body())).at("choice"),
            "/home/recordings");
  EXPECT_EQ(hello.at("bones").at(0), json({{"name", "pelvis"}, {"parent", -1}}));
}

}  // namespace
}  // namespace vesalius

#include "view/viewer.h"

#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "io/files/test_files.h"
#include "io/recordings/test_recorded.h"
#include "io/sources/write_frames.h"
#include "stream/test_crossing.h"
#include "vesalius/error.h"
#include "vesalius/forest/test_blind_labeller.h"
#include "vesalius/open_source.h"
#include "view/test_page.h"

namespace vesalius {
namespace {

using nlohmann::json;
using test::Page;
using testing::HasSubstr;

constexpr int kFrames = 100000;

/// A room, 100 frames a second, each with its number in the first pixel.
class Room : public FrameSource {
 public:
  explicit Room(int width) : size_(width) {}
  std::optional<Frame> next() override {
    if (at_ == kFrames) return std::nullopt;
    Frame frame;
    frame.name = std::to_string(at_);
    frame.time_s = at_ * 0.01;
    frame.camera = {size_, 60, 65.F, 65.F, 39.5F, 29.5F};
    frame.depth = DepthImage(size_, 60, 3000);
    frame.depth[0] = static_cast<std::uint16_t>(++at_);
    return frame;
  }
  int size() const override { return kFrames; }
  std::optional<TimeSpan> span() const override { return TimeSpan{0.0, 0.01 * (kFrames - 1)}; }
  void seek(double time_s) override { at_ = std::clamp(static_cast<int>(std::ceil(100 * time_s - 1e-6)), 0, kFrames); }

 private:
  int size_;
  int at_ = 0;
};

ViewerOptions viewer_options(bool paused, const std::string& folder) {
  ViewerOptions options;
  options.web.port = 0;
  options.web.access = web_access("127.0.0.1", "");
  options.player.playing = !paused;
  options.folder = folder;
  options.source = "room";
  return options;
}

/// A viewer that runs.
class Running {
 public:
  explicit Running(bool paused, const std::string& folder = ".", int width = 80)
      : Running(std::make_unique<Room>(width), std::make_shared<test::BlindLabeller>(),
                viewer_options(paused, folder)) {}
  Running(std::unique_ptr<FrameSource> source, Model model, const ViewerOptions& options)
      : source_(std::move(source)), viewer_(*source_, std::move(model), {}, options), thread_([this] {
          try {
            viewer_.run([this] { return stop_.load(); });
          } catch (const Error& e) {
            ended_with = e.what();
          }
        }) {}
  ~Running() { stop(); }
  /// Returns the error that ended it.
  std::string stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return ended_with;
  }
  std::uint16_t port() const { return viewer_.port(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::string ended_with;
  std::atomic<bool> stop_ = false;
  Viewer viewer_;
  std::jthread thread_;
};

json head_of(const Page::Message& message) {
  std::size_t bytes = 0;
  for (int i = 3; i >= 0; --i) bytes = bytes << 8U | static_cast<unsigned char>(message.bytes[i]);
  return json::parse(message.bytes.substr(4, bytes));
}

/// Returns what is in the next frame; null if none comes.
json next_frame(Page& page) {
  const auto message = page.receive_frame();
  page.send("next");
  return message ? head_of(*message) : json();
}

std::string name_of(const json& frame) { return frame.is_null() ? "none" : frame.at("found").at("frame"); }

/// Returns the first frame of that name, which may have been on its way behind others; null if none comes.
json frame_named(Page& page, const std::string& name) {
  for (;;) {
    json frame = next_frame(page);
    if (frame.is_null() || name_of(frame) == name) return frame;
  }
}

// Labels: threads
TEST(Viewer, PlaysFramesInOrder) {
  const Running viewer(false);
  Page page(viewer.port());
  EXPECT_THAT(page.receive()->bytes, HasSubstr("\"hello\""));
  int last = -1;
  for (int i = 0; i < 20; ++i) {
    const int name = std::stoi(name_of(next_frame(page)));
    EXPECT_GT(name, last);
    last = name;
  }
  const auto state = page.receive_text("\"state\"");
  ASSERT_TRUE(state);
  const json parsed = json::parse(state->bytes);
  EXPECT_TRUE(parsed.at("playing"));
  EXPECT_GE(parsed.at("frames").get<int>(), 20);
  EXPECT_NEAR(parsed.at("span_s").at(1), 0.01 * (kFrames - 1), 1e-6);
}

// Labels: threads
TEST(Viewer, PausedDoesWhatItIsTold) {
  const Running viewer(true);
  Page page(viewer.port());
  EXPECT_EQ(name_of(next_frame(page)), "0");
  for (const auto& [command, name] :
       std::vector<std::pair<std::string, std::string>>{{R"({"do":"step","by":1})", "1"},
                                                        {R"({"do":"seek","to_s":1.5})", "150"},
                                                        {R"({"do":"step","by":-1})", "149"}}) {
    page.send(command);
    EXPECT_FALSE(frame_named(page, name).is_null()) << command;
  }
  page.send(R"({"do":"stages","on":true})");
  const json again = frame_named(page, "149");
  ASSERT_FALSE(again.is_null()) << "the same once more";
  EXPECT_TRUE(again.contains("stages"));
  Page second(viewer.port());
  const json late = next_frame(second);
  EXPECT_EQ(name_of(late), "149") << "whoever comes later sees it too";
  EXPECT_FALSE(late.contains("stages")) << "but not what others wish for";
}

/// Runs a viewer of two people who cross, paused at the first frame.
std::unique_ptr<Running> run_crossing(bool timed, const ViewerOptions& options = viewer_options(true, ".")) {
  auto source = std::make_unique<test::Crossing>(timed);
  auto labeller = std::make_shared<test::Knowing>(source->frames());
  return std::make_unique<Running>(std::move(source), std::move(labeller), options);
}

/// Ids with their states.
std::vector<std::string> people_in(const json& frame) {
  std::vector<std::string> all;
  if (frame.is_null()) return {"none"};
  for (const json& person : frame.at("found").at("people")) {
    all.push_back(std::to_string(person.at("id").get<int>()) + person.at("state").get<std::string>());
  }
  return all;
}

// Labels: threads
TEST(Viewer, FollowsPeopleHoweverOneMoves) {
  for (const bool timed : {false, true}) {
    const auto viewer = run_crossing(timed);
    Page page(viewer->port());
    EXPECT_THAT(people_in(next_frame(page)), testing::ElementsAre("1new", "2new"));
    for (int i = 1; i < 6; ++i) {
      page.send(R"({"do":"step","by":1})");
      const json frame = frame_named(page, std::to_string(i));
      EXPECT_THAT(people_in(frame), testing::ElementsAre(i < 2 ? "1new" : "1tracked", i < 2 ? "2new" : "2tracked"));
      EXPECT_NEAR(frame.at("found").at("track_time_s"), i / kUsualRate, 1e-6);
      EXPECT_EQ(frame.at("found").at("time_s").is_null(), !timed);
    }
    for (const auto& [command, name] : std::vector<std::pair<std::string, std::string>>{
             {R"({"do":"stages","on":true})", "5"},
             {R"({"do":"step","by":-1})", "4"},
             {R"({"do":"set","option":"search.min-parts","value":3})", "4"},
             {R"({"do":"seek","to_s":0.5})", "15"},
             {R"({"do":"step","by":1})", "16"},
             {R"({"do":"seek","to_s":0.1})", "3"}}) {
      page.send(command);
      EXPECT_THAT(people_in(frame_named(page, name)), testing::ElementsAre("1tracked", "2tracked")) << command;
    }
    // Other options of tracking: everybody is new, under ids that nobody had.
    page.send(R"({"do":"set","option":"track.hidden","value":1})");
    json frame = next_frame(page);
    while (!frame.is_null() && people_in(frame)[0] == "1tracked") frame = next_frame(page);
    EXPECT_THAT(people_in(frame), testing::ElementsAre("3new", "4new"));
  }
}

// Labels: threads
TEST(Viewer, TellsWhatHappenedAndGivesPeopleAsFiles) {
  const auto viewer = run_crossing(true);
  Page page(viewer->port());
  ASSERT_FALSE(frame_named(page, "0").is_null());
  for (int i = 1; i < 6; ++i) {
    page.send(R"({"do":"step","by":1})");
    ASSERT_FALSE(frame_named(page, std::to_string(i)).is_null());
  }
  ASSERT_TRUE(page.receive_text(R"("known_s":[[0.0,0.16)"));
  Page second(viewer->port());
  const auto late = second.receive_text("\"happened\"");
  ASSERT_TRUE(late) << "whoever comes later is told as well";
  const json happened = json::parse(late->bytes);
  EXPECT_EQ(happened.at("seen_s").size(), 1U);
  const std::string table = test::request(viewer->port(), "/people.csv").body;
  EXPECT_EQ(std::ranges::count(table, '\n'), 1 + 2 * 6);
  EXPECT_THAT(test::request(viewer->port(), "/people-2.bvh").body, testing::StartsWith("HIERARCHY"));
  EXPECT_EQ(test::request(viewer->port(), "/people.csv", "evil.example").status, 403);
}

// Labels: threads
TEST(Viewer, PlaysALoop) {
  const Running viewer(true);
  Page page(viewer.port());
  page.send(R"({"do":"loop","between_s":[0.5,0.52]})");
  ASSERT_TRUE(page.receive_text(R"("loop_s":[0.5,0.52])"));
  page.send(R"({"do":"seek","to_s":0.5})");
  ASSERT_FALSE(frame_named(page, "50").is_null());
  page.send(R"({"do":"play"})");
  for (int i = 0; i < 5; ++i) {
    const json frame = next_frame(page);
    ASSERT_FALSE(frame.is_null());
    EXPECT_THAT(name_of(frame), testing::AnyOf("50", "51", "52"));
  }
  page.send(R"({"do":"loop","between_s":null})");
  EXPECT_TRUE(page.receive_text(R"("loop_s":null)"));
  page.send(R"({"do":"loop","between_s":[1]})");
  const auto notice = page.receive_text("\"notice\"");
  ASSERT_TRUE(notice);
  EXPECT_THAT(notice->bytes, HasSubstr("not a command"));
}

// Labels: threads
TEST(Viewer, FindsPeopleInEachFrameAloneIfThatIsWanted) {
  ViewerOptions options = viewer_options(true, ".");
  options.track = false;
  const auto viewer = run_crossing(true, options);
  Page page(viewer->port());
  const auto known = page.receive_text("\"options\"");
  ASSERT_TRUE(known);
  EXPECT_THAT(known->bytes, testing::Not(HasSubstr("track.")));
  const json frame = next_frame(page);
  ASSERT_EQ(frame.at("found").at("people").size(), 2U);
  EXPECT_FALSE(frame.at("found").at("people").at(0).contains("id"));
  EXPECT_FALSE(frame.at("found").contains("events"));
  EXPECT_NEAR(frame.at("floor").at("offset_m"), 0.9, 0.02);
}

// Labels: threads
TEST(Viewer, RecordsPeopleWithIds) {
  const test::TemporaryFolder folder;
  {
    const auto viewer = run_crossing(false, viewer_options(true, folder.path()));
    Page page(viewer->port());
    ASSERT_FALSE(frame_named(page, "0").is_null());
    page.send(R"({"do":"record","on":true})");
    ASSERT_TRUE(page.receive_text("\"recording\":\"" + folder.path()));
    for (int i = 1; i < 4; ++i) {
      page.send(R"({"do":"step","by":1})");
      ASSERT_FALSE(frame_named(page, std::to_string(i)).is_null());
    }
    ASSERT_TRUE(page.receive_text("\"recorded\":3"));
  }
  std::vector<json> lines;
  const std::string file = std::filesystem::directory_iterator(folder.path())->path().string();
  for (const std::string& text : test::recorded_texts(file, "/people/json")) lines.push_back(json::parse(text));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_THAT(people_in({{"found", lines[0]}}), testing::ElementsAre("1new", "2new"));
  EXPECT_THAT(people_in({{"found", lines[2]}}), testing::ElementsAre("1tracked", "2tracked"));
  EXPECT_EQ(lines[2].at("time_s"), 0.1) << "frames without times get those of the rate";
  EXPECT_EQ(lines[2].at("track_time_s"), 0.1);
}

// Labels: threads
TEST(Viewer, ChangesOptionsAndSaysWhatIsWrong) {
  const Running viewer(true);
  Page page(viewer.port());
  next_frame(page);
  page.send(R"({"do":"set","option":"search.min-parts","value":9})");
  // The new options and the same frame, detected anew, come in either order.
  bool told = false, shown = false;
  while (!told || !shown) {
    const auto message = page.receive();
    ASSERT_TRUE(message) << told << shown;
    if (message->binary) page.send("next");
    shown |= message->binary;
    told |= message->bytes.find(R"("search.min-parts","type":"integer","value":9)") != std::string::npos;
  }
  EXPECT_THAT(test::request(viewer.port(), "/options.toml").body, HasSubstr("\nsearch.min-parts = 9\n"));
  for (const auto& [command, why] : std::vector<std::pair<std::string, std::string>>{
           {R"({"do":"set","option":"search.min-parts","value":0})", "search.min-parts is 0, expected 1 to 200"},
           {R"({"do":"set","option":"grow.appearance","value":"smell"})", "smell"},
           {R"({"do":"fly"})", "unknown command"},
           {R"({"do":)", "not a command"},
           {"[]", "not a command"},
           {R"({"do":"seek"})", "not a command"},
           {R"({"do":"step","by":"x"})", "not a command"}}) {
    page.send(command);
    const auto notice = page.receive_text("\"notice\"");
    ASSERT_TRUE(notice) << command;
    EXPECT_THAT(notice->bytes, HasSubstr(why)) << command;
  }
  page.send(R"({"do":"reset"})");
  EXPECT_TRUE(page.receive_text("\"search.min-parts\",\"type\":\"integer\",\"value\":4"));
}

// Labels: threads
TEST(Viewer, RecordsWhatIsShown) {
  const test::TemporaryFolder folder;
  {
    const Running viewer(false, folder.path());
    Page page(viewer.port());
    page.send(R"({"do":"record","on":true})");
    ASSERT_TRUE(page.receive_text("\"recording\":\"" + folder.path()));
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(next_frame(page).is_null());
    page.send(R"({"do":"record","on":false})");
    const auto state = page.receive_text("\"recording\":\"\"");
    ASSERT_TRUE(state);
    const json saved = json::parse(state->bytes).at("saved");
    EXPECT_EQ(saved.at("bytes"), std::filesystem::file_size(saved.at("path").get<std::string>()));
    EXPECT_GE(saved.at("frames"), 1);
  }
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files.push_back(entry.path().string());
  ASSERT_EQ(files.size(), 1U);
  const auto source = open_source(files[0]);
  std::optional<Frame> frame = source->next();
  ASSERT_TRUE(frame);
  const int first = frame->depth[0];
  frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_GT(frame->depth[0], first);
  EXPECT_EQ(frame->depth(5, 5), 3000);
}

/// Frames of two people who cross, as a folder.
void write_crossing(const std::string& folder) {
  const test::Crossing crossing;
  const auto writer = make_frame_writer(FrameFormat::folder, folder);
  for (const LabelledFrame& one : crossing.frames()) writer->write(one.frame);
  writer->close();
}

// Labels: threads
TEST(Viewer, OpensAnotherSource) {
  const test::TemporaryFolder folder;
  write_crossing(folder / "walk");
  ViewerOptions options = viewer_options(true, folder.path());
  options.choice = folder.path();
  const auto viewer = run_crossing(true, options);
  Page page(viewer->port());
  const auto hello = page.receive_text("\"hello\"");
  ASSERT_TRUE(hello);
  EXPECT_EQ(json::parse(hello->bytes).at("choice"), std::filesystem::canonical(folder.path()).string());
  EXPECT_THAT(people_in(next_frame(page)), testing::ElementsAre("1new", "2new"));
  page.send(R"({"do":"record","on":true})");
  ASSERT_TRUE(page.receive_text("\"recording\":\"" + folder.path()));
  page.send(R"({"do":"step","by":1})");
  ASSERT_TRUE(page.receive_text("\"recorded\":1"));

  page.send(R"({"do":"list","folder":""})");
  const auto list = page.receive_text("\"sources\"");
  ASSERT_TRUE(list);
  EXPECT_THAT(list->bytes, HasSubstr(R"({"name":"walk","folder":true,"opens":true})"));

  page.send(R"({"do":"open","source":"walk"})");
  const auto other = page.receive_text("\"hello\"");
  ASSERT_TRUE(other);
  const std::string path = std::filesystem::canonical(folder / "walk").string();
  EXPECT_EQ(json::parse(other->bytes).at("source"), path);
  json frame = next_frame(page);  // one of before may have been on its way
  while (!frame.is_null() && frame.at("number") <= json::parse(other->bytes).at("after")) frame = next_frame(page);
  EXPECT_EQ(name_of(frame), "0");
  EXPECT_THAT(people_in(frame), testing::ElementsAre("3new", "4new")) << "nobody's ids again";
  const auto state = page.receive_text(R"("recording":"")");
  ASSERT_TRUE(state);
  const json saved = json::parse(state->bytes).at("saved");
  EXPECT_EQ(saved.at("frames"), 1);
  EXPECT_EQ(open_source(saved.at("path"))->size(), 1) << "complete";
  page.send(R"({"do":"seek","to_s":0.5})");
  EXPECT_FALSE(frame_named(page, "15").is_null());
}

// Labels: threads
TEST(Viewer, GoesOnWhereASourceCannotBeOpened) {
  const test::TemporaryFolder folder;
  test::put(folder / "bad.mcap", "nothing that was recorded");
  std::filesystem::create_directory(folder / "empty");
  ViewerOptions options = viewer_options(true, ".");
  options.choice = folder.path();
  const auto viewer = run_crossing(true, options);
  Page page(viewer->port());
  ASSERT_FALSE(frame_named(page, "0").is_null());
  for (const auto& [wish, why] :
       std::vector<std::pair<std::string, std::string>>{{"bad.mcap", "bad.mcap: "},
                                                        {"empty", "empty: no frames"},
                                                        {"../", "a path with"},
                                                        {"/etc", "an absolute path"},
                                                        {"openni2:9", "openni2:9: not plugged in"}}) {
    page.send(json({{"do", "open"}, {"source", wish}}).dump());
    const auto notice = page.receive_text("\"notice\"");
    ASSERT_TRUE(notice) << wish;
    EXPECT_THAT(notice->bytes, testing::AllOf(HasSubstr(why), testing::Not(HasSubstr("\\n")))) << wish;
  }
  page.send(R"({"do":"list","folder":"../"})");
  const auto refused = page.receive_text("\"sources\"");
  ASSERT_TRUE(refused);
  EXPECT_THAT(json::parse(refused->bytes).at("error"), HasSubstr("a path with"));
  page.send(R"({"do":"step","by":1})");
  EXPECT_THAT(people_in(frame_named(page, "1")), testing::ElementsAre("1new", "2new")) << "the same people as before";
}

TEST(Viewer, OpensNothingWhereItMayNot) {
  const auto viewer = run_crossing(true);
  Page page(viewer->port());
  for (const char* command : {R"({"do":"list","folder":""})", R"({"do":"open","source":"walk"})"}) {
    page.send(command);
    const auto notice = page.receive_text("\"notice\"");
    ASSERT_TRUE(notice) << command;
    EXPECT_THAT(notice->bytes, HasSubstr("no other source can be opened"));
  }
  ViewerOptions options = viewer_options(true, ".");
  options.choice = "/no/such/folder";
  EXPECT_THROW(run_crossing(true, options), Error);
}

TEST(Viewer, SaysWhenItCannotRecord) {
  Running viewer(true, "/no/such/folder");
  Page page(viewer.port());
  page.send(R"({"do":"record","on":true})");
  const auto notice = page.receive_text("\"notice\"");
  ASSERT_TRUE(notice);
  EXPECT_THAT(notice->bytes, HasSubstr("/no/such/folder/vesalius-"));
  EXPECT_THAT(viewer.stop(), HasSubstr("not all was recorded: /no/such/folder/vesalius-"));
}

TEST(Viewer, RecordsEveryTimeOnce) {
  const test::TemporaryFolder folder;
  {
    const Running viewer(true, folder.path());
    Page page(viewer.port());
    ASSERT_FALSE(frame_named(page, "0").is_null());
    page.send(R"({"do":"record","on":true})");
    ASSERT_TRUE(page.receive_text("\"recording\":\"" + folder.path()));
    for (const auto& [command, name] :
         std::vector<std::pair<std::string, std::string>>{{R"({"do":"step","by":1})", "1"},
                                                          {R"({"do":"step","by":1})", "2"},
                                                          {R"({"do":"stages","on":true})", "2"},
                                                          {R"({"do":"step","by":-1})", "1"},
                                                          {R"({"do":"seek","to_s":0})", "0"},
                                                          {R"({"do":"seek","to_s":0.05})", "5"}}) {
      page.send(command);
      ASSERT_FALSE(frame_named(page, name).is_null()) << command;
    }
    ASSERT_TRUE(page.receive_text("\"recorded\":3"));
  }
  const auto source = open_source(std::filesystem::directory_iterator(folder.path())->path().string());
  std::vector<double> times;
  while (const auto frame = source->next()) times.push_back(*frame->time_s);
  EXPECT_THAT(times, testing::ElementsAre(0.01, 0.02, 0.05));
}

TEST(Viewer, ACameraThatIsLostEndsIt) {
  class Lost : public FrameSource {
   public:
    std::optional<Frame> next() override { throw Error("camera: unplugged"); }
    int size() const override { return -1; }
    bool is_live() const override { return true; }
  };
  Lost source;
  ViewerOptions options;
  options.web.port = 0;
  Viewer viewer(source, std::make_shared<test::BlindLabeller>(), {}, options);
  EXPECT_THROW(viewer.run([] { return false; }), Error);
}

// Labels: threads
TEST(Viewer, ManyPagesOneOfThemStalledHarmNobody) {
  // Frames of 60 x 12000 pixels are more than sockets keep.
  const Running viewer(false, ".", 12000);
  Page stalled(viewer.port());
  std::vector<std::unique_ptr<Page>> pages;
  for (int i = 0; i < 9; ++i) pages.push_back(std::make_unique<Page>(viewer.port()));
  for (int i = 0; i < 10; ++i) {
    for (const auto& page : pages) EXPECT_FALSE(next_frame(*page).is_null());
  }
}

}  // namespace
}  // namespace vesalius

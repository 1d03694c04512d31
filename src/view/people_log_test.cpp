#include "view/people_log.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "export/stand_upright.h"
#include "export/write_people.h"
#include "stream/test_crossing.h"
#include "vesalius/person_json.h"
#include "view/people_files.h"
#include "view/people_finder.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Finds people in a source, and knows the lines that `vesalius detect --json` writes of them.
class Finding {
 public:
  explicit Finding(bool timed = true, bool track = true)
      : source_(timed),
        settings_(std::make_shared<const FinderSettings>(FinderSettings{{}, detector()})),
        finder_(settings_, track) {}

  /// Returns a frame with its people. Frames must be asked for in their order, as detect has them.
  ViewedFrame find(int number) {
    const auto played = std::make_shared<PlayedFrame>();
    played->frame = source_.frames().at(static_cast<std::size_t>(number)).frame;
    played->at_s = number / kUsualRate;
    ViewedFrame viewed = finder_.find(played, settings_, false);
    lines_ += frame_json(*viewed.frame, viewed.people, paper_body()) + "\n";
    return viewed;
  }
  /// Returns what `vesalius export` makes of the lines so far.
  std::string exported(const std::string& ending, std::optional<int> person = {}) const {
    const auto format = std::ranges::find(export_formats(), ending, &ExportFormat::ending);
    PeopleRecord record = parse_people(lines_, "lines", {});
    stand_upright(record);
    const std::size_t set = format->joints.empty() ? 0 : record.find_set(format->joints);
    return format->write(record, {set, person, (person ? "people-1" : "people") + ending, ""});
  }

 private:
  Detector detector() { return Detector(std::make_shared<test::Knowing>(source_.frames())); }

  test::Crossing source_;
  PeopleFinder::Settings settings_;
  PeopleFinder finder_;
  std::string lines_;
};

/// Returns what a path gets.
WebResponse got(const std::shared_ptr<const PeopleLog>& log, const std::string& path) {
  const auto response = people_response(log, path);
  return response ? response->make() : WebResponse{"", "nothing", false, {}, 404, {}};
}

TEST(PeopleLog, FilesAreThoseThatExportMakes) {
  for (const bool timed : {true, false}) {
    Finding finding(timed);
    const auto log = std::make_shared<PeopleLog>(paper_body(), kUsualRate);
    for (int i = 0; i < test::Crossing::kLength; ++i) log->add(finding.find(i), 0);
    for (const std::string ending : {".csv", ".glb"}) {
      const WebResponse file = got(log, "/people" + ending);
      EXPECT_EQ(file.status, 200U);
      EXPECT_EQ(file.file_name, "people" + ending);
      EXPECT_TRUE(file.body == finding.exported(ending)) << ending;
    }
    for (const std::string ending : {".bvh", ".trc"}) {
      EXPECT_TRUE(got(log, "/people-1" + ending).body == finding.exported(ending, 1)) << ending;
      EXPECT_EQ(got(log, "/people" + ending).status, 404U);
      EXPECT_THAT(got(log, "/people" + ending).body, HasSubstr("one person in a file"));
    }
  }
}

TEST(PeopleLog, FilesOfSingleFramesAreThoseThatExportMakes) {
  Finding finding(false, false);
  const auto log = std::make_shared<PeopleLog>(paper_body(), kUsualRate);
  for (int i = 0; i < 4; ++i) log->add(finding.find(i), 0);
  EXPECT_EQ(got(log, "/people.csv").body, finding.exported(".csv"));
  EXPECT_EQ(got(log, "/people.glb").status, 404U);
  EXPECT_THAT(got(log, "/people.glb").body, HasSubstr("nobody has a fitted body"));
}

TEST(PeopleLog, EachTimeOfTheSourceCountsOnce) {
  Finding finding;
  const auto log = std::make_shared<PeopleLog>(paper_body(), kUsualRate);
  std::vector<ViewedFrame> all;
  for (int i = 0; i < 6; ++i) all.push_back(finding.find(i));
  for (const int i : {3, 4, 5, 0, 1, 2, 3, 4, 5}) log->add(all[static_cast<std::size_t>(i)], 0);
  EXPECT_EQ(log->frames(), 6U);
  EXPECT_EQ(got(log, "/people.csv").body, finding.exported(".csv")) << "in the order of the source";
  ViewedFrame other = all[2];
  other.people.people.pop_back();
  log->add(other, 0);
  EXPECT_EQ(log->people().back().frames, 6U);
  log->add(other, 1);
  EXPECT_EQ(log->people().back().frames, 5U) << "found with other options";
  EXPECT_EQ(log->frames(), 6U);
}

TEST(PeopleLog, ForgetsWhatWasAddedFirst) {
  Finding finding;
  const ViewedFrame viewed = finding.find(0);
  const auto log = std::make_shared<PeopleLog>(paper_body(), kUsualRate, 20000);
  for (int i = 0; i < 50; ++i) {
    ViewedFrame one = viewed;
    one.at_s = i < 45 ? i : -i;
    log->add(one, 0);
  }
  const std::size_t kept = log->frames();
  EXPECT_GE(kept, 3U);
  EXPECT_LE(kept, 20U);
  EXPECT_EQ(log->forgotten(), 50 - kept);
  EXPECT_EQ(json::parse(got(log, "/people.json").body).at("forgotten"), 50 - kept);
  log->add(viewed, 0);
  EXPECT_EQ(log->frames(), kept);
}

TEST(PeopleLog, TellsWhoThereIs) {
  Finding finding;
  const auto log = std::make_shared<PeopleLog>(paper_body(), kUsualRate);
  for (const char* path : {"/people.csv", "/people.glb", "/people-1.bvh"}) {
    EXPECT_EQ(got(log, path).status, 404U);
    EXPECT_THAT(got(log, path).body, HasSubstr("nobody was found yet")) << path;
  }
  for (int i = 0; i < 6; ++i) log->add(finding.find(i), 0);
  const json known = json::parse(got(log, "/people.json").body);
  EXPECT_EQ(known.at("frames"), 6);
  ASSERT_EQ(known.at("people").size(), 2U);
  EXPECT_EQ(known.at("people").at(0).at("id"), 1);
  EXPECT_EQ(known.at("people").at(0).at("frames"), 6);
  EXPECT_GT(known.at("people").at(0).at("bodies"), 0);
  EXPECT_THAT(got(log, "/people-9.bvh").body, HasSubstr("person 9 is not known"));
  for (const char* path : {"/people", "/people.txt", "/people-1.csv", "/people-x.bvh", "/people-1x.bvh",
                           "/people/1.bvh", "/people1.bvh", "/people-01.bvh", "/people.", "/peoples.csv"}) {
    EXPECT_FALSE(people_response(log, path).has_value()) << path;
  }
}

}  // namespace
}  // namespace vesalius

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/recordings/test_recorded.h"
#include "run_program.h"
#include "small_world.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Record : public SmallWorld {
 protected:
  /// Returns the lines of `vesalius detect --json`, without what differs between a folder and its recording.
  static std::vector<json> found_in(const std::string& source) {
    const Outcome run = run_program("detect " + source + " --no-track -q --json - -m " + model());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::vector<json> lines;
    std::istringstream in(run.out);
    for (std::string line; std::getline(in, line);) {
      lines.push_back(json::parse(line));
      lines.back().erase("frame");
      lines.back().erase("time_s");
    }
    return lines;
  }
};

TEST_F(Record, HoldsFramesInWhichTheSamePeopleAreFound) {
  const std::string file = path("session.mcap");
  const Outcome run = run_program("record " + frames() + " --out " + file + " --people -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("session.mcap: 3 frames"));
  const std::vector<json> found = found_in(file);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_FALSE(found.front().at("people").empty());
  EXPECT_EQ(found, found_in(frames()));
  for (const std::string& source : {file, frames()}) {
    const std::vector<json> late = found_in(source + " --start 0.03");
    ASSERT_EQ(late.size(), 3U) << source;
    EXPECT_EQ(late[0], found[1]);
    EXPECT_EQ(late[1], found[2]);
  }
}

TEST_F(Record, HoldsPeopleOverTimeAsDetectFollowsThem) {
  const std::string file = path("followed.mcap");
  const Outcome run = run_program("record " + frames() + " --out " + file + " --track -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Outcome detect = run_program("detect " + frames() + " --track -q --json - -m " + model());
  std::istringstream in(detect.out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 4U);
  lines.pop_back();  // it closes the stream
  EXPECT_THAT(lines.front(), HasSubstr("\"id\":1,\"state\":\"new\""));
  EXPECT_EQ(test::recorded_texts(file, "/people/json"), lines);
}

TEST_F(Record, GoesThroughAFolderWithoutLoss) {
  const std::string file = path("again.mcap"), folder = path("again");
  ASSERT_EQ(run_program("record " + frames() + " --out " + file).exit_code, 0);
  ASSERT_EQ(run_program("convert " + file + " " + folder + " --to folder").exit_code, 0);
  EXPECT_EQ(found_in(folder), found_in(frames()));
}

TEST_F(Record, RefusesWhatItCannotDo) {
  const std::string file = path("mine.mcap");
  ASSERT_EQ(run_program("record " + frames() + " --out " + file).exit_code, 0);
  const std::string before = bytes_of(file);
  const Outcome again = run_program("record " + frames() + " --out " + file);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("mine.mcap: cannot be created: File exists"));
  EXPECT_EQ(bytes_of(file), before);
  const Outcome nothing = run_program("record missing/ --out " + path("none.mcap"));
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, HasSubstr("missing/: "));
  EXPECT_FALSE(std::filesystem::exists(path("none.mcap")));
  EXPECT_EQ(run_program("record " + frames()).exit_code, 2);
  const Outcome late = run_program("record " + frames() + " --start 9 --out " + path("late.mcap"));
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_THAT(late.err, HasSubstr("a start of 9 s, expected 0 to 0.067 s"));
  EXPECT_FALSE(std::filesystem::exists(path("late.mcap")));
}

}  // namespace
}  // namespace vesalius

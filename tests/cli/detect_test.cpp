#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "run_program.h"
#include "small_world.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::StartsWith;

class Detect : public SmallWorld {
 protected:
  static Outcome detect(const std::string& more) { return run_program("detect " + frames() + " -m " + model() + more); }

  static std::vector<json> lines(const std::string& text) {
    std::vector<json> parsed;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) parsed.push_back(json::parse(line));
    return parsed;
  }

  /// Returns the bytes of every file below a folder by its relative path.
  static std::map<std::string, std::string> contents(const std::string& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      files[fs::relative(entry.path(), folder).string()] = bytes_of(entry.path().string());
    }
    return files;
  }
};

TEST_F(Detect, PrintsALineForEachFrame) {
  const Outcome run = detect("");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, MatchesRegex("a: 1 person: [0-9]+ parts at 2\\.[0-9]+ m .score [0-9.]+.\nb: 1 person: .*\nc: "
                                    "nobody\n"));
  EXPECT_THAT(run.err, StartsWith("3 frames, people in 2 of them (2 in all; --track follows them)"));
}

TEST_F(Detect, QuietPrintsNothing) {
  const Outcome run = detect(" -q");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out + run.err, "");
}

void expect_point(const json& point) {
  const std::string state = point.at("state");
  EXPECT_EQ(point.contains("unseen"), state != "observed");
  EXPECT_EQ(point.size(), 4U + (point.contains("unseen") ? 1U : 0U) + (point.contains("behind") ? 1U : 0U));
  if (point.contains("behind")) {
    EXPECT_EQ(point.at("unseen"), "behind_person");
  }
  EXPECT_EQ(point.at("xyz_m").is_null(), state == "none");
  EXPECT_EQ(point.at("px").is_null(), state == "none");
  EXPECT_TRUE(state == "none" || state == "predicted" || state == "observed") << state;
  if (state != "none") {
    EXPECT_EQ(point.at("xyz_m").size(), 3U);
  }
  EXPECT_GE(point.at("confidence"), 0.0);
  EXPECT_LE(point.at("confidence"), 1.0);
}

TEST_F(Detect, PrintsNothingBesideJson) {
  const Outcome run = detect(" --json -");
  EXPECT_EQ(run.exit_code, 0);
  const std::vector<json> found = lines(run.out);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].at("frame"), "a");
  EXPECT_EQ(found[2].at("frame"), "c");
  EXPECT_TRUE(found[2].at("time_s").is_null()) << "nobody knows when these frames were taken";
  EXPECT_EQ(found[2].at("people"), json::array());
  EXPECT_EQ(found[2].at("camera"),
            json::parse(R"({"width":320,"height":240,"fx":262.5,"fy":262.5,"cx":159.5,"cy":119.5})"));
  EXPECT_EQ(found[3], json::parse(R"({"complete":true,"frames":3})"));
  ASSERT_EQ(found[0].at("people").size(), 1U);
  const json& person = found[0].at("people").at(0);
  EXPECT_EQ(person.size(), 6U);
  EXPECT_EQ(person.at("index"), 0);
  EXPECT_EQ(person.at("box_px").size(), 4U);
  EXPECT_EQ(person.at("parts").size(), 25U);
  for (const auto& part : person.at("parts")) expect_point(part);
  ASSERT_EQ(person.at("joints").size(), 3U);
  EXPECT_EQ(person.at("joints").at("nite15").size(), 15U);
  for (const auto& set : person.at("joints")) {
    for (const auto& joint : set) expect_point(joint);
  }
}

TEST_F(Detect, FitsBodiesWithTheOptionsOfTheFit) {
  const auto misfit = [](const std::string& flags) {
    const Outcome run = detect(" -q --track --json - " + flags);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return lines(run.out).at(0).at("people").at(0).at("body").at("misfit").get<double>();
  };
  EXPECT_LT(misfit("--fit.surface 0.2"), misfit("")) << "points may lie farther from the flesh";
  write("fit.toml", "[fit]\nsurface = 0.2\n");
  EXPECT_EQ(misfit("--options " + path("fit.toml")), misfit("--fit.surface 0.2"));
  EXPECT_EQ(detect(" --track --fit.surface 0").exit_code, 2);
}

TEST_F(Detect, FindsTheRenderedPersonWhereItStands) {
  const json person = lines(detect(" --json -").out).at(0).at("people").at(0);
  const json& chest = person.at("parts").at("l_chest");
  ASSERT_EQ(chest.at("state"), "observed");
  EXPECT_NEAR(chest.at("xyz_m").at(2), 2.4, 0.2);  // the feet stand at 2.5 m, and the chest's surface is nearer
  EXPECT_GT(chest.at("xyz_m").at(0), 0.0) << "the left of a person who faces the camera is on the right";
  const json& box = person.at("box_px");
  EXPECT_GT(chest.at("px").at(0), 159.5) << "so it is in the picture";
  EXPECT_LT(chest.at("px").at(0), box.at(0).get<double>() + box.at(2).get<double>());
  EXPECT_GT(chest.at("px").at(1), box.at(1));
}

// Labels: threads
TEST_F(Detect, WritesTheSameBytesForAnyNumberOfThreads) {
  std::map<std::string, std::string> first;
  for (const std::string threads : {"1", "2", "8"}) {
    const std::string out = path("threads" + threads);
    const Outcome run = detect(" -q --threads " + threads + " --out " + out + " --json " + out +
                               ".jsonl --save overlay,parts,labels,mask,cloud");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    auto all = contents(out);
    all["json"] = bytes_of(out + ".jsonl");
    if (first.empty()) first = all;
    EXPECT_EQ(all.size(), 17U);  // five kinds for three frames, labels.json and the people
    EXPECT_TRUE(all == first) << threads << " threads";
  }
}

TEST_F(Detect, TakesTheProcessorWhereAnyDeviceWillDo) {
  const auto json_on = [&](const std::string& device) {
    const Outcome run = run_program("detect " + frames() + " -q -m " + model() + " --json - --device " + device);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, AnyOf(IsEmpty(), HasSubstr("note: cuda: "))) << device;
    return run.out;
  };
  EXPECT_EQ(json_on("auto"), json_on("cpu"));
}

TEST_F(Detect, SendsPeopleWhereNobodyNeedsToListen) {
  const Outcome run = detect(" -q --udp 127.0.0.1:9 --osc 127.0.0.1:9");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, IsEmpty());
  for (const auto& [flags, exit_code, why] :
       {std::tuple{" --osc nowhere", 2, "nowhere: expected HOST:PORT"},
        std::tuple{" --udp 1.2.3.4:99999", 2, "HOST:PORT"},
        std::tuple{" --osc 127.0.0.1:9 --joints feet", 2, "joint set \"feet\" is not of this body"},
        std::tuple{" --udp no.such.host.invalid:9", 1, "no.such.host.invalid:9"}}) {
    const Outcome refused = detect(flags);
    EXPECT_EQ(refused.exit_code, exit_code) << flags;
    EXPECT_THAT(refused.err, HasSubstr(why));
  }
}

TEST_F(Detect, RefusesDevicesThatAreNotThere) {
  const auto run_on = [&](const std::string& device) {
    return run_program("detect " + frames() + " -m " + model() + " --device " + device);
  };
  const Outcome unknown = run_on("gpu");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("device \"gpu\" is not known to this build, expected \"cpu\", \"auto\""));
  const Outcome none = run_on("cuda:999");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, StartsWith("vesalius: cuda"));
}

TEST_F(Detect, SavesTheRequestedPictures) {
  const std::string out = path("saved");
  const Outcome run = detect(" --out " + out + " --save mask,labels,video");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Image<std::uint8_t> mask = read_png8(out + "/mask/a.png");
  const LabelImage labels = read_png8(out + "/labels/a.png");
  EXPECT_EQ(mask.width(), 320);
  EXPECT_EQ(mask.height(), 240);
  int inside = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    EXPECT_TRUE(mask[i] == 0 || mask[i] == kBackground);
    EXPECT_TRUE(labels[i] < 25 || labels[i] == kBackground);
    if (labels[i] != kBackground) {
      EXPECT_EQ(mask[i], 0) << "a labelled pixel belongs to a person";
    }
    inside += mask[i] == 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_EQ(json::parse(bytes_of(out + "/labels.json")).at("parts").size(), 25U);
  EXPECT_EQ(bytes_of(out + "/overlay.avi").substr(0, 4), "RIFF");
  EXPECT_FALSE(fs::exists(out + "/overlay"));
  for (const auto& file : contents(out)) EXPECT_EQ(file.first.find(".tmp"), std::string::npos) << file.first;
}

TEST_F(Detect, SavesOverlaysByDefault) {
  const std::string out = path("pictures");
  ASSERT_EQ(detect(" --out " + out).exit_code, 0);
  EXPECT_EQ(contents(out).size(), 3U);
  EXPECT_TRUE(fs::exists(out + "/overlay/c.png"));
}

TEST_F(Detect, PrefersFlagsToTheOptionsFile) {
  write("strict.toml", "[search]\nmin-parts = 25\nmax-mean-error = 0.0001\n");
  const std::string file = " --json - --options " + path("strict.toml");
  const auto people = [](const Outcome& run) { return lines(run.out).at(0).at("people").size(); };
  EXPECT_EQ(people(detect(file)), 0U);
  EXPECT_EQ(people(detect(file + " --search.min-parts 4 --search.max-mean-error 1")), 1U);
}

TEST_F(Detect, KeepsFramesBeforeADamagedOne) {
  fs::copy(frames(), path("damaged"), fs::copy_options::recursive);
  write("damaged/depth/b.png", "no picture");
  const std::string out = path("damaged_out");
  const std::string command = "detect " + path("damaged") + " -q -m " + model() + " --json " + path("people.jsonl") +
                              " --out " + out + " --save video";
  const Outcome stopped = run_program(command);
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_THAT(stopped.err, HasSubstr("b.png"));
  auto found = lines(bytes_of(path("people.jsonl")));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].at("frame"), "a");
  EXPECT_EQ(found[1].at("complete"), false);
  EXPECT_EQ(found[1].at("frames"), 1);
  EXPECT_THAT(found[1].at("why"), HasSubstr("b.png"));
  EXPECT_EQ(bytes_of(out + "/overlay.avi").substr(0, 4), "RIFF");

  const Outcome kept = run_program(command + " --keep-going");
  EXPECT_EQ(kept.exit_code, 1);
  EXPECT_THAT(kept.err, HasSubstr("1 of 3 frames failed"));
  found = lines(bytes_of(path("people.jsonl")));
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[1].at("frame"), "c");
  EXPECT_EQ(found[2], json::parse(R"({"complete":false,"frames":2,"why":"1 of 3 frames failed"})"));
}

TEST_F(Detect, PrintsLinesOnlyWithoutOtherOutputs) {
  EXPECT_EQ(detect(" --json " + path("alone.jsonl")).out, "");
  EXPECT_EQ(detect(" --out " + path("alone")).out, "");
}

TEST_F(Detect, PrintsResultsOnSeparateLinesOfATerminal) {
  std::string list;
  for (int i = 0; i < 100; ++i) list += std::to_string(i) + " ../frames/depth/c.png\n";
  fs::create_directories(path("hundred"));
  write("hundred/depth.txt", list);
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_TRUE(terminal >= 0 && ::grantpt(terminal) == 0 && ::unlockpt(terminal) == 0);
  const std::string name = ::ptsname(terminal);
  const int held = ::open(name.c_str(), O_RDWR | O_NOCTTY);  // otherwise reading might end before the program begins
  std::string shown;
  std::thread reader([&] {
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::read(terminal, buffer.data(), buffer.size())) > 0;) shown.append(buffer.data(), n);
  });
  const Outcome run =
      run_program("detect " + path("hundred") + " --fx 262 --threads 1 -m " + model() + " >" + name + " 2>" + name);
  ::close(held);
  reader.join();
  ::close(terminal);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(shown, HasSubstr("of 100 frames"));
  int results = 0;
  std::istringstream in(shown);
  for (std::string line; std::getline(in, line);) {
    if (line.ends_with('\r')) line.pop_back();
    line.erase(0, line.rfind('\r') + 1);  // the text that the terminal overwrites
    if (!line.ends_with(": nobody")) continue;
    EXPECT_THAT(line, MatchesRegex("[0-9]+: nobody"));
    ++results;
  }
  EXPECT_EQ(results, 100);
}

TEST_F(Detect, FindsTheDefaultModel) {
  fs::create_directories(path("models"));
  fs::copy_file(model(), path("models/default.model"));
  const Outcome chosen = run_program("detect " + frames() + " -q --json -", "VESALIUS_MODELS='" + path("models") + "'");
  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_EQ(chosen.out, detect(" -q --json -").out);
  EXPECT_EQ(run_program("detect " + frames() + " -q").exit_code, 0) << "the build tree has the shipped ones";
}

TEST_F(Detect, NamesTheFoldersThatLackTheDefaultModel) {
  fs::create_directories(path("bin"));
  fs::copy_file(VESALIUS_PROGRAM, path("bin/vesalius"));
  const std::string command =
      "cd " + path("") + " && VESALIUS_MODELS=elsewhere bin/vesalius detect frames 2>" + path("models.err");
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_EQ(bytes_of(path("models.err")), "vesalius: no --model given, and no default.model in elsewhere, " +
                                              path("bin/models") + ", " + path("share/vesalius/models") + "\n");
  fs::create_directories(path("share/vesalius/models"));
  fs::copy_file(model(), path("share/vesalius/models/default.model"));
  EXPECT_EQ(std::system(command.c_str()), 0) << "as an installation has it: " << bytes_of(path("models.err"));
}

TEST_F(Detect, GoesOnWithoutAReaderOfItsMessages) {
  const Outcome full = detect(" 2>/dev/full");
  EXPECT_EQ(full.exit_code, 0);
  EXPECT_EQ(std::ranges::count(full.out, '\n'), 3);
  EXPECT_EQ(detect(" 2>&-").exit_code, 0);
}

TEST_F(Detect, WritesNoMessagesIntoFilesWhenStreamsAreClosed) {
  fs::copy(frames(), path("spilt"), fs::copy_options::recursive);
  write("spilt/depth/b.png", "no picture");
  const std::string people = path("spilt.jsonl");
  run_program("detect " + path("spilt") + " -m " + model() + " --keep-going --json " + people + " 2>&-");
  EXPECT_EQ(lines(bytes_of(people)).size(), 3U) << "two frames and the closing line";
}

TEST_F(Detect, PrintsOneLineForAnyFrameName) {
  fs::create_directories(path("names"));
  fs::copy(frames() + "/depth/c.png", path("names/one\ntwo.png"));
  EXPECT_EQ(run_program("detect " + path("names") + " --fx 262 -m " + model()).out, "one two: nobody\n");
}

TEST_F(Detect, TakesABodyWithOtherJointsForTheSameParts) {
  std::string body = bytes_of(std::string(VESALIUS_SOURCE_DIR) + "/data/bodies/paper25.toml");
  const std::size_t second_set = body.find("[[joint_set]]", body.find("[[joint_set]]") + 1);
  write("one_set.toml", body.substr(0, second_set));
  const Outcome run = detect(" --json - --body " + path("one_set.toml"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(lines(run.out).at(0).at("people").at(0).at("joints").size(), 1U);
}

TEST_F(Detect, PrintsTimesAsATableOfStages) {
  const Outcome run = detect(" -q --timing");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, StartsWith("ms a frame"));
  for (const char* stage : {"read", "label", "second pass", "detect", "write"}) EXPECT_THAT(run.err, HasSubstr(stage));
}

TEST_F(Detect, WritesOrCountsEveryFrameInRealTime) {
  for (const std::string rate : {"4", "1000"}) {
    const Outcome run = detect(" --realtime --rate " + rate);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto written = std::ranges::count(run.out, '\n');
    EXPECT_GE(written, 1);
    EXPECT_THAT(run.err, HasSubstr(std::to_string(3 - written) + " dropped"));
  }
}

TEST_F(Detect, StopsAtErrorsInRealTimeToo) {
  fs::copy(frames(), path("broken"), fs::copy_options::recursive);
  write("broken/depth/a.png", "no picture");
  const Outcome run = run_program("detect " + path("broken") + " -q --realtime -m " + model());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("a.png"));
}

}  // namespace
}  // namespace vesalius

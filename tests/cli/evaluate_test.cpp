#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "capsule/capsule_person.h"
#include "dataset/labelled_dataset.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Tests on the small world's frames with a table of the people in them.
class Evaluate : public SmallWorld {
 protected:
  void SetUp() override { write("frames/frames.csv", "frame,people,posture\na,1,standing\nb,1,\nc,0,empty\n"); }
  void TearDown() override {
    fs::remove_all(path("frames/mask"));
    fs::remove_all(path("out"));
  }

  static Outcome evaluate(const std::string& more) {
    return run_program("evaluate " + frames() + " -q -m " + model() + more);
  }

  /// Returns a dataset of one frame with a person and one without.
  static std::string dataset() {
    const std::string folder = path("dataset");
    if (fs::exists(folder)) return folder;
    DatasetWriter writer(folder, {paper_body().toml, "two frames", 1, 2, 2});
    const Camera camera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};
    CapsuleScene scene;
    scene.people.emplace_back();
    writer.write(0, render(scene, camera, paper_body()));
    writer.write(1, render({}, camera, paper_body()));
    return folder;
  }
};

TEST_F(Evaluate, PrintsTheMetricsOfASet) {
  const Outcome run = evaluate("");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, ContainsRegex("^frames: 3 frames, [0-9.]+ frames/s\n  found     2 of 2 people, 100.00 % .*\n"
                                     "  false     0, 0.000 a frame .*\n"
                                     "  empty     somebody in 0 of 1 frames without people\n"
                                     "  labels    [0-9.]+ % .* of empty frames taken for people\n$"));
}

TEST_F(Evaluate, MeasuresTheDefaultModelOnTheSample) {
  const Outcome run = run_program("evaluate " VESALIUS_SOURCE_DIR "/data/sample -q");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              ContainsRegex("^sample: 8 frames, [0-9.]+ frames/s\n  found     24 of 24 people, 100.00 % .*\n  false "
                            "    0, .*\n  masks     9[78][.].* overlap with the true ones"));
  EXPECT_LE(std::ranges::count(run.out, '\n'), 10);
}

TEST_F(Evaluate, StepTakesTheFirstOfEveryN) {
  EXPECT_THAT(evaluate(" --step 2").out, ContainsRegex("^frames: 2 frames, .*\n  found     1 of 1 people, "));
}

TEST_F(Evaluate, MeasuresNoPeopleWithLabelsOnly) {
  const Outcome run = evaluate(" --labels-only");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              ContainsRegex("^frames: 3 frames, [0-9.]+ frames/s\n  labels    .* of empty frames taken for people\n$"));
}

TEST_F(Evaluate, WritesAReportWithPictures) {
  // With these options somebody is missed.
  const Outcome run = evaluate(" --refine.min-score 1 --no-refine.second-pass --report " + path("out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string html = bytes_of(path("out/report.html"));
  EXPECT_THAT(html, HasSubstr("\"png\":\"iVBOR"));
  EXPECT_THAT(html, HasSubstr("\"kind\":\"plot\""));
  EXPECT_THAT(html, HasSubstr("[\"posture.standing\","));
  EXPECT_THAT(html, HasSubstr("[\"l_foot\","));
  EXPECT_THAT(html, HasSubstr("1 of 1 people missed"));
  EXPECT_THAT(html, HasSubstr("vesalius evaluate --no-refine.second-pass --refine.min-score 1 " + frames() +
                              " --model " + model() + " --report " + path("out") + " --quiet"));
  EXPECT_THAT(bytes_of(path("out/figures.csv")), HasSubstr("\nframes,people.found,0,0,0.65"));
  EXPECT_EQ(json::parse(bytes_of(path("out/report.json"))).at("sets").size(), 1U);
}

TEST_F(Evaluate, FollowsThePeopleOfARecording) {
  write("frames/frames.csv", "frame,people\na,1\nb,1\nc,0\n");
  const Outcome run = evaluate(" --track --hidden --json " + path("track.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, ContainsRegex("^frames: 3 frames, .*\n  found     2 of 2 people, .*\n  false     0, .*\n  empty "
                                     "    somebody in 0 of 1 frames without people\n"));
  EXPECT_THAT(run.out, ContainsRegex("\n  ids       IDF1 [0-9.]+ % .*, MOTA [0-9.]+ %, ids [12].00 a person\n"));
  const json report = json::parse(bytes_of(path("track.json")));
  EXPECT_TRUE(report.at("tracked").get<bool>());
  EXPECT_EQ(report.at("sets").at(0).at("figures").at("track.missed").at("value"), 0.0);
}

TEST_F(Evaluate, FollowsPeopleOnlyWhereFramesAreRecordings) {
  const Outcome run = run_program("evaluate " + dataset() + " -q --track -m " + model());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("stands alone, expected recordings"));
  EXPECT_EQ(evaluate(" --hidden").exit_code, 2);
  EXPECT_EQ(evaluate(" --track --labels-only").exit_code, 2);
}

TEST_F(Evaluate, FollowsWithTheOptionsOfTrackingAndFittedBodies) {
  const auto options = [&](const std::string& flags) {
    EXPECT_EQ(evaluate(flags + " --json " + path("options.json")).exit_code, 0);
    return json::parse(bytes_of(path("options.json"))).at("options").get<std::string>();
  };
  const std::string tracked = options(" --track --track.confirm 2 --fit.surface 0.04");
  EXPECT_THAT(tracked, HasSubstr("\ntrack.confirm = 2\n"));
  EXPECT_THAT(tracked, HasSubstr("\nfit.surface = 0.04\n"));
  EXPECT_THAT(options(""), Not(HasSubstr("track."))) << "nobody was followed";
  EXPECT_EQ(evaluate(" --track --fit.surface 0").exit_code, 2);
}

// Labels: threads
TEST_F(Evaluate, GivesTheSameMetricsForAnyNumberOfThreads) {
  std::vector<json> sets;
  for (const char* threads : {"1", "2", "5"}) {
    ASSERT_EQ(evaluate(" --json " + path("t.json") + " --threads " + threads).exit_code, 0);
    sets.push_back(json::parse(bytes_of(path("t.json"))).at("sets").at(0));
    sets.back().erase("seconds");
  }
  EXPECT_EQ(sets[0], sets[1]);
  EXPECT_EQ(sets[0], sets[2]);
}

TEST_F(Evaluate, PrintsNothingButJsonToStandardOutput) {
  const Outcome run = evaluate(" --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out).at("sets").size(), 1U);
}

TEST_F(Evaluate, MeasuresPixelsPartsAndJointsOfDatasets) {
  const Outcome run = run_program("evaluate " + dataset() + " -q -m " + model() + " --json " + path("d.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json set = json::parse(bytes_of(path("d.json"))).at("sets").at(0);
  const json& figures = set.at("figures");
  EXPECT_GT(figures.at("pixels.mean_recall_inside").at("value"), 0.2);
  EXPECT_GE(figures.at("pixels.mean_recall_inside").at("value"), figures.at("pixels.mean_recall").at("value"));
  EXPECT_GT(figures.at("pixels.person_iou").at("value"), 0.5);
  EXPECT_TRUE(figures.contains("parts.right"));
  EXPECT_FALSE(figures.contains("joints.at_10cm"));  // the only person is in a frame that is used for fitting
  EXPECT_EQ(set.at("confusion").size(), 26U);
  EXPECT_EQ(set.at("curve_over_parts").size(), 25U);
}

TEST_F(Evaluate, ReadsHeadingsBesideTheFrames) {
  write("headings.csv", "set,frame,heading\nframes,a,front\n");
  const Outcome run = evaluate(" --headings " + path("headings.csv") + " --json " + path("h.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json::parse(bytes_of(path("h.json"))).at("sets").at(0).at("figures");
  EXPECT_EQ(figures.at("heading.front").at("denominator"), 1.0);
  EXPECT_FALSE(figures.contains("heading.back"));
  write("headings.csv", "set,frame,heading\nframes,a,up\n");
  EXPECT_THAT(evaluate(" --headings " + path("headings.csv")).err, HasSubstr("headings.csv:2: column heading: \"up\""));
}

TEST_F(Evaluate, RefusesAModelOfOtherParts) {
  std::string toml = paper_body().toml;
  for (std::size_t at = toml.find("l_foot"); at != toml.npos; at = toml.find("l_foot", at + 1)) toml[at + 2] = 'g';
  DatasetWriter(path("other"), {toml, "", 1, 1, 1}).write(0, render({}, {16, 12, 10, 10, 8, 6}, paper_body()));
  const Outcome run = run_program("evaluate " + path("other") + " -q -m " + model());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("part 0 is l_goot, in the model l_foot"));
}

TEST_F(Evaluate, StopsAtADamagedFrameUnlessToldToKeepGoing) {
  const std::string file = path("frames/depth/b.png");
  const std::string good = bytes_of(file);
  write("frames/depth/b.png", good.substr(0, good.size() / 2));
  const Outcome stops = evaluate(" --json " + path("out.json"));
  const Outcome goes_on = evaluate(" --keep-going --json " + path("out.json") + ".2");
  write("frames/depth/b.png", good);
  EXPECT_EQ(stops.exit_code, 1);
  EXPECT_THAT(stops.err, HasSubstr("b.png: "));
  EXPECT_EQ(stops.out, "");
  EXPECT_FALSE(fs::exists(path("out.json")));
  EXPECT_EQ(goes_on.exit_code, 1);
  EXPECT_THAT(goes_on.err, HasSubstr("b.png: "));
  EXPECT_THAT(goes_on.err, HasSubstr("1 frame failed"));
  EXPECT_THAT(goes_on.out, ContainsRegex("^frames: 2 frames, 1 failed, .*\n  found     1 of 1 people, "));
  const json set = json::parse(bytes_of(path("out.json.2"))).at("sets").at(0);
  EXPECT_EQ(set.at("failed"), 1);
  EXPECT_THAT(set.at("failures").at(0).get<std::string>(), HasSubstr("b.png"));
}

TEST_F(Evaluate, RefusesTruthThatCannotBeUsed) {
  const auto error = [](const std::string& more) {
    const Outcome run = evaluate(more);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    return run.err;
  };
  write("frames/frames.csv", "frame,persons\na,1\n");
  EXPECT_THAT(error(""), HasSubstr("frames.csv: no column \"people\" in the header"));
  write("frames/frames.csv", "frame,people\na,1\nc,0\n");
  EXPECT_THAT(error(""), HasSubstr("nothing is known of frame b"));
  fs::remove(path("frames/frames.csv"));
  EXPECT_THAT(error(""), HasSubstr("no truth, expected frames.csv"));
  SetUp();
  fs::create_directories(path("frames/mask"));
  write_png(Image<std::uint8_t>(8, 6, 1), path("frames/mask/b.png"));
  EXPECT_THAT(error(""), HasSubstr("mask/b.png: 8x6 pixels, expected those of the frame, 320x240"));
  EXPECT_EQ(run_program("evaluate " + frames() + " " + frames() + " -m " + model()).exit_code, 2);
  EXPECT_THAT(run_program("evaluate /nowhere -m " + model()).err, HasSubstr("/nowhere: "));
}

TEST_F(Evaluate, MeasuresJointsOfFramesThatAreNotForFitting) {
  write("frames/joints.csv",
        "frame,joint,x_m,y_m,z_m\na,head,0,-0.6,2.5\na,l_knee,0.1,0.5,2.5\nb,head,0,-0.6,2.5\nb,l_knee,0.1,0.5,2.5\n");
  const Outcome run = evaluate(" --json " + path("j.json"));
  fs::remove(path("frames/joints.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json set = json::parse(bytes_of(path("j.json"))).at("sets").at(0);
  EXPECT_EQ(set.at("figures").at("joints.at_10cm").at("denominator"), 2.0);  // the joints of frame b
  EXPECT_EQ(set.at("joint_precision").size(), 2U);
  const BodyModel body = parse_body_model(
      paper_body().toml + "\n" + bytes_of(VESALIUS_SOURCE_DIR "/data/joints/evaluation.toml"), "joints");
  EXPECT_EQ(body.joint_sets.size(), paper_body().joint_sets.size() + 2);
}

TEST_F(Evaluate, RendersTheFramesThatSynthWrites) {
  write("small.toml",
        "sensor.width = 80\nsensor.height = 60\nsensor.colour = false\nbody.kind = 'builtin'\nbody.count = 2\n"
        "pose.captured = 0.0\n");
  const std::string recipe = path("small.toml");
  const Outcome made = run_program("synth -q --recipe " + recipe + " --count 5 --seed 3 --out " + path("made"));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto figures = [&](const std::string& source) {
    const Outcome run = run_program("evaluate -q --step 2 " + source + " -m " + model() + " --json " + path("r.json"));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(bytes_of(path("r.json"))).at("sets").at(0);
  };
  const json stored = figures(path("made"));
  const json rendered = figures("--recipe " + recipe + " --count 5 --render-seed 3");
  EXPECT_EQ(rendered.at("frames"), 3);
  EXPECT_EQ(rendered.at("name"), "small");
  EXPECT_THAT(rendered.at("notes").at(0).get<std::string>(),
              StartsWith("rendered with seed 3: bodies built in, 0 captured poses, checksum of the files used "));
  for (const auto& [name, figure] : stored.at("figures").items()) {
    EXPECT_EQ(rendered.at("figures").at(name).at("value"), figure.at("value")) << name;
  }
  EXPECT_EQ(rendered.at("confusion"), stored.at("confusion"));
}

TEST_F(Evaluate, NamesSubstitutesForMissingAssetsEvenWhenQuiet) {
  write("captured.toml", "sensor.width = 80\nsensor.height = 60\nbody.count = 2\nbody.kind = 'auto'\n");
  fs::create_directories(path("no_assets"));
  const Outcome run = run_program("evaluate -q --recipe " + path("captured.toml") + " --count 1 --assets " +
                                  path("no_assets") + " -m " + model() + " --json " + path("n.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("note: captured: makehuman is not there, the built-in body instead"));
  EXPECT_THAT(run.err, HasSubstr("note: captured: mocap is not there, sampled poses instead"));
  const json notes = json::parse(bytes_of(path("n.json"))).at("sets").at(0).at("notes");
  EXPECT_THAT(notes.dump(), HasSubstr("mocap is not there"));
}

TEST_F(Evaluate, NeedsACountForARecipe) {
  write("small.toml", "body.kind = 'builtin'\n");
  const Outcome run = run_program("evaluate --recipe " + path("small.toml") + " -m " + model());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--recipe expects --count"));
  EXPECT_EQ(run_program("evaluate -m " + model()).exit_code, 2);
}

class Compare : public Evaluate {};

TEST_F(Compare, NamesMetricsThatGotWorse) {
  ASSERT_EQ(evaluate(" --json " + path("good.json")).exit_code, 0);
  ASSERT_EQ(evaluate(" --json " + path("bad.json") + " --refine.min-score 1").exit_code, 0);
  const Outcome same = run_program("compare " + path("good.json") + " " + path("good.json"));
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("\n0 better, 0 worse, "));
  const Outcome worse = run_program("compare " + path("good.json") + " " + path("bad.json"));
  EXPECT_THAT(worse.out, ContainsRegex("people.found +100.00 % -> +0.00 % +-100.00 % .* WORSE"));
  EXPECT_THAT(run_program("compare --all " + path("good.json") + " " + path("bad.json")).out, HasSubstr("  same\n"));
}

TEST_F(Compare, RefusesFilesThatAreNoEvaluation) {
  ASSERT_EQ(evaluate(" --json " + path("good.json")).exit_code, 0);
  const auto error = [](const std::string& text) {
    write("x.json", text);
    const Outcome run = run_program("compare " + path("good.json") + " " + path("x.json"));
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    return run.err;
  };
  EXPECT_THAT(error(""), HasSubstr("x.json: no evaluation"));
  EXPECT_THAT(error("[1]"), HasSubstr("x.json: no evaluation"));
  EXPECT_THAT(error(R"({"vesalius_evaluation": 99})"), HasSubstr("x.json: version 99, expected 1"));
  EXPECT_THAT(error(R"({"vesalius_evaluation": 1})"), HasSubstr("x.json: damaged evaluation"));
  EXPECT_THAT(error(R"({"vesalius_evaluation": 1, "sets": []})"), HasSubstr("no set in common"));
  const auto with = [](const std::string& metrics) {
    return R"({"vesalius_evaluation": 1, "sets": [{"name": "frames", "frames_key": "0", "figures": )" + metrics + "}]}";
  };
  EXPECT_THAT(error(with(R"({"mask.iou": 3})")), HasSubstr("x.json: damaged evaluation"));
  EXPECT_THAT(error(with(R"({"mask.iuo": {}})")), HasSubstr("x.json: unknown metric mask.iuo"));
}

}  // namespace
}  // namespace vesalius

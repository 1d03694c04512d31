#include "cluster/cluster_executor.h"

#include <gmock/gmock.h>

#include "cluster/map_task.h"
#include "cluster/test_engine.h"
#include "train/grow_forest.h"
#include "train/test_training.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::MemoryStore;
using test::TestEngine;
using test::TestEngineOptions;

std::vector<LabelledFrame> make_frames(int count) { return test::noisy_frames(count, 3.1); }

TrainOptions make_options() {
  TrainOptions options;
  options.trees = 3;
  options.hard_trees = 2;
  options.sample.pixels_per_frame = 150;
  options.sample.held_out_share = 0.1F;
  options.sample.hard_pool = 300;
  options.sample.hard_share = 0.2F;
  options.grow.leaf.max_depth = 7;
  options.grow.leaf.min_samples = 4;
  options.grow.split.candidates = 70;  // two blocks
  options.grow.split.split_pixels = 700;
  options.leaves.rounds = 5;
  options.leaves.portions = 2;
  return options;
}

class ClusterTrainingTest : public testing::Test {
 protected:
  const std::vector<LabelledFrame> frames_ = make_frames(24);
  const TrainOptions options_ = make_options();

  Forest untrained() const {
    return TrainingSet(paper_body(), training_convention(options_), options_.sample, 1).untrained_forest();
  }

  Forest whole() const { return grow_forest(frames_, paper_body(), options_); }

  Forest over(TestEngine& engine, TreeStore& trees, int shard_frames, std::uint64_t task_memory = 0,
              int tasks = 1) const {
    TrainingSet background(paper_body(), training_convention(options_), options_.sample, 1);
    for (int i = 0; i < 3; ++i) background.add(frames_[i]);
    ClusterExecutor executor(
        engine,
        {.forest = untrained(),
         .options = options_,
         .source = "",
         .frames = frames_.size() - 3,
         .backgrounds = {&background}},
        {.shard_frames = static_cast<std::uint64_t>(shard_frames), .map_tasks = tasks, .task_memory = task_memory});
    TrainObserver nobody;
    return train_forest(executor, untrained(), options_, trees, nobody);
  }

  TaskContext::ReadFrame reader() const {
    return [this](std::uint64_t i) { return frames_[3 + i]; };
  }

  static void expect_same(const Forest& a, const Forest& b) {
    EXPECT_EQ(a.trees, b.trees);
    EXPECT_EQ(a.logit_unit, b.logit_unit);
    EXPECT_EQ(a.facing.weights, b.facing.weights);
  }
};

TEST_F(ClusterTrainingTest, GivesTheForestOfOneProcess) {
  const Forest expected = whole();
  ASSERT_FALSE(expected.trees.front().logits.empty());
  struct Case {
    TestEngineOptions engine;
    int shard_frames;
    std::uint64_t task_memory;
  };
  const std::uint64_t enough = std::uint64_t{1} << 40U;
  for (const Case& c : {Case{{}, 100, 0}, Case{{.map_tasks = 3, .reduce_tasks = 2, .combine = true}, 4, 0},
                        Case{{.map_tasks = 7, .reduce_tasks = 3}, 1, 0},
                        Case{{.map_tasks = 7, .reduce_tasks = 1, .combine = true, .twice = true}, 2, 0},
                        Case{{.map_tasks = 3}, 5, enough}, Case{{.map_tasks = 7}, 5, enough}}) {
    MemoryStore store;
    TestEngine engine(store, reader(), c.engine);
    MemoryTreeStore trees;
    SCOPED_TRACE(testing::Message() << c.engine.map_tasks << " map tasks, " << c.shard_frames << " frames a shard");
    expect_same(over(engine, trees, c.shard_frames, c.task_memory, c.engine.map_tasks), expected);
  }
}

TEST_F(ClusterTrainingTest, GoesOnAfterTheLastJobThatEnded) {
  const Forest expected = whole();
  MemoryStore store;
  MemoryTreeStore trees;
  int jobs = 0, runs = 0;
  for (bool ended = false; !ended; ++runs) {
    TestEngine engine(store, reader(), {.map_tasks = 2, .jobs_before_end = 4});
    try {
      expect_same(over(engine, trees, 6), expected);
      ended = true;
    } catch (const Error& e) {
      ASSERT_STREQ(e.what(), "killed");
    }
    jobs += std::min(engine.jobs, 4);
  }
  EXPECT_GT(runs, 5);
  MemoryStore other;
  TestEngine once(other, reader(), {});
  MemoryTreeStore fresh;
  over(once, fresh, 6);
  EXPECT_LE(jobs, once.jobs + 2 * runs) << "only leaves are learned again, from the last round that was saved";
}

TEST_F(ClusterTrainingTest, SubtreesNeedFewJobs) {
  MemoryStore store, other;
  MemoryTreeStore trees, other_trees;
  TestEngine levels(store, reader(), {.map_tasks = 2}), subtrees(other, reader(), {.map_tasks = 2});
  over(levels, trees, 6);
  over(subtrees, other_trees, 6, std::uint64_t{1} << 40U, 2);
  EXPECT_LT(subtrees.jobs, levels.jobs / 2);
  EXPECT_LT(subtrees.bytes, levels.bytes / 2);
}

TEST_F(ClusterTrainingTest, NamesWhatIsDamaged) {
  MemoryStore store;
  TestEngine engine(store, reader(), {.map_tasks = 2, .jobs_before_end = 1});
  MemoryTreeStore trees;
  EXPECT_THROW(over(engine, trees, 6), Error);
  for (const std::size_t at : {std::size_t{3}, std::size_t{20}, std::size_t{5000}}) {
    std::string& bytes = store.files.at("sets-0/000002");
    bytes[at] = static_cast<char>(bytes[at] + 1);
    TestEngine again(store, reader(), {.map_tasks = 2});
    try {
      over(again, trees, 6);
      ADD_FAILURE() << "a damaged shard was read";
    } catch (const Error& e) {
      EXPECT_THAT(e.what(),
                  testing::AllOf(testing::HasSubstr("shard 2: memory/sets-0/000002"), testing::HasSubstr("--restart")));
    }
    bytes[at] = static_cast<char>(bytes[at] - 1);
  }
  std::string& result = store.files.at("jobs/prepare/out/part-0");
  result[result.find('\t') + 40] ^= 1;
  TestEngine again(store, reader(), {.map_tasks = 2});
  try {
    over(again, trees, 6);
    ADD_FAILURE() << "a damaged result was read";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("memory/jobs/prepare/out/part-0: 0000000"),
                                         testing::HasSubstr("--restart")));
  }
}

TEST_F(ClusterTrainingTest, ReportsOutputThatIsMissing) {
  class Forgetful : public TestEngine {
   public:
    using TestEngine::TestEngine;
    void run(const EngineJob& job) override {
      EngineJob less = job;
      if (job.name == lost) less.lines.pop_back();
      TestEngine::run(less);
    }
    std::string lost;
  };
  for (const auto& [job, says] :
       {std::pair("prepare", "no result for shard 4"),
        std::pair("trees-1000-level-00-rows", "samples came; the output of a map task is missing"),
        std::pair("trees-1000-level-00-counts", "of 5 shards came"), std::pair("leaf-counts", "4 of 5 shards came"),
        std::pair("facing", "no result for")}) {
    MemoryStore store;
    Forgetful engine(store, reader(), {});
    engine.lost = job;
    MemoryTreeStore trees;
    try {
      over(engine, trees, 6);
      ADD_FAILURE() << job;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(says)) << job;
    }
  }
}

TEST_F(ClusterTrainingTest, RefusesTasksOfAnotherBuild) {
  MemoryStore store;
  TestEngine engine(store, reader(), {.jobs_before_end = 0});
  MemoryTreeStore trees;
  EXPECT_THROW(over(engine, trees, 6), Error);
  std::string job = opened(store.files.at("jobs/prepare/job"), "job");
  job.replace(job.find("vesalius "), 12, "vesalius 9.9");
  store.files["jobs/prepare/job"] = sealed(job);
  std::istringstream in("1\n");
  std::ostringstream out;
  try {
    run_map_task({.store = store, .job = "prepare", .open_source = {}}, in, out);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("memory/jobs/prepare/job: made by vesalius 9.9"));
    EXPECT_THAT(e.what(), testing::HasSubstr("expected the same on all machines"));
  }
  EXPECT_EQ(out.str(), "");
}

TEST(ProgramBuild, IsThatOfTheProgramWhateverItsVersion) {
  EXPECT_THAT(program_build(), testing::MatchesRegex("vesalius [0-9.]+ of hash [0-9a-f]+"));
  EXPECT_EQ(program_build(), program_build());
  expect_this_build(program_build(), "job");
  std::string other = program_build();
  other.back() = other.back() == '0' ? '1' : '0';  // of the same version, from other sources
  EXPECT_THROW(expect_this_build(other, "job"), Error);
}

TEST_F(ClusterTrainingTest, RefusesLinesThatNameNoShard) {
  MemoryStore store;
  TestEngine engine(store, reader(), {.jobs_before_end = 0});
  MemoryTreeStore trees;
  EXPECT_THROW(over(engine, trees, 6), Error);
  for (const char* line : {"x", "5", "-1", "1 2", "0\t99"}) {
    std::istringstream in(line);
    std::ostringstream out;
    EXPECT_THROW(run_map_task({.store = store, .job = "prepare", .open_source = {}}, in, out), Error) << line;
  }
}

class TrainingSetBytes : public testing::Test {
 protected:
  TrainingSet set_of(const TrainingSet& like, TrainingSet::Contents contents) const {
    return {paper_body(), options_.sample, 1, like.first_frame(), std::move(contents)};
  }

  TrainOptions options_ = make_options();
};

TEST_F(TrainingSetBytes, GiveTheSameSet) {
  TrainingSet set(paper_body(), training_convention(options_), options_.sample, 1, 7);
  for (const LabelledFrame& frame : make_frames(12)) set.add(frame);
  const std::string bytes = training_set_bytes(set);
  TrainingSet::Contents contents{.frames = FrameStore(set.convention())};
  append_training_set(HugeBuffer(bytes), "set", contents);
  const TrainingSet same = set_of(set, std::move(contents));
  EXPECT_EQ(training_set_bytes(same), bytes);
  EXPECT_EQ(grow_tree(same, options_.grow, 0), grow_tree(set, options_.grow, 0));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 4) {
    TrainingSet::Contents none{.frames = FrameStore(set.convention())};
    EXPECT_THROW(append_training_set(HugeBuffer(bytes.substr(0, size)), "set", none), Error);
  }
}

TEST_F(TrainingSetBytes, OfShardsGiveTheSetOfAllFrames) {
  const std::vector<LabelledFrame> frames = make_frames(12);
  TrainingSet all(paper_body(), training_convention(options_), options_.sample, 1, 0);
  for (const LabelledFrame& frame : frames) all.add(frame);
  TrainingSet::Contents contents{.frames = FrameStore(all.convention())};
  for (const auto& [first, last] : {std::pair(0, 5), std::pair(5, 6), std::pair(6, 12)}) {
    TrainingSet shard(paper_body(), training_convention(options_), options_.sample, 1, first);
    for (int f = first; f < last; ++f) shard.add(frames[f]);
    append_training_set(HugeBuffer(training_set_bytes(shard)), "shard", contents);
  }
  EXPECT_EQ(training_set_bytes(set_of(all, std::move(contents))), training_set_bytes(all));
}

}  // namespace
}  // namespace vesalius

#include "cluster/engine.h"

#include <stdlib.h>

#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "cluster/cluster_executor.h"
#include "cluster/process.h"
#include "cluster/test_engine.h"
#include "io/files/test_files.h"
#include "train/messages/training_protocol.h"

namespace vesalius {
namespace {

/// Programs of an engine as a test wants them, before all others in PATH.
class FakePrograms {
 public:
  FakePrograms() : path_(::getenv("PATH")) { ::setenv("PATH", (folder_ / "bin:" + path_).c_str(), 1); }
  ~FakePrograms() { ::setenv("PATH", path_.c_str(), 1); }
  FakePrograms(const FakePrograms&) = delete;
  FakePrograms& operator=(const FakePrograms&) = delete;

  void set(const std::string& name, const std::string& script) const {
    const std::string path = test::put(folder_ / "bin/" + name, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  std::string operator/(const std::string& name) const { return folder_ / name; }

 private:
  test::TemporaryFolder folder_;
  std::string path_;
};

/// A job of one map task, in a store beside the programs.
struct OneJob {
  FakePrograms programs;
  EngineOptions options;
  EngineJob job{"work", "train", {"0"}, false};

  OneJob() {
    options.program = "true";
    options.answer_s = 1.0;
  }
  std::string file(const std::string& name) const { return programs / "store/jobs/work/" + name; }
  std::string error(std::unique_ptr<Engine> (*make)(std::unique_ptr<Store>, const EngineOptions&)) {
    const auto begun = std::chrono::steady_clock::now();
    const std::string message = test::error_of([&] { make(open_store(programs / "store"), options)->run(job); });
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(60));
    return message;
  }
};

/// Does the one task of a job, as squeue sees it.
std::string done_in(const OneJob& run) {
  return "for folder in " + run.file("tasks-*") + "; do touch $folder/map-0.done; done; echo COMPLETED None";
}

TEST(SlurmEngine, GivesUpWhereSbatchDoesNotAnswer) {
  OneJob run;
  run.programs.set("sbatch", "sleep 100");
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: sbatch does not answer within 1 s");
}

TEST(SlurmEngine, GivesUpWhereSqueueAnswersNoMore) {
  OneJob run;
  run.programs.set("sbatch", "echo 7");
  run.programs.set("squeue", "sleep 100");
  run.programs.set("scancel", "echo $* >" + (run.programs / "cancelled"));
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: squeue does not answer within 1 s");
  EXPECT_EQ(test::get(run.programs / "cancelled"), "7\n");
}

TEST(SlurmEngine, WaitsWhereSqueueIsSilentForAWhile) {
  OneJob run;
  run.programs.set("sbatch", "echo 7");
  run.programs.set("squeue", "echo >>" + (run.programs / "asked") + "; case $(wc -l <" + (run.programs / "asked") +
                                 ") in 1 | 3) sleep 100 ;; 2) exit 1 ;; *) " + done_in(run) + " ;; esac");
  make_slurm_engine(open_store(run.programs / "store"), run.options)->run(run.job);
  EXPECT_TRUE(std::filesystem::exists(run.file("out/_SUCCESS")));
}

// The earlier driver may have divided the work otherwise.
TEST(SlurmEngine, CancelsWhatAKilledDriverLeft) {
  OneJob run;
  test::put(run.file("tasks-1/reduce.slurm"), "6");
  run.programs.set("scancel", "echo $* >>" + (run.programs / "cancelled"));
  run.programs.set("sbatch", "cp " + (run.programs / "cancelled") + " " + (run.programs / "before") + "; echo 7");
  run.programs.set("squeue", done_in(run));
  make_slurm_engine(open_store(run.programs / "store"), run.options)->run(run.job);
  EXPECT_EQ(test::get(run.programs / "before"), "6\n");
  EXPECT_EQ(test::get(run.programs / "cancelled"), "6\n");
}

TEST(SlurmEngine, CancelsAllThatIsLeftOfATrainingThatBeginsAnew) {
  OneJob run;
  test::put(run.file("tasks-1/reduce.slurm"), "6");
  test::put(run.programs / "store/jobs/other/tasks-2/map.slurm", "7");
  test::put(run.programs / "store/sets-0/000000", "a shard");
  run.programs.set("scancel", "echo $* >>" + (run.programs / "cancelled"));
  const auto engine = make_slurm_engine(open_store(run.programs / "store"), run.options);
  ClusterExecutor::clear(*engine);
  EXPECT_EQ(test::get(run.programs / "cancelled"), "7\n6\n");
  EXPECT_TRUE(std::filesystem::is_empty(run.programs / "store"));
}

TEST(SlurmEngine, SubmitsNothingWhereScancelDoesNotAnswer) {
  OneJob run;
  test::put(run.file("tasks-1/map.slurm"), "7");
  run.programs.set("scancel", "sleep 100");
  run.programs.set("sbatch", "touch " + (run.programs / "submitted"));
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: scancel does not answer within 1 s");
  EXPECT_FALSE(std::filesystem::exists(run.programs / "submitted"));
}

TEST(HadoopEngine, GivesUpWhereAnEarlierJobCannotBeKilled) {
  OneJob run;
  test::put(run.file("hadoop-job"), "job_1_2");
  run.programs.set("mapred", "sleep 100");
  EXPECT_EQ(run.error(make_hadoop_engine), "Hadoop: mapred does not answer within 1 s");
  EXPECT_EQ(test::get(run.file("hadoop-job")), "job_1_2");
}

// A driver that was killed and begun again divides the work otherwise, while a task of the first one still runs and
// writes between the map and the reduce task of the second.
TEST(LocalEngine, IsNotDisturbedByTasksOfAnotherDivision) {
  OneJob run;
  const auto file = [&](const char* name) { return run.programs / name; };
  run.programs.set(
      "program",
      "case $2 in map) touch " + file("running") + "; while [ -e \"$HELD\" ]; do sleep 0.01; done; cat ;;\n" +
          "combine) for into; do :; done; lines=$(cat); echo \"$lines\" >$into.0; if [ -n \"$HELD\" ]; then touch " +
          file("written") + "; else rm -f " + file("held") + "; while [ ! -e " + file("written") +
          " ]; do sleep 0.01; done; fi ;;\n" + "reduce) cat ;; esac");
  run.options.program = run.programs / "bin/program";
  run.job.lines = {"a", "b"};
  run.job.reduced = true;
  const auto engine = [&] { return make_local_engine(open_store(run.programs / "store"), run.options, 1); };
  run.options.map_tasks = 2;
  run.options.stopped = [] { return true; };
  EXPECT_THROW(engine()->run(run.job), Interrupted);
  std::string script;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(run.programs / "store")) {
    if (entry.path().filename() == "task.sh") script = entry.path();
  }
  std::filesystem::remove(file("running"));
  test::put(file("held"), "");
  ChildProcess earlier({"env", "HELD=" + file("held"), "bash", script, "map", "0"}, file("log"));
  while (!std::filesystem::exists(file("running"))) std::this_thread::sleep_for(std::chrono::milliseconds(10));

  run.options.stopped = [] { return false; };
  run.options.map_tasks = 1;
  engine()->run(run.job);
  EXPECT_EQ(test::get(run.file("out/part-r-0")), "a\nb\n");
}

/// A store that gets full as soon as its job runs.
class FullStore : public test::MemoryStore {
 public:
  void write(const std::string& name, const std::string& bytes) override {
    if (name.find("/failed/") != std::string::npos) throw Error("memory/" + name + ": it is full");
    MemoryStore::write(name, bytes);
  }
};

// Tasks write into the store why they failed.
TEST(HadoopEngine, TellsOfAStoreThatTakesNoMessages) {
  OneJob run;
  run.programs.set("mapred", "echo 'Error: subprocess failed with code 1'; exit 1");
  const auto error_in = [&](std::unique_ptr<Store> store) {
    return test::error_of([&] { make_hadoop_engine(std::move(store), run.options)->run(run.job); });
  };
  EXPECT_EQ(error_in(std::make_unique<test::MemoryStore>()),
            "work: Hadoop gave up: Error: subprocess failed with code 1");
  EXPECT_EQ(error_in(std::make_unique<FullStore>()),
            "work: Hadoop gave up: memory/jobs/work/failed/driver: it is full");
}

}  // namespace
}  // namespace vesalius

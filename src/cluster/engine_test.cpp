#include "cluster/engine.h"

#include <stdlib.h>

#include <chrono>

#include "io/files/test_files.h"

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
    options.answer_s = 0.5;
  }
  std::string file(const std::string& name) const { return programs / "store/jobs/work/" + name; }
  std::string error(std::unique_ptr<Engine> (*make)(std::unique_ptr<Store>, const EngineOptions&)) {
    const auto begun = std::chrono::steady_clock::now();
    const std::string message = test::error_of([&] { make(open_store(programs / "store"), options)->run(job); });
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(60));
    return message;
  }
};

TEST(SlurmEngine, GivesUpWhereSbatchDoesNotAnswer) {
  OneJob run;
  run.programs.set("sbatch", "sleep 100");
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: sbatch does not answer within 0.5 s");
}

TEST(SlurmEngine, GivesUpWhereSqueueAnswersNoMore) {
  OneJob run;
  run.programs.set("sbatch", "echo 7");
  run.programs.set("squeue", "sleep 100");
  run.programs.set("scancel", "echo $* >" + (run.programs / "cancelled"));
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: squeue does not answer within 0.5 s");
  EXPECT_EQ(test::get(run.programs / "cancelled"), "7\n");
}

TEST(SlurmEngine, WaitsWhereSqueueIsSilentForAWhile) {
  OneJob run;
  run.programs.set("sbatch", "echo 7");
  run.programs.set("squeue", "echo >>" + (run.programs / "asked") + "; case $(wc -l <" + (run.programs / "asked") +
                                 ") in 1 | 3) sleep 100 ;; 2) exit 1 ;; *) touch " + run.file("map-0.done") +
                                 "; echo COMPLETED None ;; esac");
  make_slurm_engine(open_store(run.programs / "store"), run.options)->run(run.job);
  EXPECT_TRUE(std::filesystem::exists(run.file("out/_SUCCESS")));
}

// The earlier driver may have divided the work otherwise, so that its files are of no use.
TEST(SlurmEngine, CancelsWhatAKilledDriverLeft) {
  OneJob run;
  test::put(run.file("reduce.slurm"), "6");
  run.programs.set("scancel", "echo $* >>" + (run.programs / "cancelled"));
  run.programs.set("sbatch", "cp " + (run.programs / "cancelled") + " " + (run.programs / "before") + "; echo 7");
  run.programs.set("squeue", "touch " + run.file("map-0.done") + "; echo COMPLETED None");
  make_slurm_engine(open_store(run.programs / "store"), run.options)->run(run.job);
  EXPECT_EQ(test::get(run.programs / "before"), "6\n");
  EXPECT_EQ(test::get(run.programs / "cancelled"), "6\n");
}

TEST(SlurmEngine, SubmitsNothingWhereScancelDoesNotAnswer) {
  OneJob run;
  test::put(run.file("map.slurm"), "7");
  run.programs.set("scancel", "sleep 100");
  run.programs.set("sbatch", "touch " + (run.programs / "submitted"));
  EXPECT_EQ(run.error(make_slurm_engine), "Slurm: scancel does not answer within 0.5 s");
  EXPECT_FALSE(std::filesystem::exists(run.programs / "submitted"));
}

TEST(HadoopEngine, GivesUpWhereAnEarlierJobCannotBeKilled) {
  OneJob run;
  test::put(run.file("hadoop-job"), "job_1_2");
  run.programs.set("mapred", "sleep 100");
  EXPECT_EQ(run.error(make_hadoop_engine), "Hadoop: mapred does not answer within 0.5 s");
  EXPECT_EQ(test::get(run.file("hadoop-job")), "job_1_2");
}

}  // namespace
}  // namespace vesalius

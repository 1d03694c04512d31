#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>

#include "cluster/engine.h"
#include "cluster/store.h"
#include "cluster/train_job.h"
#include "io/files/test_files.h"
#include "train/messages/training_protocol.h"

namespace vesalius {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kStore = "a=store of one";

/// Stands for vesalius: counts its lines by key. Says how it was called.
constexpr const char* kProgram = R"(#!/bin/bash
echo "$*" >>"$(dirname "$0")/calls"
case $2 in
  map) while read -r line; do printf '%s\t1\n%s\t1\n' "$line" "${line:0:1}"; done ;;
  *) awk -F '\t' '{ sum[$1] += $2 } END { for (key in sum) print key "\t" sum[key] }' | sort ;;
esac
)";

class ScriptEngineTest : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::string plain_ = test::get(VESALIUS_PLAIN_JOB);
  EngineOptions options_ = [this] {
    EngineOptions options;
    options.program = program("vesa'lius", kProgram);
    options.map_tasks = 2;
    options.reduce_tasks = 3;
    return options;
  }();

  std::string program(const std::string& name, const std::string& text) const {
    test::put(folder_ / name, text);
    std::filesystem::permissions(folder_ / name, std::filesystem::perms::owner_all);
    return folder_ / name;
  }

  /// Runs a job by a script and returns what it left as part-0.
  std::string run(const std::string& script, bool reduced = true) const {
    const auto engine = make_script_engine(open_store(folder_ / kStore), options_, program("script", script));
    const EngineJob job{"count", "train", {"a1", "a2", "b1", "a1"}, reduced, reduced};
    engine->run(job);
    EXPECT_TRUE(engine->store().exists(result_folder(job.name) + "/_SUCCESS"));
    return engine->store().read(result_folder(job.name) + "/part-0");
  }

  std::string message_of(const std::string& script) const {
    return test::error_of([&] { run(script); });
  }
};

TEST_F(ScriptEngineTest, MapsSortsAndReduces) {
  const std::string counts = "a\t3\na1\t2\na2\t1\nb\t1\nb1\t1\n";
  EXPECT_EQ(run(plain_), counts);
  EXPECT_THAT(test::get(folder_ / "calls"),
              AllOf(HasSubstr("train map --store " + (folder_ / kStore) + " --job count --threads 1\n"),
                    HasSubstr("train combine\n"), HasSubstr("train reduce --store ")));
  std::filesystem::remove(folder_ / "calls");
  options_.combine = false;
  EXPECT_EQ(run(plain_), counts);
  EXPECT_THAT(test::get(folder_ / "calls"), testing::Not(HasSubstr("combine")));
}

TEST_F(ScriptEngineTest, LeavesOutWhatAJobDoesNotHave) {
  EXPECT_EQ(run(plain_, false), "a1\t1\na\t1\nb1\t1\nb\t1\na2\t1\na\t1\na1\t1\na\t1\n");
}

TEST_F(ScriptEngineTest, PassesNumbersAndArguments) {
  options_.arguments = {"--queue=long", "x"};
  options_.task_threads = 5;
  EXPECT_EQ(run(R"(#!/bin/bash
mkdir "$2"
echo $VESALIUS_JOB $VESALIUS_MAP_TASKS $VESALIUS_REDUCE_TASKS $VESALIUS_TASK_THREADS "${@:3}" >"$2/part-0"
)"),
            "count 2 3 5 --queue=long x\n");
}

TEST_F(ScriptEngineTest, SaysWhyAScriptFailed) {
  EXPECT_EQ(message_of("#!/bin/bash\necho working\necho no machine is free >&2\nexit 3\n"),
            "count: " + (folder_ / "script") + " failed: no machine is free");
  EXPECT_EQ(message_of("#!/bin/bash\nkill -9 $$\n"), "count: " + (folder_ / "script") + " failed: it said nothing");
}

TEST_F(ScriptEngineTest, ExpectsRecords) {
  run(plain_);  // what an earlier run left does not count
  EXPECT_THAT(message_of("#!/bin/bash\n"),
              AllOf(StartsWith("count: " + (folder_ / "script") + " left no file part-* in " + (folder_ / kStore)),
                    HasSubstr(result_folder("count") + "-")));
}

TEST_F(ScriptEngineTest, LeavesNothingOfEarlierRuns) {
  EXPECT_THAT(message_of("#!/bin/bash\nmkdir \"$2\"\n: >\"$2/part-9\"\nexit 1\n"), HasSubstr("failed"));
  run(plain_);
  const std::unique_ptr<Store> store = open_store(folder_ / kStore);
  EXPECT_THAT(store->list(job_folder("count")), ElementsAre("lines", "out", "script.log"));
  EXPECT_THAT(store->list(result_folder("count")), ElementsAre("_SUCCESS", "part-0"));
}

TEST_F(ScriptEngineTest, EndsAScriptWhenAskedToStop) {
  options_.stopped = [&] { return std::filesystem::exists(folder_ / "begun"); };
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(run("#!/bin/bash\n: >'" + (folder_ / "begun") + "'\nsleep 60\n"), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

}  // namespace
}  // namespace vesalius

#include "cluster/process.h"

#include <chrono>
#include <thread>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using namespace std::chrono_literals;

TEST(RunCommand, ReturnsWhatAProgramLeft) {
  const CommandResult result = run_command({"sh", "-c", "echo out; echo err >&2; exit 3"}, 60s);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.out, "out\n");
  EXPECT_EQ(result.err, "err\n");
  EXPECT_TRUE(result.in_time);
}

TEST(RunCommand, EndsAProgramThatTakesTooLongWithWhatItStarted) {
  const test::TemporaryFolder folder;
  const auto begun = std::chrono::steady_clock::now();
  const CommandResult result =
      run_command({"sh", "-c", "(sleep 1; touch '" + (folder / "lives") + "') & sleep 60"}, 200ms);
  EXPECT_FALSE(result.in_time);
  EXPECT_EQ(result.err, "sh does not answer within 0.2 s");
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 30s);
  std::this_thread::sleep_for(1200ms);
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(RunCommand, SaysWhatCannotBeStarted) {
  EXPECT_EQ(test::error_of([] { run_command({"/nonexistent/program"}, 1s); }),
            "/nonexistent/program: cannot be started: No such file or directory");
}

}  // namespace
}  // namespace vesalius

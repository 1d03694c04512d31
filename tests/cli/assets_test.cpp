#include "downloads/assets.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>

#include "downloads/test_server.h"
#include "io/files/test_files.h"
#include "run_program.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::Reply;
using test::TestServer;
using testing::HasSubstr;

std::string shared_assets() {
  const char* shared = std::getenv("VESALIUS_SHARED");
  return (shared != nullptr ? shared : std::string(VESALIUS_SOURCE_DIR "/../shared")) + "/assets";
}

/// Tests with archives as the program's list describes them.
class RealAssets : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(shared_assets() + "/makehuman.tar.xz")) GTEST_SKIP() << "no archives in " << shared_assets();
  }
  std::string home() const { return folder_ / "home"; }

  test::TemporaryFolder folder_;
};

void expect_whole(const AssetPackage& package, const std::string& folder) {
  for (const AssetFile& file : package.files) {
    EXPECT_TRUE(holds(folder + "/" + package.name + "/" + file.path, file.digest)) << file.path;
  }
  EXPECT_FALSE(fs::exists(folder + "/.unfinished"));
}

TEST(Assets, AreSoughtInTheirDefaultFolderByAllThatRender) {
  const test::TemporaryFolder folder;
  const std::string made = folder / "packages";
  for (const AssetFile& file : asset_package("makehuman").files) {  // of the right sizes, without contents
    const fs::path path = fs::path(made) / "makehuman" / file.path;
    fs::create_directories(path.parent_path());
    test::put(path.string(), "");
    fs::resize_file(path, file.digest.bytes);
  }
  const std::string recipe = folder / "recipe.toml";
  test::put(recipe, "body.kind = 'makehuman'\npose.captured = 0\n");
  const std::string forest = VESALIUS_SOURCE_DIR "/data/models/capsule.forest";
  for (const std::string& command : {"synth --recipe " + recipe + " --count 1 --out " + (folder / "frames"),
                                     "evaluate --recipe " + recipe + " --count 1 -m " + forest,
                                     "train --recipe " + recipe + " --count 1 --out " + (folder / "new.forest")}) {
    const Outcome run = run_program(command + " -q", "VESALIUS_ASSETS=" + made);
    EXPECT_EQ(run.exit_code, 1) << command;
    EXPECT_THAT(run.err, HasSubstr("base.obj")) << command;
  }
}

TEST_F(RealAssets, AreFetchedFromAServer) {
  TestServer server([](const std::string& path) {
    const std::string file = shared_assets() + path;
    return fs::exists(file) ? Reply{200, test::get(file)} : Reply{404, ""};
  });
  const std::string command = "assets --dir " + home() + " --mirror " + server.address();
  const Outcome first = run_program(command);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("/makehuman: 238 files fetched, 0 were there"));
  EXPECT_THAT(first.err, HasSubstr("/mocap: 465 files fetched, 0 were there"));
  EXPECT_THAT(first.err, HasSubstr("licence: CC0"));
  for (const AssetPackage& package : asset_packages()) expect_whole(package, home());

  fs::remove(home() + "/mocap/manifest.csv");
  const Outcome again = run_program(command);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("/makehuman: 0 files fetched, 238 were there"));
  EXPECT_THAT(again.err, HasSubstr("/mocap: 1 file fetched, 464 were there"));
  EXPECT_EQ(run_program("assets -q --dir " + home() + " --mirror /").err, "") << "nothing is looked for";
  fs::remove(home() + "/mocap/manifest.csv");
  const Outcome enclosed = run_program("assets motions --dir " + home());
  EXPECT_THAT(enclosed.err, HasSubstr("/mocap: 1 file fetched, 464 were there")) << "the program holds it";
  expect_whole(asset_package("mocap"), home());
}

TEST_F(RealAssets, AreCompletedAfterAKill) {
  const AssetPackage& package = asset_package("makehuman");
  ASSERT_EQ(run_program("assets -q makehuman --dir " + (folder_ / "mirror") + " --mirror " + shared_assets()).exit_code,
            0);
  constexpr int kKilledAt = 40;
  std::atomic<pid_t> child{0};
  std::atomic<int> asked{0};
  TestServer server([&](const std::string& path) {
    const std::string file = (folder_ / "mirror") + path;
    if (++asked == kKilledAt) {
      while (child == 0) usleep(1000);
      return Reply{200, test::get(file), "", 1000, true};  // half a file, then silence
    }
    return fs::exists(file) ? Reply{200, test::get(file)} : Reply{404, ""};
  });
  const std::string address = server.address();
  child = fork();
  if (child == 0) {
    execl(VESALIUS_PROGRAM, VESALIUS_PROGRAM, "assets", "-q", "makehuman", "--dir", home().c_str(), "--mirror",
          address.c_str(), nullptr);
    _exit(127);
  }
  const std::string unfinished = home() + "/.unfinished/file";
  const auto in_the_middle = [&] {
    return asked == kKilledAt && fs::exists(unfinished) && fs::file_size(unfinished) > 0;
  };
  while (!in_the_middle()) {
    ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
    usleep(1000);
  }
  ASSERT_EQ(kill(child, SIGKILL), 0);
  waitpid(child, nullptr, 0);

  std::size_t there = 0;
  for (const AssetFile& file : package.files) {
    const std::string path = home() + "/makehuman/" + file.path;
    if (!fs::exists(path)) continue;
    EXPECT_TRUE(holds(path, file.digest)) << path;
    ++there;
  }
  EXPECT_EQ(there, kKilledAt - 2U) << "the archive, not there, was asked for first";
  const Outcome resumed = run_program("assets makehuman --dir " + home() + " --mirror " + address);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("/makehuman: 200 files fetched, 38 were there"));
  expect_whole(package, home());
}

TEST_F(RealAssets, ReportAFullDisk) {
  // A limit on the size of files (512 blocks of 1024 bytes) stands in for a full disk.
  const std::string command = "ulimit -f 512; '" VESALIUS_PROGRAM "' assets -q mocap --dir " + home() + " --mirror " +
                              shared_assets() + " 2>" + (folder_ / "err");
  const int status = std::system(("bash -c \"" + command + "\"").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(test::get(folder_ / "err"), HasSubstr("cannot be written: File too large"));
  EXPECT_EQ(fs::exists(home() + "/.unfinished"), false);
}

TEST(AssetsCommand, ListsThePackages) {
  const test::TemporaryFolder folder;
  const Outcome run = run_program("assets --list --dir " + folder.path());
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("makehuman: 238 files, 78.2 MB, not fetched\n"));
  EXPECT_THAT(run.out, HasSubstr("NSF EIA-0196217"));
  EXPECT_THAT(run.out, HasSubstr("made of 292 files, 56.7 MB, of https://raw.githubusercontent.com/zhangchi8620/"));
  EXPECT_THAT(run.out, HasSubstr("    licence: HDM05: CC BY-SA 3.0\n"));
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(AssetsCommand, ReportsErrorsInOneLine) {
  const test::TemporaryFolder folder;
  const auto refused = [&](const std::string& arguments, int exit_code, const std::string& reason) {
    const Outcome run = run_program("assets -q " + arguments);
    EXPECT_EQ(run.exit_code, exit_code) << arguments;
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  };
  const std::string into = " --dir " + (folder / "home");
  refused("moccap" + into, 2, "no assets are called \"moccap\", expected makehuman, mocap");
  refused("--mirror ftp://example.org" + into, 2, "expected an address with http://");
  refused("--mirror /no/such" + into, 2, "/no/such: no such folder");
  refused("motions --mirror " + folder.path() + into, 1, "/mocap/cmu_amc/01.asf: not found");
  refused("makehuman --mirror " + folder.path() + into, 1, "not found");
  refused("makehuman --mirror " + folder.path() + " --dir /dev/null", 1, "/dev/null: folder cannot be ");
  test::put(folder / "makehuman.tar.xz", "no archive");
  refused("makehuman --mirror " + folder.path() + into, 1, "makehuman.tar.xz: ");
  EXPECT_FALSE(fs::exists(folder / "home/makehuman"));
}

}  // namespace
}  // namespace vesalius

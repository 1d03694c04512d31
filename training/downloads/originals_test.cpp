#include <sys/resource.h>

#include <csignal>
#include <map>

#include "downloads/assets.h"
#include "downloads/test_archive.h"
#include "downloads/test_server.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::Reply;
using test::TestServer;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// An invented package whose files are made of what a server has published in two repositories.
class Originals : public testing::Test {
 protected:
  Originals() {
    package_.name = "p";
    package_.archive.path = "p.tar.xz";
    for (const auto& [path, content] : made_) package_.files.push_back({path, digest_of(content)});
    package_.enclosed["list.csv"] = made_.at("list.csv");
    package_.sources.resize(2);
    package_.sources[0].home = server_.address() + "/a/1f";
    package_.sources[1].home = server_.address() + "/b/2e";
    package_.sources[0].originals = {{"cmu/01.asf", original("sub jects/01.asf", "/a/1f/sub%20jects/01.asf")},
                                     {"cmu/01_1.amc", original("01 (1).amc", "/a/1f/01%20%281%29.amc", "01.asf")}};
    package_.sources[1].originals = {{"walk.bvh", original("x/w.bvh", "/b/2e/x/w.bvh")}};
  }

  static FileDigest digest_of(std::string_view bytes) { return {bytes.size(), sha256_of(bytes)}; }
  AssetOriginal original(const std::string& path, const std::string& asked, const std::string& skeleton = "") const {
    return {path, digest_of(published_.at(asked)), skeleton};
  }
  std::string home() const { return folder_ / "home"; }
  std::string file(const std::string& path) const { return home() + "/p/" + path; }
  InstallReport install(const InstallWatch& watch = {}, const std::string& mirror = "") const {
    WebOptions options;
    options.tries = 2;
    options.first_wait_s = 0.01;
    return install_assets(package_, home(), mirror, watch, options);
  }
  std::string error() const {
    const std::string message = test::error_of([&] { install(); });
    EXPECT_FALSE(fs::exists(home() + "/.unfinished"));
    return message;
  }
  void expect_installed() const {
    EXPECT_TRUE(has_assets(package_, home()));
    for (const auto& [path, content] : made_) EXPECT_EQ(test::get(file(path)), content) << path;
    EXPECT_FALSE(fs::exists(home() + "/.unfinished"));
  }

  test::TemporaryFolder folder_;
  std::map<std::string, std::string> published_ = {
      {"/a/1f/sub%20jects/01.asf", ":version 1.10\r\n"},
      {"/a/1f/01%20%281%29.amc", "# M\xfcller\r\n1\r\nroot -0.00004 1.23456\r\nlhand 2.5\r\n2\r\nroot 9 9\r\n"},
      {"/b/2e/x/w.bvh", "HIERARCHY\nMOTION\nFrames: 1\nFrame Time: .0083333\n0.125 1.999"}};
  const std::map<std::string, std::string> made_ = {
      {"cmu/01.asf", ":version 1.10\r\n"},
      {"cmu/01_1.amc", "#!OML:ASF 01.asf\n:FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1.235\nlhand 2.5\n"},
      {"list.csv", "file,description\n"},
      {"walk.bvh", "HIERARCHY\nMOTION\nFrames: 1\nFrame Time: 0.0333332\n0.12 2\n"}};
  TestServer server_{[this](const std::string& path) {
    const auto found = published_.find(path);
    return found == published_.end() ? Reply{404, ""} : Reply{200, found->second};
  }};
  AssetPackage package_;
};

TEST_F(Originals, BecomeTheFilesOfThePackage) {
  std::uint64_t last = 0, total = 0;
  const InstallReport report = install([&](std::uint64_t done, std::uint64_t of) {
    EXPECT_GE(done, last);
    last = done;
    total = of;
    return true;
  });
  EXPECT_EQ(report.fetched, 4U);
  expect_installed();
  EXPECT_THAT(server_.requests(), ElementsAre("/a/1f/sub%20jects/01.asf", "/a/1f/01%20%281%29.amc", "/b/2e/x/w.bvh"));
  EXPECT_EQ(total, package_.sources[0].bytes() + package_.sources[1].bytes());
  EXPECT_EQ(install().kept, 4U);
  EXPECT_EQ(server_.requests().size(), 3U) << "nothing is fetched again";
}

TEST_F(Originals, AreFetchedFromWhereItWasInterrupted) {
  const std::uint64_t first = package_.sources[0].originals.at("cmu/01.asf").digest.bytes;
  EXPECT_THAT(test::error_of([&] { install([&](std::uint64_t done, std::uint64_t) { return done <= first; }); }),
              HasSubstr("interrupted"));
  EXPECT_TRUE(fs::exists(file("cmu/01.asf")));
  EXPECT_FALSE(fs::exists(file("cmu/01_1.amc")));
  test::put(home() + "/.unfinished/originals/cmu/01_1.amc", "what a killed installation left");
  test::put(file("walk.bvh"), std::string(made_.at("walk.bvh").size(), 'x'));
  const std::size_t before = server_.requests().size();
  EXPECT_EQ(install().kept, 1U);
  EXPECT_EQ(server_.requests().size(), before + 2);
  expect_installed();
}

TEST_F(Originals, AreNamedIfTheyVanished) {
  published_.erase("/b/2e/x/w.bvh");
  EXPECT_EQ(error(), server_.address() + "/b/2e/x/w.bvh: not found, expected the original of " + file("walk.bvh") +
                         "; --mirror takes the package from elsewhere");
  EXPECT_TRUE(fs::exists(file("cmu/01_1.amc"))) << "what came before is kept";
  EXPECT_FALSE(fs::exists(file("walk.bvh")));
}

TEST_F(Originals, AreRefusedIfTheyChanged) {
  const std::string path = "/a/1f/01%20%281%29.amc";
  const std::string right = published_[path];
  published_[path].back() = ' ';
  EXPECT_THAT(error(), AllOf(HasSubstr(server_.address() + "/a/1f/01 (1).amc: "), HasSubstr("cmu/01_1.amc: SHA-256 of"),
                             HasSubstr("expected " + sha256_of(right))));
  published_[path] = right.substr(1);
  EXPECT_THAT(error(), HasSubstr("cmu/01_1.amc: 59 bytes came, expected 60"));
  EXPECT_FALSE(fs::exists(file("cmu/01_1.amc")));
}

TEST_F(Originals, AreNamedIfTheyMakeAnotherFile) {
  package_.sources[0].originals.at("cmu/01_1.amc").skeleton = "02.asf";
  EXPECT_THAT(error(), AllOf(HasSubstr("made from " + server_.address() + "/a/1f/01 (1).amc: " + file("cmu/01_1.amc")),
                             HasSubstr("expected " + sha256_of(made_.at("cmu/01_1.amc")))));
  published_["/b/2e/x/w.bvh"] = "no motion";
  package_.sources[0].originals.at("cmu/01_1.amc").skeleton = "01.asf";
  package_.sources[1].originals.at("walk.bvh").digest = digest_of("no motion");
  EXPECT_THAT(error(), HasSubstr("/x/w.bvh: walk.bvh:1: expected \"Frame Time:\""));
  EXPECT_FALSE(fs::exists(file("walk.bvh")));
}

TEST_F(Originals, AreNotAskedForIfThereIsAMirror) {
  for (const auto& [path, content] : made_) test::put((folder_ / "mirror/p/") + path, content);
  install({}, folder_ / "mirror");
  expect_installed();
  EXPECT_TRUE(server_.requests().empty());
}

TEST_F(Originals, AreNamedIfNobodyAnswers) {
  package_.sources[0].home = TestServer([](const std::string&) { return Reply{}; }).address();
  EXPECT_THAT(error(),
              AllOf(HasSubstr(package_.sources[0].home + "/sub jects/01.asf: cannot be fetched: nobody answers"),
                    HasSubstr("(2 tries)")));
}

// A limit on the size of files stands in for a full disk.
TEST_F(Originals, AreNotKeptOnAFullDisk) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 20;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = error();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, HasSubstr("cmu/01_1.amc: cannot be written: File too large"));
  EXPECT_TRUE(fs::exists(file("cmu/01.asf")));
}

}  // namespace
}  // namespace vesalius

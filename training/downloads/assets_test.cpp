#include "downloads/assets.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>

#include "downloads/test_archive.h"
#include "downloads/test_server.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::Reply;
using test::TestServer;
using testing::HasSubstr;

FileDigest digest_of(std::string_view bytes) { return {bytes.size(), sha256_of(bytes)}; }

/// An invented package, a folder that mirrors it and a folder in which to install it.
class Assets : public testing::Test {
 protected:
  Assets() {
    package_.name = "p";
    package_.archive.path = "p.tar.xz";
    std::vector<test::ArchiveEntry> entries = {{"p/extra", "not listed"}};
    for (const auto& [path, content] : contents_) {
      package_.files.push_back({path, digest_of(content)});
      entries.push_back({"p/" + path, content});
    }
    archive_ = test::get(test::write_archive(folder_ / "p.tar.xz", entries));
    package_.archive.digest = digest_of(archive_);
  }

  std::string home() const { return folder_ / "home"; }
  std::string mirror() const { return folder_ / "mirror"; }
  void mirror_archive() const { test::put(mirror() + "/p.tar.xz", archive_); }
  void mirror_files() const {
    for (const auto& [path, content] : contents_) test::put(mirror() + "/p/" + path, content);
  }
  InstallReport install(const std::string& from) const {
    WebOptions options;
    options.tries = 2;
    options.first_wait_s = 0.01;
    return install_assets(package_, home(), from, {}, options);
  }
  std::string error_from(const std::string& from) const {
    return test::error_of([&] { install(from); });
  }
  /// Expects that the whole package is there, and nothing else.
  void expect_installed() const {
    EXPECT_TRUE(has_assets(package_, home()));
    std::size_t found = 0;
    for (const auto& entry : fs::recursive_directory_iterator(home())) found += entry.is_regular_file() ? 1 : 0;
    EXPECT_EQ(found, contents_.size());
    for (const auto& [path, content] : contents_) EXPECT_EQ(test::get(home() + "/p/" + path), content) << path;
    EXPECT_FALSE(fs::exists(home() + "/.unfinished"));
  }
  TestServer::Answer answer_from_home() const {
    return [this](const std::string& path) {
      const auto found = contents_.find(path.substr(1));
      return found == contents_.end() ? Reply{404, ""} : Reply{200, found->second};
    };
  }

  test::TemporaryFolder folder_;
  std::map<std::string, std::string> contents_ = {
      {"a.txt", "one"}, {"empty", ""}, {"sub/large", std::string(300'000, 'x')}, {"sub/z", "last"}};
  AssetPackage package_;
  std::string archive_;
};

TEST_F(Assets, InstallFromAnArchive) {
  mirror_archive();
  EXPECT_FALSE(has_assets(package_, home()));
  const InstallReport first = install(mirror());
  EXPECT_EQ(first.fetched, 4U);
  EXPECT_EQ(first.kept, 0U);
  expect_installed();
  EXPECT_EQ(asset_reader(package_, home())("sub/z"), "last");
  EXPECT_THAT(test::error_of([&] { asset_reader(package_, home())("none"); }), HasSubstr("/p/none: cannot be read"));
  fs::remove_all(mirror());
  EXPECT_EQ(install(mirror()).kept, 4U) << "nothing left to fetch";
}

TEST_F(Assets, InstallFromFiles) {
  mirror_files();
  EXPECT_EQ(install(mirror()).fetched, 4U);
  expect_installed();
}

TEST_F(Assets, InstallFromAMirrorOnTheWeb) {
  mirror_files();
  TestServer server([&](const std::string& path) {
    return fs::exists(mirror() + path) ? Reply{200, test::get(mirror() + path)} : Reply{404, ""};
  });
  EXPECT_EQ(install(server.address()).fetched, 4U);
  expect_installed();
  EXPECT_EQ(server.requests().front(), "/p.tar.xz");
  EXPECT_EQ(server.requests().size(), 5U);
  fs::remove_all(home());
  mirror_archive();
  EXPECT_EQ(install(server.address()).fetched, 4U);
  expect_installed();
  EXPECT_EQ(server.requests().size(), 6U) << "the archive alone";
}

TEST_F(Assets, InstallFromHomesInTurn) {
  TestServer other([&](const std::string& path) {
    if (path == "/sub/z") return Reply{200, "lost"};  // the same size, but another digest
    return path == "/a.txt" ? Reply{200, "another release"} : answer_from_home()(path);
  });
  TestServer right(answer_from_home());
  package_.homes = {other.address(), right.address()};
  EXPECT_EQ(install("").fetched, 4U);
  expect_installed();
}

TEST_F(Assets, NameTheFileThatNoHomeHas) {
  TestServer other([&](const std::string& path) {
    return path == "/sub/z" ? Reply{200, "lost"} : answer_from_home()(path);
  });
  package_.homes = {other.address()};
  EXPECT_THAT(error_from(""),
              testing::AllOf(HasSubstr(other.address() + "/sub/z: "), HasSubstr("SHA-256 of what came")));
  EXPECT_FALSE(fs::exists(home() + "/p/sub/z"));
  EXPECT_TRUE(fs::exists(home() + "/p/sub/large")) << "what came before is kept";
  package_.homes = {other.address() + "/elsewhere", other.address() + "/nowhere"};
  EXPECT_THAT(error_from(""), HasSubstr("/elsewhere/sub/z: not found, nor at the other homes of p"));
  package_.homes.clear();
  EXPECT_THAT(error_from(""), HasSubstr("p: no public address holds sub/z, expected a mirror with p.tar.xz"));
}

TEST_F(Assets, RefuseWrongBytes) {
  test::put(mirror() + "/p.tar.xz", archive_ + "x");
  EXPECT_THAT(error_from(mirror()), HasSubstr("p.tar.xz: "));
  std::string flipped = archive_;
  flipped[100] = static_cast<char>(flipped[100] ^ 1);
  test::put(mirror() + "/p.tar.xz", flipped);
  EXPECT_THAT(error_from(mirror()), HasSubstr("SHA-256 of what came"));
  test::put(mirror() + "/p.tar.xz", archive_.substr(0, 50));
  EXPECT_THAT(error_from(mirror()), HasSubstr("50 bytes came, expected "));
  fs::remove(mirror() + "/p.tar.xz");
  mirror_files();
  test::put(mirror() + "/p/sub/z", "lost");
  EXPECT_THAT(error_from(mirror()), HasSubstr("mirror/p/sub/z: "));
  EXPECT_FALSE(fs::exists(home() + "/p/sub/z"));
  fs::remove(mirror() + "/p/sub/z");
  EXPECT_THAT(error_from(mirror()), HasSubstr("mirror/p/sub/z: not found"));
}

TEST_F(Assets, LeaveNoEmptyFolderIfNothingWasFetched) {
  EXPECT_NE(error_from(folder_ / "nowhere"), "");
  EXPECT_FALSE(fs::exists(home()));
  WebOptions options;
  options.tries = 1;
  const std::string deep = folder_ / "a/b/c/";
  EXPECT_NE(test::error_of([&] { install_assets(package_, deep, folder_ / "nowhere", {}, options); }), "");
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  fs::create_directory(home());
  EXPECT_NE(error_from(folder_ / "nowhere"), "");
  EXPECT_TRUE(fs::exists(home())) << "it was there before";
}

TEST_F(Assets, RefuseArchivesThatDoNotMatchThePackage) {
  const auto with_archive = [&](const std::vector<test::ArchiveEntry>& entries) {
    fs::remove_all(home());
    fs::create_directories(mirror());
    package_.archive.digest = digest_of(test::get(test::write_archive(mirror() + "/p.tar.xz", entries)));
    return error_from(mirror());
  };
  EXPECT_THAT(with_archive({{"p/a.txt", "one"}}), HasSubstr("p.tar.xz: holds no p/empty"));
  EXPECT_THAT(with_archive({{"p/empty", "full"}}), HasSubstr("/p/empty: more bytes came than"));
  EXPECT_THAT(with_archive({{"../escaped", "x"}}), HasSubstr("expected a path inside the archive"));
  EXPECT_THAT(with_archive({{"p/sub", "/tmp", AE_IFLNK}}), HasSubstr("is a link or device"));
  EXPECT_FALSE(fs::exists(folder_ / "escaped"));
  EXPECT_FALSE(fs::exists(home() + "/p"));
}

TEST_F(Assets, RepairDamagedFilesAndKeepTheOthers) {
  mirror_archive();
  install(mirror());
  test::put(home() + "/p/a.txt", "eno");
  fs::remove(home() + "/p/sub/z");
  test::put(home() + "/.unfinished/file", "what a killed installation left");
  const InstallReport again = install(mirror());
  EXPECT_EQ(again.fetched, 2U);
  EXPECT_EQ(again.kept, 2U);
  expect_installed();
}

TEST_F(Assets, ReportProgress) {
  mirror_files();
  std::uint64_t last = 0;
  std::uint64_t total = 0;
  install_assets(package_, home(), mirror(), [&](std::uint64_t done, std::uint64_t of) {
    EXPECT_GE(done, last);
    last = done;
    total = of;
    return true;
  });
  EXPECT_EQ(total, package_.bytes());
  EXPECT_EQ(last, total);
  fs::remove_all(home());
  const auto stop = [&](std::uint64_t done, std::uint64_t) { return done < 1000; };
  EXPECT_THAT(test::error_of([&] { install_assets(package_, home(), mirror(), stop); }), HasSubstr("interrupted"));
  EXPECT_FALSE(fs::exists(home() + "/.unfinished"));
  EXPECT_TRUE(fs::exists(home() + "/p/a.txt"));
  EXPECT_FALSE(fs::exists(home() + "/p/sub/large"));
}

TEST_F(Assets, AreInstalledByOneProcessAtATime) {
  mirror_archive();
  fs::create_directories(home());
  const int other = ::open(home().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  EXPECT_THAT(error_from(mirror()), HasSubstr("home: another process is writing there"));
  ::close(other);
  EXPECT_EQ(install(mirror()).fetched, 4U);
}

TEST_F(Assets, NameAFolderThatCannotBeWritten) {
  mirror_archive();
  test::put(home(), "a file where the folder should be");
  EXPECT_THAT(error_from(mirror()), HasSubstr("home: folder cannot be made: "));
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::remove(home());
  fs::create_directories(home());
  ASSERT_EQ(chmod(home().c_str(), 0555), 0);
  EXPECT_THAT(error_from(mirror()), HasSubstr("cannot be written: Permission denied"));
}

TEST(AssetsFolder, FollowsTheEnvironment) {
  const auto with = [](const char* own, const char* data, const char* home) {
    const auto set = [](const char* name, const char* value) {
      value == nullptr ? unsetenv(name) : setenv(name, value, 1);
    };
    set("VESALIUS_ASSETS", own);
    set("XDG_DATA_HOME", data);
    set("HOME", home);
    return assets_folder();
  };
  const std::map<const char*, std::string> names = {{"VESALIUS_ASSETS", ""}, {"XDG_DATA_HOME", ""}, {"HOME", ""}};
  std::map<const char*, std::pair<bool, std::string>> before;
  for (const auto& [name, unused] : names) {
    const char* value = std::getenv(name);
    before[name] = {value != nullptr, value == nullptr ? "" : value};
  }
  EXPECT_EQ(with("/own", "/data", "/home/me"), "/own");
  EXPECT_EQ(with("", "/data", "/home/me"), "/data/vesalius");
  EXPECT_EQ(with(nullptr, "relative", "/home/me"), "/home/me/.local/share/vesalius");
  EXPECT_EQ(with(nullptr, nullptr, "/home/me"), "/home/me/.local/share/vesalius");
  EXPECT_THAT(test::error_of([&] { with(nullptr, nullptr, nullptr); }), HasSubstr("no folder for assets"));
  for (const auto& [name, value] : before) {
    value.first ? setenv(name, value.second.c_str(), 1) : unsetenv(name);
  }
}

}  // namespace
}  // namespace vesalius

#include "cluster/webhdfs_store.h"

#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "io/files/test_files.h"

#if __has_include(<boost/beast/http.hpp>)
#include "cluster/test_hdfs.h"
#define VESALIUS_HAS_TEST_HDFS
#endif

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

WebOptions hasty() {
  WebOptions options = webhdfs_options();
  options.connect_s = 1;
  options.stall_s = 1;
  options.tries = 3;
  options.first_wait_s = 0.01;
  return options;
}

TEST(WebHdfsAddress, IsChecked) {
  for (const char* place : {"webhdfs://", "webhdfs://host/x", "webhdfs://host:9870", "webhdfs://host:0/x",
                            "webhdfs://host:70000/x", "webhdfs://host:98x/x", "webhdfs://:9870/x", "webhdfs://u@h:1/x",
                            "webhdfs://host:9870/a/../b", "webhdfs://host:9870/a?b", "webhdfs://host:9870//a"}) {
    EXPECT_THROW(open_store(place), UsageError) << place;
  }
  EXPECT_EQ(open_store("webhdfs://host:9870/user/x//")->place(), "webhdfs://host:9870/user/x");
  EXPECT_EQ(open_store("webhdfs://host:9870/")->place(), "webhdfs://host:9870/");
  EXPECT_NE(dynamic_cast<WebHdfsStore*>(open_store("webhdfs://host:9870/x").get()), nullptr);
}

TEST(WebHdfsAddress, NobodyAnswersThere) {
  WebHdfsStore store("webhdfs://127.0.0.1:1/user/x", hasty());
  const std::string expected = "webhdfs://127.0.0.1:1/user/x/sets/3: nobody answers: Connection refused";
  EXPECT_EQ(test::error_of([&] { store.read("sets/3"); }), expected);
  EXPECT_EQ(test::error_of([&] { store.write("sets/3", "bytes"); }), expected);
  EXPECT_EQ(test::error_of([&] { store.list("sets/3"); }), expected);
}

TEST(WebHdfsAddress, NamesAreChecked) {
  WebHdfsStore store("webhdfs://127.0.0.1:1/user/x", hasty());
  for (const char* name : {"", "/x", "../x", "x/../y", "a b", "x.tmp-1"}) {
    EXPECT_THROW(store.read(name), UsageError) << name;
    EXPECT_THROW(store.exists(name), UsageError) << name;
    EXPECT_THROW(store.write(name, "bytes"), UsageError) << name;
    EXPECT_THROW(store.remove(name), UsageError) << name;
  }
  EXPECT_THROW(store.list("../x"), UsageError);
}

#ifdef VESALIUS_HAS_TEST_HDFS

std::string bytes_of(std::size_t count, std::uint64_t seed) {
  Random rng(seed);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(rng.next() & 0xFFU);
  return bytes;
}

const test::HdfsReply kOverloaded{503, "try again", ""};
const test::HdfsReply kQuota = test::remote_exception(
    403, "DSQuotaExceededException", "The DiskSpace quota of /user/x is exceeded: quota = 1 B\n\tat a.place(Java:12)");

/// A store below /user/x of a cluster of its own.
class WebHdfs : public testing::Test {
 protected:
  std::string message(const std::function<void()>& f) const { return test::error_of(f); }

  test::TestHdfs hdfs;
  const std::string address = hdfs.address() + "/user/x";
  WebHdfsStore store{address, hasty()};
};

TEST_F(WebHdfs, ReadsWhatWasWritten) {
  const std::string bytes = bytes_of(5000000, 1);
  store.write("sets/3", bytes);
  EXPECT_TRUE(store.read("sets/3") == bytes);
  EXPECT_EQ(hdfs.files.size(), 1U);
  EXPECT_TRUE(hdfs.files.at("/user/x/sets/3") == bytes);
  EXPECT_TRUE(store.exists("sets/3"));
  EXPECT_TRUE(store.exists("sets"));
  EXPECT_FALSE(store.exists("sets/4"));
  store.write("empty", "");
  EXPECT_EQ(store.read("empty"), "");
}

TEST_F(WebHdfs, OverwritesAFile) {
  store.write("f", "first");
  store.write("f", "the second");
  EXPECT_EQ(store.read("f"), "the second");
  EXPECT_EQ(hdfs.files.size(), 1U);
  hdfs.knows_rename_options = false;
  store.write("g", "first");
  EXPECT_THAT(message([&] { store.write("g", "the second"); }), HasSubstr("/g: WebHDFS does not rename over a file"));
  EXPECT_EQ(store.read("g"), "first");
  EXPECT_EQ(hdfs.files.size(), 2U);
}

TEST_F(WebHdfs, WorksInTheRoot) {
  WebHdfsStore root(hdfs.address() + "/", hasty());
  root.write("f", "bytes");
  EXPECT_EQ(hdfs.files.count("/f"), 1U);
  EXPECT_EQ(root.read("f"), "bytes");
  EXPECT_THAT(root.list(""), ElementsAre("f"));
}

TEST_F(WebHdfs, ListsAFolderInOrder) {
  EXPECT_THAT(store.list(""), IsEmpty());
  for (const char* name : {"x/10", "x/9", "x/below/1", "y"}) store.write(name, "bytes");
  hdfs.files["/user/x/x/.9.tmp-0123"] = "half";
  EXPECT_THAT(store.list("x"), ElementsAre("10", "9", "below"));
  EXPECT_THAT(store.list(""), ElementsAre("x", "y"));
  EXPECT_THAT(store.list("none"), IsEmpty());
  EXPECT_THAT(store.list("y"), IsEmpty());
}

TEST_F(WebHdfs, RemovesFilesAndFolders) {
  for (const char* name : {"x/1", "x/below/2", "y"}) store.write(name, "bytes");
  store.remove("x/1");
  EXPECT_THAT(store.list("x"), ElementsAre("below"));
  store.remove("x");
  store.remove("none");
  EXPECT_THAT(store.list(""), ElementsAre("y"));
}

TEST_F(WebHdfs, SaysWhatIsMissing) {
  store.write("folder/f", "bytes");
  EXPECT_EQ(message([&] { store.read("none"); }),
            address + "/none: FileNotFoundException: File does not exist: /user/x/none");
  EXPECT_EQ(message([&] { store.read("folder"); }), address + "/folder: a folder, expected a file");
}

TEST_F(WebHdfs, TriesAgain) {
  hdfs.next = {kOverloaded, kOverloaded};
  store.write("f", "bytes");
  for (const char* exception : {"StandbyException", "RetriableException", "SafeModeException"}) {
    hdfs.next = {test::remote_exception(403, exception, "wait")};
    EXPECT_EQ(store.read("f"), "bytes");
    EXPECT_THAT(hdfs.next, IsEmpty());
  }
  hdfs.next_writes = {kOverloaded};
  store.write("f", "other bytes");
  EXPECT_EQ(store.read("f"), "other bytes");
  EXPECT_EQ(hdfs.files.size(), 1U);
}

TEST_F(WebHdfs, GivesUpAfterSomeTries) {
  hdfs.next = {kOverloaded, kOverloaded, kOverloaded};
  EXPECT_EQ(message([&] { store.exists("f"); }), address + "/f: HTTP status 503, expected an answer of WebHDFS");
  EXPECT_EQ(hdfs.requests.size(), 3U);
}

TEST_F(WebHdfs, LeavesNoFileThatWasRefused) {
  store.write("f", "before");
  hdfs.requests.clear();
  for (const std::size_t size : {10U, 5000000U}) {
    hdfs.next_writes = {kQuota};
    EXPECT_EQ(message([&] { store.write("f", bytes_of(size, 2)); }),
              address + "/f: DSQuotaExceededException: The DiskSpace quota of /user/x is exceeded: quota = 1 B");
    EXPECT_EQ(store.read("f"), "before");
    EXPECT_EQ(hdfs.files.size(), 1U);
  }
  const std::vector<std::string> once = {"CREATE", "CREATE+", "DELETE", "GETFILESTATUS", "OPEN", "OPEN+"};
  EXPECT_THAT(std::vector<std::string>(hdfs.requests.begin(), hdfs.requests.begin() + 6),
              testing::ElementsAreArray(once));
  hdfs.next = {test::remote_exception(403, "AccessControlException", "Permission denied: user=x")};
  EXPECT_EQ(message([&] { store.write("g", "bytes"); }),
            address + "/g: AccessControlException: Permission denied: user=x");
}

TEST_F(WebHdfs, RefusesAShortAnswer) {
  store.write("f", bytes_of(1000, 3));
  hdfs.next_cuts = {10};
  EXPECT_EQ(store.read("f"), bytes_of(1000, 3));
  hdfs.next_cuts = {10, 0, 999};
  EXPECT_THAT(message([&] { store.read("f"); }), testing::MatchesRegex(".*/f: data node 127.*: broken off: .*"));
  hdfs.next_cuts = {10, 0, 999};
  hdfs.says_cut_length = true;
  EXPECT_EQ(message([&] { store.read("f"); }), address + "/f: 999 bytes came, expected 1000");
}

TEST_F(WebHdfs, AcceptsARenameWhoseAnswerWasLost) {
  hdfs.loses_rename_answer = true;
  store.write("f", "bytes");
  EXPECT_EQ(store.read("f"), "bytes");
  EXPECT_EQ(hdfs.files.size(), 1U);
}

TEST_F(WebHdfs, RefusesOtherServers) {
  hdfs.next = {{404, "<html>not here</html>", ""}};
  EXPECT_THAT(message([&] { store.list(""); }),
              StartsWith(address + ": HTTP status 404, expected an answer of WebHDFS"));
  hdfs.next = {{200, "<html>welcome</html>", ""}};
  EXPECT_EQ(message([&] { store.list("x"); }), address + "/x: the server's answer is not one of WebHDFS");
  hdfs.next = {{200, "{}", ""}};
  EXPECT_THAT(message([&] { store.exists("x"); }), HasSubstr("not one of WebHDFS"));
  hdfs.next = {{401, "", ""}};
  EXPECT_THAT(message([&] { store.exists("x"); }), HasSubstr("Kerberos"));
}

TEST_F(WebHdfs, ServesSeveralThreads) {
  constexpr int kThreads = 4;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([this, i] {
      const std::string bytes = bytes_of(200000, static_cast<std::uint64_t>(i));
      store.write("f" + std::to_string(i), bytes);
      EXPECT_TRUE(store.read("f" + std::to_string(i)) == bytes);
      store.write("same", bytes);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(store.list(""), ElementsAre("f0", "f1", "f2", "f3", "same"));
}

TEST_F(WebHdfs, GivesTheUsersName) {
  const char* before = std::getenv("HADOOP_USER_NAME");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("HADOOP_USER_NAME", "some&body", 1);
  WebHdfsStore(address, hasty()).list("");
  EXPECT_EQ(hdfs.user, "some&body");
  before != nullptr ? ::setenv("HADOOP_USER_NAME", kept.c_str(), 1) : ::unsetenv("HADOOP_USER_NAME");
}

#else

TEST(WebHdfs, IsTested) { GTEST_SKIP() << "needs Boost (libboost-dev)"; }

#endif

}  // namespace
}  // namespace vesalius

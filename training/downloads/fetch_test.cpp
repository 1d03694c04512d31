#include "downloads/fetch.h"

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <optional>

#include "downloads/test_server.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::Reply;
using test::TestServer;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kText = "some bytes that are fetched";

FileDigest digest_of(std::string_view bytes) { return {bytes.size(), sha256_of(bytes)}; }

WebOptions hasty() {
  WebOptions options;
  options.tries = 3;
  options.first_wait_s = 0.01;
  options.stall_s = 1;
  return options;
}

/// Fetches a file from a place and returns its bytes, or nullopt if there is no such file.
std::optional<std::string> fetched(const std::string& place, const std::string& path = "f",
                                   const WebOptions& options = hasty(), const std::string& expected = kText) {
  const test::TemporaryFolder folder;
  Origin origin(place, options);
  VerifiedFile file(folder / "out", folder / "part", digest_of(expected));
  if (!origin.get(path, file)) return std::nullopt;
  file.commit();
  return test::get(folder / "out");
}

TEST(Fetch, ReadsFromFolders) {
  const test::TemporaryFolder folder;
  test::put(folder / "sub dir/f %", kText);
  EXPECT_EQ(fetched(folder.path(), "sub dir/f %"), kText);
  EXPECT_EQ(fetched(folder.path() + "//", "sub dir/f %"), kText);
  EXPECT_EQ(fetched("file://" + (folder / "sub%20dir"), "f %"), kText);
  EXPECT_EQ(fetched(folder.path(), "none"), std::nullopt);
  EXPECT_EQ(fetched(folder.path(), "sub dir/f %/below"), std::nullopt);
  EXPECT_THAT(test::error_of([&] { fetched(folder.path(), "sub dir"); }), HasSubstr("not a regular file"));
}

TEST(Fetch, RefusesOtherPlaces) {
  EXPECT_THROW(Origin("ftp://example.org"), UsageError);
  EXPECT_THAT(test::error_of([] { Origin("ftp://example.org"); }), HasSubstr("expected an address with http://"));
  const std::string message = test::error_of([] { Origin("http://user:secret@ho st/"); });
  EXPECT_THAT(message, StartsWith("not an address: "));
  EXPECT_THAT(message, testing::Not(HasSubstr("secret")));
  EXPECT_THAT(test::error_of([] { Origin("/no/such/folder"); }), HasSubstr("no such folder"));
  EXPECT_THAT(test::error_of([] { Origin("file:///no/such/folder"); }), HasSubstr("no such folder"));
}

TEST(Fetch, ReadsFromServers) {
  TestServer server([](const std::string& path) {
    return path.ends_with("none") ? Reply{404, "not here"} : Reply{200, kText};
  });
  EXPECT_EQ(fetched(server.address() + "/base/", "sub dir/f%"), kText);
  EXPECT_EQ(server.requests().back(), "/base/sub%20dir/f%25");
  EXPECT_EQ(fetched(server.address(), "none"), std::nullopt);
}

TEST(Fetch, FollowsRedirectionsOnlyToTheWeb) {
  const test::TemporaryFolder folder;
  test::put(folder / "f", kText);
  TestServer server([&](const std::string& path) {
    if (path == "/moved/f") return Reply{302, "", "Location: /f\r\n"};
    if (path == "/file/f") return Reply{302, "", "Location: file://" + (folder / "f") + "\r\n"};
    if (path.starts_with("/round")) return Reply{302, "", "Location: " + path + "x\r\n"};
    return Reply{200, kText};
  });
  EXPECT_EQ(fetched(server.address() + "/moved"), kText);
  EXPECT_THAT(test::error_of([&] { fetched(server.address() + "/file"); }), HasSubstr("Protocol \"file\""));
  EXPECT_THAT(test::error_of([&] { fetched(server.address() + "/round"); }), HasSubstr("redirects"));
}

TEST(Fetch, RetriesAfterPassingErrors) {
  TestServer busy([asked = 0](const std::string&) mutable {
    return ++asked < 3 ? Reply{503, "later"} : Reply{200, kText};
  });
  EXPECT_EQ(fetched(busy.address()), kText);
  EXPECT_EQ(busy.requests().size(), 3U);
  TestServer cut([asked = 0](const std::string&) mutable {
    return Reply{200, kText, "", ++asked < 3 ? 5 : std::string::npos};
  });
  EXPECT_EQ(fetched(cut.address()), kText) << "the first piece is not counted twice";
  TestServer always_cut([](const std::string&) { return Reply{200, kText, "", 5}; });
  EXPECT_THAT(test::error_of([&] { fetched(always_cut.address()); }), HasSubstr("(3 tries)"));
  EXPECT_EQ(always_cut.requests().size(), 3U);
  TestServer shut([](const std::string&) { return Reply{403, "no"}; });
  EXPECT_THAT(test::error_of([&] { fetched(shut.address()); }), HasSubstr("403"));
  EXPECT_EQ(shut.requests().size(), 1U);
}

TEST(Fetch, EndsStalledTransfers) {
  TestServer server([&](const std::string&) { return Reply{200, kText, "", 5, true}; });
  WebOptions options = hasty();
  options.tries = 1;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(test::error_of([&] { fetched(server.address(), "f", options); }),
              StartsWith(server.address() + "/f: cannot be fetched: "));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(Fetch, StopsWhenAsked) {
  TestServer server([&](const std::string&) { return Reply{200, kText, "", 5, true}; });
  WebOptions options = hasty();
  options.stall_s = 600;
  options.go_on = [](std::uint64_t bytes) { return bytes < 5; };
  EXPECT_THAT(test::error_of([&] { fetched(server.address(), "f", options); }), HasSubstr("/f: interrupted"));

  TestServer busy([&](const std::string&) { return Reply{503, "later"}; });
  int asked = 0;
  options.first_wait_s = 600;
  options.go_on = [&](std::uint64_t) { return ++asked < 10; };
  EXPECT_THAT(test::error_of([&] { fetched(busy.address(), "f", options); }), HasSubstr("/f: interrupted"));
}

TEST(Fetch, StopsAfterMoreBytesThanExpected) {
  const std::string endless(1 << 22, 'x');
  TestServer server([&](const std::string&) { return Reply{200, endless}; });
  EXPECT_THROW(fetched(server.address()), WrongBytes);
  const test::TemporaryFolder folder;
  test::put(folder / "f", endless);
  EXPECT_THROW(fetched(folder.path()), WrongBytes);
}

TEST(Fetch, ShowsNoPassword) {
  TestServer server([&](const std::string&) { return Reply{500, ""}; });
  std::string address = server.address();
  address.insert(address.find("//") + 2, "user:secret@");
  const std::string message = test::error_of([&] { fetched(address); });
  EXPECT_THAT(message, StartsWith(server.address() + "/f: "));
  EXPECT_THAT(message, testing::Not(HasSubstr("secret")));
}

TEST(Fetch, NamesAServerThatDoesNotAnswer) {
  std::string address;
  {
    address = TestServer([](const std::string&) { return Reply{}; }).address();
  }
  EXPECT_THAT(test::error_of([&] { fetched(address); }), HasSubstr("cannot be fetched"));
}

TEST(VerifiedFile, AppearsOnlyWhenComplete) {
  const test::TemporaryFolder folder;
  VerifiedFile file(folder / "a/b/final", folder / "part", digest_of("hello world"));
  file.write("wrong");
  file.restart();
  file.write("hello ");
  file.write("world");
  EXPECT_FALSE(fs::exists(folder / "a"));
  file.commit();
  EXPECT_EQ(test::get(folder / "a/b/final"), "hello world");
  EXPECT_FALSE(fs::exists(folder / "part"));
  EXPECT_TRUE(holds(folder / "a/b/final", digest_of("hello world")));
  EXPECT_FALSE(holds(folder / "a/b/final", digest_of("hello World")));
  EXPECT_FALSE(holds(folder / "a/b/final", digest_of("hello")));
  EXPECT_FALSE(holds(folder / "a/b", digest_of("")));
  EXPECT_FALSE(holds(folder / "none", digest_of("")));
}

TEST(VerifiedFile, RefusesOtherBytesAndKeepsTheOldFile) {
  const test::TemporaryFolder folder;
  const std::string path = test::put(folder / "f", "old");
  const auto write = [&](std::string_view bytes) {
    VerifiedFile file(path, folder / "part", digest_of("abc"));
    file.write(bytes);
    file.commit();
  };
  EXPECT_THAT(test::error_of([&] { write("abcd"); }), HasSubstr("/f: more bytes came than the 3 expected"));
  EXPECT_THAT(test::error_of([&] { write("ab"); }), HasSubstr("/f: 2 bytes came, expected 3"));
  EXPECT_THAT(test::error_of([&] { write("abd"); }), HasSubstr("expected ba7816bf"));
  EXPECT_THROW(write("abd"), WrongBytes);
  EXPECT_EQ(test::get(path), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  write("abc");
  EXPECT_EQ(test::get(path), "abc");
}

TEST(VerifiedFile, NamesTheReasonIfItCannotBeWritten) {
  const test::TemporaryFolder folder;
  test::put(folder / "file", "");
  EXPECT_THAT(test::error_of([&] { VerifiedFile(folder / "f", folder / "none/part", digest_of("abc")); }),
              HasSubstr("/f: cannot be written: No such file"));
  const auto below_a_file = [&] {
    VerifiedFile file(folder / "file/f", folder / "part", digest_of(""));
    file.commit();
  };
  EXPECT_THAT(test::error_of(below_a_file), HasSubstr("file/f: cannot be written: "));
  EXPECT_EQ(folder.file_count(), 1U);
}

// A limit on the size of files stands in for a full disk, since both make a write fail with a reason.
TEST(VerifiedFile, ReportsAFullDisk) {
  const test::TemporaryFolder folder;
  const std::string bytes(1 << 16, 'x');
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  std::string message;
  {
    VerifiedFile file(folder / "f", folder / "part", digest_of(bytes));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    message = test::error_of([&] { file.write(bytes); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, HasSubstr("/f: cannot be written: File too large"));
  EXPECT_EQ(folder.file_count(), 0U);
}

}  // namespace

}  // namespace vesalius

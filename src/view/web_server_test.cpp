#include "view/web_server.h"

#include <gmock/gmock.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <mutex>
#include <thread>

#include "vesalius/error.h"
#include "view/test_page.h"

namespace vesalius {
namespace {

using namespace std::chrono_literals;
using test::Page;
using test::request;
using testing::HasSubstr;

/// A server with a page, a secret file and clients that say hello.
class Server {
 public:
  explicit Server(const std::string& token = "", WebServerOptions options = {})
      : server(with_access(std::move(options), token),
               {[this](const std::string& path) -> std::optional<WebResponse> {
                  if (path == "/") return WebResponse{"text/html", "page", false, {}};
                  if (path == "/view.js") return WebResponse{"text/javascript", "script", false, {}};
                  if (path == "/options.toml") return WebResponse{"application/toml", "a = 1", false, "options.toml"};
                  if (path == "/slow") return WebResponse{"", "", false, {}, 200, [this] { return make_slowly(); }};
                  return std::nullopt;
                },
                [](const std::string& path) { return path == "/view.js"; },
                [] { return std::vector<std::string>{"hello"}; },
                [this](const std::string& text, const auto& wish) -> std::optional<std::string> {
                  const std::scoped_lock lock(mutex);
                  received.push_back(text);
                  wish({text == "details"});
                  if (text == "ask") return "answer";
                  return std::nullopt;
                },
                [this](std::chrono::duration<double>) { ++shown; }}) {
    server.start();
  }

  std::uint16_t port() const { return server.port(); }
  void frame(const std::string& bytes, const std::string& with_details = "") {
    server.publish_frame(bytes, with_details, std::chrono::steady_clock::now());
  }
  /// Waits until `holds`, which must come.
  void until(const std::function<bool()>& holds) const {
    for (int i = 0; i < 10000 && !holds(); ++i) std::this_thread::sleep_for(1ms);
    ASSERT_TRUE(holds());
  }

  /// Takes until it is allowed to end.
  WebResponse make_slowly() {
    ++making;
    while (!may_end) std::this_thread::sleep_for(1ms);
    if (fails) throw std::runtime_error("no memory");
    return {"text/plain", std::string(1 << 20, 'x'), false, "slow.txt", 200, {}};
  }

  std::mutex mutex;
  std::vector<std::string> received;
  std::atomic<int> making = 0;
  std::atomic<bool> may_end = false, fails = false;
  std::atomic<int> shown = 0;
  WebServer server;

 private:
  static WebServerOptions with_access(WebServerOptions options, const std::string& token) {
    options.port = 0;
    options.access = web_access("127.0.0.1", token);
    return options;
  }
};

// Labels: threads
TEST(WebServer, GoesOnWhileAnAnswerIsMade) {
  Server server;
  // One is made and one waits, whichever come first; who else asks is sent away.
  std::vector<test::Got> got(4);
  std::atomic<int> sent_away = 0;
  std::vector<std::jthread> asking;
  for (test::Got& one : got) {
    asking.emplace_back([&] {
      one = request(server.port(), "/slow");
      sent_away += one.status == 503 ? 1 : 0;
    });
  }
  server.until([&] { return server.making == 1; });
  EXPECT_EQ(request(server.port(), "/").status, 200);
  EXPECT_EQ(request(server.port(), "/slow", "evil.example").status, 403);
  server.until([&] { return sent_away == 2; });
  server.may_end = true;
  asking.clear();
  int given = 0;
  for (const test::Got& one : got) {
    if (one.status == 503) continue;
    ++given;
    EXPECT_EQ(one.status, 200);
    EXPECT_EQ(one.body.size(), 1U << 20U);
  }
  EXPECT_EQ(given, 2);
  server.fails = true;
  EXPECT_EQ(request(server.port(), "/slow").status, 500);
  EXPECT_EQ(request(server.port(), "/slow").body, "vesalius: no memory\n");
}

// Labels: threads
TEST(WebServer, EndsWhileAnswersAreMade) {
  std::optional<Server> server(std::in_place);
  const std::uint16_t port = server->port();
  std::vector<std::jthread> asking;
  for (int i = 0; i < 2; ++i) {
    asking.emplace_back([port] {
      try {
        request(port, "/slow");
      } catch (const std::exception&) {  // who comes too late finds nobody
      }
    });
  }
  server->until([&] { return server->making == 1; });
  server->may_end = true;
  server.reset();
}

TEST(WebServer, GivesFilesAndNothingElse) {
  Server server;
  const auto page = request(server.port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "page");
  EXPECT_THAT(std::string(page.response["Content-Security-Policy"]), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.response["X-Content-Type-Options"], "nosniff");
  EXPECT_THAT(std::string(request(server.port(), "/options.toml").response["Content-Disposition"]),
              HasSubstr("options.toml"));
  for (const char* path : {"/etc/passwd", "/../etc/passwd", "//etc/passwd", "/%2e%2e/etc/passwd", "/view.js/.."}) {
    EXPECT_EQ(request(server.port(), path).status, 404) << path;
  }
  EXPECT_EQ(request(server.port(), "/", "127.0.0.1", "", test::http::verb::post).status, 405);
  EXPECT_EQ(request(server.port(), "/", "127.0.0.1", "", test::http::verb::delete_).status, 405);
  EXPECT_EQ(request(server.port(), "/stream").status, 426) << "not as a WebSocket";
}

TEST(WebServer, RefusesForeignHostsAndPages) {
  Server server;
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  const std::string host = "127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(request(server.port(), "/", "evil.example").status, 403);
  EXPECT_EQ(request(server.port(), "/", host, "http://evil.example").status, 403);
  EXPECT_EQ(Page(server.port(), "/stream", "evil.example").status, 403);
  EXPECT_EQ(Page(server.port(), "/stream", host, "http://evil.example").status, 403);
  EXPECT_EQ(Page(server.port(), "/stream", host, "null").status, 403);
  EXPECT_EQ(Page(server.port(), "/stream", host, own).status, 101);
}

TEST(WebServer, WantsTheTokenForAllButTheScripts) {
  Server server("secret");
  EXPECT_EQ(request(server.port(), "/").status, 403);
  EXPECT_EQ(request(server.port(), "/?token=wrong").status, 403);
  EXPECT_EQ(request(server.port(), "/?token=secret").status, 200);
  EXPECT_EQ(request(server.port(), "/options.toml?a=1&token=secret").status, 200);
  EXPECT_EQ(request(server.port(), "/view.js").status, 200);
  EXPECT_EQ(Page(server.port(), "/stream").status, 403);
  EXPECT_EQ(Page(server.port(), "/stream?token=secret").status, 101);
}

TEST(WebServer, TalksWithItsPages) {
  Server server;
  Page page(server.port());
  EXPECT_EQ(page.receive()->bytes, "hello");
  page.send("ask");
  EXPECT_EQ(page.receive()->bytes, "answer");
  EXPECT_EQ(server.server.clients(), 1);
  server.server.publish_text("state", "one");
  EXPECT_EQ(page.receive()->bytes, "one");
  const std::scoped_lock lock(server.mutex);
  EXPECT_THAT(server.received, testing::ElementsAre("ask"));
}

TEST(WebServer, SendsTheNewestFrameToWhoAsks) {
  Server server;
  Page page(server.port());
  page.receive();
  server.frame("1");
  EXPECT_EQ(page.receive()->bytes, "1");
  server.frame("2");
  EXPECT_EQ(page.receive()->bytes, "2");
  for (const char* frame : {"3", "4", "5"}) server.frame(frame);
  server.server.publish_text("state", "all offered");
  EXPECT_EQ(page.receive()->bytes, "all offered") << "two are on their way at most";
  page.send("next");
  const auto newest = page.receive();
  EXPECT_EQ(newest->bytes, "5");
  EXPECT_TRUE(newest->binary);
  page.send("next");
  page.send("next");
  server.until([&] { return server.shown == 3; });
  server.frame("6");
  EXPECT_EQ(page.receive()->bytes, "6");
}

TEST(WebServer, SendsDetailsToThoseWhoWishForThem) {
  Server server;
  Page plain(server.port());
  {
    Page curious(server.port());
    curious.receive();
    curious.send("details");
    server.until([&] { return server.server.clients_for_details() == 1; });
    server.frame("frame", "frame and more");
    EXPECT_EQ(curious.receive()->bytes, "frame and more");
    EXPECT_EQ(plain.receive_frame()->bytes, "frame");
  }
  server.until([&] { return server.server.clients_for_details() == 0; });
}

TEST(WebServer, KeepsEveryTextWithoutAKind) {
  Server server;
  Page page(server.port());
  for (const char* text : {"one", "two", "three"}) server.server.publish_text("", text);
  EXPECT_EQ(page.receive_text("one")->bytes, "one");
  EXPECT_EQ(page.receive()->bytes, "two");
  EXPECT_EQ(page.receive()->bytes, "three");
}

TEST(WebServer, IsNotHeldUpByAStalledPage) {
  Server server;
  Page stalled(server.port());
  Page page(server.port());
  page.receive();
  const std::string large(4 << 20, 'x');  // more than sockets keep
  for (int i = 0; i < 20; ++i) {
    server.frame(large);
    ASSERT_EQ(page.receive()->bytes.size(), large.size()) << i;
    page.send("next");
  }
}

TEST(WebServer, HangsUpOnTooLongAndTooManyMessages) {
  Server server;
  Page loud(server.port());
  loud.send(std::string(100000, 'x'));
  EXPECT_TRUE(loud.is_closed());
  WebServerOptions options;
  options.max_rate = 20;
  Server strict("", options);
  Page fast(strict.port());
  for (int i = 0; i < 50; ++i) fast.send("next");
  EXPECT_TRUE(fast.is_closed());
  strict.until([&] { return strict.server.clients() == 0; });
}

TEST(WebServer, TakesOnlySoManyPages) {
  WebServerOptions options;
  options.max_clients = 2;
  Server server("", options);
  auto first = std::make_unique<Page>(server.port());
  const Page second(server.port());
  EXPECT_EQ(Page(server.port()).status, 503);
  EXPECT_EQ(request(server.port(), "/").status, 200);
  first.reset();
  server.until([&] { return server.server.clients() == 1; });
  EXPECT_EQ(Page(server.port()).status, 101) << "one has left";
}

TEST(WebServer, ServesOthersWhileManyRequestsAreHalfSent) {
  WebServerOptions options;
  options.max_connections = 8;
  Server server("", options);
  Page page(server.port());
  page.receive();
  boost::asio::io_context io;
  std::vector<boost::asio::ip::tcp::socket> held;
  for (int i = 0; i < 40; ++i) {
    held.emplace_back(io).connect({boost::asio::ip::make_address("127.0.0.1"), server.port()});
    boost::asio::write(held.back(), boost::asio::buffer(std::string("GET / HTTP/1.1\r\n")));
    if (i % 10 != 9) continue;
    EXPECT_EQ(request(server.port(), "/").status, 200) << i;
  }
  server.server.publish_text("state", "still here");
  EXPECT_EQ(page.receive()->bytes, "still here") << "pages that are open stay";
}

TEST(WebServer, RefusesHugeRequests) {
  Server server;
  EXPECT_NE(request(server.port(), "/" + std::string(20000, 'x')).status, 200);
  EXPECT_EQ(request(server.port(), "/").status, 200) << "and lives on";
}

TEST(WebServer, SaysWhyItCannotListen) {
  const Server server;
  const auto message = [](const std::string& host, std::uint16_t port) {
    WebServerOptions options;
    options.host = host;
    options.port = port;
    try {
      const WebServer second(options, {});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("it listens");
  };
  EXPECT_THAT(message("127.0.0.1", server.port()), HasSubstr("another program has this port"));
  EXPECT_THAT(message("192.0.2.1", 0), HasSubstr("192.0.2.1:0: "));
  EXPECT_THAT(message("no such host", 0), HasSubstr("expected an address of this machine"));
}

}  // namespace
}  // namespace vesalius

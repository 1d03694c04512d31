#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

// A web server on the loopback interface for tests. It misbehaves as a test demands.
namespace vesalius::test {

struct Reply {
  int status = 200;
  std::string body;
  std::string headers = {};             ///< additional headers, each ending with "\r\n"
  std::size_t cut = std::string::npos;  ///< hangs up after this many bytes of the body
  bool stall = false;                   ///< sends nothing after the body, but keeps the connection open
};

class TestServer {
 public:
  /// Answers requests one after the other on a thread of its own.
  using Answer = std::function<Reply(const std::string& path)>;

  explicit TestServer(Answer answer) : answer_(std::move(answer)), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    if (listener_ < 0 || ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        ::listen(listener_, 16) != 0 || ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("no server on loopback");
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~TestServer() {
    stop_ = true;
    thread_.join();
    ::close(listener_);
  }
  TestServer(const TestServer&) = delete;
  TestServer& operator=(const TestServer&) = delete;

  /// Returns the paths requested so far.
  std::vector<std::string> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  std::string address() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  static constexpr int kPoll_ms = 20;

  /// Waits until there is something to read or accept and returns true; returns false when the server ends.
  bool readable(int fd) const {
    while (!stop_) {
      pollfd waiting{fd, POLLIN, 0};
      if (::poll(&waiting, 1, kPoll_ms) > 0) return true;
    }
    return false;
  }
  void serve() {
    while (readable(listener_)) {
      const int connection = ::accept(listener_, nullptr, nullptr);
      if (connection < 0) continue;
      answer(connection);
      ::close(connection);
    }
  }
  void answer(int connection) {
    std::string request;
    while (request.find("\r\n\r\n") == std::string::npos && readable(connection)) {
      char piece[4096];
      const ssize_t n = ::recv(connection, piece, sizeof(piece), 0);
      if (n <= 0) return;
      request.append(piece, static_cast<std::size_t>(n));
    }
    const std::size_t begin = request.find(' ') + 1;
    const std::string path = request.substr(begin, request.find(' ', begin) - begin);
    {
      const std::lock_guard lock(mutex_);
      requests_.push_back(path);
    }
    const Reply reply = answer_(path);
    send(connection, "HTTP/1.1 " + std::to_string(reply.status) + " As the test says\r\nConnection: close\r\n" +
                         reply.headers + "Content-Length: " + std::to_string(reply.body.size()) + "\r\n\r\n");
    send(connection, std::string_view(reply.body).substr(0, reply.cut));
    if (reply.stall && readable(connection)) return;  // until the other side hangs up
  }
  static void send(int connection, std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }

  Answer answer_;
  int listener_;
  int port_ = 0;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::vector<std::string> requests_;
  std::thread thread_;
};

}  // namespace vesalius::test

#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <string>

namespace vesalius::test {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

/// What an HTTP request got.
struct Got {
  int status = 0;
  std::string body;
  http::response<http::string_body> response;
};

/// Asks by HTTP; `status` is 0 if the server hung up.
inline Got request(std::uint16_t port, const std::string& target, const std::string& host = "127.0.0.1",
                   const std::string& origin = "", http::verb method = http::verb::get, bool upgrade = false) {
  net::io_context io;
  beast::tcp_stream stream(io);
  stream.connect(net::ip::tcp::endpoint(net::ip::make_address("127.0.0.1"), port));
  http::request<http::empty_body> asked(method, target, 11);
  asked.set(http::field::host, host);
  if (!origin.empty()) asked.set(http::field::origin, origin);
  if (upgrade) {
    asked.set(http::field::connection, "Upgrade");
    asked.set(http::field::upgrade, "websocket");
    asked.set(http::field::sec_websocket_key, "dGhlIHNhbXBsZSBub25jZQ==");
    asked.set(http::field::sec_websocket_version, "13");
  }
  beast::error_code error;
  http::write(stream, asked, error);
  beast::flat_buffer buffer;
  Got got;
  http::read(stream, buffer, got.response, error);
  if (!error) got.status = static_cast<int>(got.response.result_int());
  got.body = got.response.body();
  return got;
}

/// A page without a browser.
class Page {
 public:
  struct Message {
    std::string bytes;
    bool binary = false;
  };

  /// `status` is 101 if the server took the page, otherwise that of its refusal.
  explicit Page(std::uint16_t port, const std::string& target = "/stream", const std::string& host = "127.0.0.1",
                const std::string& origin = "") {
    const net::ip::tcp::endpoint endpoint(net::ip::make_address("127.0.0.1"), port);
    beast::get_lowest_layer(stream_).connect(endpoint);
    stream_.set_option(websocket::stream_base::decorator([&](websocket::request_type& asked) {
      if (!origin.empty()) asked.set(http::field::origin, origin);
    }));
    beast::error_code error;
    stream_.handshake(host, target, error);
    status = error ? request(port, target, host, origin, http::verb::get, true).status : 101;
  }

  void send(const std::string& text) {
    beast::error_code error;
    stream_.write(net::buffer(text), error);
  }

  /// Returns the next message; nothing if none comes in time or the server has hung up.
  std::optional<Message> receive(std::chrono::milliseconds patience = std::chrono::seconds(10)) {
    if (!reading_) {
      reading_ = true;
      arrived_ = broken_ = false;
      stream_.async_read(buffer_, [this](beast::error_code error, std::size_t) {
        arrived_ = !error;
        broken_ = static_cast<bool>(error);
      });
    }
    const auto end = std::chrono::steady_clock::now() + patience;
    io_.restart();
    while (!arrived_ && !broken_ && std::chrono::steady_clock::now() < end) io_.run_one_until(end);
    if (!arrived_) return std::nullopt;
    reading_ = false;
    Message message{beast::buffers_to_string(buffer_.data()), stream_.got_binary()};
    buffer_.consume(buffer_.size());
    return message;
  }
  /// Returns the next message that is binary, or that is text and contains `part`. Asks for the next frame for each
  /// that comes before.
  std::optional<Message> receive_frame() {
    return receive_where([](const Message& m) { return m.binary; });
  }
  std::optional<Message> receive_text(const std::string& part) {
    return receive_where([&](const Message& m) { return !m.binary && m.bytes.find(part) != m.bytes.npos; });
  }
  /// Returns whether the server hangs up.
  bool is_closed() {
    while (receive()) {
    }
    return broken_;
  }

  int status = 0;

 private:
  template <class Fits>
  std::optional<Message> receive_where(Fits fits) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < end) {
      std::optional<Message> message = receive();
      if (!message || fits(*message)) return message;
      if (message->binary) send("next");
    }
    return std::nullopt;
  }

  net::io_context io_;
  websocket::stream<beast::tcp_stream> stream_{io_};
  beast::flat_buffer buffer_;
  bool reading_ = false, arrived_ = false, broken_ = false;
};

}  // namespace vesalius::test

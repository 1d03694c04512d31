#include "view/web_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <list>
#include <set>
#include <utility>
#include <vector>

#include "vesalius/base/quiet_thread.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using net::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kRequestPatience(10);  // for a request, and for its answer to be taken
constexpr std::size_t kSlowest = 128U << 10U;         // bytes a second by which a long answer is taken at least
constexpr int kMostMade = 2;                          // answers that are made or on their way: they may be large
constexpr std::size_t kMaxHeader = 8192;              // bytes
constexpr std::uint64_t kMaxBody = 1024;              // of a request: none is expected
constexpr std::size_t kMostTexts = 50;                // that wait for one client
constexpr int kMostOnTheirWay = 2;                    // frames: one is drawn while the next is sent
constexpr std::string_view kNext = "next";
constexpr std::string_view kStream = "/stream";

/// Scripts, connections and pictures of this server alone; no other page may frame it or read it.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src "
    "'self'; form-action 'none'; frame-ancestors 'none'; base-uri 'none'";

/// A message on its way to clients, which share its bytes.
struct Message {
  std::string bytes;
  bool is_frame = false;
  Clock::time_point arrived;
};
using MessagePointer = std::shared_ptr<const Message>;

/// Counts messages of one second.
class RateLimit {
 public:
  explicit RateLimit(double most) : most_(most), left_(most) {}

  bool allows_one_more() {
    const auto now = Clock::now();
    left_ = std::min(most_, left_ + most_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    return (left_ -= 1.0) >= 0.0;
  }

 private:
  double most_;
  double left_;
  Clock::time_point last_ = Clock::now();
};

/// "/options.toml?token=12" as path and token.
std::pair<std::string, std::string> split_target(std::string_view target) {
  const std::size_t question = target.find('?');
  std::string token;
  if (question != target.npos) {
    constexpr std::string_view kToken = "token=";
    std::string_view rest = target.substr(question + 1);
    while (!rest.empty()) {
      const std::string_view one = rest.substr(0, rest.find('&'));
      if (one.starts_with(kToken)) token = one.substr(kToken.size());
      rest.remove_prefix(std::min(rest.size(), one.size() + 1));
    }
  }
  return {std::string(target.substr(0, question)), token};
}

class Client;
class Connection;

/// What connections share. All but the two counts belongs to the server's thread.
struct Hub {
  WebServerOptions options;
  WebHandlers handlers;
  std::set<Client*> clients;
  std::list<Connection*> waiting;  ///< for requests or for answers to be taken, the longest first
  std::atomic<int> client_count = 0;
  std::atomic<int> detail_count = 0;
  int connections = 0;
  int made = 0;             ///< answers that are being made or sent
  net::thread_pool* maker;  ///< its thread makes them
};

/// One page.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(tcp::socket socket, Hub& hub) : stream_(std::move(socket)), hub_(hub), rate_(hub.options.max_rate) {
    hub_.clients.insert(this);
    ++hub_.client_count;
    ++hub_.connections;
  }
  ~Client() {
    hub_.clients.erase(this);
    wish({});
    --hub_.client_count;
    --hub_.connections;
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void accept(const http::request<http::string_body>& request) {
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(hub_.options.max_message);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      for (std::string& text : self->hub_.handlers.greet()) {
        self->texts_.emplace_back("", std::make_shared<const Message>(Message{std::move(text), false, {}}));
      }
      self->write_next();
      self->read();
    });
  }

  void offer_frame(const MessagePointer& plain, const MessagePointer& with_details) {
    frame_ = wishes_.details && with_details ? with_details : plain;
    write_next();
  }

  void offer_text(const std::string& kind, const MessagePointer& message) {
    if (!kind.empty()) std::erase_if(texts_, [&](const auto& waiting) { return waiting.first == kind; });
    if (texts_.size() == kMostTexts) texts_.pop_front();
    texts_.emplace_back(kind, message);
    write_next();
  }

  void close() { beast::get_lowest_layer(stream_).close(); }

 private:
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->close();
      const std::string text = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      if (!self->rate_.allows_one_more()) return self->close();
      if (text == kNext) {
        self->frame_was_shown();
      } else {
        self->obey(text);
      }
      self->read();
    });
  }

  void obey(const std::string& text) {
    const auto answer = hub_.handlers.receive(text, [this](const ClientWishes& wishes) { wish(wishes); });
    if (answer) offer_text("", std::make_shared<const Message>(Message{*answer, false, {}}));
  }

  void wish(const ClientWishes& wishes) {
    hub_.detail_count += (wishes.details ? 1 : 0) - (wishes_.details ? 1 : 0);
    wishes_ = wishes;
  }

  void frame_was_shown() {
    if (on_their_way_.empty()) return;
    const Clock::time_point arrived = on_their_way_.front();
    on_their_way_.pop_front();
    hub_.handlers.shown(Clock::now() - arrived);
    write_next();
  }

  /// Writes what waits, one message at a time: texts first, then the frame if the page has asked for one.
  void write_next() {
    if (writing_ || !stream_.is_open()) return;
    if (!texts_.empty()) {
      writing_ = texts_.front().second;
      texts_.pop_front();
    } else if (frame_ && on_their_way_.size() < kMostOnTheirWay) {
      writing_ = std::exchange(frame_, nullptr);
      on_their_way_.push_back(writing_->arrived);
    } else {
      return;
    }
    stream_.binary(writing_->is_frame);
    stream_.async_write(net::buffer(writing_->bytes),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          self->writing_.reset();
                          if (error) return self->close();
                          self->write_next();
                        });
  }

  websocket::stream<beast::tcp_stream> stream_;
  Hub& hub_;
  RateLimit rate_;
  ClientWishes wishes_;
  beast::flat_buffer buffer_;
  std::deque<std::pair<std::string, MessagePointer>> texts_;  ///< with their kinds
  MessagePointer frame_;                                      ///< newest that is not sent yet
  MessagePointer writing_;
  std::deque<Clock::time_point> on_their_way_;  ///< arrival of frames that the page has not shown yet
};

/// A connection that asks for files, until it becomes a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Hub& hub) : stream_(std::move(socket)), hub_(hub) {
    ++hub_.connections;
    place_ = hub_.waiting.insert(hub_.waiting.end(), this);
  }
  ~Connection() {
    end_made();
    hub_.waiting.erase(place_);
    --hub_.connections;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(kMaxBody);
    wait();
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!error) self->answer(self->parser_->release());
    });
  }

  /// Ends the connection. Until that is done, others come before it.
  void give_way() {
    stream_.close();
    hub_.waiting.splice(hub_.waiting.end(), hub_.waiting, place_);
  }

 private:
  using Request = http::request<http::string_body>;

  /// Begins to wait for the other side, behind all who wait already.
  void wait(std::size_t bytes = 0) {
    stream_.expires_after(kRequestPatience + std::chrono::seconds(bytes / kSlowest));
    hub_.waiting.splice(hub_.waiting.end(), hub_.waiting, place_);
  }

  void answer(const Request& request) {
    const auto [path, token] = split_target({request.target().data(), request.target().size()});
    const bool free = hub_.handlers.is_public(path);
    std::optional<std::string_view> origin;
    if (const auto field = request.find(http::field::origin); field != request.end()) {
      origin.emplace(field->value().data(), field->value().size());
    }
    const auto host = request[http::field::host];
    const WebAccess& access = hub_.options.access;
    const auto refused = why_refused(access, {host.data(), host.size()}, origin, free ? access.token : token);
    if (refused) return refuse(request, http::status::forbidden, *refused);
    if (path == kStream) return upgrade(request);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(request, http::status::method_not_allowed, "expected GET");
    }
    std::optional<WebResponse> found = hub_.handlers.get(path);
    if (!found) return refuse(request, http::status::not_found, "nothing here");
    if (found->make) return make(request, found->make);
    send(request, std::move(*found));
  }

  /// Makes an answer in the other thread and sends it.
  void make(const Request& request, const std::function<WebResponse()>& how) {
    if (hub_.made == kMostMade)
      return refuse(request, http::status::service_unavailable, "others are saving; try again");
    ++hub_.made;
    is_made_ = true;
    net::post(*hub_.maker, [self = shared_from_this(), request = Request(request), how = std::function(how)]() mutable {
      WebResponse made;
      try {
        made = how();
      } catch (const std::exception& e) {  // memory that is short must not end the program
        made = {"text/plain; charset=utf-8", std::string("vesalius: ") + e.what() + "\n", false, {}, 500, {}};
      }
      // The connection ends in the server's thread.
      const auto back = self->stream_.get_executor();
      net::post(back, [self = std::move(self), request = std::move(request), made = std::move(made)]() mutable {
        self->send(request, std::move(made));
      });
    });
  }

  void end_made() {
    if (std::exchange(is_made_, false)) --hub_.made;
  }

  void upgrade(const Request& request) {
    if (!websocket::is_upgrade(request)) {
      return refuse(request, http::status::upgrade_required, "expected a WebSocket");
    }
    if (hub_.client_count >= hub_.options.max_clients) {
      return refuse(request, http::status::service_unavailable,
                    fmt::format("{} pages are open, which is the most", hub_.options.max_clients));
    }
    stream_.expires_never();
    std::make_shared<Client>(stream_.release_socket(), hub_)->accept(request);
  }

  void refuse(const Request& request, http::status status, const std::string& why) {
    send(request,
         {"text/plain; charset=utf-8", "vesalius: " + why + "\n", false, {}, static_cast<unsigned>(status), {}});
  }

  void send(const Request& request, WebResponse content) {
    response_ = {static_cast<http::status>(content.status), request.version()};
    response_.set(http::field::content_type, content.type);
    if (content.gzip) response_.set(http::field::content_encoding, "gzip");
    if (!content.file_name.empty()) {
      response_.set(http::field::content_disposition, fmt::format("attachment; filename=\"{}\"", content.file_name));
    }
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", kPolicy);
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.keep_alive(request.keep_alive());
    response_.body() = std::move(content.body);
    response_.prepare_payload();
    if (request.method() == http::verb::head) response_.body().clear();
    wait(response_.body().size());
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->end_made();
      self->response_.body() = {};
      if (!error && self->response_.keep_alive()) return self->read();
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  Hub& hub_;
  std::list<Connection*>::iterator place_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  bool is_made_ = false;  ///< whether its answer counts among those that are made
};

}  // namespace

struct WebServer::Server {
  Server(WebServerOptions options, WebHandlers handlers)
      : hub{std::move(options), std::move(handlers), {}, {}, 0, 0, 0, 0, &maker} {
    listen();
  }

  ~Server() {
    maker.stop();
    maker.join();
    io.stop();
    if (thread.joinable()) thread.join();
  }

  void start() {
    accept();
    thread = quiet_thread([this] { io.run(); });
  }

  void listen() {
    const std::string place = fmt::format("{}:{}", hub.options.host, hub.options.port);
    beast::error_code error;
    tcp::resolver resolver(io);
    const auto found = resolver.resolve(hub.options.host, std::to_string(hub.options.port),
                                        tcp::resolver::passive | tcp::resolver::numeric_service, error);
    if (error) throw Error(fmt::format("{}: {}, expected an address of this machine", place, error.message()));
    const tcp::endpoint endpoint = found.begin()->endpoint();
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
    if (error == net::error::address_in_use) {
      throw Error(place + ": another program has this port, expected a free one (--port)");
    }
    if (error) throw Error(fmt::format("{}: {}, expected an address and a port to listen at", place, error.message()));
    port = acceptor.local_endpoint().port();
  }

  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (error) return accept_later();
      const bool full = hub.connections >= hub.options.max_connections;
      // Whoever sends half a request and no more is not in others' way.
      if (full && !hub.waiting.empty()) hub.waiting.front()->give_way();
      if (!full || !hub.waiting.empty()) {
        beast::error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        std::make_shared<Connection>(std::move(socket), hub)->read();
      }
      accept();
    });
  }

  /// Where no file descriptor is free, the next attempt would fail at once as well.
  void accept_later() {
    pause.expires_after(std::chrono::milliseconds(100));
    pause.async_wait([this](beast::error_code error) {
      if (!error) accept();
    });
  }

  /// Calls `offer` for every client, in the server's thread.
  template <class Offer>
  void to_all(Offer offer) {
    net::post(io, [this, offer = std::move(offer)] {
      // A client whose connection breaks leaves the set.
      const std::vector<Client*> all(hub.clients.begin(), hub.clients.end());
      for (Client* client : all) offer(*client);
    });
  }

  Hub hub;
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  net::steady_timer pause{io};
  net::thread_pool maker{1};  ///< the last, since what waits for it has connections
  std::uint16_t port = 0;
  std::jthread thread;
};

WebServer::WebServer(WebServerOptions options, WebHandlers handlers)
    : server_(std::make_unique<Server>(std::move(options), std::move(handlers))) {}

WebServer::~WebServer() = default;

void WebServer::start() { server_->start(); }

std::uint16_t WebServer::port() const { return server_->port; }

int WebServer::clients() const { return server_->hub.client_count; }

int WebServer::clients_for_details() const { return server_->hub.detail_count; }

void WebServer::publish_frame(std::string bytes, std::string with_details, Clock::time_point arrived) {
  const auto plain = std::make_shared<const Message>(Message{std::move(bytes), true, arrived});
  MessagePointer detailed;
  if (!with_details.empty())
    detailed = std::make_shared<const Message>(Message{std::move(with_details), true, arrived});
  server_->to_all([plain, detailed](Client& client) { client.offer_frame(plain, detailed); });
}

void WebServer::publish_text(const std::string& kind, std::string text) {
  const auto message = std::make_shared<const Message>(Message{std::move(text), false, {}});
  server_->to_all([kind, message](Client& client) { client.offer_text(kind, message); });
}

}  // namespace vesalius

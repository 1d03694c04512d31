#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/web_access.h"

namespace vesalius {

struct WebServerOptions {
  std::string host = "127.0.0.1";  ///< address or name to listen at
  std::uint16_t port = 8080;       ///< 0 = any that is free
  WebAccess access;
  int max_clients = 16;  ///< WebSockets at a time
  /// Connections at a time, WebSockets among them. One more ends that which waits longest for a request.
  int max_connections = 64;
  std::size_t max_message = 65536;  ///< bytes of a client's message; a longer one ends its connection
  double max_rate = 200.0;          ///< messages a second from one client; more end its connection
};

/// What a request gets.
struct WebResponse {
  std::string type;  ///< MIME type
  std::string body;
  bool gzip = false;           ///< whether the body is compressed
  std::string file_name = {};  ///< name under which a browser saves it; empty = it shows it
  unsigned status = 200;
  /// Where it takes long: makes what is sent instead. Called in a thread beside the server's, one after the other.
  std::function<WebResponse()> make = {};
};

/// What one client wants.
struct ClientWishes {
  bool details = false;  ///< the frames with all that there is of them
};

/// What the server asks its owner. All are called in the server's thread and must not take long.
struct WebHandlers {
  /// Returns what lies at a path; nothing if nothing does. Files that are the same for everybody need no token.
  std::function<std::optional<WebResponse>(const std::string& path)> get;
  std::function<bool(const std::string& path)> is_public;
  /// Returns the first messages of a new client.
  std::function<std::vector<std::string>()> greet;
  /// Receives a client's message and returns what to answer, if anything. `wish` changes the client's wishes.
  std::function<std::optional<std::string>(const std::string& text, const std::function<void(ClientWishes)>& wish)>
      receive;
  /// Tells how long it took from a frame's arrival until a client had shown it.
  std::function<void(std::chrono::duration<double>)> shown;
};

/// Serves a page by HTTP and, at /stream, its data by WebSocket, on one port and one thread. A frame is sent only to
/// clients that have asked for one with the message "next": each has two on its way at most, and the newest replaces
/// one that it has not asked for yet, so that a slow client sees fewer frames, not older ones, and holds up nobody.
class WebServer {
 public:
  /// Listens, but answers nobody before `start`. Throws Error with host and port if it cannot.
  WebServer(WebServerOptions options, WebHandlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  void start();
  std::uint16_t port() const;
  /// Returns the number of WebSockets, and of those that wish for details.
  int clients() const;
  int clients_for_details() const;

  /// Sends a frame to all clients; `with_details` to those that wish for them, unless it is empty. `arrived` says when
  /// the frame was there.
  void publish_frame(std::string bytes, std::string with_details, std::chrono::steady_clock::time_point arrived);
  /// Sends a text to all clients. One of the same `kind` that a client has not got yet is replaced; of those without a
  /// kind only so many wait.
  void publish_text(const std::string& kind, std::string text);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace vesalius

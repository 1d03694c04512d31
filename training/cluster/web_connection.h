#pragma once

#include <memory>
#include <string>

namespace vesalius {

/// What a web server answered, or why none did.
struct WebAnswer {
  int status = 0;        ///< of HTTP; 0 if no whole answer came
  std::string body;      ///< also what came of one that was cut off
  std::string location;  ///< address to which the server redirects, else empty
  std::string problem;   ///< one line saying why no whole answer came, else empty
  bool passing = false;  ///< whether that problem may be gone a moment later
};

/// Sends requests, one after the other. Redirects are not followed, and no proxy is used. One thread may use it.
class WebConnection {
 public:
  /// Times in seconds: to connect, and for which a transfer may stay below 100 bytes a second. Throws Error if libcurl
  /// cannot be used.
  WebConnection(double connect_s, double stall_s);
  ~WebConnection();
  WebConnection(const WebConnection&) = delete;
  WebConnection& operator=(const WebConnection&) = delete;

  /// Sends a request and waits for the answer, whatever its status. Sends `body` with it unless null.
  WebAnswer ask(const char* method, const std::string& url, const std::string* body = nullptr);

 private:
  class Transfer;

  std::unique_ptr<Transfer> transfer_;
};

/// Returns `text` as it stands in an address: all but letters, digits, '-', '.', '_', '~' and '/' become %XX.
std::string url_encoded(const std::string& text);

}  // namespace vesalius

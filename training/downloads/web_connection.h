#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "vesalius/error.h"

namespace vesalius {

struct WebOptions {
  double connect_s = 20.0;    ///< time within which a server must answer
  double stall_s = 30.0;      ///< time for which a transfer may stay below 100 bytes a second
  int tries = 4;              ///< attempts for each request if the server or the network fails
  double first_wait_s = 1.0;  ///< pause before the second try; each later pause is twice as long
  /// This function is called several times a second with the bytes of the current answer so far. If it returns false,
  /// an Error says that the request was interrupted.
  std::function<bool(std::uint64_t bytes)> go_on = {};
  bool direct = false;  ///< whether proxies of the environment are passed by, and redirects not followed
};

/// What a web server answered, or why none did.
struct WebAnswer {
  int status = 0;            ///< status of HTTP; 0 if no whole answer came
  std::string body;          ///< also what came of one that was cut off
  std::string location;      ///< address to which the server redirects, else empty
  std::string problem;       ///< one line saying why no whole answer came, else empty
  bool passing = false;      ///< whether the same request may succeed a moment later
  bool interrupted = false;  ///< whether `go_on` ended it
};

/// Sends requests, one after the other. Redirects lead to the web only, never to a file. One thread may use it.
class WebConnection {
 public:
  /// Throws Error if libcurl cannot be used.
  explicit WebConnection(const WebOptions& options);
  ~WebConnection();
  WebConnection(const WebConnection&) = delete;
  WebConnection& operator=(const WebConnection&) = delete;

  /// Takes the body of an answer piece by piece.
  using TakeBytes = std::function<void(std::string_view)>;

  /// Sends a request and waits for the answer, whatever its status. Sends `body` with it unless null. The answer's body
  /// goes to `take`, if given, unless the status is an error's. Passes on what `take` throws.
  WebAnswer ask(const char* method, const std::string& url, const std::string* body = nullptr,
                const TakeBytes& take = {});

 private:
  class Transfer;

  std::unique_ptr<Transfer> transfer_;
};

/// A request that failed.
class WebFailure : public Error {
 public:
  WebFailure(const std::string& message, bool passing) : Error(message), is_passing(passing) {}

  const bool is_passing;  ///< whether the same may succeed a moment later
};

/// Waits before another try after so many. Throws Error naming `shown` if asked to stop.
void wait_to_repeat(const WebOptions& options, int tries, const std::string& shown);

/// Calls `f` until it throws no passing WebFailure, as often as the options allow. Messages name `shown`.
template <class F>
auto repeated(const WebOptions& options, const std::string& shown, F&& f) -> decltype(f()) {
  for (int attempt = 1;; ++attempt) {
    try {
      return f();
    } catch (const WebFailure& failure) {
      if (!failure.is_passing || attempt >= options.tries) throw;
    }
    wait_to_repeat(options, attempt, shown);
  }
}

/// Returns `text` as it stands in an address: all but letters, digits, '-', '.', '_' and '~' become %XX.
std::string url_encoded(const std::string& text);

}  // namespace vesalius

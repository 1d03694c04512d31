#include "downloads/web_connection.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <system_error>
#include <thread>

namespace vesalius {
namespace {

constexpr long kMaxRedirects = 5;
constexpr long kStalled_bytes_per_s = 100;
constexpr auto kNap = std::chrono::milliseconds(50);

/// State that a transfer shares with libcurl's callbacks. No exception may pass through those.
struct Arrival {
  CURL* handle;
  const WebConnection::TakeBytes& take;
  const WebOptions& options;
  std::string body = {};
  std::uint64_t bytes = 0;
  std::exception_ptr thrown = {};
};

long status_of(CURL* handle) {
  long status = 0;
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
  return status;
}

std::size_t take_bytes(char* data, std::size_t size, std::size_t count, void* user) {
  auto& arrival = *static_cast<Arrival*>(user);
  try {
    const std::string_view piece(data, size * count);
    arrival.bytes += piece.size();
    if (arrival.take && status_of(arrival.handle) < 400) {
      arrival.take(piece);
    } else {
      arrival.body += piece;
    }
    return size * count;
  } catch (...) {
    arrival.thrown = std::current_exception();
    return size * count == 0 ? 1 : 0;
  }
}

int ask_to_go_on(void* user, curl_off_t /*total*/, curl_off_t /*now*/, curl_off_t /*up*/, curl_off_t /*up_now*/) {
  const auto& arrival = *static_cast<const Arrival*>(user);
  return arrival.options.go_on && !arrival.options.go_on(arrival.bytes) ? 1 : 0;
}

/// Returns whether the same request may succeed a moment later.
bool is_passing(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_CONNECT:
    case CURLE_PARTIAL_FILE:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
    case CURLE_SSL_CONNECT_ERROR:
      return true;
    default:
      return false;
  }
}

}  // namespace

class WebConnection::Transfer {
 public:
  explicit Transfer(const WebOptions& options) : options_(options) {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    handle_.reset(ready == CURLE_OK ? curl_easy_init() : nullptr);
    headers_.reset(curl_slist_append(nullptr, "Content-Type: application/octet-stream"));
    if (!handle_ || !headers_) throw Error("libcurl cannot be used on this system");
    set(CURLOPT_NOSIGNAL, 1L);
    if (options.direct) {
      set(CURLOPT_NOPROXY, "*");
    } else {
      set(CURLOPT_FOLLOWLOCATION, 1L);
      set(CURLOPT_MAXREDIRS, kMaxRedirects);
      set(CURLOPT_ACCEPT_ENCODING, "");
    }
    set(CURLOPT_USERAGENT, "vesalius");
    set(CURLOPT_CONNECTTIMEOUT_MS, std::max(1L, static_cast<long>(options.connect_s * 1000)));
    set(CURLOPT_LOW_SPEED_LIMIT, kStalled_bytes_per_s);
    set(CURLOPT_LOW_SPEED_TIME, std::max(1L, static_cast<long>(options.stall_s)));
    set(CURLOPT_ERRORBUFFER, reason_.data());
    set(CURLOPT_WRITEFUNCTION, &take_bytes);
    set(CURLOPT_XFERINFOFUNCTION, &ask_to_go_on);
    set(CURLOPT_NOPROGRESS, 0L);
  }

  WebAnswer ask(const char* method, const std::string& url, const std::string* sent, const TakeBytes& take) {
    Arrival arrival{.handle = handle_.get(), .take = take, .options = options_};
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_HTTPGET, 1L);
    set(CURLOPT_HTTPHEADER, sent != nullptr ? headers_.get() : nullptr);
    if (sent != nullptr) {
      set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(sent->size()));
      set(CURLOPT_POSTFIELDS, sent->data());
      set(CURLOPT_POST, 1L);
    }
    set(CURLOPT_CUSTOMREQUEST, method);
    set(CURLOPT_WRITEDATA, &arrival);
    set(CURLOPT_XFERINFODATA, &arrival);
    reason_[0] = '\0';
    const CURLcode code = curl_easy_perform(handle_.get());
    if (arrival.thrown) std::rethrow_exception(arrival.thrown);

    WebAnswer answer;
    answer.body = std::move(arrival.body);
    if (code != CURLE_OK) {
      answer.problem = problem(code);
      answer.passing = is_passing(code);
      answer.interrupted = code == CURLE_ABORTED_BY_CALLBACK;
      return answer;
    }
    answer.status = int(status_of(handle_.get()));
    answer.passing = answer.status == 408 || answer.status == 429 || answer.status >= 500;
    const char* location = info<char*>(CURLINFO_REDIRECT_URL);
    if (location != nullptr) answer.location = location;
    return answer;
  }

 private:
  struct Close {
    void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
    void operator()(curl_slist* list) const { curl_slist_free_all(list); }
  };

  template <class T>
  void set(CURLoption option, T value) {
    const CURLcode code = curl_easy_setopt(handle_.get(), option, value);
    if (code != CURLE_OK) throw Error(fmt::format("libcurl: {}", curl_easy_strerror(code)));
  }
  template <class T>
  T info(CURLINFO which) {
    T value{};
    curl_easy_getinfo(handle_.get(), which, &value);
    return value;
  }
  std::string problem(CURLcode code) {
    const std::string text = reason_[0] != '\0' ? reason_.data() : curl_easy_strerror(code);
    const std::string reason = text.substr(0, text.find('\n'));
    // libcurl's own words for this one name host and port, which the caller shows anyway, and not the reason.
    const long error = info<long>(CURLINFO_OS_ERRNO);
    if (code == CURLE_COULDNT_CONNECT && error != 0) {
      return "nobody answers: " + std::generic_category().message(int(error));
    }
    const bool is_connected = info<double>(CURLINFO_CONNECT_TIME) > 0.0;
    const bool is_about_connecting = code == CURLE_COULDNT_RESOLVE_HOST || code == CURLE_COULDNT_CONNECT ||
                                     (code == CURLE_OPERATION_TIMEDOUT && !is_connected);
    return (is_about_connecting ? "nobody answers: " : "broken off: ") + reason;
  }

  const WebOptions options_;
  std::unique_ptr<CURL, Close> handle_;
  std::unique_ptr<curl_slist, Close> headers_;
  std::array<char, CURL_ERROR_SIZE> reason_{};
};

WebConnection::WebConnection(const WebOptions& options) : transfer_(std::make_unique<Transfer>(options)) {}

WebConnection::~WebConnection() = default;

WebAnswer WebConnection::ask(const char* method, const std::string& url, const std::string* body,
                             const TakeBytes& take) {
  return transfer_->ask(method, url, body, take);
}

void wait_to_repeat(const WebOptions& options, int tries, const std::string& shown) {
  const std::chrono::duration<double> pause(std::ldexp(options.first_wait_s, tries - 1));
  const auto end = std::chrono::steady_clock::now() + pause;
  while (std::chrono::steady_clock::now() < end) {
    if (options.go_on && !options.go_on(0)) throw Error(shown + ": interrupted");
    std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(kNap, pause));
  }
}

std::string url_encoded(const std::string& text) {
  const std::unique_ptr<char, decltype(&curl_free)> encoded(curl_easy_escape(nullptr, text.data(), int(text.size())),
                                                            &curl_free);
  return encoded.get();
}

}  // namespace vesalius

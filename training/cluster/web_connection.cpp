#include "cluster/web_connection.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>
#include <system_error>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr long kStalled_bytes_per_s = 100;

/// A body as it arrives. No exception may pass through libcurl.
struct Body {
  std::string bytes;
  std::exception_ptr thrown;
};

std::size_t take_bytes(char* data, std::size_t size, std::size_t count, void* user) {
  auto& body = *static_cast<Body*>(user);
  try {
    body.bytes.append(data, size * count);
    return size * count;
  } catch (...) {
    body.thrown = std::current_exception();
    return size * count == 0 ? 1 : 0;
  }
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
      return true;
    default:
      return false;
  }
}

}  // namespace

class WebConnection::Transfer {
 public:
  Transfer(double connect_s, double stall_s) {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    handle_.reset(ready == CURLE_OK ? curl_easy_init() : nullptr);
    headers_.reset(curl_slist_append(nullptr, "Content-Type: application/octet-stream"));
    if (!handle_ || !headers_) throw Error("libcurl cannot be used on this system");
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_NOPROXY, "*");
    set(CURLOPT_USERAGENT, "vesalius");
    set(CURLOPT_CONNECTTIMEOUT_MS, std::max(1L, static_cast<long>(connect_s * 1000)));
    set(CURLOPT_LOW_SPEED_LIMIT, kStalled_bytes_per_s);
    set(CURLOPT_LOW_SPEED_TIME, std::max(1L, static_cast<long>(stall_s)));
    set(CURLOPT_ERRORBUFFER, reason_.data());
    set(CURLOPT_WRITEFUNCTION, &take_bytes);
  }

  WebAnswer ask(const char* method, const std::string& url, const std::string* sent) {
    Body body;
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_HTTPGET, 1L);
    set(CURLOPT_HTTPHEADER, sent != nullptr ? headers_.get() : nullptr);
    if (sent != nullptr) {
      set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(sent->size()));
      set(CURLOPT_POSTFIELDS, sent->data());
      set(CURLOPT_POST, 1L);
    }
    set(CURLOPT_CUSTOMREQUEST, method);
    set(CURLOPT_WRITEDATA, &body);
    reason_[0] = '\0';
    const CURLcode code = curl_easy_perform(handle_.get());
    if (body.thrown) std::rethrow_exception(body.thrown);

    WebAnswer answer;
    answer.body = std::move(body.bytes);
    if (code != CURLE_OK) {
      answer.problem = problem(code);
      answer.passing = is_passing(code);
      return answer;
    }
    answer.status = static_cast<int>(info<long>(CURLINFO_RESPONSE_CODE));
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
      return "nobody answers: " + std::generic_category().message(static_cast<int>(error));
    }
    const bool is_connected = info<double>(CURLINFO_CONNECT_TIME) > 0.0;
    const bool is_about_connecting = code == CURLE_COULDNT_RESOLVE_HOST || code == CURLE_COULDNT_CONNECT ||
                                     (code == CURLE_OPERATION_TIMEDOUT && !is_connected);
    return (is_about_connecting ? "nobody answers: " : "broken off: ") + reason;
  }

  std::unique_ptr<CURL, Close> handle_;
  std::unique_ptr<curl_slist, Close> headers_;
  std::array<char, CURL_ERROR_SIZE> reason_{};
};

WebConnection::WebConnection(double connect_s, double stall_s)
    : transfer_(std::make_unique<Transfer>(connect_s, stall_s)) {}

WebConnection::~WebConnection() = default;

WebAnswer WebConnection::ask(const char* method, const std::string& url, const std::string* body) {
  return transfer_->ask(method, url, body);
}

std::string url_encoded(const std::string& text) {
  constexpr std::string_view kPlain = "-._~/";
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain || kPlain.find(c) != kPlain.npos) {
      out += c;
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return out;
}

}  // namespace vesalius

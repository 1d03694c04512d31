#include "downloads/fetch.h"

#include <curl/curl.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <exception>
#include <filesystem>
#include <system_error>
#include <thread>
#include <vector>

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = std::size_t{1} << 16;
constexpr long kMaxRedirects = 5;
constexpr long kStalled_bytes_per_s = 100;
constexpr auto kNap = std::chrono::milliseconds(50);

constexpr std::string_view kFilePrefix = "file://";

bool is_web_address(const std::string& place) { return place.starts_with("http://") || place.starts_with("https://"); }

std::string without_slashes(std::string text) {
  while (text.ends_with('/')) text.pop_back();
  return text;
}

/// An address in its parts.
class Url {
 public:
  /// Throws UsageError if it is not an address. The message does not repeat it, because it may hold a password.
  explicit Url(const std::string& address) {
    const CURLUcode code = curl_url_set(handle_.get(), CURLUPART_URL, address.c_str(), 0);
    if (code != CURLUE_OK) throw UsageError(std::string("not an address: ") + curl_url_strerror(code));
  }
  Url(const Url& other) : handle_(curl_url_dup(other.handle_.get())) {}
  Url& operator=(const Url&) = delete;
  ~Url() = default;

  std::string decoded_path() const { return get(CURLUPART_PATH, CURLU_URLDECODE); }
  /// Returns the address of a file below this one.
  std::string with(const std::string& decoded_path_below) const {
    const Url url(*this);
    const std::string path = without_slashes(decoded_path()) + "/" + decoded_path_below;
    const CURLUcode code = curl_url_set(url.handle_.get(), CURLUPART_PATH, path.c_str(), CURLU_URLENCODE);
    if (code != CURLUE_OK) throw Error(fmt::format("libcurl: {}", curl_url_strerror(code)));
    return url.get(CURLUPART_URL, 0);
  }
  std::string without_password() const {
    const Url shown(*this);
    curl_url_set(shown.handle_.get(), CURLUPART_USER, nullptr, 0);
    curl_url_set(shown.handle_.get(), CURLUPART_PASSWORD, nullptr, 0);
    return shown.get(CURLUPART_URL, 0);
  }

 private:
  struct Free {
    void operator()(CURLU* handle) const { curl_url_cleanup(handle); }
  };

  std::string get(CURLUPart part, unsigned flags) const {
    char* text = nullptr;
    if (curl_url_get(handle_.get(), part, &text, flags) != CURLUE_OK) return "";
    std::string out = text;
    curl_free(text);
    return out;
  }

  std::unique_ptr<CURLU, Free> handle_{curl_url()};
};

/// State that a transfer shares with libcurl's callbacks. No exception may pass through those.
struct Transfer {
  VerifiedFile& file;
  const FetchOptions& options;
  std::exception_ptr thrown;
  bool stopped = false;
};

std::size_t take_bytes(char* data, std::size_t size, std::size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  try {
    transfer.file.write({data, size * count});
    return size * count;
  } catch (...) {
    transfer.thrown = std::current_exception();
    return size * count == 0 ? 1 : 0;
  }
}

int ask_to_go_on(void* user, curl_off_t /*total*/, curl_off_t /*now*/, curl_off_t /*up*/, curl_off_t /*up_now*/) {
  auto& transfer = *static_cast<Transfer*>(user);
  transfer.stopped = transfer.options.go_on && !transfer.options.go_on(transfer.file.written());
  return transfer.stopped ? 1 : 0;
}

/// Returns whether the same request may succeed a moment later.
bool passing(CURLcode code, long status) {
  switch (code) {
    case CURLE_OK:
    case CURLE_HTTP_RETURNED_ERROR:
      return status == 408 || status == 429 || status >= 500;
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

/// One connection. It is kept for the next file.
class Origin::Server {
 public:
  Server(const Url& address, const FetchOptions& options) : address_(address), options_(options) {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    handle_.reset(ready == CURLE_OK ? curl_easy_init() : nullptr);
    if (!handle_) throw Error("libcurl cannot be used on this system");
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_FAILONERROR, 1L);
    set(CURLOPT_FOLLOWLOCATION, 1L);  // libcurl follows only to the web, never to a file
    set(CURLOPT_MAXREDIRS, kMaxRedirects);
    set(CURLOPT_ACCEPT_ENCODING, "");
    set(CURLOPT_USERAGENT, "vesalius");
    set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(options.connect_s * 1000));
    set(CURLOPT_LOW_SPEED_LIMIT, kStalled_bytes_per_s);
    set(CURLOPT_LOW_SPEED_TIME, std::max(1L, static_cast<long>(options.stall_s)));
    set(CURLOPT_ERRORBUFFER, reason_.data());
    set(CURLOPT_WRITEFUNCTION, &take_bytes);
    set(CURLOPT_XFERINFOFUNCTION, &ask_to_go_on);
    set(CURLOPT_NOPROGRESS, 0L);
  }

  bool get(const std::string& path, const std::string& shown, VerifiedFile& file) {
    set(CURLOPT_URL, address_.with(path).c_str());
    for (int attempt = 1;; ++attempt) {
      file.restart();
      Transfer transfer{file, options_, nullptr};
      const CURLcode code = perform(transfer);
      if (transfer.thrown) std::rethrow_exception(transfer.thrown);
      if (transfer.stopped) throw Error(shown + ": interrupted");
      if (code == CURLE_OK) return true;
      const long status = status_of_answer();
      if (code == CURLE_HTTP_RETURNED_ERROR && (status == 404 || status == 410)) return false;
      if (attempt >= options_.tries || !passing(code, status)) fail(shown, code, attempt);
      wait(shown, options_.first_wait_s * static_cast<double>(1 << (attempt - 1)));
    }
  }

 private:
  struct Close {
    void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
  };

  template <class T>
  void set(CURLoption option, T value) {
    const CURLcode code = curl_easy_setopt(handle_.get(), option, value);
    if (code != CURLE_OK) throw Error(fmt::format("libcurl: {}", curl_easy_strerror(code)));
  }
  CURLcode perform(Transfer& transfer) {
    set(CURLOPT_WRITEDATA, &transfer);
    set(CURLOPT_XFERINFODATA, &transfer);
    reason_[0] = '\0';
    return curl_easy_perform(handle_.get());
  }
  long status_of_answer() {
    long status = 0;
    curl_easy_getinfo(handle_.get(), CURLINFO_RESPONSE_CODE, &status);
    return status;
  }
  [[noreturn]] void fail(const std::string& shown, CURLcode code, int attempts) const {
    const std::string reason = reason_[0] != '\0' ? reason_.data() : curl_easy_strerror(code);
    throw Error(fmt::format("{}: cannot be fetched: {}{}", shown, reason.substr(0, reason.find('\n')),
                            attempts > 1 ? fmt::format(" ({} tries)", attempts) : ""));
  }
  void wait(const std::string& shown, double seconds) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      if (options_.go_on && !options_.go_on(0)) throw Error(shown + ": interrupted");
      std::this_thread::sleep_for(kNap);
    }
  }

  const Url address_;
  const FetchOptions& options_;
  std::unique_ptr<CURL, Close> handle_;
  std::array<char, CURL_ERROR_SIZE> reason_{};
};

Origin::Origin(const std::string& place, FetchOptions options) : options_(std::move(options)) {
  if (is_web_address(place)) {
    const Url address(place);
    place_ = without_slashes(address.without_password());
    server_ = std::make_unique<Server>(address, options_);
    return;
  }
  if (place.starts_with(kFilePrefix)) {
    place_ = Url(place).decoded_path();
  } else if (place.find("://") != std::string::npos) {
    throw UsageError(place + ": expected an address with http://, https:// or file://, or a folder");
  } else {
    place_ = place;
  }
  place_ = without_slashes(place_);
  if (place_.empty()) place_ = "/";
  std::error_code ignored;
  if (!fs::is_directory(place_, ignored)) throw UsageError(place_ + ": no such folder");
}

Origin::~Origin() = default;

std::string Origin::place_of(const std::string& path) const { return place_ + "/" + path; }

bool Origin::get(const std::string& path, VerifiedFile& file) {
  return server_ ? server_->get(path, place_of(path), file) : copy(path, file);
}

bool Origin::copy(const std::string& path, VerifiedFile& file) const {
  const std::string from = place_of(path);
  const auto fail = [&](int error) {
    throw Error(fmt::format("{}: cannot be read: {}", from, std::generic_category().message(error)));
  };
  // O_NONBLOCK is needed because opening a pipe that nobody writes to would wait for ever.
  const Descriptor in(::open(from.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (!in.is_open() && (errno == ENOENT || errno == ENOTDIR)) return false;
  struct stat info {};
  if (!in.is_open() || ::fstat(in.get(), &info) != 0) fail(errno);
  if (!S_ISREG(info.st_mode)) throw Error(from + ": not a regular file");
  file.restart();
  std::vector<char> piece(kPiece);
  for (;;) {
    const ssize_t n = ::read(in.get(), piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    if (n == 0) return true;
    file.write({piece.data(), static_cast<std::size_t>(n)});
    if (options_.go_on && !options_.go_on(file.written())) throw Error(from + ": interrupted");
  }
}

}  // namespace vesalius

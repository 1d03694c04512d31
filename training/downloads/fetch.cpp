#include "downloads/fetch.h"

#include <curl/curl.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = std::size_t{1} << 16;

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

}  // namespace

bool holds(const std::string& path, const FileDigest& expected) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) != expected.bytes) return false;
  return sha256_of_file(path) == expected.sha256;
}

VerifiedFile::VerifiedFile(std::string path, std::string unfinished_path, FileDigest expected)
    : path_(std::move(path)), unfinished_path_(std::move(unfinished_path)), expected_(std::move(expected)) {
  file_ = Descriptor(::open(unfinished_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!file_.is_open()) fail(errno);
}

VerifiedFile::~VerifiedFile() {
  if (!committed_) std::remove(unfinished_path_.c_str());
}

void VerifiedFile::fail(int error) const {
  throw Error(fmt::format("{}: cannot be written: {}", path_, std::generic_category().message(error)));
}

void VerifiedFile::write(std::string_view bytes) {
  if (bytes.size() > expected_.bytes - written_) {
    throw WrongBytes(fmt::format("{}: more bytes came than the {} expected", path_, expected_.bytes));
  }
  sum_.update(bytes);
  written_ += bytes.size();
  if (const int error = write_all(file_, bytes)) fail(error);
}

void VerifiedFile::restart() {
  if (::ftruncate(file_.get(), 0) != 0 || ::lseek(file_.get(), 0, SEEK_SET) != 0) fail(errno);
  sum_.finish();
  written_ = 0;
}

void VerifiedFile::commit() {
  if (written_ != expected_.bytes) {
    throw WrongBytes(fmt::format("{}: {} bytes came, expected {}", path_, written_, expected_.bytes));
  }
  const std::string sum = sum_.finish();
  if (sum != expected_.sha256) {
    throw WrongBytes(fmt::format("{}: SHA-256 of what came is {}, expected {}", path_, sum, expected_.sha256));
  }
  // Some file systems report a full disk only here.
  if (const int error = file_.close()) fail(error);
  std::error_code error;
  fs::create_directories(fs::path(path_).parent_path(), error);
  if (error) fail(error.value());
  if (std::rename(unfinished_path_.c_str(), path_.c_str()) != 0) fail(errno);
  committed_ = true;
}

Origin::Origin(const std::string& place, WebOptions options) : options_(std::move(options)) {
  if (is_web_address(place)) {
    const Url address(place);
    place_ = without_slashes(address.without_password());
    address_ = place;
    connection_ = std::make_unique<WebConnection>(options_);
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

std::string Origin::place_of(const std::string& path) const { return place_ + "/" + path; }

bool Origin::get(const std::string& path, VerifiedFile& file) {
  return connection_ ? ask(path, file) : copy(path, file);
}

bool Origin::ask(const std::string& path, VerifiedFile& file) {
  const std::string shown = place_of(path), url = Url(address_).with(path);
  int tries = 0;
  return repeated(options_, shown, [&] {
    ++tries;
    file.restart();
    const WebAnswer answer = connection_->ask("GET", url, nullptr, [&](std::string_view bytes) { file.write(bytes); });
    if (answer.status >= 200 && answer.status < 300) return true;
    if (answer.status == 404 || answer.status == 410) return false;
    if (answer.interrupted) throw Error(shown + ": interrupted");
    const std::string reason = answer.problem.empty() ? fmt::format("HTTP status {}", answer.status) : answer.problem;
    throw WebFailure(
        fmt::format("{}: cannot be fetched: {}{}", shown, reason, tries > 1 ? fmt::format(" ({} tries)", tries) : ""),
        answer.passing);
  });
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

#include "cluster/webhdfs_store.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string_view>
#include <utility>

#include "cluster/store.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kPrefix = "webhdfs://";

/// A request about a file or folder that is not there.
class Missing : public WebFailure {
 public:
  using WebFailure::WebFailure;
};

std::string first_line(const std::string& text) { return text.substr(0, text.find_first_of("\r\n")); }

/// Returns the member `key` of an object if it is a text.
std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Of HDFS's exceptions, these say that the name node is starting or another one takes over.
bool is_passing(const std::string& exception) {
  return exception == "StandbyException" || exception == "RetriableException" || exception == "SafeModeException";
}

/// Throws WebFailure unless the request succeeded or is redirected. `shown` is the address for the message, `node`
/// names a node that the address does not: "data node HOST:PORT: ".
void check(const WebAnswer& answer, const std::string& shown, const std::string& node = "") {
  if (!answer.problem.empty()) throw WebFailure(fmt::format("{}: {}{}", shown, node, answer.problem), answer.passing);
  if (answer.status >= 200 && answer.status < 400) return;
  const Json json = Json::parse(answer.body, nullptr, false);
  if (json.is_object() && json.contains("RemoteException") && json["RemoteException"].is_object()) {
    const std::string exception = first_line(text_of(json["RemoteException"], "exception"));
    const std::string message = first_line(text_of(json["RemoteException"], "message"));
    const std::string text = fmt::format("{}: {}: {}", shown, exception, message);
    if (exception == "FileNotFoundException") throw Missing(text, answer.passing);
    throw WebFailure(text, answer.passing || is_passing(exception));
  }
  const char* hint = answer.status == 401
                         ? ": it wants more than a user's name, such as Kerberos, which is not supported"
                         : ", expected an answer of WebHDFS";
  throw WebFailure(fmt::format("{}: {}HTTP status {}{}", shown, node, answer.status, hint), answer.passing);
}

std::string user_name() {
  for (const char* variable : {"HADOOP_USER_NAME", "USER", "LOGNAME"}) {
    const char* value = std::getenv(variable);
    if (value != nullptr && *value != '\0') return value;
  }
  const passwd* entry = ::getpwuid(::geteuid());
  if (entry == nullptr) throw Error("no user's name for HDFS: HADOOP_USER_NAME is not set");
  return entry->pw_name;
}

bool is_host_and_port(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == text.npos || colon == 0) return false;
  const auto is_host_character = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_';
  };
  if (!std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(colon), is_host_character)) return false;
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, port);
  return error == std::errc() && stop == end && port != 0;
}

/// Returns a name beside `name` that no other writer chooses.
std::string temporary_beside(const std::string& name) {
  std::random_device device;
  const std::size_t begin = name.rfind('/') + 1;  // 0 if there is none
  return fmt::format("{}.{}.tmp-{:08x}{:08x}", name.substr(0, begin), name.substr(begin), device(), device());
}

struct FileStatus {
  std::uint64_t length = 0;  ///< bytes
  bool is_folder = false;
};

}  // namespace

/// What is asked about one file or folder, over a connection of its own. Messages show the address of `shown_name`.
class WebHdfsStore::Call {
 public:
  Call(const WebHdfsStore& store, const std::string& name, const std::string& shown_name)
      : options_(store.options_),
        shown_(store.address_ + store.path_of(shown_name)),
        url_(fmt::format("http://{}/webhdfs/v1{}?user.name={}&op=", store.address_.substr(kPrefix.size()),
                         store.path_of(name), url_encoded(store.user_))),
        connection_(options_) {}
  Call(const WebHdfsStore& store, const std::string& name) : Call(store, name, name) {}

  /// Returns nullopt if there is no such file or folder.
  std::optional<FileStatus> status() {
    try {
      return repeated(options_, shown_, [&] { return status_once(); });
    } catch (const Missing&) {
      return std::nullopt;
    }
  }

  std::string read() {
    return repeated(options_, shown_, [&] {
      const FileStatus status = status_once();
      if (status.is_folder) throw Error(shown_ + ": a folder, expected a file");
      WebAnswer answer = ask("GET", "OPEN");
      if (!answer.location.empty()) answer = ask_data_node("GET", answer.location);
      // A data node that ends early, or a file that was replaced in between.
      if (answer.body.size() != status.length) {
        throw WebFailure(fmt::format("{}: {} bytes came, expected {}", shown_, answer.body.size(), status.length),
                         true);
      }
      return std::move(answer.body);
    });
  }

  /// Writes a file under this name itself. Sets `begun` once there may be a file.
  void create(const std::string& bytes, bool& begun) {
    repeated(options_, shown_, [&] {
      // The name node makes no file: it only says which data node takes the bytes.
      const WebAnswer answer = ask("PUT", "CREATE&overwrite=true");
      if (answer.location.empty()) throw Error(shown_ + ": expected the address of a data node from WebHDFS");
      begun = true;
      ask_data_node("PUT", answer.location, &bytes);
    });
  }

  /// Renames this file of `length` bytes. A plain RENAME does nothing if the target is there. With renameoptions, which
  /// the name node of Hadoop 2 and 3 reads (NamenodeWebHdfsMethods: it calls rename2), the target is replaced in one
  /// step, and a failure is an exception.
  void rename(const WebHdfsStore& store, const std::string& name, std::uint64_t length) {
    const std::string operation = "RENAME&renameoptions=OVERWRITE&destination=" + store.path_of(name);
    bool is_first = true;
    repeated(options_, shown_, [&] {
      const bool is_again = !std::exchange(is_first, false);
      try {
        // What does not know the option answers as to a plain one: with a truth value.
        const WebAnswer answer = ask("PUT", operation);
        if (!answer.body.empty() && !is_true(answer)) throw Error(shown_ + ": WebHDFS does not rename over a file");
      } catch (const Missing&) {
        if (!is_again) throw;
        // Renamed by an earlier try whose answer was lost?
        const auto status = Call(store, name).status();
        if (!status || status->is_folder || status->length != length) throw;
      }
    });
  }

  std::vector<std::string> list() {
    const WebAnswer answer = repeated(options_, shown_, [&] { return ask("GET", "LISTSTATUS"); });
    std::vector<std::string> names;
    try {
      const Json json = Json::parse(answer.body);
      for (const Json& status : json.at("FileStatuses").at("FileStatus")) {
        // A file lists itself alone, under no name.
        std::string name = status.at("pathSuffix").get<std::string>();
        if (!name.empty() && !is_temporary_name(name)) names.push_back(std::move(name));
      }
    } catch (const Json::exception&) {
      not_webhdfs();
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  /// Removes this file or folder, if there is one.
  void remove() {
    // False says that there was none; anything but a truth value is an error.
    repeated(options_, shown_, [&] { is_true(ask("DELETE", "DELETE&recursive=true")); });
  }

 private:
  WebAnswer ask(const char* method, const std::string& operation) {
    WebAnswer answer = connection_.ask(method, url_ + operation);
    check(answer, shown_);
    return answer;
  }
  WebAnswer ask_data_node(const char* method, const std::string& url, const std::string* bytes = nullptr) {
    if (!url.starts_with("http://")) throw Error(shown_ + ": the data node's address is not http://");
    const std::size_t begin = url.find("//") + 2;
    WebAnswer answer = connection_.ask(method, url, bytes);
    check(answer, shown_, fmt::format("data node {}: ", url.substr(begin, url.find('/', begin) - begin)));
    if (answer.status >= 300) throw Error(shown_ + ": the data node redirects to another address");
    return answer;
  }
  FileStatus status_once() {
    const WebAnswer answer = ask("GET", "GETFILESTATUS");
    try {
      const Json status = Json::parse(answer.body).at("FileStatus");
      return {status.at("length").get<std::uint64_t>(), status.at("type").get<std::string>() == "DIRECTORY"};
    } catch (const Json::exception&) {
      not_webhdfs();
    }
  }
  bool is_true(const WebAnswer& answer) const {
    try {
      return Json::parse(answer.body).at("boolean").get<bool>();
    } catch (const Json::exception&) {
      not_webhdfs();
    }
  }
  [[noreturn]] void not_webhdfs() const { throw Error(shown_ + ": the server's answer is not one of WebHDFS"); }

  const WebOptions options_;
  const std::string shown_;
  const std::string url_;  ///< url of the name node; an operation can be appended
  WebConnection connection_;
};

bool WebHdfsStore::takes(const std::string& place) { return place.starts_with(kPrefix); }

WebHdfsStore::WebHdfsStore(const std::string& address, WebOptions options) : options_(std::move(options)) {
  const auto refuse = [&] {
    throw UsageError(address + ": expected webhdfs://HOST:PORT/PATH, the path of letters, digits, '.', '_' and '-'");
  };
  if (!takes(address)) refuse();
  const std::size_t slash = std::min(address.find('/', kPrefix.size()), address.size());
  address_ = address.substr(0, slash);
  root_ = address.substr(slash);
  while (root_.ends_with('/')) root_.pop_back();
  if (slash == address.size() || !is_host_and_port(std::string_view(address_).substr(kPrefix.size()))) refuse();
  if (!root_.empty() && !is_store_name(root_.substr(1))) refuse();
  user_ = user_name();
}

std::string WebHdfsStore::path_of(const std::string& name) const {
  if (!name.empty()) return root_ + "/" + name;
  return root_.empty() ? "/" : root_;
}

std::string WebHdfsStore::read(const std::string& name) const {
  check_store_name(name);
  return Call(*this, name).read();
}

bool WebHdfsStore::exists(const std::string& name) const {
  check_store_name(name);
  return Call(*this, name).status().has_value();
}

void WebHdfsStore::write(const std::string& name, const std::string& bytes) {
  check_store_name(name);
  const std::string temporary = temporary_beside(name);
  bool begun = false;
  try {
    Call call(*this, temporary, name);
    call.create(bytes, begun);
    call.rename(*this, name, bytes.size());
  } catch (const Error&) {
    if (begun) discard(temporary);
    throw;
  }
}

void WebHdfsStore::discard(const std::string& name) const {
  WebHdfsStore hasty = *this;
  hasty.options_.tries = 1;
  try {
    Call(hasty, name).remove();
  } catch (const Error&) {  // what failed before says more
  }
}

std::vector<std::string> WebHdfsStore::list(const std::string& folder) const {
  check_store_folder(folder);
  try {
    return Call(*this, folder).list();
  } catch (const Missing&) {
    return {};
  }
}

void WebHdfsStore::remove(const std::string& name) {
  check_store_name(name);
  Call(*this, name).remove();
}

}  // namespace vesalius

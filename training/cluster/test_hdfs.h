#pragma once

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cstdint>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

// Name node and data node of HDFS in one, on the loopback interface. It misbehaves as a test demands.
namespace vesalius::test {

struct HdfsReply {
  int status = 200;
  std::string body = {};
  std::string location = {};
};

inline HdfsReply remote_exception(int status, const std::string& exception, const std::string& message) {
  const nlohmann::json json = {{"RemoteException", {{"exception", exception}, {"message", message}}}};
  return {status, json.dump()};
}

class TestHdfs {
 public:
  TestHdfs() : acceptor_(context_, {boost::asio::ip::address_v4::loopback(), 0}) {
    port_ = acceptor_.local_endpoint().port();
    thread_ = std::thread([this] { serve(); });
  }
  ~TestHdfs() {
    stop_ = true;
    Socket socket(context_);
    socket.connect(acceptor_.local_endpoint());  // wakes the thread
    thread_.join();
  }
  TestHdfs(const TestHdfs&) = delete;
  TestHdfs& operator=(const TestHdfs&) = delete;

  std::string address() const { return "webhdfs://" + host(); }

  // To be set and read between requests.
  std::map<std::string, std::string> files;  ///< bytes by absolute path
  std::deque<HdfsReply> next;                ///< answers to the next requests, whatever they are
  std::deque<HdfsReply> next_writes;  ///< answers to the next bytes that are written; the file stays there, empty
  std::deque<std::size_t> next_cuts;  ///< the next files that are read end after so many bytes
  bool says_cut_length = false;       ///< such an answer claims to be whole
  bool loses_rename_answer = false;   ///< once
  bool knows_rename_options = true;
  std::vector<std::string> requests;  ///< operations so far; those of the data node end in "+"
  std::string user;                   ///< user of the last request to the name node

 private:
  using Socket = boost::asio::ip::tcp::socket;
  using Error = boost::beast::error_code;
  using Query = std::map<std::string, std::string>;

  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }

  static std::string decoded(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '%') {
        out += static_cast<char>(std::stoi(std::string(text.substr(i + 1, 2)), nullptr, 16));
        i += 2;
      } else {
        out += text[i];
      }
    }
    return out;
  }
  static Query parse_query(std::string_view text) {
    Query query;
    while (!text.empty()) {
      const std::string_view one = text.substr(0, text.find('&'));
      const std::size_t equals = std::min(one.find('='), one.size() - 1);
      query[std::string(one.substr(0, equals))] = decoded(one.substr(equals + 1));
      text.remove_prefix(std::min(text.size(), one.size() + 1));
    }
    return query;
  }

  void serve() {
    for (;;) {
      Socket socket(context_);
      Error error;
      acceptor_.accept(socket, error);
      if (stop_) return;
      if (!error) answer(socket);
    }
  }

  /// One request of one connection.
  void answer(Socket& socket) {
    namespace http = boost::beast::http;
    boost::beast::flat_buffer buffer;
    http::request_parser<http::string_body> parser;
    parser.body_limit(std::uint64_t{1} << 30U);
    Error error;
    http::read_header(socket, buffer, parser, error);
    if (error) return;
    const std::string target(parser.get().target());
    const std::size_t question = target.find('?');
    constexpr std::string_view kRoot = "/webhdfs/v1";
    const std::string path = decoded(target.substr(kRoot.size(), question - kRoot.size()));
    const Query query = parse_query(std::string_view(target).substr(question + 1));
    const bool is_data = query.count("datanode") > 0;
    requests.push_back(query.at("op") + (is_data ? "+" : ""));
    if (parser.get()[http::field::expect] == "100-continue" && next_writes.empty()) {
      http::write(socket, http::response<http::empty_body>(http::status::continue_, 11), error);
    }
    if (parser.get()[http::field::expect] != "100-continue" || next_writes.empty()) {
      http::read(socket, buffer, parser, error);
      if (error) return;
    }
    std::size_t cut = std::string::npos;
    if (is_data && query.at("op") == "OPEN" && !next_cuts.empty()) {
      cut = next_cuts.front();
      next_cuts.pop_front();
    }
    const bool hangs_up = query.at("op") == "RENAME" && std::exchange(loses_rename_answer, false);
    const HdfsReply reply = reply_to(std::string(parser.get().method_string()), path, query, parser.get().body());
    if (!hangs_up) send(socket, reply, cut);
  }

  void send(Socket& socket, const HdfsReply& reply, std::size_t cut) const {
    const std::string body = reply.body.substr(0, cut);
    std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " As the test says\r\nConnection: close\r\n";
    if (!reply.location.empty()) head += "Location: " + reply.location + "\r\n";
    head += "Content-Length: " + std::to_string(says_cut_length ? body.size() : reply.body.size()) + "\r\n\r\n";
    Error error;
    boost::asio::write(socket, boost::asio::buffer(head + body), error);
    socket.shutdown(Socket::shutdown_send, error);
  }

  HdfsReply reply_to(const std::string& method, const std::string& path, const Query& query, const std::string& body) {
    if (!next.empty()) {
      const HdfsReply reply = next.front();
      next.pop_front();
      return reply;
    }
    const std::string& operation = query.at("op");
    if (query.count("datanode") > 0) return reply_of_data_node(operation, path, body);
    user = query.at("user.name");
    const std::string data_node = "http://" + host() + "/webhdfs/v1" + path + "?datanode=1&op=" + operation;
    if (method + operation == "PUTCREATE" && query.at("overwrite") == "true") return {307, "", data_node};
    if (method + operation == "PUTRENAME") return rename(path, query);
    if (method + operation == "DELETEDELETE" && query.at("recursive") == "true") {
      const auto removed = std::erase_if(files, [&](const auto& file) { return is_at_or_below(file.first, path); });
      return {200, removed > 0 ? R"({"boolean":true})" : R"({"boolean":false})"};
    }
    if (method != "GET") return remote_exception(400, "IllegalArgumentException", "no such operation");
    const bool is_file = files.count(path) > 0;
    const bool is_folder = !is_file && !children(path).empty();
    if (!is_file && !is_folder) {
      return remote_exception(404, "FileNotFoundException", "File does not exist: " + path + "\n\tat a place");
    }
    if (operation == "OPEN") return {307, "", data_node};
    if (operation == "LISTSTATUS") return {200, list(path, is_file)};
    const nlohmann::json json = {{"length", is_file ? files[path].size() : 0},
                                 {"type", is_file ? "FILE" : "DIRECTORY"}};
    return {200, nlohmann::json({{"FileStatus", json}}).dump()};
  }

  HdfsReply reply_of_data_node(const std::string& operation, const std::string& path, const std::string& body) {
    if (operation == "OPEN") return {200, files.at(path)};
    if (next_writes.empty()) {
      files[path] = body;
      return {201};
    }
    files[path].clear();
    const HdfsReply reply = next_writes.front();
    next_writes.pop_front();
    return reply;
  }

  HdfsReply rename(const std::string& path, const Query& query) {
    const std::string& to = query.at("destination");
    const bool overwrites = knows_rename_options && query.at("renameoptions") == "OVERWRITE";
    if (files.count(path) == 0) {
      return remote_exception(404, "FileNotFoundException", "rename source " + path + " is not found.");
    }
    if (!overwrites && files.count(to) > 0) return {200, R"({"boolean":false})"};
    files[to] = std::exchange(files[path], "");
    files.erase(path);
    return {200, overwrites ? "" : R"({"boolean":true})"};
  }

  static bool is_at_or_below(const std::string& path, const std::string& folder) {
    return path == folder || path.starts_with(folder == "/" ? folder : folder + "/");
  }
  std::set<std::string> children(const std::string& folder) const {
    std::set<std::string> names;
    const std::size_t begin = folder == "/" ? 1 : folder.size() + 1;
    for (const auto& [path, bytes] : files) {
      if (path.size() > begin && is_at_or_below(path, folder)) {
        names.insert(path.substr(begin, path.find('/', begin) - begin));
      }
    }
    return names;
  }
  /// Names in no useful order.
  std::string list(const std::string& path, bool is_file) const {
    nlohmann::json statuses = nlohmann::json::array();
    const std::set<std::string> names = is_file ? std::set<std::string>{""} : children(path);
    for (auto name = names.rbegin(); name != names.rend(); ++name) statuses.push_back({{"pathSuffix", *name}});
    return nlohmann::json({{"FileStatuses", {{"FileStatus", statuses}}}}).dump();
  }

  boost::asio::io_context context_;
  boost::asio::ip::tcp::acceptor acceptor_;
  unsigned short port_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace vesalius::test

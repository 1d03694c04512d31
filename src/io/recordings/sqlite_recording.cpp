#include <fmt/format.h>
#include <sqlite3.h>

#include <limits>
#include <map>

#include "io/recordings/chunked_recording.h"
#include "io/recordings/recording_formats.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// First bytes of a message that rosbag2 compressed by itself.
constexpr std::string_view kZstdMagic = "\x28\xB5\x2F\xFD";

class SqliteRecording final : public Recording {
 public:
  explicit SqliteRecording(const std::string& path)
      : path_(path), database_(nullptr, sqlite3_close), rows_(nullptr, sqlite3_finalize) {
    sqlite3* opened = nullptr;
    // "immutable": neither a lock nor a journal beside the file, which may lie where nobody can write.
    const int status = sqlite3_open_v2(uri_of(path).c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (status != SQLITE_OK) fail();
    expect_tables();
    const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (step(topics)) {
      topic_of_[sqlite3_column_int64(topics.get(), 0)] = topics_.size();
      const bool is_cdr = text(topics, 3) == "cdr";
      topics_.push_back({std::string(text(topics, 1)), short_type(text(topics, 2)),
                         is_cdr ? MessageLayout::cdr : MessageLayout::other, 0});
    }
    const Statement counts = prepare("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
    while (step(counts)) {
      const auto found = topic_of_.find(sqlite3_column_int64(counts.get(), 0));
      if (found != topic_of_.end()) topics_[found->second].messages = sqlite3_column_int64(counts.get(), 1);
    }
    rewind();
  }

  const std::vector<RecordedTopic>& topics() const override { return topics_; }

  std::optional<RecordedMessage> next() override {
    while (next_row()) {
      const auto found = topic_of_.find(sqlite3_column_int64(rows_.get(), 0));
      if (found == topic_of_.end()) continue;
      RecordedMessage message{found->second, sqlite3_column_int64(rows_.get(), 1), {}};
      const void* data = sqlite3_column_blob(rows_.get(), 2);
      if (data != nullptr) {
        message.bytes = {static_cast<const char*>(data),
                         static_cast<std::size_t>(sqlite3_column_bytes(rows_.get(), 2))};
      }
      if (message.bytes.starts_with(kZstdMagic)) {
        unpacked_ = decompress(message.bytes, "zstd", stated_zstd_size(message.bytes, path_), path_);
        message.bytes = unpacked_;
      }
      return message;
    }
    return std::nullopt;
  }

  void rewind() override { seek(std::numeric_limits<std::int64_t>::min()); }

  std::optional<std::int64_t> last_ns() const override { return limit_of("MAX"); }

  bool seek(std::int64_t time_ns) override {
    rows_ = prepare("SELECT topic_id, timestamp, data FROM messages WHERE timestamp >= ?1 ORDER BY timestamp, id");
    if (sqlite3_bind_int64(rows_.get(), 1, time_ns) != SQLITE_OK) fail();
    return time_ns > limit_of("MIN").value_or(time_ns);
  }

 private:
  /// Returns the least or greatest time, which the database knows by its index.
  std::optional<std::int64_t> limit_of(const char* function) const {
    const Statement found = prepare(fmt::format("SELECT {}(timestamp) FROM messages", function).c_str());
    if (!step(found) || sqlite3_column_type(found.get(), 0) == SQLITE_NULL) return std::nullopt;
    return sqlite3_column_int64(found.get(), 0);
  }
  /// Goes to the next message; at the end, and where the file is damaged, there is none after it.
  bool next_row() {
    try {
      if (rows_ && step(rows_)) return true;
    } catch (const Error&) {
      rows_.reset();
      throw;
    }
    rows_.reset();
    return false;
  }
  static std::string uri_of(const std::string& path) {
    std::string uri = "file:";
    for (const char c : path)
      uri +=
          c == '?' || c == '#' || c == '%' ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
    return uri + "?immutable=1";
  }
  /// A view of that name could be a query that never ends.
  void expect_tables() const {
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    const Statement tables = prepare(
        "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages') AND sql NOT LIKE "
        "'%VIRTUAL%'");
    if (!step(tables) || sqlite3_column_int(tables.get(), 0) != 2) {
      throw Error(path_ + ": an SQLite file that is no ROS 2 bag, expected tables topics and messages");
    }
  }
  [[noreturn]] void fail() const {
    throw Error(fmt::format("{}: not a ROS 2 bag that can be read: {}", path_,
                            database_ ? sqlite3_errmsg(database_.get()) : "no memory"));
  }
  Statement prepare(const char* query) const {
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &made, nullptr) != SQLITE_OK) fail();
    return {made, sqlite3_finalize};
  }
  bool step(const Statement& statement) const {
    const int status = sqlite3_step(statement.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail();
    return status == SQLITE_ROW;
  }
  static std::string_view text(const Statement& statement, int column) {
    const unsigned char* value = sqlite3_column_text(statement.get(), column);
    return value == nullptr ? std::string_view() : reinterpret_cast<const char*>(value);
  }

  std::string path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
  Statement rows_;
  std::vector<RecordedTopic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_;
  std::string unpacked_;
};

}  // namespace

std::unique_ptr<Recording> open_sqlite(const std::string& path) { return std::make_unique<SqliteRecording>(path); }

}  // namespace vesalius

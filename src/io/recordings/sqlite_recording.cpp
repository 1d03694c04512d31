#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/mman.h>

#include <algorithm>
#include <filesystem>
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

/// Returns the bytes of a file that SQLite left beside its database; 0 where there is none, or nothing in it.
std::uint64_t size_beside(const DataFile& file, const char* name, std::string_view magic) {
  const std::string path = file.path() + name;
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return 0;
  const DataFile beside(path);
  return beside.read(0, magic.size()) == magic ? beside.size() : 0;
}

/// The bytes of a file as memory, of which the system reads what is asked for.
class MappedFile {
 public:
  explicit MappedFile(const DataFile& file)
      : size_(file.size()), at_(::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.descriptor(), 0)) {
    if (at_ == MAP_FAILED) throw Error(file.path() + ": cannot be mapped into memory");
  }
  ~MappedFile() { ::munmap(at_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  unsigned char* bytes() const { return static_cast<unsigned char*>(at_); }

 private:
  std::size_t size_;
  void* at_;
};

/// A file may be made to harm: its pages may point at each other, so that few bytes have any number of rows of any
/// length. So SQLite gets no more steps, and gives no more bytes, than a file of that size can have.
class SqliteRecording final : public Recording {
 public:
  explicit SqliteRecording(DataFile file)
      : file_(std::move(file)),
        path_(file_.path()),
        bytes_(file_.size() + size_beside(file_, "-wal", "\x37\x7F\x06")),
        unpacked_bytes_(bytes_),
        database_(nullptr, sqlite3_close),
        keys_(nullptr, sqlite3_finalize),
        row_(nullptr, sqlite3_finalize) {
    open();
    expect_tables();
    const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics");
    while (step(topics)) {
      topic_of_[sqlite3_column_int64(topics.get(), 0)] = topics_.size();
      const bool is_cdr = bytes(topics, 3) == "cdr";
      topics_.push_back({std::string(bytes(topics, 1)), short_type(bytes(topics, 2)),
                         is_cdr ? MessageLayout::cdr : MessageLayout::other, 0});
    }
    const Statement all = prepare("SELECT topic_id FROM messages WHERE typeof(topic_id) = 'integer'");
    while (step(all)) {
      const auto found = topic_of_.find(sqlite3_column_int64(all.get(), 0));
      if (found != topic_of_.end()) ++topics_[found->second].messages;
    }
    rewind();
  }

  const std::vector<RecordedTopic>& topics() const override { return topics_; }

  std::optional<RecordedMessage> next() override {
    while (next_row()) {
      const auto found = topic_of_.find(sqlite3_column_int64(row_.get(), 0));
      if (found == topic_of_.end()) continue;
      RecordedMessage message{found->second, sqlite3_column_int64(row_.get(), 1), bytes(row_, 2)};
      if (message.bytes.starts_with(kZstdMagic)) {
        const std::size_t size = stated_zstd_size(message.bytes, path_);
        unpacked_bytes_.add(size, path_);
        unpacked_ = decompress(message.bytes, "zstd", size, path_);
        message.bytes = unpacked_;
      }
      return message;
    }
    return std::nullopt;
  }

  void rewind() override { seek(std::numeric_limits<std::int64_t>::min()); }

  std::optional<std::int64_t> last_ns() const override { return first_by("DESC"); }

  bool seek(std::int64_t time_ns) override {
    given_ = 0;
    unpacked_bytes_.reset();
    row_ = prepare("SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?1 AND typeof(topic_id) = 'integer'");
    // Messages themselves are not sorted: the index, or where there is none a list of times alone, gives their order.
    keys_ = prepare(
        "SELECT rowid FROM messages WHERE timestamp >= ?1 AND typeof(timestamp) = 'integer' ORDER BY timestamp, rowid");
    if (sqlite3_bind_int64(keys_.get(), 1, time_ns) != SQLITE_OK) fail();
    return time_ns > first_by("ASC").value_or(time_ns);
  }

  std::vector<std::string> notes() const override { return notes_; }

 private:
  void open() {
    const bool has_wal = bytes_ > file_.size();
    if (size_beside(file_, "-journal", "\xD9\xD5\x05\xF9\x20\xA1\x63\xD7") > 0) {
      notes_.push_back(
          fmt::format("{0}: {0}-journal is not read: whoever wrote it was stopped amid a change, and some "
                      "messages may be damaged; `sqlite3` mends a copy of both when it opens it",
                      path_));
    }
    // "immutable": neither a lock nor a journal beside the file, which may lie where nobody can write. What a writer
    // left in a log beside it is read without locks, with the log's index in memory.
    const std::string uri =
        file_.has_name() ? uri_of(path_) + (has_wal ? "?vfs=unix-none" : "?immutable=1") : "file::memory:";
    sqlite3* opened = nullptr;
    const int status = sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (status != SQLITE_OK) fail();
    if (!file_.has_name()) use_mapped();
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    const auto longest = std::clamp<std::uint64_t>(bytes_, 1U << 16U, kMaxPieceBytes);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(longest));
    sqlite3_progress_handler(opened, kStepsAtOnce, count_steps, this);
    execute("PRAGMA cell_size_check = ON");
    if (has_wal) {
      execute("PRAGMA locking_mode = EXCLUSIVE");
      notes_.push_back(fmt::format("{0}: was not closed; the messages in {0}-wal are read too", path_));
    }
  }

  /// A file without a name is one in memory for SQLite, which can have no log beside it: its header must not say so.
  void use_mapped() {
    constexpr std::size_t kVersions = 18, kHeader = 100;
    if (file_.size() < kHeader) throw Error(path_ + ": truncated SQLite file");
    mapped_.emplace(file_);
    mapped_->bytes()[kVersions] = mapped_->bytes()[kVersions + 1] = 1;
    const auto size = static_cast<sqlite3_int64>(file_.size());
    if (sqlite3_deserialize(database_.get(), "main", mapped_->bytes(), size, size, SQLITE_DESERIALIZE_READONLY) !=
        SQLITE_OK)
      fail();
  }

  static constexpr int kStepsAtOnce = 1000;
  static int count_steps(void* self) {
    constexpr std::uint64_t kFree = 1'000'000, kPerByte = 2;  // a row has ten bytes or more, and takes twelve steps
    auto& recording = *static_cast<SqliteRecording*>(self);
    return (recording.steps_ += kStepsAtOnce) > kFree + kPerByte * recording.bytes_ ? 1 : 0;
  }

  /// Returns the first time in this order, which the database knows by its index.
  std::optional<std::int64_t> first_by(const char* order) const {
    const Statement found = prepare(
        fmt::format("SELECT timestamp FROM messages WHERE typeof(timestamp) = 'integer' ORDER BY timestamp {} LIMIT 1",
                    order)
            .c_str());
    if (!step(found)) return std::nullopt;
    return sqlite3_column_int64(found.get(), 0);
  }
  /// Goes to the next message; at the end, and where the file is damaged, there is none after it.
  bool next_row() {
    try {
      while (keys_ && step(keys_)) {
        sqlite3_reset(row_.get());
        if (sqlite3_bind_int64(row_.get(), 1, sqlite3_column_int64(keys_.get(), 0)) != SQLITE_OK) fail();
        if (step(row_)) return true;
      }
    } catch (const Error&) {
      keys_.reset();
      throw;
    }
    keys_.reset();
    return false;
  }
  static std::string uri_of(const std::string& path) {
    std::string uri = "file:";
    for (const char c : path)
      uri +=
          c == '?' || c == '#' || c == '%' ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
    return uri;
  }
  /// Views of these names, and columns that are worked out, could be queries that never end.
  void expect_tables() const {
    const Statement tables = prepare(
        "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND rootpage > 0 AND name IN ('topics', 'messages')");
    if (!step(tables) || sqlite3_column_int(tables.get(), 0) != 2) {
      throw Error(path_ + ": an SQLite file that is no ROS 2 bag, expected tables topics and messages");
    }
    for (const char* table : {"topics", "messages"}) {
      const Statement made = prepare(fmt::format("SELECT 1 FROM pragma_table_xinfo('{}') WHERE hidden", table).c_str());
      if (step(made)) throw Error(fmt::format("{}: table {} has generated columns, expected none", path_, table));
    }
  }
  [[noreturn]] void fail() const {
    throw Error(fmt::format("{}: not a ROS 2 bag that can be read: {}", path_, what_failed()));
  }
  std::string what_failed() const {
    if (!database_) return "no memory";
    if (sqlite3_errcode(database_.get()) == SQLITE_INTERRUPT) return "more rows than its size can hold";
    return sqlite3_errmsg(database_.get());
  }
  void execute(const char* query) const {
    if (sqlite3_exec(database_.get(), query, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  Statement prepare(const char* query) const {
    steps_ = 0;
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &made, nullptr) != SQLITE_OK) fail();
    return {made, sqlite3_finalize};
  }
  bool step(const Statement& statement) const {
    const int status = sqlite3_step(statement.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail();
    return status == SQLITE_ROW;
  }
  /// Returns a text or bytes, which are counted.
  std::string_view bytes(const Statement& statement, int column) {
    const void* value = sqlite3_column_type(statement.get(), column) == SQLITE_TEXT
                            ? sqlite3_column_text(statement.get(), column)
                            : sqlite3_column_blob(statement.get(), column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement.get(), column));
    given_ += size;
    if (given_ > bytes_) {
      keys_.reset();
      throw Error(path_ + ": damaged: more bytes in its rows than in the file");
    }
    return value == nullptr ? std::string_view() : std::string_view(static_cast<const char*>(value), size);
  }

  DataFile file_;
  std::string path_;
  std::uint64_t bytes_;              ///< of the file and its log
  std::uint64_t given_ = 0;          ///< bytes of texts and messages since the first
  mutable std::uint64_t steps_ = 0;  ///< of SQLite since a query began
  UnpackedBytes unpacked_bytes_;
  std::vector<std::string> notes_;
  std::optional<MappedFile> mapped_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
  Statement keys_, row_;  ///< places of the messages in order; the one that was found last
  std::vector<RecordedTopic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_;
  std::string unpacked_;
};

}  // namespace

std::unique_ptr<Recording> open_sqlite(DataFile file) { return std::make_unique<SqliteRecording>(std::move(file)); }

}  // namespace vesalius

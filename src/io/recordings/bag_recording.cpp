#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "io/files/byte_stream.h"
#include "io/recordings/chunked_recording.h"
#include "io/recordings/recording_formats.h"

namespace vesalius {
namespace {

constexpr std::uint8_t kMessage = 0x02, kIndex = 0x04, kChunk = 0x05, kChunkInfo = 0x06, kConnection = 0x07;
/// Headers of records hold a few numbers and names.
constexpr std::uint32_t kMaxHeaderBytes = 1U << 20U;

/// The fields of a record's header: NAME=value.
class Fields {
 public:
  Fields(std::string_view bytes, const std::string& name) : name_(name) {
    ByteReader in(bytes, name);
    while (in.left() > 0) {
      const std::string_view field = in.text("field of a header");
      const std::size_t equals = field.find('=');
      if (equals == field.npos) in.fail("a field of a header without \"=\"");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

  std::string_view text(std::string_view key) const {
    const auto found = fields_.find(key);
    return found == fields_.end() ? std::string_view() : found->second;
  }
  template <class T>
  T number(std::string_view key) const {
    ByteReader in(text(key), name_);
    return in.number<T>("field of a header");
  }

 private:
  const std::string& name_;
  std::map<std::string_view, std::string_view> fields_;
};

class BagRecording final : public ChunkedRecording {
 public:
  explicit BagRecording(DataFile file) : ChunkedRecording(std::move(file), kBagMagic.size()) {
    find_chunks();
    find_topics();
    rewind();
    is_open_ = true;
  }

  std::optional<RecordedMessage> next() override {
    for (;;) {
      while (chunk_at_ < chunk_.size()) {
        if (auto message = next_of_chunk()) return message;
      }
      if (!next_record()) return std::nullopt;
      if (header_->number<std::uint8_t>("op") == kChunk) load_chunk();
    }
  }

 private:
  /// Reads the next record of the chunk; returns nothing where that is no message.
  std::optional<RecordedMessage> next_of_chunk() try {
    ByteReader in(std::string_view(chunk_).substr(chunk_at_), file_.path());
    const Fields header(in.text("header of a record"), file_.path());
    const std::string_view data = in.text("data of a record");
    chunk_at_ = chunk_.size() - in.left();
    if (header.number<std::uint8_t>("op") != kMessage) return std::nullopt;
    const auto found = topic_of_.find(header.number<std::uint32_t>("conn"));
    if (found == topic_of_.end()) return std::nullopt;
    return RecordedMessage{found->second, time_of(header, "time"), data};
  } catch (const Error&) {
    chunk_at_ = chunk_.size();
    throw Error(fmt::format("{}: damaged in the chunk that ends at byte {}", file_.path(), at_));
  }

  /// Seconds, then nanoseconds.
  static std::int64_t time_of(const Fields& header, std::string_view key) {
    const auto time = header.number<std::uint64_t>(key);
    return static_cast<std::int64_t>((time & 0xFFFFFFFFU) * 1000000000U + (time >> 32U));
  }

  /// Goes to the next record that is whole and reads its header. Returns false at the end. Throws Error where records
  /// are damaged; the call after that goes on with the next chunk that is known.
  bool next_record() {
    for (;;) {
      const std::uint64_t at = at_;
      try {
        return read_record();
      } catch (const Error&) {
        const auto later = chunks_.upper_bound(at);
        at_ = later == chunks_.end() ? file_.size() : *later;
        if (is_open_) throw Error(fmt::format("{}: damaged at byte {}, expected a record", file_.path(), at));
      }
    }
  }

  /// Finds the places of chunks by the list at the end of the file, if it has one.
  void find_chunks() try {
    if (!read_record()) return;
    at_ = header_->number<std::uint64_t>("index_pos");
    while (at_ > kBagMagic.size() && read_record()) {
      if (header_->number<std::uint8_t>("op") == kChunkInfo)
        chunks_.insert(header_->number<std::uint64_t>("chunk_pos"));
    }
  } catch (const Error&) {  // whoever reads it record by record hears of it
  }

  bool read_record() {
    const std::string length_bytes = file_.read(at_, sizeof(std::uint32_t));
    if (length_bytes.empty()) return false;
    if (length_bytes.size() < sizeof(std::uint32_t)) return stop_early();
    const auto length = ByteReader(length_bytes, file_.path()).number<std::uint32_t>("length of a header");
    if (length > kMaxHeaderBytes) throw Error(file_.path() + ": a header of too many bytes");
    header_bytes_ = file_.read(at_ + sizeof(std::uint32_t), length + sizeof(std::uint32_t));
    if (header_bytes_.size() < length + sizeof(std::uint32_t)) return stop_early();
    const std::string_view after = std::string_view(header_bytes_).substr(length);
    data_length_ = ByteReader(after, file_.path()).number<std::uint32_t>("length of data");
    data_at_ = at_ + 2 * sizeof(std::uint32_t) + length;
    const std::uint64_t left = file_.size() - data_at_;
    const std::uint64_t begin = std::exchange(at_, data_at_ + std::min<std::uint64_t>(data_length_, left));
    header_.emplace(std::string_view(header_bytes_).substr(0, length), file_.path());
    const bool is_chunk = header_->number<std::uint8_t>("op") == kChunk;
    // The chunk at which rosbag was killed says that it is empty: its sizes are filled in when it is full.
    const bool is_open = is_chunk && data_length_ == 0 && left > 0 && header_->number<std::uint32_t>("size") == 0;
    extent_ = is_open || data_length_ > left ? Packed::cut : Packed::whole;
    if (extent_ == Packed::whole) return true;
    at_ = begin;
    end_early();
    data_length_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(left, kMaxPieceBytes));
    return is_chunk;
  }

  bool stop_early() {
    end_early();
    return false;
  }

  /// Returns how many bytes a record has by what its head says; 0 where that is not whole.
  static std::uint64_t record_length(std::string_view bytes) {
    std::uint64_t length = 0;
    for (int part = 0; part < 2; ++part) {  // header, data
      if (length + sizeof(std::uint32_t) > bytes.size()) return 0;
      const std::string none;
      ByteReader in(bytes.substr(length), none);
      length += sizeof(std::uint32_t) + in.number<std::uint32_t>("length");
    }
    return length;
  }

  void load_chunk() {
    chunk_.clear();
    chunk_at_ = 0;
    const std::string packed = read_piece(data_at_, data_length_);
    const auto stated = header_->number<std::uint32_t>("size");
    const std::size_t size = stated == 0 && extent_ == Packed::cut ? kMaxPieceBytes : stated;
    unpack_chunk(packed, header_->text("compression"), size, extent_);
    if (extent_ == Packed::cut) keep_whole_records(record_length);
  }

  void add_connection(const Fields& header, std::string_view data) {
    const auto id = header.number<std::uint32_t>("conn");
    if (topic_of_.contains(id)) return;
    const Fields connection(data, file_.path());
    topic_of_[id] = topics_.size();
    topics_.push_back(
        {std::string(header.text("topic")), std::string(connection.text("type")), MessageLayout::ros1, 0});
  }

  /// Reads all connections and counts the messages by the index behind each chunk. Chunks are opened only where the
  /// file ends without the connections and the times of chunks that it would have there.
  void find_topics() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> counts;
    std::map<std::uint64_t, std::int64_t> last_of;  // by the places of chunks
    bool chunk_without_index = false;
    rewind();
    for (std::uint64_t at = at_; next_record(); at = at_) {
      const auto op = header_->number<std::uint8_t>("op");
      if (op == kConnection) add_connection(*header_, read_piece(data_at_, data_length_));
      if (op == kChunk) {
        chunk_without_index = true;
        stretches_.push_back({at, 0});
      }
      if (op == kChunkInfo) last_of[header_->number<std::uint64_t>("chunk_pos")] = time_of(*header_, "end_time");
      if (op == kIndex) {
        chunk_without_index = false;
        counts.emplace_back(header_->number<std::uint32_t>("conn"), header_->number<std::uint32_t>("count"));
      }
    }
    const bool timed = std::ranges::all_of(stretches_, [&](const Stretch& one) { return last_of.contains(one.at); });
    const bool complete = !topics_.empty() && !chunk_without_index && timed;
    if (!complete) return open_all_chunks();
    for (Stretch& stretch : stretches_) stretch.last_ns = last_of[stretch.at];
    for (const auto& [connection, count] : counts) {
      const auto found = topic_of_.find(connection);
      if (found != topic_of_.end()) topics_[found->second].messages += count;
    }
  }

  void open_all_chunks() {
    stretches_.clear();
    rewind();
    for (std::uint64_t at = at_; next_record(); at = at_) {
      if (header_->number<std::uint8_t>("op") != kChunk) continue;
      stretches_.push_back({at, 0});
      try {
        load_chunk();
        count_messages();
      } catch (const Error&) {  // `next` says so when it comes there
      }
    }
  }

  void count_messages() {
    ByteReader in(chunk_, file_.path());
    while (in.left() > 0) {
      const Fields header(in.text("header of a record"), file_.path());
      const std::string_view data = in.text("data of a record");
      const auto op = header.number<std::uint8_t>("op");
      if (op == kConnection) add_connection(header, data);
      if (op != kMessage) continue;
      stretches_.back().last_ns = std::max(stretches_.back().last_ns, time_of(header, "time"));
      const auto found = topic_of_.find(header.number<std::uint32_t>("conn"));
      if (found != topic_of_.end()) ++topics_[found->second].messages;
    }
  }

  std::map<std::uint32_t, std::size_t> topic_of_;
  std::set<std::uint64_t> chunks_;  ///< places of them, as far as a list says
  bool is_open_ = false;            ///< whether topics are known
  std::uint64_t data_at_ = 0;
  std::uint32_t data_length_ = 0;
  Packed extent_ = Packed::whole;  ///< of the data of the record found last
  std::string header_bytes_;
  std::optional<Fields> header_;  ///< header of the record found last; its texts lie in header_bytes_
};

}  // namespace

std::unique_ptr<Recording> open_bag(DataFile file) { return std::make_unique<BagRecording>(std::move(file)); }

}  // namespace vesalius

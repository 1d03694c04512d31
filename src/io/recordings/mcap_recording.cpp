#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "io/files/byte_stream.h"
#include "io/recordings/chunked_recording.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/recording_formats.h"

namespace vesalius {
namespace {

MessageLayout layout_of(std::string_view encoding) {
  if (encoding == "cdr") return MessageLayout::cdr;
  if (encoding == "ros1") return MessageLayout::ros1;
  if (encoding == "protobuf") return MessageLayout::protobuf;
  if (encoding == "json") return MessageLayout::json;
  return MessageLayout::other;
}

/// A record in the file: where its content begins and how long it is.
struct Place {
  McapRecord kind{};
  std::uint64_t at = 0, length = 0;
  Packed extent = Packed::whole;
};

class McapRecording final : public ChunkedRecording {
 public:
  explicit McapRecording(DataFile file) : ChunkedRecording(std::move(file), kMcapMagic.size()) {
    find_topics();
    rewind();
  }

  std::optional<RecordedMessage> next() override {
    for (;;) {
      while (chunk_at_ < chunk_.size()) {
        ByteReader in(std::string_view(chunk_).substr(chunk_at_), file_.path());
        chunk_at_ = chunk_.size();  // in case of damage
        const auto kind = static_cast<McapRecord>(in.number<std::uint8_t>("record"));
        const auto length = in.number<std::uint64_t>("length of a record");
        if (length > in.left()) in.fail("a chunk ends within a record");
        const std::string_view content = in.take(length, "record");
        chunk_at_ = chunk_.size() - in.left();
        if (kind == McapRecord::message) {
          if (const auto message = as_message(content)) return message;
        }
      }
      const std::optional<Place> place = next_place();
      if (!place) return std::nullopt;
      if (place->kind == McapRecord::chunk) {
        place->extent == Packed::whole ? load_chunk(*place) : void(try_chunk(*place));
      } else if (place->kind == McapRecord::message) {
        loose_ = read_piece(place->at, place->length);
        if (const auto message = as_message(loose_)) return message;
      }
    }
  }

 private:
  /// Returns the next record of the data section that is in the file as a whole, or the chunk in which that ends;
  /// nothing after it.
  std::optional<Place> next_place() {
    const std::string head = file_.read(at_, kMcapRecordHead);
    if (head.size() < kMcapRecordHead) return stop_early(!head.empty() || !ended_);
    ByteReader in(head, file_.path());
    Place place;
    place.kind = static_cast<McapRecord>(in.number<std::uint8_t>("record"));
    place.length = in.number<std::uint64_t>("length of a record");
    place.at = at_ + kMcapRecordHead;
    if (place.kind == McapRecord::data_end || place.kind == McapRecord::footer) {
      ended_ = true;
      return std::nullopt;
    }
    const std::uint64_t left = file_.size() - place.at;
    if (place.length > left) {
      stop_early(true);
      if (place.kind != McapRecord::chunk) return std::nullopt;
      place.length = std::min<std::uint64_t>(left, kMaxPieceBytes);
      place.extent = Packed::cut;
      return place;
    }
    at_ = place.at + place.length;
    return place;
  }

  std::optional<Place> stop_early(bool is_early) {
    if (is_early) end_early();
    at_ = file_.size();
    return std::nullopt;
  }

  void load_chunk(const Place& place) {
    chunk_.clear();
    chunk_at_ = 0;
    const std::string bytes = read_piece(place.at, place.length);
    ByteReader in(bytes, file_.path());
    in.number<std::uint64_t>("first time of a chunk");
    in.number<std::uint64_t>("last time of a chunk");
    const auto size = in.number<std::uint64_t>("size of a chunk");
    in.number<std::uint32_t>("checksum of a chunk");
    const std::string_view method = in.text("compression of a chunk");
    const auto packed = in.number<std::uint64_t>("compressed size of a chunk");
    const bool is_whole = place.extent == Packed::whole;
    if (packed > in.left() && is_whole) in.fail("a chunk is shorter than it says");
    unpack_chunk(in.take(std::min<std::uint64_t>(packed, in.left()), "chunk"), method, size, place.extent);
    if (!is_whole) keep_whole_records(record_length);
  }

  /// Returns how many bytes a record has by what its head says; 0 where that is not whole.
  static std::uint64_t record_length(std::string_view bytes) {
    if (bytes.size() < kMcapRecordHead) return 0;
    const std::string none;
    const auto length = ByteReader(bytes.substr(1), none).number<std::uint64_t>("length of a record");
    return length > bytes.size() ? length : kMcapRecordHead + length;  // either is too long for the chunk, or right
  }

  /// Returns nothing for a message of a channel that nobody described.
  std::optional<RecordedMessage> as_message(std::string_view content) const {
    ByteReader in(content, file_.path());
    const auto channel = in.number<std::uint16_t>("channel of a message");
    in.number<std::uint32_t>("number of a message");
    RecordedMessage message;
    message.time_ns = static_cast<std::int64_t>(in.number<std::uint64_t>("time of a message"));
    in.number<std::uint64_t>("time of a message");
    message.bytes = in.take(in.left(), "message");
    const auto found = topic_of_.find(channel);
    if (found == topic_of_.end()) return std::nullopt;
    message.topic = found->second;
    return message;
  }

  void add_schema(std::string_view content) {
    ByteReader in(content, file_.path());
    const auto id = in.number<std::uint16_t>("number of a schema");
    schemas_[id] = in.text("name of a schema");
  }

  void add_channel(std::string_view content) {
    ByteReader in(content, file_.path());
    const auto id = in.number<std::uint16_t>("number of a channel");
    const auto schema = in.number<std::uint16_t>("schema of a channel");
    const std::string name(in.text("topic of a channel"));
    const std::string_view encoding = in.text("encoding of a channel");
    if (topic_of_.contains(id)) return;
    topic_of_[id] = topics_.size();
    topics_.push_back({name, short_type(schemas_[schema]), layout_of(encoding), 0});
  }

  /// Learns topics, numbers of messages and what lies where from the summary at the end; where there is none, from all
  /// that is there.
  void find_topics() {
    if (read_summary()) return find_stretches();
    topics_.clear();
    topic_of_.clear();
    rewind();
    while (const std::optional<Place> place = next_place()) {
      add_stretch(*place);
      switch (place->kind) {
        case McapRecord::schema:
          add_schema(read_piece(place->at, place->length));
          break;
        case McapRecord::channel:
          add_channel(read_piece(place->at, place->length));
          break;
        case McapRecord::message:
          count(file_.read(place->at, sizeof(std::uint16_t)));
          break;
        case McapRecord::chunk:
          if (!try_chunk(*place)) break;
          for_records(chunk_, [&](McapRecord kind, std::string_view content) {
            if (kind == McapRecord::schema) add_schema(content);
            if (kind == McapRecord::channel) add_channel(content);
            if (kind == McapRecord::message) count(content);
          });
          break;
        default:
          break;
      }
    }
  }

  /// Finds chunks by the index in the summary, and what that does not list by the heads of records.
  void find_stretches() {
    rewind();
    for (;;) {
      if (const auto listed = listed_.find(at_); listed != listed_.end()) {
        stretches_.push_back({at_, listed->second.last_ns});
        at_ = listed->second.end;
        loose_since_ = 0;
        continue;
      }
      const std::optional<Place> place = next_place();
      if (!place) return;
      add_stretch(*place);
    }
  }

  /// Adds a chunk, or a message outside of chunks, by the time at its beginning.
  void add_stretch(const Place& place) {
    constexpr std::uint64_t kBeforeLast = 8;     // first time of a chunk
    constexpr std::uint64_t kBeforeMessage = 6;  // channel and number of a message
    constexpr std::uint64_t kStretchBytes = std::uint64_t{1} << 20U;
    const bool is_chunk = place.kind == McapRecord::chunk;
    if (!is_chunk && place.kind != McapRecord::message) return;
    const std::uint64_t before = is_chunk ? kBeforeLast : kBeforeMessage;
    if (place.length < before + sizeof(std::uint64_t)) return;  // `next` says so when it comes there
    const std::string bytes = file_.read(place.at + before, sizeof(std::uint64_t));
    const auto last_ns = static_cast<std::int64_t>(ByteReader(bytes, file_.path()).number<std::uint64_t>("time"));
    const std::uint64_t at = place.at - kMcapRecordHead;
    if (!is_chunk && loose_since_ != 0 && at - loose_since_ < kStretchBytes) {
      stretches_.back().last_ns = std::max(stretches_.back().last_ns, last_ns);
      return;
    }
    stretches_.push_back({at, last_ns});
    loose_since_ = is_chunk ? 0 : at;
  }

  void add_chunk_index(std::string_view content) {
    ByteReader in(content, file_.path());
    in.number<std::uint64_t>("first time of a chunk");
    ListedChunk chunk;
    chunk.last_ns = static_cast<std::int64_t>(in.number<std::uint64_t>("last time of a chunk"));
    const auto at = in.number<std::uint64_t>("place of a chunk");
    const auto length = in.number<std::uint64_t>("length of a chunk");
    in.text("places of the indices of a chunk");
    const auto indices = in.number<std::uint64_t>("length of the indices of a chunk");
    if (at >= file_.size() || length == 0 || length > file_.size() - at) return;
    chunk.end = at + length;
    if (indices > file_.size() - chunk.end) return;
    chunk.end += indices;
    listed_[at] = chunk;
  }

  bool try_chunk(const Place& place) {
    try {
      load_chunk(place);
    } catch (const Error&) {
      chunk_.clear();
      return false;  // `next` says so when it comes there
    }
    return true;
  }

  template <class Each>
  void for_records(std::string_view bytes, const Each& each) const {
    ByteReader in(bytes, file_.path());
    while (in.left() >= kMcapRecordHead) {
      const auto kind = static_cast<McapRecord>(in.number<std::uint8_t>("record"));
      const auto length = in.number<std::uint64_t>("length of a record");
      if (length > in.left()) return;
      each(kind, in.take(length, "record"));
    }
  }

  void count(std::string_view message) {
    ByteReader in(message, file_.path());
    const auto found = topic_of_.find(in.number<std::uint16_t>("channel of a message"));
    if (found != topic_of_.end()) ++topics_[found->second].messages;
  }

  /// Takes schemas, channels and numbers of messages from the summary. Returns whether it has channels.
  bool read_summary() {
    constexpr std::uint64_t kFooter = 20;
    const std::uint64_t tail = kMcapRecordHead + kFooter + kMcapMagic.size();
    if (file_.size() < kMcapMagic.size() + tail) return false;
    const std::string end = file_.read(file_.size() - tail, tail);
    if (!end.ends_with(kMcapMagic) || static_cast<McapRecord>(end[0]) != McapRecord::footer) return false;
    ByteReader in(std::string_view(end).substr(kMcapRecordHead), file_.path());
    const auto start = in.number<std::uint64_t>("place of the summary");
    if (start == 0 || start > file_.size() - tail || file_.size() - tail - start > kMaxPieceBytes) return false;
    const std::string summary = file_.read(start, file_.size() - tail - start);
    std::string statistics;
    for_records(summary, [&](McapRecord kind, std::string_view content) {
      if (kind == McapRecord::schema) add_schema(content);
      if (kind == McapRecord::channel) add_channel(content);
      if (kind == McapRecord::statistics) statistics = content;
      if (kind == McapRecord::chunk_index) add_chunk_index(content);
    });
    if (statistics.empty()) {
      for (RecordedTopic& topic : topics_) topic.messages = -1;
    } else {
      count_all(statistics);
    }
    return !topics_.empty();
  }

  void count_all(const std::string& statistics) {
    constexpr std::size_t kBeforeCounts = 42;  // bytes of numbers of messages, schemas, channels and so on, and times
    constexpr std::size_t kEntry = 10;
    ByteReader in(statistics, file_.path());
    in.take(kBeforeCounts, "statistics");
    ByteReader counts(in.text("numbers of messages"), file_.path());
    while (counts.left() >= kEntry) {
      const auto found = topic_of_.find(counts.number<std::uint16_t>("channel"));
      const auto messages = counts.number<std::uint64_t>("number of messages");
      if (found != topic_of_.end()) topics_[found->second].messages = static_cast<std::int64_t>(messages);
    }
  }

  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> topic_of_;
  /// A chunk that the summary lists.
  struct ListedChunk {
    std::int64_t last_ns = 0;
    std::uint64_t end = 0;  ///< behind it and its indices
  };
  std::map<std::uint64_t, ListedChunk> listed_;  ///< by their places
  bool ended_ = false;
  std::string loose_;              ///< a message outside of chunks
  std::uint64_t loose_since_ = 0;  ///< where the last stretch begins if that is of messages outside of chunks, else 0
};

}  // namespace

std::unique_ptr<Recording> open_mcap(DataFile file) { return std::make_unique<McapRecording>(std::move(file)); }

}  // namespace vesalius

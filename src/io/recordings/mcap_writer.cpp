#include "io/recordings/mcap_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "io/files/byte_stream.h"
#include "io/recordings/recording.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{4} << 20U;
constexpr std::uint64_t kChunkTime_ns = 1'000'000'000;
/// Level 1 packs depth nearly as well as higher ones, at several hundred MB a second.
constexpr int kChunkLevel = 1;

std::string record(McapRecord kind, std::string_view content) {
  ByteWriter out;
  out.number(static_cast<std::uint8_t>(kind));
  out.number(static_cast<std::uint64_t>(content.size()));
  out.bytes() += content;
  return std::move(out.bytes());
}

}  // namespace

McapWriter::McapWriter(const std::string& path) : path_(path) {
  file_ = Descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file_.is_open()) {
    throw Error(fmt::format("{}: cannot be created: {}", path, std::generic_category().message(errno)));
  }
  put(kMcapMagic);
  ByteWriter header;
  header.text("ros2");
  header.text("vesalius");
  put(record(McapRecord::header, header.bytes()));
}

McapWriter::~McapWriter() {
  try {
    close();
  } catch (const Error&) {  // whoever wants to know calls close
  }
}

std::uint16_t McapWriter::add_topic(const std::string& topic, const std::string& type, const std::string& definition) {
  Channel channel;
  const auto id = static_cast<std::uint16_t>(channels_.size());
  // 0 stands for no schema.
  const auto [schema, is_new] = schemas_.try_emplace(type, static_cast<std::uint16_t>(schemas_.size() + 1));
  if (is_new) {
    ByteWriter content;
    content.number(schema->second);
    content.text(type);
    content.text("ros2msg");
    content.text(definition);
    channel.schema_record = record(McapRecord::schema, content.bytes());
  }
  ByteWriter content;
  content.number(id);
  content.number(schema->second);
  content.text(topic);
  content.text("cdr");
  content.number(std::uint32_t{0});  // no metadata
  channel.channel_record = record(McapRecord::channel, content.bytes());
  chunk_ += channel.schema_record + channel.channel_record;
  channels_.push_back(std::move(channel));
  return id;
}

void McapWriter::write(std::uint16_t topic, std::int64_t time_ns, std::string_view message) {
  Channel& channel = channels_.at(topic);
  const bool chunk_is_new = std::ranges::all_of(channels_, [](const Channel& c) { return c.index.empty(); });
  if (chunk_is_new) chunk_first_ns_ = chunk_last_ns_ = time_ns;
  if (messages_ == 0) first_ns_ = last_ns_ = time_ns;
  chunk_first_ns_ = std::min(chunk_first_ns_, time_ns);
  chunk_last_ns_ = std::max(chunk_last_ns_, time_ns);
  first_ns_ = std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  channel.index.emplace_back(static_cast<std::uint64_t>(time_ns), chunk_.size());
  ByteWriter content;
  content.number(topic);
  content.number(static_cast<std::uint32_t>(channel.messages));
  content.number(static_cast<std::uint64_t>(time_ns));
  content.number(static_cast<std::uint64_t>(time_ns));
  content.bytes() += message;
  chunk_ += record(McapRecord::message, content.bytes());
  ++channel.messages;
  ++messages_;
  if (chunk_.size() >= kChunkBytes || apart_ns(chunk_last_ns_, chunk_first_ns_) >= kChunkTime_ns) finish_chunk();
}

void McapWriter::finish_chunk() {
  if (chunk_.empty()) return;
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kChunkLevel);
  if (ZSTD_isError(size) != 0) throw Error(fmt::format("{}: zstd: {}", path_, ZSTD_getErrorName(size)));
  ByteWriter content;
  content.number(static_cast<std::uint64_t>(chunk_first_ns_));
  content.number(static_cast<std::uint64_t>(chunk_last_ns_));
  content.number(static_cast<std::uint64_t>(chunk_.size()));
  content.number(std::uint32_t{0});  // no checksum; zstd notices damage
  content.text("zstd");
  content.number(static_cast<std::uint64_t>(size));
  content.bytes().append(packed, 0, size);
  const std::string chunk = record(McapRecord::chunk, content.bytes());

  std::string indices;
  ByteWriter places;  // of the index of each channel
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Channel& channel = channels_[c];
    if (channel.index.empty()) continue;
    places.number(static_cast<std::uint16_t>(c));
    places.number(at_ + chunk.size() + indices.size());
    ByteWriter entries;
    for (const auto& [time, place] : channel.index) {
      entries.number(time);
      entries.number(place);
    }
    ByteWriter index;
    index.number(static_cast<std::uint16_t>(c));
    index.text(entries.bytes());
    indices += record(McapRecord::message_index, index.bytes());
    channel.index.clear();
  }
  ByteWriter chunk_index;
  chunk_index.number(static_cast<std::uint64_t>(chunk_first_ns_));
  chunk_index.number(static_cast<std::uint64_t>(chunk_last_ns_));
  chunk_index.number(at_);
  chunk_index.number(static_cast<std::uint64_t>(chunk.size()));
  chunk_index.text(places.bytes());
  chunk_index.number(static_cast<std::uint64_t>(indices.size()));
  chunk_index.text("zstd");
  chunk_index.number(static_cast<std::uint64_t>(size));
  chunk_index.number(static_cast<std::uint64_t>(chunk_.size()));
  chunk_indices_ += record(McapRecord::chunk_index, chunk_index.bytes());
  ++chunks_;
  put(chunk + indices);
  chunk_.clear();
}

void McapWriter::close() {
  if (std::exchange(closed_, true)) return;
  finish_chunk();
  ByteWriter data_end;
  data_end.number(std::uint32_t{0});  // no checksum
  put(record(McapRecord::data_end, data_end.bytes()));

  const std::uint64_t start = at_;
  ByteWriter offsets;
  const auto group = [&](McapRecord kind, const std::string& records) {
    if (records.empty()) return;
    ByteWriter offset;
    offset.number(static_cast<std::uint8_t>(kind));
    offset.number(at_);
    offset.number(static_cast<std::uint64_t>(records.size()));
    offsets.bytes() += record(McapRecord::summary_offset, offset.bytes());
    put(records);
  };
  std::string schemas, channels;
  ByteWriter counts;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    schemas += channels_[c].schema_record;
    channels += channels_[c].channel_record;
    counts.number(static_cast<std::uint16_t>(c));
    counts.number(channels_[c].messages);
  }
  ByteWriter statistics;
  statistics.number(messages_);
  statistics.number(static_cast<std::uint16_t>(schemas_.size()));
  statistics.number(static_cast<std::uint32_t>(channels_.size()));
  statistics.number(std::uint32_t{0});  // attachments
  statistics.number(std::uint32_t{0});  // metadata
  statistics.number(chunks_);
  statistics.number(static_cast<std::uint64_t>(first_ns_));
  statistics.number(static_cast<std::uint64_t>(last_ns_));
  statistics.text(counts.bytes());
  group(McapRecord::schema, schemas);
  group(McapRecord::channel, channels);
  group(McapRecord::statistics, record(McapRecord::statistics, statistics.bytes()));
  group(McapRecord::chunk_index, chunk_indices_);
  const std::uint64_t offset_start = at_;
  put(offsets.bytes());
  ByteWriter footer;
  footer.number(start);
  footer.number(offset_start);
  footer.number(std::uint32_t{0});  // no checksum
  put(record(McapRecord::footer, footer.bytes()));
  put(kMcapMagic);
  if (const int error = file_.close(); error != 0) {
    throw Error(fmt::format("{}: cannot be written: {}", path_, std::generic_category().message(error)));
  }
}

void McapWriter::put(std::string_view bytes) {
  if (const int error = write_all(file_, bytes); error != 0) {
    throw Error(fmt::format("{}: cannot be written: {}", path_, std::generic_category().message(error)));
  }
  at_ += bytes.size();
}

}  // namespace vesalius

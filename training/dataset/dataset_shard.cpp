#include "dataset/dataset_shard.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "io/files/byte_stream.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

// The line ends in it serve the same purpose as PNG's: a text-mode transfer changes them, so this kind of damage can be
// named.
constexpr std::string_view kMagic("\x89VSD\r\n\x1a\n", 8);
constexpr std::size_t kFixedBytes = 8 + 2 + 2 + 4 + 8 + 8 + 8;
constexpr std::size_t kEntryBytes = 4 + 8;
constexpr std::size_t kChecksumBytes = 8;
static_assert(kMostShardHeaderBytes == kFixedBytes + kMostFramesPerShard * kEntryBytes + kChecksumBytes);

std::size_t header_bytes(std::size_t frames) { return kFixedBytes + frames * kEntryBytes + kChecksumBytes; }

}  // namespace

void check_dataset_version(std::uint64_t version, const std::string& name) {
  if (version == kDatasetVersion) return;
  throw Error(fmt::format("{}: written by {} version: format {}, this program reads {}", name,
                          version > kDatasetVersion ? "a newer" : "another", version, kDatasetVersion));
}

std::uint64_t checksum_of(std::string_view bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

std::string serialise_shard(std::uint64_t dataset_hash, std::uint64_t first, const std::vector<std::string>& frames) {
  std::uint64_t size = header_bytes(frames.size());
  for (const std::string& frame : frames) size += frame.size();
  ByteWriter out;
  out.bytes() += kMagic;
  out.number(static_cast<std::uint16_t>(kDatasetVersion));
  out.number(std::uint16_t{0});
  out.number(static_cast<std::uint32_t>(frames.size()));
  out.number(dataset_hash);
  out.number(first);
  out.number(size);
  for (const std::string& frame : frames) {
    out.number(static_cast<std::uint32_t>(frame.size()));
    out.number(checksum_of(frame));
  }
  out.number(checksum_of(out.bytes()));
  out.bytes().reserve(size);
  for (const std::string& frame : frames) out.bytes() += frame;
  return std::move(out.bytes());
}

ShardTable parse_shard_table(std::string_view beginning, std::uint64_t file_bytes, const std::string& name) {
  if (beginning.substr(0, kMagic.size()) != kMagic.substr(0, beginning.size())) {
    throw Error(name + ": no shard of a labelled dataset");
  }
  if (beginning.size() < kFixedBytes) {
    throw Error(fmt::format("{}: cut: {} bytes of the {} of a shard's header", name, beginning.size(), kFixedBytes));
  }
  ByteReader in(beginning, name);
  in.take(kMagic.size(), "magic");
  const auto version = in.number<std::uint16_t>("version");
  check_dataset_version(version, name);
  const auto reserved = in.number<std::uint16_t>("flags");
  const auto count = in.number<std::uint32_t>("number of frames");
  if (reserved != 0 || count == 0 || count > kMostFramesPerShard) {
    throw Error(fmt::format("{}: damaged header: format {}, {} frames", name, version, count));
  }
  ShardTable table;
  table.dataset_hash = in.number<std::uint64_t>("dataset");
  table.first = in.number<std::uint64_t>("first frame");
  const auto size = in.number<std::uint64_t>("size");
  const std::size_t header = header_bytes(count);
  if (file_bytes < size || beginning.size() < header) {
    throw Error(fmt::format("{}: cut: {} of {} bytes", name, file_bytes, std::max<std::uint64_t>(size, header)));
  }
  std::uint64_t offset = header;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto bytes = in.number<std::uint32_t>("table");
    table.entries.push_back({offset, bytes, in.number<std::uint64_t>("table")});
    offset += bytes;
  }
  const bool whole = in.number<std::uint64_t>("checksum") == checksum_of(beginning.substr(0, header - kChecksumBytes));
  if (!whole || offset != size || file_bytes != size) throw Error(name + ": damaged header: its checksum does not fit");
  return table;
}

ShardFile::ShardFile(std::string path) : path_(std::move(path)), file_(open_regular_file(path_)) {}

std::string ShardFile::read(std::uint64_t offset, std::size_t count) const {
  std::string bytes(count, '\0');
  std::size_t done = 0;
  while (done < count) {
    const ssize_t n = ::pread(file_.descriptor.get(), bytes.data() + done, count - done, off_t(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(fmt::format("{}: cannot be read: {}", path_, std::generic_category().message(errno)));
    if (n == 0) throw Error(fmt::format("{}: cut: ends at byte {}", path_, offset + done));
    done += n;
  }
  return bytes;
}

ShardTable ShardFile::table() const {
  return parse_shard_table(read(0, std::min<std::uint64_t>(file_.size, kMostShardHeaderBytes)), file_.size, path_);
}

std::string ShardFile::frame(const ShardEntry& entry, std::uint64_t index) const {
  if (entry.offset > file_.size || entry.bytes > file_.size - entry.offset) {
    throw Error(fmt::format("{}: frame {}: cut: the file has only {} bytes", path_, index, file_.size));
  }
  std::string bytes = read(entry.offset, entry.bytes);
  if (checksum_of(bytes) != entry.checksum) {
    throw Error(fmt::format("{}: frame {}: damaged: its checksum does not fit", path_, index));
  }
  return bytes;
}

}  // namespace vesalius

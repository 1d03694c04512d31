#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/data_file.h"
#include "io/recordings/recording.h"

namespace vesalius {

/// Most bytes that one compressed piece of a recording may hold.
inline constexpr std::size_t kMaxPieceBytes = std::size_t{1} << 28;

/// Counts what a file unpacks to, so that a small one does not keep a machine busy.
class UnpackedBytes {
 public:
  explicit UnpackedBytes(std::uint64_t file_bytes) : most_(2 * kMaxPieceBytes + kMostTimes * file_bytes) {}
  /// Adds a piece that is about to be unpacked. Throws Error naming `name` where it is too much.
  void add(std::uint64_t bytes, const std::string& name);
  void reset() { sum_ = 0; }

 private:
  /// Pictures of real sensors are packed to a tenth, chunks of rendered ones without noise to a hundredth.
  static constexpr std::uint64_t kMostTimes = 200;
  std::uint64_t most_, sum_ = 0;
};

/// Whether packed bytes are all that there were, or the beginning of them.
enum class Packed { whole, cut };

/// Decompresses `packed`, whose `method` is "" or "none", "zstd", "lz4" (frames) or "bz2", into exactly `size` bytes;
/// of what is cut into as many as come, `size` at most. Throws Error naming `name` if the method is another one, `size`
/// is more than kMaxPieceBytes, or the data is damaged or of another size. Memory grows with what comes out, not with
/// what is stated.
std::string decompress(std::string_view packed, std::string_view method, std::size_t size, const std::string& name,
                       Packed extent = Packed::whole);

/// Returns the size that the header of a zstd frame states. Throws Error naming `name` if it states none.
std::size_t stated_zstd_size(std::string_view packed, const std::string& name);

/// A recording whose records follow each other in a file, most of them packed into chunks.
class ChunkedRecording : public Recording {
 public:
  const std::vector<RecordedTopic>& topics() const override { return topics_; }
  void rewind() override {
    at_ = first_;
    chunk_.clear();
    chunk_at_ = 0;
    unpacked_.reset();
  }
  std::optional<std::int64_t> last_ns() const override {
    if (stretches_.empty()) return std::nullopt;
    return std::ranges::max_element(stretches_, {}, &Stretch::last_ns)->last_ns;
  }
  bool seek(std::int64_t time_ns) override {
    rewind();
    const auto is_late = [time_ns](const Stretch& stretch) { return stretch.last_ns >= time_ns; };
    auto found = std::ranges::find_if(stretches_, is_late);
    if (found == stretches_.end() && found != stretches_.begin()) --found;
    if (found == stretches_.begin()) return false;
    at_ = found->at;
    return true;
  }
  std::vector<std::string> notes() const override { return notes_; }

 protected:
  /// A part of the file, from a record on: a chunk, or messages outside of chunks.
  struct Stretch {
    std::uint64_t at = 0;
    std::int64_t last_ns = 0;  ///< when its latest message was recorded
  };

  /// The first record stands at byte `first`.
  ChunkedRecording(DataFile file, std::uint64_t first)
      : file_(std::move(file)), at_(first), first_(first), unpacked_(file_.size()) {}

  /// Reads a record or its data. Throws Error where it is longer than any may be.
  std::string read_piece(std::uint64_t at, std::uint64_t length) const;

  /// Makes `packed` the chunk that is read next. Throws Error where it is damaged, or where all chunks together are far
  /// more than the file; there are none after it then.
  void unpack_chunk(std::string_view packed, std::string_view method, std::size_t size, Packed extent);

  /// Removes what follows the whole records of the chunk. `length_at` tells how long the record at a place is, 0 where
  /// its head is not whole.
  template <class LengthAt>
  void keep_whole_records(const LengthAt& length_at) {
    std::size_t end = 0;
    for (;;) {
      const std::uint64_t length = length_at(std::string_view(chunk_).substr(end));
      if (length == 0 || length > chunk_.size() - end) break;
      end += length;
    }
    chunk_.resize(end);
  }

  /// Notes that the file ends within a record and goes to its end.
  void end_early() {
    if (notes_.empty()) {
      notes_.push_back(
          fmt::format("{}: cut short at byte {}; the whole messages before it are read", file_.path(), at_));
    }
    at_ = file_.size();
  }

  DataFile file_;
  std::vector<RecordedTopic> topics_;
  std::uint64_t at_;  ///< place of the next record in the file
  std::string chunk_;
  std::size_t chunk_at_ = 0;        ///< place of the next record in the chunk
  std::vector<Stretch> stretches_;  ///< all with messages, in the order of the file

 private:
  std::uint64_t first_;
  UnpackedBytes unpacked_;
  std::vector<std::string> notes_;
};

}  // namespace vesalius

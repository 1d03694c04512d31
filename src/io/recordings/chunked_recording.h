#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/files/data_file.h"
#include "io/recordings/recording.h"

namespace vesalius {

/// A recording whose records follow each other in a file, most of them packed into chunks.
class ChunkedRecording : public Recording {
 public:
  const std::vector<RecordedTopic>& topics() const override { return topics_; }
  void rewind() override {
    at_ = first_;
    chunk_.clear();
    chunk_at_ = 0;
  }
  std::vector<std::string> notes() const override { return notes_; }

 protected:
  /// The first record stands at byte `first`.
  ChunkedRecording(DataFile file, std::uint64_t first) : file_(std::move(file)), at_(first), first_(first) {}

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
  std::uint64_t at_;  ///< of the next record in the file
  std::string chunk_;
  std::size_t chunk_at_ = 0;  ///< of the next record in the chunk

 private:
  std::uint64_t first_;
  std::vector<std::string> notes_;
};

}  // namespace vesalius

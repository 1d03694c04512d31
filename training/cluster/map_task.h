#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <ostream>
#include <string>

#include "cluster/store.h"
#include "train/samples/huge_buffer.h"
#include "train/samples/training_set.h"
#include "vesalius/frame.h"

namespace vesalius {

struct Record;
struct TrainJob;

/// What a task finds on its machine.
struct TaskContext {
  using ReadFrame = std::function<LabelledFrame(std::uint64_t)>;

  Store& store;
  std::string job;  ///< name of the job
  /// Opens the frames that TrainJob::source names; any thread may call what it returns with a frame's number.
  std::function<ReadFrame(const std::string& source)> open_source = {};
  /// Told of progress: adds to a counter.
  std::function<void(const std::string& counter, std::uint64_t more)> count = {};
  /// Bytes of values that are held at a time.
  std::size_t row_bytes = std::size_t{128} << 20U;
};

/// Runs a map task: does what the job says with each line of `in`, which names a shard or a subtree task (after the
/// last tab, since some engines put a position before), and writes records. Throws Error for a line that is neither,
/// and naming what is damaged or cannot be read or written.
void run_map_task(const TaskContext& context, std::istream& in, std::ostream& out);

/// Writes a shard's set where the job says, and returns the record that a task of kPrepare would write. `hard` is the
/// number of hard negatives in it.
Record store_set(Store& store, const TrainJob& job, const TrainingSet& set, std::size_t shard, std::uint64_t hard);

/// Returns a set's frames and samples as bytes with a checksum (docs/formats.md).
std::string training_set_bytes(const TrainingSet& set);

/// Adds what such bytes hold behind what `contents` has, whose frames stay where they lie in the buffer. Throws Error
/// naming `name` if the bytes are damaged or of another version.
void append_training_set(HugeBuffer buffer, const std::string& name, TrainingSet::Contents& contents);

}  // namespace vesalius

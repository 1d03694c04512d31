#pragma once

#include <istream>
#include <ostream>
#include <string>
#include <vector>

#include "cluster/map_task.h"

namespace vesalius {

/// Merges neighbouring records of one key, as combiners of map tasks do. Messages are merged up to some MiB, so memory
/// is bounded. Throws Error for a damaged record.
void run_combine_task(std::istream& in, std::ostream& out);

/// Divides records among the files `into`.0, `into`.1 ..., merged before if `merge`. Files appear when all are written.
/// Throws Error naming a file that cannot be written.
void run_partition_task(std::istream& in, const std::string& into, int parts, bool merge);

/// Divides records among `parts` reducers by their keys. Returns the part.
int part_of(const std::string& key, int parts);

/// Runs a reduce task: reads records in which those of a key are neighbours, and writes one record for each. It holds
/// the messages of one key at a time: of a node at most `split_pixels` rows of a block of candidates, of leaves a block
/// of them, whatever the number of shards. Throws Error if a message is damaged or missing.
void run_reduce_task(const TaskContext& context, std::istream& in, std::ostream& out);

}  // namespace vesalius

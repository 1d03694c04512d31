#pragma once

#include <cstddef>
#include <vector>

#include "io/files/byte_stream.h"
#include "vesalius/forest.h"

// The trees of a model file (docs/formats.md). Reading throws Error for bytes that cannot be decoded. Whether the trees
// make sense is left to check(Forest).
namespace vesalius {

/// Limit on the number of nodes, and on that of leaves, over all trees of a file. Without it a small file that
/// compresses well could ask for any amount of memory. It is about six times a large forest; reading that many takes
/// 0.5 GB.
inline constexpr std::size_t kMaxModelNodes = std::size_t{1} << 23U;

/// Appends trees, which must be consistent. A node and a leaf take about 8 bytes together if both are in depth-first
/// order, as trainers write them; any other order is kept too, but takes more bytes. Throws Error beyond
/// kMaxModelNodes.
void write_trees(ByteWriter& out, const std::vector<Tree>& trees);
std::vector<Tree> read_trees(ByteReader& in);

/// Writes the logits of all leaves, by columns: first the first one of every leaf.
void write_logits(ByteWriter& out, const std::vector<Tree>& trees);
/// Reads `size` logits for each leaf of trees that read_trees returned.
void read_logits(ByteReader& in, std::size_t size, std::vector<Tree>& trees);

}  // namespace vesalius

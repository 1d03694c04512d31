#pragma once

#include <cstddef>
#include <vector>

#include "io/files/byte_stream.h"
#include "vesalius/forest/forest.h"

// The trees of a model file (docs/formats.md). Reading throws Error for bytes that are none; what the trees mean is
// left to check(Forest).
namespace vesalius {

/// Most nodes, and most leaves, of all trees of a file: what compresses well could else ask for any amount of memory.
/// About six times a large forest; reading that many takes 0.5 GB.
inline constexpr std::size_t kMaxModelNodes = std::size_t{1} << 23U;

/// Appends consistent trees. Trees whose nodes and leaves are in depth-first order, as trainers make them,
/// take about 8 bytes for a node and a leaf; in any other order they come back just as well, from more bytes. Throws
/// Error beyond kMaxModelNodes.
void write_trees(ByteWriter& out, const std::vector<Tree>& trees);
std::vector<Tree> read_trees(ByteReader& in);

}  // namespace vesalius

#pragma once

#include "io/files/byte_stream.h"
#include "vesalius/boosted_trees.h"
#include "vesalius/forest.h"
#include "vesalius/forest/facing.h"
#include "vesalius/network/network.h"

// What the sections of a model file hold (docs/formats.md). Reading throws Error for bytes that cannot be decoded;
// whether they make sense is left to check(Model).
namespace vesalius {

inline constexpr unsigned kForestBackground = 1;  ///< the class after the last part is the background
inline constexpr unsigned kForestLogits = 2;      ///< leaves were learned jointly and have logits

void write_forest(ByteWriter& out, const Forest& forest);
/// Reads what follows the flags into a forest that has its body already.
void read_forest(ByteReader& in, unsigned flags, Forest& forest);

void write_network(ByteWriter& out, const Network& network);
/// `centres`: whether the layer of centres stands there, as since version 2 of the section.
Network read_network(ByteReader& in, bool centres = true);
/// Reads what training a network leaves (docs/formats.md), for a body of so many parts. Throws Error for a file that
/// cannot be read or whose network is inconsistent (check(Network)).
Network load_network(const std::string& path, int parts);

void write_headings(ByteWriter& out, const FacingModel& headings);
FacingModel read_headings(ByteReader& in, int headings, int parts);

void write_boosted(ByteWriter& out, const BoostedTrees& boosted);
/// `names`: whether the names of what they ask for come first.
BoostedTrees read_boosted(ByteReader& in, const char* what, bool names = true);

}  // namespace vesalius

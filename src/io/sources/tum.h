#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/sources/list_source.h"

namespace vesalius {

/// One line of a TUM list (depth.txt, rgb.txt).
struct TumEntry {
  double time_s = 0.0;
  std::string stamp;  ///< the time as written
  std::string file;   ///< relative to the list's folder
};

/// Reads lines of the form "timestamp file". Empty lines and those that begin with # are skipped. The entries are
/// sorted by time. Throws Error naming `name` and the line if a line has another form or repeats the time of an earlier
/// one.
std::vector<TumEntry> parse_tum_list(std::string_view text, const std::string& name);

/// Pairs depth with colour as the benchmark's associate tool does: of all pairs less than `max_difference_s` apart the
/// closest is taken first, and each entry is in one pair only. Both lists must be sorted by time. Returns for each
/// entry of `depth` the index in `colour`, or -1. Takes O(n log n) time.
std::vector<int> associate(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour,
                           double max_difference_s);

/// Lists a folder in the layout of the TUM RGB-D benchmark: depth.txt and, if there is colour, rgb.txt.
FrameList list_tum(const std::string& folder, const SourceOptions& options);

}  // namespace vesalius

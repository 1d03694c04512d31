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

/// Lines "timestamp file"; empty lines and those after # are skipped. The entries are in the order of their times.
/// Throws Error naming `name` and the line for one of another form or a time that an earlier line has.
std::vector<TumEntry> parse_tum_list(std::string_view text, const std::string& name);

/// Partners of two lists in order of time, as the benchmark's associate tool finds them: of all pairs less than
/// `max_difference_s` apart, the closest first, each entry in one pair only. For each of `depth` the index in `colour`,
/// -1 = none. O(n log n).
std::vector<int> associate(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour,
                           double max_difference_s);

/// A folder in the layout of the TUM RGB-D benchmark: depth.txt, and rgb.txt or no colour.
FrameList list_tum(const std::string& folder, const SourceOptions& options);

}  // namespace vesalius

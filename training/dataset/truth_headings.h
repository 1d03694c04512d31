#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "dataset/truth_csv.h"
#include "dataset/truth_source.h"

namespace vesalius {

/// Reads a cell with front, side, back or nothing. Throws Error naming the line for anything else.
std::optional<Heading> heading_in(const CsvTable& table, std::size_t row, std::size_t column);

/// The side that people turn to the camera, as a table beside the frames says: columns `set`, `frame` and `heading`.
class HeadingTable {
 public:
  /// Throws Error naming the line of a table that cannot be used, and if a frame comes twice.
  static HeadingTable parse(const CsvTable& table);
  static HeadingTable read(const std::string& path) { return parse(CsvTable::read(path)); }

  std::optional<Heading> of(const std::string& set, const std::string& frame) const;

 private:
  std::map<std::pair<std::string, std::string>, Heading> headings_;  ///< keys: set and frame
};

/// Returns the same frames with the headings that the table has for the set; others keep their own.
std::unique_ptr<TruthSource> with_headings(std::unique_ptr<TruthSource> frames, HeadingTable headings, std::string set);

}  // namespace vesalius

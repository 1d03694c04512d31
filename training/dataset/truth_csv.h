#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/frame_truth.h"

namespace vesalius {

/// A table of comma-separated values with a header line. Cells contain neither commas nor quotes.
class CsvTable {
 public:
  /// Parses a table; `name` is used as the path in errors. Throws Error with the line if a row has not as many cells as
  /// the header, and if the header names a column twice.
  static CsvTable parse(std::string_view text, std::string name);
  static CsvTable read(const std::string& path);

  std::size_t rows() const { return rows_.size(); }
  bool has(std::string_view column) const;
  /// Returns the index of a column. Throws Error naming it if the table has no such column.
  std::size_t column(std::string_view name) const;
  const std::string& cell(std::size_t row, std::size_t column) const { return rows_[row].cells[column]; }
  /// These convert a cell. They throw Error with line and column if it is not a finite number or lies outside `low` to
  /// `high`.
  double number(std::size_t row, std::size_t column) const;
  int integer(std::size_t row, std::size_t column, int low, int high) const;
  /// Returns e.g. "frames.csv:12" for messages.
  std::string place(std::size_t row) const;
  /// Throws Error naming line, column and the cell's text.
  [[noreturn]] void fail(std::size_t row, std::size_t column, const std::string& expected) const;

 private:
  struct Row {
    int line = 0;
    std::vector<std::string> cells;
  };

  std::string name_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

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

}  // namespace vesalius

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// A table of comma-separated values with a header line; cells hold neither commas nor quotes.
class CsvTable {
 public:
  /// `name` stands for the path in errors. Throws Error with the line for one that has not as many cells as the header,
  /// and for a header that names a column twice.
  static CsvTable parse(std::string_view text, std::string name);
  static CsvTable read(const std::string& path);

  std::size_t rows() const { return rows_.size(); }
  bool has(std::string_view column) const;
  /// Index of a column. Throws Error naming it where the table lacks it.
  std::size_t column(std::string_view name) const;
  const std::string& cell(std::size_t row, std::size_t column) const { return rows_[row].cells[column]; }
  /// Throw Error with line and column for what is no (finite) number, and for one outside `low` to `high`.
  double number(std::size_t row, std::size_t column) const;
  int integer(std::size_t row, std::size_t column, int low, int high) const;
  /// "frames.csv:12", for messages.
  std::string place(std::size_t row) const;

 private:
  struct Row {
    int line = 0;
    std::vector<std::string> cells;
  };
  [[noreturn]] void fail(std::size_t row, std::size_t column, const std::string& expected) const;

  std::string name_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

}  // namespace vesalius

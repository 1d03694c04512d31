#include "dataset/truth_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kMaxCsvBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxShown = 60;

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

/// Makes untrusted text fit for a one-line message.
std::string shown(std::string_view text) {
  std::string out(text.substr(0, kMaxShown));
  std::ranges::replace_if(
      out, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return out;
}

}  // namespace

CsvTable CsvTable::parse(std::string_view text, std::string name) {
  CsvTable table;
  table.name_ = std::move(name);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  int line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    std::vector<std::string> cells = split(line);
    if (table.header_.empty()) {
      table.header_ = std::move(cells);
    } else if (cells.size() != table.header_.size()) {
      throw Error(fmt::format("{}:{}: {} cells, expected {} as in the header", table.name_, line_number, cells.size(),
                              table.header_.size()));
    } else {
      table.rows_.push_back({line_number, std::move(cells)});
    }
  }
  if (table.header_.empty()) throw Error(table.name_ + ": empty, expected a header with the columns' names");
  for (const std::string& column : table.header_) {
    if (std::ranges::count(table.header_, column) == 1) continue;
    throw Error(fmt::format("{}: the column \"{}\" comes twice", table.name_, shown(column)));
  }
  return table;
}

CsvTable CsvTable::read(const std::string& path) { return parse(read_file(path, kMaxCsvBytes), path); }

bool CsvTable::has(std::string_view column) const { return std::ranges::find(header_, column) != header_.end(); }

std::size_t CsvTable::column(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) throw Error(fmt::format("{}: no column \"{}\" in the header", name_, name));
  return found - header_.begin();
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& text = cell(row, column);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) {
    fail(row, column, "a finite number");
  }
  return value;
}

int CsvTable::integer(std::size_t row, std::size_t column, int low, int high) const {
  const std::string& text = cell(row, column);
  int value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value < low || value > high) {
    fail(row, column, fmt::format("a whole number from {} to {}", low, high));
  }
  return value;
}

std::string CsvTable::place(std::size_t row) const { return fmt::format("{}:{}", name_, rows_[row].line); }

void CsvTable::fail(std::size_t row, std::size_t column, const std::string& expected) const {
  throw Error(fmt::format("{}: column {}: \"{}\", expected {}", place(row), header_[column], shown(cell(row, column)),
                          expected));
}

std::optional<Heading> heading_in(const CsvTable& table, std::size_t row, std::size_t column) {
  const std::string& word = table.cell(row, column);
  if (word.empty()) return std::nullopt;
  for (const Heading heading : {Heading::front, Heading::side, Heading::back}) {
    if (word == to_string(heading)) return heading;
  }
  table.fail(row, column, "front, side, back or nothing");
}

HeadingTable HeadingTable::parse(const CsvTable& table) {
  const std::size_t set = table.column("set"), frame = table.column("frame"), heading = table.column("heading");
  HeadingTable headings;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto known = heading_in(table, row, heading);
    if (!known) continue;
    if (!headings.headings_.emplace(std::pair(table.cell(row, set), table.cell(row, frame)), *known).second) {
      throw Error(fmt::format("{}: frame {} of {} comes twice", table.place(row), table.cell(row, frame),
                              table.cell(row, set)));
    }
  }
  return headings;
}

std::optional<Heading> HeadingTable::of(const std::string& set, const std::string& frame) const {
  const auto found = headings_.find({set, frame});
  return found != headings_.end() ? std::optional(found->second) : std::nullopt;
}

}  // namespace vesalius

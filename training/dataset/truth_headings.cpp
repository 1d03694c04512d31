#include "dataset/truth_headings.h"

#include <fmt/format.h>

#include <utility>

#include "dataset/mapped_truth.h"
#include "vesalius/base/error.h"

namespace vesalius {
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

std::unique_ptr<TruthSource> with_headings(std::unique_ptr<TruthSource> frames, HeadingTable headings,
                                           std::string set) {
  return mapped(std::move(frames), [headings = std::move(headings), set = std::move(set)](TrueFrame frame) {
    if (const auto heading = headings.of(set, frame.frame.name)) frame.truth.heading = heading;
    return frame;
  });
}

}  // namespace vesalius

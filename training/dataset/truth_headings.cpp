#include "dataset/truth_headings.h"

#include <fmt/format.h>

#include <utility>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// The frames of a source with headings of a table.
class HeadedTruth final : public TruthSource {
 public:
  HeadedTruth(std::unique_ptr<TruthSource> frames, HeadingTable headings, std::string set)
      : frames_(std::move(frames)), headings_(std::move(headings)), set_(std::move(set)) {}

  std::optional<TrueFrame> next() override {
    std::optional<TrueFrame> frame = frames_->next();
    if (!frame) return frame;
    if (const auto heading = headings_.of(set_, frame->frame.name)) frame->truth.heading = heading;
    return frame;
  }
  void leave_sequence() override { frames_->leave_sequence(); }
  int size() const override { return frames_->size(); }
  std::vector<std::string> notes() const override { return frames_->notes(); }
  std::vector<std::string> part_names() const override { return frames_->part_names(); }

 private:
  std::unique_ptr<TruthSource> frames_;
  HeadingTable headings_;
  std::string set_;
};

}  // namespace

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
  return std::make_unique<HeadedTruth>(std::move(frames), std::move(headings), std::move(set));
}

}  // namespace vesalius

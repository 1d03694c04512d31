#include "pixel_score.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "vesalius/forest/label_pixels.h"

namespace vesalius {
namespace {

struct Tally {
  std::vector<std::int64_t> right, seen;
  std::int64_t body = 0, called_body = 0, both = 0;
};

void count(const Posteriors& posteriors, const LabelledFrame& frame, int part_count, Tally& tally) {
  for (int v = 0; v < posteriors.height; ++v) {
    for (int u = 0; u < posteriors.width; ++u) {
      if (frame.frame.depth(u, v) == 0) continue;
      const std::uint16_t* sums = posteriors.at(u, v);
      const auto part = static_cast<std::size_t>(std::max_element(sums, sums + part_count) - sums);
      const bool called_body = posteriors.classes == part_count || sums[part] > sums[part_count];
      const std::uint8_t truth = frame.labels(u, v);
      tally.called_body += called_body;
      if (truth == kBackground) continue;
      ++tally.body;
      tally.both += called_body;
      ++tally.seen[truth];
      tally.right[truth] += part == truth;
    }
  }
}

double ratio(std::int64_t a, std::int64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

}  // namespace

PixelScore score_pixels(const Forest& forest, const std::vector<LabelledFrame>& frames) {
  const ForestLabeller labeller(forest);
  const auto parts = static_cast<std::size_t>(forest.body.part_count());
  Tally tally{std::vector<std::int64_t>(parts, 0), std::vector<std::int64_t>(parts, 0)};
  for (const LabelledFrame& frame : frames) {
    count(labeller.label(frame.frame), frame, forest.body.part_count(), tally);
  }
  PixelScore score;
  int in_view = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    score.recall_by_part.push_back(ratio(tally.right[p], tally.seen[p]));
    if (tally.seen[p] == 0) continue;
    score.part_recall += score.recall_by_part[p];
    ++in_view;
  }
  score.part_recall /= in_view;
  score.body_recall = ratio(tally.both, tally.body);
  score.body_precision = ratio(tally.both, tally.called_body);
  return score;
}

}  // namespace vesalius

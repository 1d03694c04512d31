#include "vesalius/trace.h"

#include <utility>

namespace vesalius {

void enlarge(const GridGuide& guide, Person& person) {
  const Box box = guide.whole_box(person.box);
  Mask mask(guide.width(), guide.height(), 0);
  LabelImage labels(guide.width(), guide.height(), kBackground);
  // Whoever is not in the mask has no label.
  guide.each(
      box, [&](int column, int row) { return person.mask(column, row) != 0; },
      [&](int u, int v, int column, int row) {
        mask(u, v) = person.mask(column, row);
        labels(u, v) = person.labels(column, row);
      });
  person.box = bounding_box(mask, box);
  person.mask = std::move(mask);
  person.labels = std::move(labels);
}

void enlarge(const GridGuide& guide, Trace& trace) {
  trace.raw_labels = guide.enlarge(trace.raw_labels, kBackground);
  trace.labels = guide.enlarge(trace.labels, kBackground);
  trace.flat = guide.enlarge(trace.flat, std::uint8_t{0});
  if (!trace.inside.empty()) trace.inside = guide.enlarge(trace.inside, kBackground);
  trace.clusters.index = guide.enlarge(trace.clusters.index, -1);
  for (PartCluster& cluster : trace.clusters.items) cluster.first_pixel = guide.whole_index(cluster.first_pixel);
  for (Trace::Candidate& candidate : trace.candidates) {
    candidate.grown = guide.enlarge(candidate.grown, std::uint8_t{0});
    candidate.labels = guide.enlarge(candidate.labels, kBackground);
  }
}

}  // namespace vesalius

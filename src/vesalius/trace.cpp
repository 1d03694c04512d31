#include "vesalius/trace.h"

namespace vesalius {

void enlarge(const GridGuide& guide, Person& person) {
  person.mask = guide.enlarge(person.mask, std::uint8_t{0}, person.box);
  person.labels = guide.enlarge(person.labels, kBackground, person.box);
  person.box = bounding_box(person.mask);
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

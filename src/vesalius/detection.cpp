#include "vesalius/detection.h"

#include <cmath>
#include <string>
#include <utility>

#include "vesalius/base/error.h"

namespace vesalius {

float shared_pixels(const Mask& a, const Mask& b) {
  long both = 0, either = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] != 0 && b[i] != 0 ? 1 : 0;
    either += a[i] != 0 || b[i] != 0 ? 1 : 0;
  }
  return either > 0 ? float(both) / float(either) : 0.F;
}

void check(const Prior& prior, const Frame& frame) {
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Prior::KnownPerson& known = prior.people[i];
    for (const auto& [name, number] : {std::pair{"odds", known.odds}, std::pair{"size", known.size}}) {
      if (std::isfinite(number) && number > 0.F) continue;
      throw Error("prior: the " + std::string(name) + " of person " + std::to_string(i) +
                  ": expected a number above 0, found " + std::to_string(number));
    }
    const Mask& mask = known.mask;
    if (mask.empty() || mask.same_size(frame.depth)) continue;
    throw Error("prior: the mask of person " + std::to_string(i) + " has " + std::to_string(mask.width()) + "x" +
                std::to_string(mask.height()) + " pixels, expected the frame's " + std::to_string(frame.depth.width()) +
                "x" + std::to_string(frame.depth.height()));
  }
}

Prior every_nth(const Prior& prior, int step) {
  Prior coarse = prior;
  for (Prior::KnownPerson& known : coarse.people) known.mask = every_nth(known.mask, step);
  return coarse;
}

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

Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height) {
  Image<std::uint8_t> map(width, height, kBackground);
  for (std::size_t p = 0; p < people.size() && p < kBackground; ++p) {
    if (people[p].mask.empty()) continue;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (people[p].mask[i] != 0) map[i] = static_cast<std::uint8_t>(p);
    }
  }
  return map;
}

LabelImage part_label_map(const std::vector<Person>& people, int width, int height) {
  LabelImage map(width, height, kBackground);
  for (const Person& person : people) {
    if (person.mask.empty()) continue;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (person.mask[i] != 0) map[i] = person.labels[i];
    }
  }
  return map;
}

}  // namespace vesalius

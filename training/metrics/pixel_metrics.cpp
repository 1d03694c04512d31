#include "metrics/pixel_metrics.h"

#include <fmt/format.h>

#include "vesalius/error.h"

namespace vesalius {
namespace {

void add_term(MetricTerms& terms, MetricId id, std::uint64_t numerator, std::uint64_t denominator) {
  if (denominator == 0) return;
  terms.push_back({std::move(id), double(numerator), double(denominator)});
}

/// The numbers of pixels of both and of either, for all parts together.
struct Overlap {
  std::uint64_t both = 0;
  std::uint64_t either = 0;
};

Overlap person_overlap(const PixelConfusion& confusion) {
  Overlap overlap;
  const int background = confusion.parts();
  for (int truth = 0; truth <= background; ++truth) {
    for (int given = 0; given <= background; ++given) {
      const std::uint64_t count = confusion.count(truth, given);
      if (truth != background && given != background) overlap.both += count;
      if (truth != background || given != background) overlap.either += count;
    }
  }
  return overlap;
}

Overlap background_overlap(const PixelConfusion& confusion) {
  Overlap overlap;
  const int background = confusion.parts();
  overlap.both = confusion.count(background, background);
  for (int other = 0; other < background; ++other) {
    overlap.either += confusion.count(background, other) + confusion.count(other, background);
  }
  overlap.either += overlap.both;
  return overlap;
}

}  // namespace

PixelConfusion::PixelConfusion(int parts) : parts_(parts), counts_((parts + 1) * (parts + 1)) {}

void PixelConfusion::add(const LabelImage& truth, const LabelImage& given, const DepthImage& depth) {
  if (!truth.same_size(given) || !truth.same_size(depth)) {
    throw Error(fmt::format("labels of {}x{} and {}x{} pixels for a depth of {}x{}, expected one size", truth.width(),
                            truth.height(), given.width(), given.height(), depth.width(), depth.height()));
  }
  const auto class_of = [this](std::uint8_t label) {
    if (label == kBackground) return parts_;
    if (label >= parts_) throw Error(fmt::format("label {}, expected one of {} parts", label, parts_));
    return int(label);
  };
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] != 0) ++counts_[index(class_of(truth[i]), class_of(given[i]))];
  }
}

void PixelConfusion::add(const PixelConfusion& other) {
  if (other.parts_ != parts_) throw Error("confusions of different bodies");
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
}

std::uint64_t PixelConfusion::of_truth(int truth) const {
  std::uint64_t sum = 0;
  for (int given = 0; given <= parts_; ++given) sum += count(truth, given);
  return sum;
}

double mask_iou(const Mask& a, const Mask& b, const DepthImage& depth) {
  std::uint64_t both = 0;
  std::uint64_t either = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    both += a[i] != 0 && b[i] != 0 ? 1U : 0U;
    either += a[i] != 0 || b[i] != 0 ? 1U : 0U;
  }
  return either > 0 ? double(both) / double(either) : 0.0;
}

MetricTerms pixel_terms(const PixelConfusion& with_background, const PixelConfusion& inside, const BodyModel& body) {
  MetricTerms terms;
  const Overlap person = person_overlap(with_background);
  const Overlap background = background_overlap(with_background);
  add_term(terms, Metric::pixel_person_iou, person.both, person.either);
  add_term(terms, Metric::pixel_background_iou, background.both, background.either);
  for (int part = 0; part < body.part_count(); ++part) {
    const std::string& name = body.parts[part].name;
    add_term(terms, {Metric::pixel_recall, part, name}, with_background.count(part, part),
             with_background.of_truth(part));
    add_term(terms, {Metric::pixel_recall_inside, part, name}, inside.count(part, part), inside.of_truth(part));
  }
  return terms;
}

MetricTerms mask_terms(const FrameTruth& truth, const LabelImage& labels, const DepthImage& depth) {
  std::uint64_t readings = 0;
  std::uint64_t body = 0;
  Overlap overlap;
  const bool has_mask = !truth.mask.empty();
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const bool given = labels[i] != kBackground;
    const bool person = has_mask && truth.mask[i] != 0;
    ++readings;
    body += given ? 1U : 0U;
    overlap.both += given && person ? 1U : 0U;
    overlap.either += given || person ? 1U : 0U;
  }
  MetricTerms terms;
  if (truth.people == 0) {
    add_term(terms, Metric::body_on_empty, body, readings);
  } else if (has_mask) {
    add_term(terms, Metric::pixel_person_iou, overlap.both, overlap.either);
  }
  return terms;
}

}  // namespace vesalius

#include "metrics/judge_samples.h"

#include <algorithm>
#include <array>

#include "metrics/match_people.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

/// The overlap of a candidate with people, in units of what a match needs.
struct Likeness {
  double as_person = 0.0;  ///< IoU with one person, or the larger share for the mask of all people
  double on_people = 0.0;  ///< share of its pixels on people
};

Likeness likeness(const Mask& mask, const FrameTruth& truth, const DepthImage& depth) {
  std::array<long, 256> of_person{};
  std::array<long, 256> shared{};
  long pixels = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const std::size_t who = !truth.person.empty() ? truth.person[i] : truth.mask[i] != 0 ? 0 : kBackground;
    ++of_person[who];
    if (mask[i] == 0) continue;
    ++shared[who];
    ++pixels;
  }
  if (pixels == 0) return {};
  const double on_people = double(pixels - shared[kBackground]) / double(pixels) / kShareOnMask;
  if (truth.person.empty()) {
    const double smaller = double(std::max(1L, std::min(pixels, of_person[0])));
    return {double(shared[0]) / smaller / kShareOnMask, on_people};
  }
  double best = 0.0;
  for (std::size_t who = 0; who < kBackground; ++who) {
    const auto either = double(of_person[who] + pixels - shared[who]);
    best = std::max(best, double(shared[who]) / either);
  }
  return {best / kMatchIou, on_people};
}

}  // namespace

std::vector<BoostSample> judge_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth) {
  std::vector<BoostSample> samples;
  const bool known = !truth.person.empty() || !truth.mask.empty();
  if (truth.people != 0 && !known) return samples;
  for (const Trace::Candidate& candidate : trace.candidates) {
    if (candidate.refined.found == 0) continue;
    const Likeness like = truth.people == 0 ? Likeness{} : likeness(candidate.grown, truth, depth);
    const bool person = like.as_person >= 1.0;
    if (person || std::max(like.as_person, like.on_people) < 0.5) {
      samples.push_back({judge_features(candidate.evidence), person});
    }
  }
  return samples;
}

}  // namespace vesalius
